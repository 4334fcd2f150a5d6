"""Refuse recordings that cannot belong to the robot as they stand, and say in words what others cannot show."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping

import numpy as np

from jointwear.files.errors import InputError
from jointwear.files.wording import count
from jointwear.measurement.axis_readings import (
    EXCHANGED,
    Likelihood,
    Reading,
    other_scale,
    readings,
    units_of_one,
)
from jointwear.measurement.motion import Measured
from jointwear.measurement.recording import Recording
from jointwear.measurement.turns import turns_on
from jointwear.measurement.units import POSITION_WORDS, sizes_of
from jointwear.robots.dynamics import Dynamics
from jointwear.robots.robot import Robot
from jointwear.statistics.runs import runs

#: Samples looked at by the checks against the model.
LOOK = 1500
#: One of so many of them is enough to rule out most other readings of the axes.
SOME = 8
FEWEST = 40
#: What is measured of every joint, as far as it is given.
_ROLES = ("position", "torque", "velocity", "acceleration")
#: Drop of the log residual, summed over axes, from which another reading of the axes is believed, and down to which
#: it is worth a closer look.
CLEARLY = 0.9
#: Share of the squared torque of an axis that a right reading of it never leaves.
WRONG = 0.5
#: Log likelihood [nats] by which the closer look must favour another reading that fits no better in size. What a robot
#: file lacks reached 26 (a flip) and 19 (a swap) in right logs of some 600 simulated robots, as residuals repeat with
#: the motion; of 347 flips on 56 simulated arms 289 reach 40, 294 reach 25. A torque of the motor is told from the size
#: of its friction, which no load changes; see :func:`favours`.
FAVOURS = {
    "swap": 25.0, "flip": 40.0, "torque": 40.0, "motor": 12.0, "zero": 40.0, "torques": 40.0, "positions": 40.0,
    "unit": 40.0,
}  # fmt: skip
#: Multiple of that of a flip where the model explains the axis as it is, so that nothing asks for another sign: a zero
#: of the torque that wanders over a day reached 41 nats for a wrist; of 45 flips 37 reach 100, none lies between.
NOTHING_WRONG = 2.0
#: Share of them that is enough for a flip that fits far better in size too, but not :data:`BY_FAR`: a friction that
#: differs between the directions in the robot file and not in the robot reached a drop of 1.05 and 7 nats.
SIZE_TOO, BY_FAR = 0.5, 1.8
#: Readings that another cause resembles, a load, a mounting or a drive that two joints share: they have to fit far
#: better in size and be far likelier.
RESEMBLED = ("zero", "torques", "positions")
#: Readings that have to fit far better in size.
OF_SIZE = (*RESEMBLED, "unit")
#: Readings that leave the motion as it is.
OF_TORQUE = ("torques", "torque", "motor")
#: Why another reading is believed, as the end of the sentence that says what it is.
_WHY = {
    **dict.fromkeys(EXCHANGED, "; exchanged they fit the model"),
    "flip": "; turned around it fits the model",
    "torque": " against its motion",
    "motor": "",
    "zero": "; from there it fits the model",
    "unit": "; read so it fits the model",
    "scale": ": another unit, a current, or a share of a rating",
}
#: Share of the squared torque that wrong parameters leave of the right reading; axes of a wrist resemble each other, so
#: that an exchange of two needs more.
RIGHT, SAME_WRIST = 0.01, 0.03
#: Readings of the axes, of those that leave least, that another explanation of all joints has to be likelier than.
BEST = 3


#: Share of the samples that positions are judged by.
NEARLY_ALL = 0.995
#: Position [rad] from which a joint tells whether it is in degrees: as such it would be a hundredth of a turn.
AT_ZERO = 0.06
#: Temperatures [degC] that no drive works at for long; below the one are 400 K, above the other no degC less 273.
HOTTEST, COLDEST = 200.0, -100.0


class Refused(InputError):
    """A recording that must not be judged.

    Attributes
    ----------
    suggestion : what to mend, in words. by_keys : it names keys of the configuration or of the robot file, which hold
        for all logs of a robot: where others are right, such a key would spoil them.
    """

    def __init__(self, reason: str, suggestion: str, by_keys: bool = False) -> None:
        super().__init__(reason)
        self.reason, self.suggestion, self.by_keys = reason, suggestion, by_keys


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
    if len(recording.time) < FEWEST:
        raise Refused(
            f"data set '{name}': has {count(len(recording.time), 'sample')}; at least {FEWEST} are needed",
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
            few = inside.sum() > over.sum()
            alone = f"; where the other joints are right, write joint {axis + 1} in their unit" if few else ""
            read = "" if stated == "rad" else f" once they are read as {POSITION_WORDS[stated]}"
            raise Refused(
                f"data set '{recording.name}': positions of joint {axis + 1} reach {largest[axis]:.4g}{read}, its "
                f"limits are {robot.lower[axis]:.3g} to {robot.upper[axis]:.3g} rad; they look like "
                f"{POSITION_WORDS[unit]}",
                f"state units: {{position: {unit}}}{alone}",
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
    sizes = sizes_of("position")
    for unit in sorted(sizes, key=sizes.__getitem__, reverse=True):
        if sizes[unit] < sizes.get(stated, 1.0):
            yield unit, sizes[unit] / sizes.get(stated, 1.0)


def _features(measured: Measured) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Positions, velocities, accelerations and torques of a thinned recording that moves, (m, 4, n)."""
    n = measured.position.shape[1]
    if not len(measured.time):
        return np.zeros((0, 4, n)), np.zeros(0), np.zeros((0, n), bool)
    step = max(1, len(measured.time) // LOOK)
    parts = (measured.position, measured.velocity, measured.acceleration, measured.torque)
    return np.stack([p[::step] for p in parts], axis=1), measured.time[::step], measured.usable[::step]


def explained(dynamics: Dynamics, parts: np.ndarray, usable: np.ndarray) -> np.ndarray:
    """Return for each axis the part (n,) of the squared torque that the model leaves, sizes of friction left free; NaN
    where fewer than `FEWEST` samples can be judged.

    Parameters
    ----------
    parts : (m, 4, n) position, velocity, acceleration, torque. usable : (m, n) bool.
    """
    rigid = dynamics.rigid_body_torque(*(parts[:, k] for k in range(3)))
    return _left(dynamics.robot, rigid, parts, usable, range(parts.shape[2]))


def _explained_at_least(dynamics: Dynamics, parts: np.ndarray, usable: np.ndarray, reading: Reading) -> np.ndarray:
    """Return for each axis no more than what :func:`explained` says of a reading, from one sample in :data:`SOME`.

    A fit to all samples leaves at least as much of these as a fit to them alone.
    """
    some, known = reading.read(parts[::SOME], usable[::SOME], dynamics.robot)
    left = np.nan_to_num(explained(dynamics, some, known)) * np.sum(some[:, 3] ** 2, axis=0, where=known)
    read, known = reading.read(parts, usable, dynamics.robot)
    left /= np.maximum(np.sum(read[:, 3] ** 2, axis=0, where=known), 1e-12)
    return np.where(known.sum(axis=0) < FEWEST, np.nan, left)


def explained_otherwise(
    dynamics: Dynamics,
    parts: np.ndarray,
    usable: np.ndarray,
    refuted: Callable[[Reading, np.ndarray], bool] | None = None,
) -> Iterator[tuple[Reading, np.ndarray]]:
    """Yield every other reading of the axes with what :func:`explained` says of it, (n,).

    Parameters
    ----------
    parts, usable : as of :func:`explained`.
    refuted : whether a reading that leaves so much, or more, is none: it is left out where a part of the samples tells.
        Default: all are yielded.
    """
    robot, axes = dynamics.robot, range(parts.shape[2])
    rigid = dynamics.rigid_body_torque(*(parts[:, k] for k in range(3)))
    plain: np.ndarray | None = None
    for reading in (*readings(robot), *units_of_one(robot, parts[:, 0])):
        if reading.kind not in OF_TORQUE:
            if refuted is None or not refuted(reading, _explained_at_least(dynamics, parts, usable, reading)):
                yield reading, explained(dynamics, *reading.read(parts, usable, robot))
            continue
        turned = reading.read(parts, usable, robot)
        # The motion is the same, and so are all axes but those of the reading.
        plain = _left(robot, rigid, parts, usable, axes) if plain is None else plain
        left, concerned = plain.copy(), list(reading.axes)
        left[concerned] = _left(robot, rigid, *turned, concerned)[concerned]
        yield reading, left


def _left(robot: Robot, rigid: np.ndarray, parts: np.ndarray, usable: np.ndarray, axes: Iterable[int]) -> np.ndarray:
    """Return :func:`explained` for some axes, NaN for the others; `rigid` (m, n) torque of the rigid bodies."""
    from scipy.optimize import nnls

    shares = np.full(parts.shape[2], np.nan)
    for j in axes:
        used = usable[:, j]
        if used.sum() < FEWEST:
            continue
        v, a, torque = parts[used, 1:, j].T
        forward = v > 0
        level = np.where(forward, robot.coulomb_positive[j], robot.coulomb_negative[j])
        if not np.any(level):
            level = np.where(forward, 1.0, -1.0)
        # Friction and motor inertia cannot drive: their coefficients are not negative.
        design = np.stack([level, v, a], axis=1)
        _, norm = nnls(design, torque - rigid[used, j] + robot.armature[j] * a)
        shares[j] = norm**2 / max(float(np.sum(torque**2)), 1e-12)
    return shares


def total_left(left: np.ndarray, floor: float) -> float:
    """Return the total log of what is left of the axes (n,): lower is better, but below `floor` no better."""
    return float(np.nansum(np.log(np.maximum(left, floor))))


def best_reading(dynamics: Dynamics, parts: np.ndarray, usable: np.ndarray) -> tuple[float, Reading]:
    """Return the likeliest of the other readings of the axes that leave least, with its log likelihood [nats].

    Parameters
    ----------
    parts, usable : as of :func:`explained`, (m, 4, n) and (m, n).
    """
    scores = [(total_left(left, RIGHT), reading) for reading, left in explained_otherwise(dynamics, parts, usable)]
    likelihood, robot = Likelihood(dynamics, FEWEST), dynamics.robot
    best = [reading for _, reading in sorted(scores, key=lambda x: x[0])[:BEST]]
    nats = [(likelihood(*reading.read(parts, usable, robot)), reading) for reading in best]
    return max(nats, key=lambda x: x[0])


def favours(reading: Reading, robot: Robot) -> float:
    """Return the log likelihood [nats] of :data:`FAVOURS` for a reading; without friction in the robot file nothing
    tells a torque of the motor by its size, and it needs as much as a turned one."""
    axis = reading.axes[0]
    rubs = np.any([robot.coulomb_positive[axis], robot.coulomb_negative[axis], robot.viscous[axis]])
    return FAVOURS["torque" if reading.kind == "motor" and not rubs else reading.kind]


def _enough(reading: Reading, gained: float, left: np.ndarray, robot: Robot) -> float:
    """Return the nats by which a reading must be likelier that lowers the log of what is left by `gained`.

    `left` is the share of the squared torque (k,) that the model leaves of the axes concerned as they are.
    """
    if gained <= CLEARLY:
        doubt = NOTHING_WRONG if reading.kind == "flip" and np.nanmax(left, initial=0.0) < RIGHT else 1.0
        return np.inf if reading.kind in OF_SIZE else doubt * favours(reading, robot)
    if reading.kind in RESEMBLED:
        return favours(reading, robot)
    return 0.0 if reading.kind == "swap" or gained > BY_FAR else SIZE_TOO * favours(reading, robot)


def check_axes(name: str, robot: Robot, measured: Measured) -> bool:
    """Check order, signs and zeros of the axes, and the side of their torques, against the nominal model.

    Another reading must explain the data far better with the parameters of the nominal model as they are, and be the
    likelier one when these may be somewhat wrong; or it must be far more likely when they may. Returns whether there
    was enough motion to ask.

    Parameters
    ----------
    name : of the data set or the log, for messages.

    Raises
    ------
    Refused : for swapped joints, torques or positions, a flipped axis, motor-side torque, another zero.
    """
    parts, time, usable = _features(measured)
    if len(time) < FEWEST:
        return False
    dynamics = Dynamics(robot)
    left = explained(dynamics, parts, usable)
    if not np.isfinite(left).any():
        return False
    likelihood = Likelihood(dynamics, FEWEST)
    as_read: float | None = None
    believed: list[tuple[float, Reading, np.ndarray]] = []

    def gained(reading: Reading, other: np.ndarray) -> float:
        floor = SAME_WRIST if reading.kind in EXCHANGED else RIGHT
        return total_left(left, floor) - total_left(other, floor)

    def refuted(reading: Reading, other: np.ndarray) -> bool:
        concerned = other[list(reading.axes)]
        return gained(reading, other) < -CLEARLY or not np.nanmax(concerned, initial=0.0) < WRONG

    for reading, other in explained_otherwise(dynamics, parts, usable, refuted):
        if refuted(reading, other):
            continue
        if reading.kind in EXCHANGED and not np.isfinite(other[list(reading.axes)]).any():
            # What an exchange of two axes does to the others does not tell of them where both hardly move.
            continue
        as_read = likelihood(parts, usable) if as_read is None else as_read
        nats = likelihood(*reading.read(parts, usable, robot)) - as_read
        if nats > _enough(reading, gained(reading, other), left[list(reading.axes)], robot):
            believed.append((nats, reading, other))
    if believed:
        nats, reading, remains = max(believed, key=lambda x: x[0])
        # A joint that turns the other way does what it does where the two beside it count from half a turn further.
        also = [r for n, r, _ in believed if r is not reading and n > nats - favours(reading, robot)]
        # Friction of another size may ask for another axis, too.
        scaled = other_scale(dynamics, parts, usable)
        if scaled and likelihood(*scaled.read(parts, usable, robot)) - as_read > nats + favours(reading, robot):
            reading, also, remains = scaled, [], left
        others, remedies = "".join(f"; or {r.reason}" for r in also), "".join(f"; or {r.remedy}" for r in also)
        too_much, another = even_so(remains, robot)
        why = f"{_WHY[reading.kind]}{others}{too_much}"
        by_keys = any(r.by_keys for r in (reading, *also))
        raise Refused(f"{name}: {reading.reason}{why}", f"{reading.remedy}{remedies}{another}", by_keys)
    return True


def even_so(left: np.ndarray, robot: Robot) -> tuple[str, str]:
    """Return the ends of a reason and of its remedy where what it leaves of the axes (n,), as of :func:`explained`, is
    more than a right one leaves of most: then the robot file may be that of another arm. Else nothing."""
    share = float(np.nanmedian(left))
    if not share > RIGHT:
        return "", ""
    return (
        f"; even so the model leaves {100 * share:.2g} % of the squared torque",
        f"; or name the robot file of this arm, if that of '{robot.name}' is another's",
    )
