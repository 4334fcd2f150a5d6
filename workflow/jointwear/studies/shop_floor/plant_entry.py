"""What the user of a robot writes into the config: baseline, limit, stated rate, and the events that were told."""

from __future__ import annotations

from typing import Any

from jointwear.measurement.timestamps import stamp
from jointwear.studies.shop_floor.cell import Cell
from jointwear.studies.shop_floor.month import BASELINE_DAYS
from jointwear.studies.shop_floor.sensing import START

#: Growth [%] of the limit that forecasts count down to.
LIMIT = 20.0
#: False alarms per 1,000 h that a user states where nothing else is asked for.
STATED = 1.0


def entry_of(cell: Cell, rate: float) -> dict[str, Any]:
    """Return the entry of the config that a user of this robot writes, without its logs and robot file."""
    baseline = START + 86_400 * BASELINE_DAYS
    events = [
        {
            "time": stamp(START + 3600 * event.hour, True),
            "axes": [j + 1 for j in event.axes],
            "kind": event.kind,
            "note": "greased" if event.kind == "service" else "torque scale changed",
        }
        for event in cell.events
        if event.told
    ]
    return {
        "window": "1h",
        "baseline": {"until": stamp(baseline, True)},
        "limits": {"coulomb_increase_percent": LIMIT},
        "false_alarms_per_1000_h": rate,
    } | ({"events": events} if events else {})
