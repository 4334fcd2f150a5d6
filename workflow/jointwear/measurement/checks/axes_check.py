"""Check that positions and torques are those of the axes that the robot file names: order, signs, zeros, side."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from itertools import chain

import numpy as np

from jointwear.files.wording import significant
from jointwear.measurement.checks.axis_readings import (
    EXCHANGED,
    Likelihood,
    Reading,
    other_scale,
    readings,
    units_of_one,
)
from jointwear.measurement.checks.turned_signs import (
    Nats,
    in_doubt,
    likeliest_signs,
    nats_of_signs,
    needed_signs,
    turned_around,
)
from jointwear.measurement.derived.motion import Measured
from jointwear.measurement.refused import FEWEST_OF_JOINT, Refused
from jointwear.measurement.stated import Stated
from jointwear.measurement.turns import turns_on
from jointwear.measurement.units import POSITION_WORDS
from jointwear.robots.dynamics import Dynamics
from jointwear.robots.robot import Robot

#: Samples looked at by the checks against the model.
LOOK = 1500
#: One of so many of them is enough to rule out most other readings of the axes.
SOME = 8
#: Share of a sum of squares up to which rounding changes it.
ROUNDING = 1e-9
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
    "unit": 40.0, "base": 40.0, "position": 40.0,
}  # fmt: skip
#: Multiple of that of a flip where the model explains the axis as it is, so that nothing asks for another sign: a zero
#: of the torque that wanders over a day reached 41 nats for a wrist; of 45 flips 37 reach 100, none lies between. The
#: same for an exchange that moves what is wrong from one axis to the other: such a zero reached 30 on two of a wrist.
NOTHING_WRONG = 2.0
#: Share of them that is enough for a flip that fits far better in size too, but not :data:`BY_FAR`: a friction that
#: differs between the directions in the robot file and not in the robot reached a drop of 1.05 and 7 nats. A flip
#: needs all of them, however well it fits, where more of the torque is left than a right axis leaves (:data:`RIGHT`): a
#: hose on a joint about the vertical reached 1.16 and 21 nats, and left 5 %.
SIZE_TOO, BY_FAR = 0.5, 1.8
#: Readings that another cause resembles, a load, a mounting or a drive that two joints share: they have to fit far
#: better in size and be far likelier.
RESEMBLED = ("zero", "base", "torques", "positions", "position")
#: Readings that have to fit far better in size.
OF_SIZE = (*RESEMBLED, "unit")
#: Readings that leave the motion as it is.
OF_TORQUE = ("torques", "torque", "motor")
#: Why another reading is believed, as the end of the sentence that says what it is.
_WHY = {
    **dict.fromkeys(EXCHANGED, "; exchanged they fit the model"),
    "flip": "; turned around it fits the model",
    "torque": " against its motion",
    "position": " against its torque; turned around it fits the model",
    "motor": "",
    "zero": "; from there it fits the model",
    "base": "; taken from that link it fits the model",
    "unit": "; read so it fits the model",
    "scale": ": another unit, a current, or a share of a rating",
}
#: Share of the squared torque that wrong parameters leave of the right reading; axes of a wrist resemble each other, so
#: that an exchange of two needs more.
RIGHT, SAME_WRIST = 0.01, 0.03
#: Readings of the axes, of those that leave least, that another explanation of all joints has to be likelier than.
BEST = 3


def features(measured: Measured) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Positions, velocities, accelerations and torques of a thinned recording that moves, (m, 4, n)."""
    n = measured.position.shape[1]
    if not len(measured.time):
        return np.zeros((0, 4, n)), np.zeros(0), np.zeros((0, n), bool)
    step = max(1, len(measured.time) // LOOK)
    parts = (measured.position, measured.velocity, measured.acceleration, measured.torque)
    return np.stack([p[::step] for p in parts], axis=1), measured.time[::step], measured.usable[::step]


def explained(
    dynamics: Dynamics,
    parts: np.ndarray,
    usable: np.ndarray,
    loosely: bool = False,
    rigid: np.ndarray | None = None,
) -> np.ndarray:
    """Return for each axis the part (n,) of the squared torque that the model leaves, sizes of friction left free; NaN
    where fewer than `FEWEST_OF_JOINT` samples can be judged.

    Parameters
    ----------
    parts : (m, 4, n) position, velocity, acceleration, torque. usable : (m, n) bool.
    loosely : signs are left free too, and any number of samples is judged: never more, and several times as fast.
    rigid : (m, n) torque of the rigid bodies [N m] where it is known, default that of `parts`.
    """
    rigid = dynamics.rigid_body_torque(*(parts[:, k] for k in range(3))) if rigid is None else rigid
    if loosely:
        return _left_loosely(dynamics.robot, rigid, parts, usable)
    return _left(dynamics.robot, rigid, parts, usable, range(parts.shape[2]))


def _explained_at_least(dynamics: Dynamics, parts: np.ndarray, usable: np.ndarray, reading: Reading) -> np.ndarray:
    """Return for each axis no more than what :func:`explained` says of a reading, from one sample in :data:`SOME`.

    A fit to all samples leaves at least as much of these as a fit to them alone, however few they are.
    """
    some, known = reading.read(parts[::SOME], usable[::SOME], dynamics.robot)
    left = explained(dynamics, some, known, True) * np.sum(some[:, 3] ** 2, axis=0, where=known)
    read, known = reading.read(parts, usable, dynamics.robot)
    left /= np.maximum(np.sum(read[:, 3] ** 2, axis=0, where=known), 1e-12)
    return np.where(known.sum(axis=0) < FEWEST_OF_JOINT, np.nan, left)


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
        if used.sum() < FEWEST_OF_JOINT:
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


def _left_loosely(robot: Robot, rigid: np.ndarray, parts: np.ndarray, usable: np.ndarray) -> np.ndarray:
    """Return no more than :func:`_left` of all axes, (n,): what a projection leaves, by which rounding adds nothing."""
    _, v, a, torque = np.where(usable, parts.transpose(1, 0, 2), 0.0)
    level = np.where(v > 0, robot.coulomb_positive, robot.coulomb_negative)
    level = np.where(np.any(np.where(usable, level, 0.0), axis=0), level, np.where(v > 0, 1.0, -1.0))
    design = np.stack([np.where(usable, level, 0.0), v, a], axis=-1).transpose(1, 0, 2)
    wanted = np.where(usable, torque - rigid + robot.armature * a, 0.0).T
    along = np.linalg.qr(design)[0].transpose(0, 2, 1) @ wanted[..., None]
    square = np.sum(wanted**2, axis=1)
    left = np.maximum(square - np.sum(along[..., 0] ** 2, axis=1) - ROUNDING * square, 0.0)
    return left / np.maximum(np.sum(torque**2, axis=0), 1e-12)


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
    likelihood, robot = Likelihood(dynamics, FEWEST_OF_JOINT), dynamics.robot
    best = [reading for _, reading in sorted(scores, key=lambda x: x[0])[:BEST]]
    nats = [(likelihood(*reading.read(parts, usable, robot)), reading) for reading in best]
    return max(nats, key=lambda x: x[0])


def favours(reading: Reading, robot: Robot) -> float:
    """Return the log likelihood [nats] of :data:`FAVOURS` for a reading; without friction in the robot file nothing
    tells a torque of the motor by its size, and it needs as much as a turned one."""
    axis = reading.axes[0]
    rubs = np.any([robot.coulomb_positive[axis], robot.coulomb_negative[axis], robot.viscous[axis]])
    return FAVOURS["torque" if reading.kind == "motor" and not rubs else reading.kind]


def _enough(reading: Reading, gained: float, left: np.ndarray, other: np.ndarray, robot: Robot) -> float:
    """Return the nats by which a reading must be likelier that lowers the log of what is left by `gained`; one of
    :data:`OF_SIZE` lowers it by more than :data:`CLEARLY`.

    `left` and `other` are the shares of the squared torque (k,) that the model leaves of the axes concerned as they are
    and read so.
    """
    if gained <= CLEARLY:
        explained_as_is = reading.kind == "flip" and np.nanmax(left, initial=0.0) < RIGHT
        moved = reading.kind in EXCHANGED and bool(np.any((left < RIGHT) & (other > RIGHT)))
        return (NOTHING_WRONG if explained_as_is or moved else 1.0) * favours(reading, robot)
    wrong_still = reading.kind == "flip" and not np.nanmax(other, initial=0.0) < RIGHT
    if reading.kind in RESEMBLED or reading.several or wrong_still:
        return favours(reading, robot)
    return 0.0 if reading.kind == "swap" or gained > BY_FAR else SIZE_TOO * favours(reading, robot)


def _spoils(left: np.ndarray, other: np.ndarray) -> bool:
    """Whether an exchange makes a wrong axis of a right one: both axes of a true one are wrong as they are read.

    What one of the two lacks, a motor that turns with its neighbour, makes it resemble the other where all joints of
    pick and place move at the same times; the other then bears the exchange.

    Parameters
    ----------
    left, other : (2,) shares of the squared torque that the model leaves of the axes as they are and exchanged.
    """
    return bool(np.any((left < RIGHT) & (other > SAME_WRIST)))


def signs_of(robot: Robot, measured: Measured) -> Nats:
    """Return :func:`~.turned_signs.nats_of_signs` of a recording, which :func:`check_axes` and :func:`signs_in_doubt`
    both ask."""
    parts, _, usable = features(measured)
    return nats_of_signs(Dynamics(robot), parts, usable)


def check_axes(
    name: str, robot: Robot, measured: Measured, stated: Stated | None = None, signs: Nats | None = None
) -> bool:
    """Check order, signs and zeros of the axes, and the side of their torques, against the nominal model.

    Another reading must explain the data far better with the parameters of the nominal model as they are, and be the
    likelier one when these may be somewhat wrong; or it must be far more likely when they may. Returns whether there
    was enough motion to ask.

    Parameters
    ----------
    name : of the data set or the log, for messages. stated : what its configuration says already, default nothing.
    signs : of :func:`signs_of` of the same arguments, default they are worked out.

    Raises
    ------
    Refused : for swapped joints, torques or positions, a flipped axis, motor-side torque, another zero.
    """
    parts, time, usable = features(measured)
    if len(time) < FEWEST_OF_JOINT:
        return False
    dynamics = Dynamics(robot)
    left = explained(dynamics, parts, usable)
    if not np.isfinite(left).any():
        return False
    signs = signs or nats_of_signs(dynamics, parts, usable)
    if believed := _believed(dynamics, parts, usable, left, signs):
        raise _refusal(name, dynamics, parts, usable, left, believed, stated or Stated())
    return True


#: A reading that is believed: by how many nats it is likelier, and the shares (n,) that it leaves of the axes.
_Reading = tuple[float, Reading, np.ndarray]


def _believed(
    dynamics: Dynamics, parts: np.ndarray, usable: np.ndarray, left: np.ndarray, signs: Nats
) -> list[_Reading]:
    """Return the other readings of the axes that explain the data far better; the arguments are those of
    :func:`explained`, `left` (n,) is what it returns, and `signs` are those of :func:`signs_of`."""
    robot, likelihood = dynamics.robot, Likelihood(dynamics, FEWEST_OF_JOINT)
    as_read: float | None = None
    believed: list[_Reading] = []

    def gained(reading: Reading, other: np.ndarray) -> float:
        floor = SAME_WRIST if reading.kind in EXCHANGED else RIGHT
        return total_left(left, floor) - total_left(other, floor)

    def refuted(reading: Reading, other: np.ndarray) -> bool:
        concerned, gain = other[list(reading.axes)], gained(reading, other)
        if reading.kind in EXCHANGED and _spoils(left[list(reading.axes)], concerned):
            return True
        # What has to fit far better in size is not asked how likely it is where it does not.
        worse = gain <= CLEARLY if reading.kind in OF_SIZE or reading.several else gain < -CLEARLY
        return worse or not np.nanmax(concerned, initial=0.0) < WRONG

    def several() -> Iterator[tuple[Reading, np.ndarray]]:
        for reading in _turned_together(dynamics, parts, usable, left, signs):
            yield reading, explained(dynamics, *reading.read(parts, usable, robot))

    for reading, other in chain(explained_otherwise(dynamics, parts, usable, refuted), several()):
        if refuted(reading, other):
            continue
        if reading.kind in EXCHANGED and not np.isfinite(other[list(reading.axes)]).any():
            # What an exchange of two axes does to the others does not tell of them where both hardly move.
            continue
        as_read = likelihood(parts, usable) if as_read is None else as_read
        nats = likelihood(*reading.read(parts, usable, robot)) - as_read
        concerned = list(reading.axes)
        if nats > _enough(reading, gained(reading, other), left[concerned], other[concerned], robot):
            believed.append((nats, reading, other))
    return believed


def _turned_together(
    dynamics: Dynamics, parts: np.ndarray, usable: np.ndarray, left: np.ndarray, signs: Nats
) -> Iterator[Reading]:
    """Yield the readings that turn several joints around, or the torques of several; `left` and `signs` as of
    :func:`_believed`."""
    needed = needed_signs(signs, likeliest_signs(signs, parts.shape[2]), FAVOURS["flip"])
    if len(needed) > 1:
        yield turned_around(needed)
    # The torque of a joint says nothing of that of another: each that fits far better turned around is.
    everyone = Reading("torque", tuple(range(parts.shape[2])))
    other = explained(dynamics, *everyone.read(parts, usable, dynamics.robot))
    with np.errstate(invalid="ignore"):
        better = np.log(np.maximum(left, RIGHT)) - np.log(np.maximum(other, RIGHT)) > CLEARLY
    if better.sum() > 1:
        yield Reading("torque", tuple(np.flatnonzero(better).tolist()))


def signs_in_doubt(robot: Robot, measured: Measured, signs: Nats, stated: Stated | None = None) -> list[str]:
    """Return in words the signs of joints that would fit better, though by too little to refuse a recording.

    Parameters
    ----------
    measured, signs, stated : as of :func:`check_axes`, which did not refuse them.
    """
    parts, time, usable = features(measured)
    if len(time) < FEWEST_OF_JOINT:
        return []
    dynamics = Dynamics(robot)
    return list(in_doubt(lambda turned: explained(dynamics, turned, usable), signs, parts, stated or Stated()))


def _refusal(
    name: str,
    dynamics: Dynamics,
    parts: np.ndarray,
    usable: np.ndarray,
    left: np.ndarray,
    believed: list[_Reading],
    stated: Stated,
) -> Refused:
    """Return the refusal that names the likeliest of the readings that are believed, and those that are nearly as
    likely; `name`, `stated` and `left` are those of :func:`check_axes` and :func:`_believed`."""
    robot = dynamics.robot
    nats, reading, remains = max(believed, key=lambda x: x[0])
    # A joint that turns the other way does what it does where the two beside it count from half a turn further.
    also = [r for n, r, _ in believed if r is not reading and n > nats - favours(reading, robot)]
    if reading.kind == "flip":
        # Of those that are not needed some may be turned around as well.
        signs = nats_of_signs(dynamics, parts, usable)
        best = turned_around(likeliest_signs(signs, robot.joints))
        also += [best] if reading.several and set(best.axes) > set(reading.axes) else []
    # Friction of another size may ask for another axis, too.
    if scaled := other_scale(dynamics, parts, usable):
        likelihood = Likelihood(dynamics, FEWEST_OF_JOINT)
        lead = likelihood(*scaled.read(parts, usable, robot)) - likelihood(parts, usable)
        if lead > nats + favours(reading, robot):
            reading, also, remains = scaled, [], left
    if reading.kind == "unit" and (of_all := _unit_of_all(dynamics, parts, usable, reading, remains, stated)):
        return Refused(f"{name}: {of_all[0]}", of_all[1], by_keys=True, readings=[reading.kind])
    others = "".join(f"; or {r.reason}" for r in also)
    remedies = "".join(f"; or {r.remedy_beside(stated)}" for r in also)
    too_much, another = even_so(remains, robot)
    why = f"{_WHY[reading.kind]}{others}{too_much}"
    by_keys, kinds = any(r.by_keys for r in (reading, *also)), [r.kind for r in (reading, *also)]
    remedy = f"{reading.remedy_beside(stated)}{remedies}{another}"
    return Refused(f"{name}: {reading.reason}{why}", remedy, by_keys, kinds)


def _unit_of_all(
    dynamics: Dynamics, parts: np.ndarray, usable: np.ndarray, reading: Reading, remains: np.ndarray, stated: Stated
) -> tuple[str, str] | None:
    """Return reason and remedy where all joints are in the unit that one of them looks like.

    One key is wrong more often than one joint is odd, and what is friction nearly alone fits in any unit.

    Parameters
    ----------
    reading : of that joint in another unit. remains : (n,) share of the squared torque that it leaves.
    """
    unit, robot = reading.looks_like(stated), dynamics.robot
    every = parts.copy()
    every[:, :3] *= reading.factors[0]
    reach = np.where(turns_on(robot), np.inf, np.maximum(np.abs(robot.lower), np.abs(robot.upper)))
    if not unit or np.any(np.abs(every[:, 0]).max(axis=0, initial=0.0) > reach):
        return None
    left = explained(dynamics, every, usable)
    if np.any(left > np.maximum(remains, RIGHT)):
        return None
    said, words = stated.units.get("position"), POSITION_WORDS[unit]
    if not said:
        return f"the positions look like {words}", f"state units: {{position: {unit}}}"
    return (
        f"the positions look like {words}, their stated unit is {said}",
        f"state units: {{position: {unit}}}, or take 'units.position' out where it says {said}",
    )


def even_so(left: np.ndarray, robot: Robot) -> tuple[str, str]:
    """Return the ends of a reason and of its remedy where what it leaves of the axes (n,), as of :func:`explained`, is
    more than a right one leaves of most: then the robot file may be that of another arm. Else nothing."""
    share = float(np.nanmedian(left))
    if not share > RIGHT:
        return "", ""
    return (
        f"; even so the model leaves {significant(100 * share, 2)} % of the squared torque",
        f"; or name the robot file of this arm, if that of '{robot.name}' is another's",
    )
