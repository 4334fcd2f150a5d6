"""Torques that are another multiple of the model's than one: another unit, a current, a share of a rating."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from jointwear.files.wording import numbered, significant
from jointwear.measurement.checks.axis_readings import Likelihood, Reading
from jointwear.measurement.derived.motion import Measured
from jointwear.measurement.recording import Recording
from jointwear.measurement.refused import FEWEST_OF_JOINT, Refused
from jointwear.measurement.stated import Stated
from jointwear.measurement.units import CURRENTS, size_of, sizes_of
from jointwear.robots.dynamics import Dynamics
from jointwear.robots.flange import FlangeLoad
from jointwear.robots.robot import Robot

#: Factor on the torque of the bodies beyond which it is another unit or a current, and no wrong mass.
FACTOR = 2.0
#: Factor from which that of one joint alone is believed. The factors of 60 right recordings of drawing 11 of the tier
#: "world" lie between 0.42 and 1.23.
OF_ONE = 5.0
#: Standard errors by which the factor of an axis must stand out; fewest axes that must have one; share of the squared
#: torque that may be left once it is applied.
STANDS_OUT, FEWEST_AXES, LEFT = 10.0, 2, 0.1
#: Factor from which one that joints have in common is told, and fewest of these. Masses of a robot file are rarely all
#: wrong by as much to the same side.
SHARED, FEWEST_SHARING = 1.2, 3
#: Factor by which friction may differ from the robot file beside the factor of the torque.
FRICTION = 2.5
#: Units of torque that a common factor stands for, and how far (ratio) it may lie from one.
LIKELY, NEAR_FACTOR = ("N m", "mN m", "kN m"), 1.3
#: Nats by which a model with free parameters and a payload must make a torque over its factors likelier, where another
#: load may be as good a cause: another unit gave 45 and more on logs of 18 simulated robots, another product 1 at most.
LIKELIER = 10.0
#: Factor on what the bodies ask of the joint that carries most of them, from which no load, friction or balance
#: explains the torque.
FAR_OFF = 20.0
#: Samples that are compared with the model.
THINNED = 1500


@dataclass(frozen=True)
class Factors:
    """What the torque of a recording is of the model's, whatever load the arm carries.

    `factor` (n,) and `left` (n,) as of :func:`factors`, of `samples`; `name` of the data set, for messages; `stated`
    unit of the torque; `given`: what the configuration says of units and factors.
    """

    name: str
    robot: Robot
    samples: Measured
    factor: np.ndarray
    left: np.ndarray
    stated: str = "N m"
    given: Stated = field(default_factory=Stated)


def torque_factors(recording: Recording, robot: Robot, measured: Measured) -> Factors:
    """Return the factors of the torques of a recording."""
    samples = thinned(measured)
    found = factors(samples, robot, load_free=True, behind_gears=recording.torque_kind == "link_sensor")
    unit, given = recording.units.get("torque", "N m"), Stated(recording.units, recording.factors)
    return Factors(f"data set '{recording.name}'", robot, samples, *found, unit, given)


def check_scale(found: Factors) -> list[str]:
    """Check that the torque of a recording has the size of the model's.

    A factor that most joints share and that no unit explains comes back in words, as masses may be as wrong; so do
    factors that do not make the model fit better, as two faults at once hide each other.

    Raises
    ------
    Refused : with the factors, and the key that mends them.
    """
    known = np.flatnonzero(np.isfinite(found.factor))
    if len(known) >= FEWEST_SHARING and np.all(found.factor[known] < 0):
        raise Refused(
            f"{found.name}: the sign of the torque of {numbered('joint', known + 1)} looks flipped against the motion",
            found.given.instead("scale", dict.fromkeys(range(found.robot.joints), -1.0))
            or "turn the sign of the torque: give 'scale' with -1 for every joint",
            by_keys=True,
        )
    constant = found.given.factors.get("torque_constant", ())
    scale = _of_most(found.factor, found.left, found.robot.gear_ratio, found.stated, constant)
    if scale is None:
        return _shared(found.factor)
    if _is_likelier(found, _size(found) > np.log(FACTOR)):
        raise Refused(f"{found.name}: {scale.reason}", scale.remedy, by_keys=True)
    told = "corrected for that it fits no better: the arm carries another load, or the columns have another order too"
    return [f"{scale.reason}; {told}"]


def check_scale_of_one(found: Factors) -> None:
    """Check that the torque of no single joint has another size than the model's.

    Raises
    ------
    Refused : with the factor, and the key that mends it.
    """
    size = _size(found)
    worst = int(np.argmax(size))
    if size[worst] <= np.log(OF_ONE) or not _is_likelier(found, np.arange(len(size)) == worst):
        return
    factor, others = abs(found.factor[worst]), np.delete(size, worst)
    # Of an arm of few joints none may tell what the unit of the others is.
    alone = not np.isnan(np.delete(found.factor, worst)).all() and bool((others < np.log(FACTOR)).all())
    unit = next((u for u, times in _other_units(found.stated) if abs(np.log(factor / times)) < np.log(NEAR_FACTOR)), "")
    looks = "another unit than that of the other joints" if alone else unit or "another unit"
    shared = f"state units: {{torque: {unit}}} if all joints are, or " if unit and not alone else ""
    scaled = found.given.instead("scale", {worst: 1 / factor})
    scaled = scaled or f"give 'scale' with {significant(1 / factor)} for joint {worst + 1}"
    raise Refused(
        f"{found.name}: the torque of joint {worst + 1} is {significant(factor)} times that of the model; it "
        f"looks like {looks}",
        f"{shared}{scaled}, 'torque_constant' for each, or its column",
        by_keys=True,
    )


def _size(found: Factors) -> np.ndarray:
    """Return how far the factor of each joint is from one, as a logarithm (n,), 0 where it is not clear."""
    return np.nan_to_num(np.abs(np.log(np.abs(found.factor))))


def _shared(factor: np.ndarray) -> list[str]:
    """Return in words a factor (n,) that three joints or more have in common, and that is not one."""
    known = np.log(np.abs(factor[np.isfinite(factor)]))
    if len(known) < FEWEST_SHARING:
        return []
    middle = float(np.median(known))
    if abs(middle) <= np.log(SHARED) or np.any(np.abs(known - middle) > 0.5 * abs(middle)):
        return []
    told = f"the torque is about {significant(np.exp(middle), 2)} times that of the model on all joints that tell it"
    return [f"{told}: masses may be as wrong, and so may its unit or scale, which moves every parameter that is found"]


def _is_likelier(found: Factors, concerned: np.ndarray) -> bool:
    """Return whether the model makes the torque over its factors likelier than as it is, whatever the load.

    A body at the flange that the file does not have turns a wrist many times as hard as its own links do.

    Parameters
    ----------
    concerned : (n,) joints whose factor is taken off.
    """
    samples = found.samples
    scale = np.abs(np.where(concerned, found.factor, 1.0))
    return gained_by(scale, Dynamics(found.robot), samples.parts, samples.usable) > 0


def gained_by(scale: np.ndarray, dynamics: Dynamics, parts: np.ndarray, usable: np.ndarray) -> float:
    """Return by how many nats the torque over a scale (n,) is likelier than as it is, whatever load the arm carries.

    Parameters
    ----------
    parts : (m, 4, n) position, velocity, acceleration, torque. usable : (m, n) bool.
    """
    likelihood, scaled = Likelihood(dynamics, FEWEST_OF_JOINT), parts.copy()
    scaled[:, 3] /= scale
    return likelihood(scaled, usable) - likelihood(parts, usable)


def shared_scale(
    dynamics: Dynamics, parts: np.ndarray, usable: np.ndarray, nominal_friction: bool = False
) -> float | None:
    """Return the one factor on the torques of all joints under which a model with free parameters and a payload is
    likeliest; None where that is no other unit, or not clearly likelier than one.

    Factors joint by joint (:func:`factors`) lie to either side of :data:`FACTOR` where all torques are halved, and a
    load that is picked up in between moves them. What all joints share no load does. Friction is free on each axis: a
    URDF states it many times too large or not at all, and the factor that mends such friction changes with the speed.
    What gravity and inertia are too small to tell is none.

    Parameters
    ----------
    parts : (m, 4, n) position, velocity, acceleration, torque. usable : (m, n) bool.
    nominal_friction : whether friction is that of the robot file instead, as far as one drive is like another. That
        tells how large a factor is, and not that there is one.
    """
    likelihood = Likelihood(dynamics if nominal_friction else _frictionless(dynamics), FEWEST_OF_JOINT)

    def nats(size: float) -> float:
        scaled = parts.copy()
        scaled[:, 3] /= np.exp(size)
        return likelihood(scaled, usable)

    # Coarse, then fine about the best; at the end of what is looked at lies something else.
    step = np.log(FACTOR) / 2
    steps = np.arange(-int(np.log(FAR_OFF) / step), int(np.log(FAR_OFF) / step) + 1)
    found = {float(size): nats(size) for size in step * steps}
    best = max(found, key=found.__getitem__)
    if best in (min(found), max(found)):
        return None
    for finer in (step / 2, step / 4):
        found |= {best + d: nats(best + d) for d in (-finer, finer)}
        best = max(found, key=found.__getitem__)
    clear = abs(best) > np.log(FACTOR / NEAR_FACTOR) and found[best] - found[0.0] > LIKELIER
    return float(np.exp(best)) if clear else None


def _frictionless(dynamics: Dynamics) -> Dynamics:
    """Return the dynamics of a robot whose file leaves the friction open."""
    none = np.zeros(dynamics.robot.joints)
    return Dynamics(replace(dynamics.robot, viscous=none, coulomb_positive=none, coulomb_negative=none))


def a_load_explains(measured: Measured, robot: Robot, stated: str = "N m") -> bool:
    """Return whether factors on most joints that stand for no unit may be those of a load at the flange.

    They are none of a load where they are beyond :data:`OF_ONE` on most joints, or stay off beside a load of any mass,
    if the model makes the torque over them likelier too.

    Parameters
    ----------
    measured : samples with another scale (:func:`wrong_scale`). stated : unit that the torque was read in.
    """
    plain, beside = factors(measured, robot), factors(measured, robot, load_free=True)
    known = plain[0][np.isfinite(plain[0])]
    beyond = np.mean(np.abs(np.log(np.abs(known))) > np.log(OF_ONE)) > 0.5
    stays = _of_most(*beside, robot.gear_ratio, stated) is not None
    if not beyond and not stays:
        return True
    dynamics, parts, usable = Dynamics(robot), measured.parts, measured.usable
    # One for each joint, or one for all: a load hides that of a wrist.
    scales = [_clearly_off(plain[0])]
    if stays:
        scales += [_clearly_off(beside[0]), np.full(robot.joints, np.nanmedian(np.abs(beside[0])))]
    return max(gained_by(scale, dynamics, parts, usable) for scale in scales) < LIKELIER


def _clearly_off(factor: np.ndarray) -> np.ndarray:
    """Return factors (n,) without their sign, 1 where they are not clear or not beyond :data:`FACTOR`."""
    size = np.nan_to_num(np.abs(np.log(np.abs(factor))))
    return np.where(size > np.log(FACTOR), np.abs(factor), 1.0)


def check_size(measured: Measured, robot: Robot, name: str) -> None:
    """Check that the torque of the joint that carries most of the bodies is of their size.

    The factors of :func:`factors` need a model that follows the torque; where a load or a drive is missing it does not.
    Of a turntable friction is nearly all of the torque: what the file's friction explains is no other unit.

    Raises
    ------
    Refused : with the factor, and the keys that mend it.
    """
    rigid = Dynamics(robot).rigid_body_torque(measured.position, measured.velocity, measured.acceleration)
    rubbed = rigid + robot.friction(measured.velocity)
    used = measured.usable & np.isfinite(measured.torque)
    count = used.sum(axis=0)
    bodies, whole, torque = (
        np.sqrt(np.sum(np.where(used, x, 0.0) ** 2, axis=0) / np.maximum(count, 1))
        for x in (rigid, rubbed, measured.torque)
    )
    most = int(np.argmax(np.where(count >= FEWEST_OF_JOINT, bodies, -1.0)))
    if count[most] < FEWEST_OF_JOINT or not bodies[most] > 0 or not torque[most] > 0:
        return
    factor = torque[most] / bodies[most]
    explained = factor > 1 and torque[most] < FRICTION * whole[most]
    if abs(np.log(factor)) > np.log(FAR_OFF) and not explained:
        raise Refused(
            f"{name}: the torque of joint {most + 1} is about {significant(factor)} times what the bodies of the "
            "model ask there; it looks like another unit, a current or a share of a rating",
            "state units: {torque: ...}, or give 'torque_constant' in N m/A, or 'scale' in N m of one unit, by axis",
            by_keys=True,
        )


def thinned(measured: Measured) -> Measured:
    """Return about :data:`THINNED` of the samples."""
    step = max(1, len(measured.time) // THINNED)
    return measured.part(slice(None, None, step))


@dataclass(frozen=True)
class WrongScale:
    """The torque of most axes is another multiple of the model's than one.

    `reason` and `remedy`, a key, are words. `left`: share of the squared torque that is left once it is applied, a
    median over the axes; `unit` that it looks like.
    """

    reason: str
    remedy: str
    left: float
    unit: str = ""


def factors(
    measured: Measured, robot: Robot, load_free: bool = False, behind_gears: bool = False
) -> tuple[np.ndarray, np.ndarray]:
    """Return the factor of the torque of each joint on the model's (n,), and the share of its squared torque that is
    left once it is applied (n,); NaN where it is not clear.

    Each axis is regressed on the torque of its bodies and friction of free size, and of a motor inertia where the robot
    file has none; its factor counts where it is clear and leaves little. A wrong robot file leaves factors near one, or
    much of the torque.

    Parameters
    ----------
    load_free : whether a load at the flange of any mass and centre is part of each regression.
    behind_gears : whether the torque is measured there, without the friction of the drives.
    """
    motion = measured.position, measured.velocity, measured.acceleration
    rigid = Dynamics(robot).rigid_body_torque(*motion)
    load = FlangeLoad(robot).unit_sum(*motion) if load_free else None
    n = rigid.shape[1]
    factor, left = np.full(n, np.nan), np.full(n, np.nan)
    for j in range(n):
        used = measured.usable[:, j]
        if used.sum() < FEWEST_OF_JOINT:
            continue
        v, torque = measured.velocity[used, j], measured.torque[used, j]
        design = np.stack([rigid[used, j], np.sign(v), v, np.ones(len(v))], axis=1)
        if robot.armature[j] == 0.0 and not behind_gears:
            # A file that knows no motor inertia, as a URDF of the links alone, lacks most of what turns a wrist.
            design = np.concatenate([design, measured.acceleration[used, j][:, None]], axis=1)
        if load is not None:
            design = np.concatenate([design, load[used][:, :, j]], axis=1)
        size = np.maximum(np.sqrt((design**2).mean(axis=0)), 1e-12)
        inverse = np.linalg.pinv((design / size).T @ (design / size), rcond=1e-9)
        fit = inverse @ ((design / size).T @ torque)
        error = torque - (design / size) @ fit
        spread = np.sqrt(max(float(error @ error) / max(len(v) - design.shape[1], 1) * inverse[0, 0], 0.0))
        clear = abs(fit[0]) > STANDS_OUT * spread and error @ error < LEFT * float(torque @ torque)
        # A load at the flange multiplies the bodies of a wrist and leaves its friction; a wrong unit scales both.
        nominal = np.abs([robot.coulomb_positive[j], robot.coulomb_negative[j]]).mean()
        rubbed = abs(fit[1] / size[1]) / nominal if nominal > 0 else abs(fit[0] / size[0])
        if clear and (behind_gears or (rubbed > 0 and abs(np.log(rubbed * size[0] / abs(fit[0]))) < np.log(FRICTION))):
            factor[j], left[j] = fit[0] / size[0], error @ error / float(torque @ torque)
    return factor, left


def wrong_scale(
    measured: Measured, robot: Robot, stated: str = "N m", constant: Sequence[float] = ()
) -> WrongScale | None:
    """Return what the scale of the torque looks like where it is not that of the model on most joints, else None.

    Parameters
    ----------
    stated : unit that the torque was read in. constant : `torque_constant` [N m/A] that it was multiplied by, one an
        axis; default none.
    """
    return _of_most(*factors(measured, robot), robot.gear_ratio, stated, constant)


def off_scale(
    measured: Measured, robot: Robot, load_free: bool = False, asked: np.ndarray | None = None
) -> np.ndarray | None:
    """Return the factors (n,) of the torque on the model's, 1 where one is not clear; None where none is clearly off:
    two joints by :data:`FACTOR`, or one by :data:`OF_ONE`.

    Parameters
    ----------
    load_free : as of :func:`factors`. asked : (n,) bool, joints that are looked at, default all.
    """
    factor = factors(measured, robot, load_free)[0]
    if asked is not None:
        factor = np.where(asked, factor, np.nan)
    size = np.nan_to_num(np.abs(np.log(np.abs(factor))))
    size[factor < 0] = np.inf
    if np.sum(size > np.log(FACTOR)) < FEWEST_AXES and not np.any(size > np.log(OF_ONE)):
        return None
    return np.where(np.isfinite(factor), factor, 1.0)


def _other_units(stated: str) -> Iterator[tuple[str, float]]:
    """Yield the other units that a torque read in a stated one may be in, and its factor on the model's then."""
    known = sizes_of("torque") | CURRENTS
    for unit in CURRENTS if stated in CURRENTS else LIKELY:
        if unit != stated:
            yield unit, (CURRENTS.get(stated) or size_of("torque", stated)) / known[unit]


