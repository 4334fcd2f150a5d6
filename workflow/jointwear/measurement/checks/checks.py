"""Refuse recordings whose sizes, labels, times or units cannot be, and say in words what others cannot show."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

import numpy as np

from jointwear.files.wording import count, numbered
from jointwear.measurement.recording import Recording
from jointwear.measurement.refused import FEWEST_OF_JOINT, Refused
from jointwear.measurement.turns import turns_on
from jointwear.measurement.units import POSITION_WORDS, size_of, sizes_of
from jointwear.robots.robot import Robot
from jointwear.statistics.runs import runs

#: What is measured of every joint, as far as it is given.
_ROLES = ("position", "torque", "velocity", "acceleration")
#: Share of the samples that positions are judged by.
NEARLY_ALL = 0.995
#: Position [rad] from which a joint tells whether it is in degrees: as such it would be a hundredth of a turn.
AT_ZERO = 0.06
#: Temperatures [degC] that no drive works at for long; below the one are 400 K, above the other no degC less 273.
HOTTEST, COLDEST = 200.0, -100.0


def check_recording(recording: Recording, robot: Robot) -> list[str]:
    """Check size, gaps and units of a recording; return restrictions in words.

    Raises
    ------
    Refused : for another number of joints, degrees, kelvin, too few or no finite samples.
    """
    name = recording.name
    if recording.joints != robot.joints:
        raise Refused(
            f"data set '{name}': has {count(recording.joints, 'joint')}, robot '{robot.name}' has {robot.joints}",
            "name the robot file of this arm, or map the right columns",
        )
    if len(recording.time) < FEWEST_OF_JOINT:
        raise Refused(
            f"data set '{name}': has {count(len(recording.time), 'sample')}; at least {FEWEST_OF_JOINT} are needed",
            "record longer",
        )
    _check_labels(recording)
    given = {role: x for role in _ROLES if (x := getattr(recording, role)) is not None}
    good = np.all([np.isfinite(x).all(axis=1) for x in given.values()], axis=0)
    if not np.isfinite(recording.time).all():
        raise Refused(f"data set '{name}': the time holds values that are not finite", "repair the time stamps")
    if good.mean() < 0.2:
        raise Refused(
            f"data set '{name}': only {100 * good.mean():.0f} % of the samples are finite in every joint"
            f"{_of_whom(given)}",
            "map the measured columns, or leave the gaps out; velocities and accelerations that are left out under "
            "'variables' are derived",
            by_keys=True,
        )
    _units(recording, robot, good)
    restrictions = [recording.unread] if recording.unread else []
    if good.mean() < 1.0:
        restrictions.append(f"{100 * (1 - good.mean()):.2g} % of the samples are {_lost(recording)} and were left out")
    if len(recording.time) < 400:
        restrictions.append(f"only {count(len(recording.time), 'sample')}: weak effects cannot be seen")
    return restrictions


def _lost(recording: Recording) -> str:
    """Return in words why samples count as missing."""
    told = [
        f"{' and '.join(f'{x:g}' for x in numbers)} of the {role}"
        for role, numbers in recording.missing.items()
        if role != "temperature"
    ]
    return f"missing or not finite (read as missing: {', '.join(told)})" if told else "missing or not finite"


def _check_labels(recording: Recording) -> None:
    """Check that the samples of a trajectory lie together.

    Raises
    ------
    Refused : with the sample at which one comes back, and whether its time had passed before: rows that come twice must
        not be labelled apart, or a recording would be tested on itself.
    """
    seen: set[int] = set()
    for run in runs(recording.trajectory):
        label = int(recording.trajectory[run.start])
        if label in seen:
            back = f"data set '{recording.name}': trajectory {label} comes back at sample {run.start + 1}, after others"
            until = np.max(recording.time[: run.start][recording.trajectory[: run.start] == label])
            if recording.time[run.start] <= until:
                raise Refused(
                    f"{back}, with a time ({recording.time[run.start]:.9g} s) that it had passed (it had come to "
                    f"{until:.9g} s): rows come twice or in another order",
                    "leave out rows that come twice and put the others in order; only another recording, with a clock "
                    "of its own, gets a label of its own",
                )
            raise Refused(back, "label every run of samples apart, as by counting them: each is left out in turn")
        seen.add(label)


def _of_whom(given: Mapping[str, np.ndarray]) -> str:
    """Return in words which columns are hardly ever finite."""
    found = []
    for role, values in given.items():
        finite = np.isfinite(values).mean(axis=0)
        found += [f"the {role} of joint {j + 1} in {100 * finite[j]:.0f} %" for j in np.flatnonzero(finite < 0.5)]
    return f"; {', '.join(found)}" if found else ""


def _of_motors(largest: np.ndarray, reach: np.ndarray, robot: Robot) -> str:
    """Return what to do where largest positions (n,) [rad] beyond the reach (n,) [rad] of all joints are of motors."""
    ratio = np.abs(robot.gear_ratio)
    if np.any(ratio <= 1.0) or np.any(largest / ratio > reach) or np.mean(largest > reach) <= 0.5:
        return ""
    return (
        "; where they are angles of the motors, divide those of each joint by its gear_ratio, and give the gear_ratios "
        "as 'scale' where the torques are of the motors too"
    )


def _units(recording: Recording, robot: Robot, good: np.ndarray) -> None:
    """Positions far outside the limits that come inside in a smaller unit are in that one; 200 and more is kelvin."""
    q = recording.position[good]
    reach = np.maximum(np.abs(robot.lower), np.abs(robot.upper))
    # Some samples may be no positions at all.
    largest = np.quantile(np.abs(q), NEARLY_ALL, axis=0)
    over = largest > np.maximum(1.5 * reach, reach + 1.0)
    # A joint that turns on and on is beyond its limits alone; in degrees most joints that are not at zero are.
    inside = ~over & (largest > AT_ZERO)
    if not np.any(over & ~turns_on(robot)) and over.sum() <= inside.sum():
        over[:] = False
    stated = recording.units.get("position") or "rad"
    for unit, share in _smaller_units(stated):
        if over.any() and np.mean(share * largest <= reach + 0.5) > 0.5 and largest.max() > 10:
            axis = int(np.argmax(largest / reach))
            others = numbered("joint", np.flatnonzero(over) + 1)
            # One key holds for all joints: following it, those that are right would be read in the smaller unit.
            alone = f"; where the other joints are right, write {others} in their unit" if inside.any() else ""
            motors = _of_motors(largest, reach, robot) if stated == "rad" else ""
            read = "" if stated == "rad" else f" once they are read as {POSITION_WORDS.get(stated, stated)}"
            raise Refused(
                f"data set '{recording.name}': positions of joint {axis + 1} reach {largest[axis]:.4g}{read}, its "
                f"limits are {robot.lower[axis]:.3g} to {robot.upper[axis]:.3g} rad; they look like "
                f"{POSITION_WORDS[unit]}",
                f"state units: {{position: {unit}}}{alone}{motors}",
                by_keys=True,
            )
    warm = None if recording.temperature is None else recording.temperature[np.isfinite(recording.temperature)]
    if warm is not None and len(warm) and np.median(warm) > HOTTEST:
        raise Refused(
            f"data set '{recording.name}': the temperature is {np.median(warm):.4g} in the median; it looks like "
            "kelvin",
            "state units: {temperature: K}",
            by_keys=True,
        )
    if recording.units.get("temperature") == "K" and warm is not None and len(warm) and np.median(warm) < COLDEST:
        raise Refused(
            f"data set '{recording.name}': the temperature is {np.median(warm):.4g} degC in the median; it looks like "
            "degC that is read as kelvin",
            "state units: {temperature: degC}",
            by_keys=True,
        )


def _smaller_units(stated: str) -> Iterator[tuple[str, float]]:
    """Yield the units of positions that are smaller than the stated one, the largest first, and their shares of it."""
    sizes, own = sizes_of("position"), size_of("position", stated)
    for unit in sorted(sizes, key=sizes.__getitem__, reverse=True):
        if sizes[unit] < own:
            yield unit, sizes[unit] / own
