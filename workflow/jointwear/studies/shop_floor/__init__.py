"""A shop floor made up for scoring the monitor: arms in closed loop, gears that warm up, shifts, products, messy logs.

Nothing here shares formulas with the effects of the library or with the reproduction: friction follows a film between
lubricated surfaces and a viscosity law of its own, gears are heated by what they dissipate, and the torque is what a
controller with an imperfect model asks of its motors. :mod:`.fast_path` hands a robot-month to the monitor as window
statistics, :mod:`.log_files` writes the same month as a user's logs, :mod:`.sample` scores a judge.
"""