def _of_most(
    factor: np.ndarray, left: np.ndarray, gear: np.ndarray, stated: str = "N m", constant: Sequence[float] = ()
) -> WrongScale | None:
    known = np.flatnonzero(np.isfinite(factor))
    off = np.abs(np.log(np.abs(factor[known]))) > np.log(FACTOR)
    if len(known) < FEWEST_AXES or off.mean() <= 0.5:
        return None
    middle, remains = float(np.median(np.abs(factor[known]))), float(np.median(left[known]))
    if len(constant) == len(factor) and np.all(
        np.abs(np.log(np.abs(factor[known] / np.array(constant)[known]))) < np.log(NEAR_FACTOR)
    ):
        reason = "the torque is that of the model times 'torque_constant'; it looks like N m as it is logged"
        return WrongScale(reason, "take 'torque_constant' out, which is for a current in A", remains, "N m")
    for unit, size in _other_units(stated):
        if np.all(np.abs(np.log(np.abs(factor[known]) / size)) < np.log(NEAR_FACTOR)):
            reason = f"the torque is about {significant(middle)} times that of the model; it looks like {unit}"
            return WrongScale(reason, f"state units: {{torque: {unit}}}", remains, unit)
    behind = np.abs(np.log(np.abs(factor[known] * gear[known]))) < np.log(NEAR_FACTOR)
    if np.all(behind) and np.all(np.abs(gear[known]) > FACTOR):
        motor = Reading("motor", tuple(known))
        return WrongScale(motor.reason, motor.remedy, remains, "of the motor")
    told = ", ".join(f"{significant(abs(factor[j]))} on joint {j + 1}" for j in known)
    reason = (
        f"the torque is another multiple of the model's than one ({told}); it looks like a current, a share of a "
        "rating or a torque of the motor's side, or the robot file is that of another arm"
    )
    remedy = (
        "give 'torque_constant' in N m/A on the joint side and 'units: {torque: A}', or 'scale' in N m of one unit, "
        "for each axis (what is read now times about "
        + ", ".join(f"{significant(1 / abs(factor[j]))} for joint {j + 1}" for j in known)
        + ")"
    )
    return WrongScale(reason, remedy, remains)
