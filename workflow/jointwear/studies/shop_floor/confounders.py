"""Ten things that a plant does to a robot and that are not wear, and the scenarios that are scored.

`warm_up` shifts, nights and weekends: the gears cool and warm up. `weather` the room follows day and weather.
`cold_spell` a door stays open for days. `products` two or three programs. `payload` loads that the log does not tell.
`override` the speed is turned down. `service` grease lowers the friction of some axes. `sensor_gain` the scale of the
torque steps. `messy` hours missing, cut short, at rest, or without a torque. `running_in` new gears run in.
Each scenario has none, one or all of them.
"""

from __future__ import annotations

CONFOUNDERS = (
    "warm_up", "weather", "cold_spell", "products", "payload", "override", "service", "sensor_gain", "messy",
    "running_in",
)  # fmt: skip
SCENARIOS = ("none", *CONFOUNDERS, "all")
#: What a robot may log of temperature, and how many of a fleet do.
THERMOMETERS = {"each axis": 0.5, "one": 0.25, "none": 0.25}


def scenario_of(index: int) -> str:
    """Return the scenario of a robot of a fleet: every second has everything, the others take turns."""
    return "all" if index % 2 == 0 else SCENARIOS[(index // 2) % (len(SCENARIOS) - 1)]


def present(scenario: str) -> frozenset[str]:
    """Return the confounders of a scenario."""
    if scenario == "all":
        return frozenset(CONFOUNDERS)
    return frozenset() if scenario == "none" else frozenset({scenario})
