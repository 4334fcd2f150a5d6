"""The hidden-effect test on plants of another maker: arms that controllers move in MuJoCo, their logs for discovery.

The plants share no formula with the library of effects: friction, springs, couplings, elastic gears, delays and loads
are MuJoCo's own. Needs the packages of `requirements/plants.txt`.
"""
