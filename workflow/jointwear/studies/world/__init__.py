"""The hidden-effect test on plants from another simulator: arms that controllers move in MuJoCo, and their logs.

The plants share no formula with the library of effects: friction, springs, couplings, elastic gears, delays and loads
are MuJoCo's own. Needs the packages of `requirements/plants.txt`.
"""
