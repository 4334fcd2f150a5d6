"""The hidden-effect test: make data sets in which a known effect is hidden, and score what discovery says of them.

The generator (everything but :mod:`scoring`, :mod:`peers` and :mod:`solve`) has its own formulas. It shares the rigid
body with the rest of the library and nothing of the effects that discovery searches for, so that a right answer is
more than a formula meeting itself.
"""
