"""Rows of a fleet as the judgement of its robots leaves them."""

from jointwear.monitor.findings.findings import fell_words
from jointwear.monitor.fleet.page import robot_item
from jointwear.monitor.local_time import zone_of
from jointwear.monitor.presentation.condition import CHANGED, HEALTHY, UNJUDGED, UNRESOLVED
from jointwear.monitor.presentation.standing import NOTHING

NOW = 1_767_225_600.0
DAY = 86400.0


def axis(number=1, level=HEALTHY, **more):
    calm = {"reached": False, "growth": 0.1, "growth_std": 0.1, "limit": 20.0, "hours": None, "quantity": "",
            "change": None, "unit": "", "since": None, "alarms": 0, "check": "", "viscous_growth": None}  # fmt: skip
    if level in (CHANGED, UNRESOLVED):
        calm |= {"quantity": "coulomb friction", "since": NOW - DAY, "alarms": 3, "check": "check the gear"}
    found = {"axis": number, "joint": f"joint_{number}", "level": level, **calm, **more}
    moments = [None if h is None else NOW - 3600 + 3600 * h for h in found["hours"] or ()]
    return {**found, "limit_at": moments or None}


def robot(name, *axes, **more):
    found = {"robot": name, "folder": name, "result": "judged", "logs": 10, "windows": 240, "last_sample": NOW - 3600,
             "rhythm_hours": 24.0, "dated": True, "axes": list(axes) or [axis()]}  # fmt: skip
    return {**NOTHING, **found, **more}


FLEET = [
    robot("calm"),
    robot("worn", axis(2, CHANGED, growth=12.0, hours=[200.0, 90.0, None])),
    robot("sooner", axis(3, CHANGED, growth=9.0, viscous_growth=31.0, hours=[80.0, 40.0, 400.0])),
    robot("done", axis(1, CHANGED, growth=23.0, hours=[0.0, 0.0, 0.0], reached=True)),
    robot("broken", result="refused", reason="degrees <b>", axes=[], refused_logs=10),
    robot("odd", axis(2, UNRESOLVED), copied_logs=3),
    robot("silent", last_sample=NOW - 5 * DAY),
    robot("still", axis(1, UNJUDGED), unjudged_logs=10, unjudged_windows=240),
]


def fall(axis, days=0, **more):
    found = {"time": NOW - days * DAY, "axes": [axis], "kind": "proposed_service", "words": fell_words([axis])}
    return {**found, "fell": True, **more}


def began(days, judged_after=4.0):
    told = {"time": NOW - days * DAY, "axes": [], "kind": "program", "words": "A program began.", "ran": 6.0}
    return {**told, "judged_after": judged_after}


def findings_on_card(row):
    """Findings that the page of the fleet shows of a robot, those that ask for something before its notes."""
    item = robot_item(row, zone_of(None), "robots")
    return [*item["open"], *item["notes"]]
