"""What the motion of a data set, or the robot file, does not let discovery show, in words."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace

import numpy as np

from jointwear.discovery.problem.building_up import IN_PROPORTION
from jointwear.discovery.problem.candidates import LINK_MASS, Candidate
from jointwear.discovery.problem.problem import FRICTION, Problem
from jointwear.discovery.problem.reversals import unseen_slow_motion
from jointwear.effects import get_effect
from jointwear.effects.temperature import SMALLEST_SPREAD
from jointwear.files.wording import listed, numbered
from jointwear.measurement.derived.motion import Measured
from jointwear.measurement.possible import likely_unit
from jointwear.measurement.refused import Refused

#: Temperatures are said to go with the trajectories where these are fewer, and their means scatter by so many times
#: what they do within.
FEW_RECORDS, APART = 5, 3.0
#: Range of positions [rad] from which a joint that cannot be judged is not called at rest: some degrees.
TURNED = 0.1


def motion_restrictions(problem: Problem, name: str, clock: str = "s") -> list[str]:
    """Return in words what these data and this robot file do not show.

    That is: which axes are at rest, which velocities were put right, what the temperature cannot tell, and of which
    motors the file has no inertia.

    Parameters
    ----------
    name : of the data set, for messages. clock : unit that the time was read in.

    Raises
    ------
    Refused : where no axis moves enough to be judged.
    """
    if not problem.judged:
        steps = np.diff(problem.measured.time)[np.diff(problem.measured.trajectory) == 0]
        unit = likely_unit(float(np.median(steps)) if len(steps) else None, clock)
        raise Refused(
            f"{name}: no axis moves for long enough to be judged",
            "record motion of every joint, away from rest, for several seconds, 20 times a second or more; if that was "
            f"done, state the unit of the time, as units: {{time: {unit}}}",
            by_keys=True,
        )
    found = _not_judged(problem) + unseen_slow_motion(_with_unsure(problem), problem.judged) + _at_rest_in_test(problem)
    found += _too_coarse(problem) + _built_up(problem)
    return found + late_velocities(problem.measured) + _of_temperature(problem) + _motors_not_in_file(problem)


def _not_judged(problem: Problem) -> list[str]:
    """Return in words of which joints nothing can be said, and why."""
    found = []
    for axis in range(problem.robot.joints):
        if axis in problem.judged:
            continue
        if np.ptp(problem.measured.torque[:, axis]) == 0.0:
            why = "has a torque that keeps one value"
        elif np.ptp(problem.measured.position[problem.train, axis]) > TURNED:
            why = "turns too slowly in the training trajectories for the noise of its position"
        else:
            why = "is at rest in the training trajectories"
        found.append(f"joint {axis + 1} {why}: nothing can be said about its drive")
    return found


def _too_coarse(problem: Problem) -> list[str]:
    """Return in words of which joints too few samples lie between reversals for noise to be told."""
    if not problem.too_coarse:
        return []
    fewest = min(int(problem.usable[:, axis].sum()) for axis in problem.too_coarse)
    joints = numbered("joint", [axis + 1 for axis in problem.too_coarse])
    told = (
        f"{joints}: too coarse in time to tell noise from what the model lacks: at {problem.measured.rate:.3g} Hz few "
        f"samples lie between one reversal and the next, and only {fewest} can be judged; nothing is named there: log "
        "20 times a second or more, or for much longer"
    )
    return [told]


def _at_rest_in_test(problem: Problem) -> list[str]:
    """Return in words which joints that are judged do not move in the held-out motion."""
    moving = problem.measured.usable[problem.test].any(axis=0)
    if not moving.any():
        return ["no joint moves in the test trajectories: the gap on held-out motion is unknown"]
    return [f"joint {axis + 1} is at rest in the test trajectories" for axis in problem.judged if not moving[axis]]


def _with_unsure(problem: Problem) -> Measured:
    """Return the samples with those that were left out because friction builds up there: the motion does show them."""
    usable = problem.measured.usable.copy()
    for axis, way in problem.building_up.items():
        usable[:, axis] |= way.unsure(problem.measured.velocity[:, axis], problem.settings.usual)
    return replace(problem.measured, usable=usable)


def _built_up(problem: Problem) -> list[str]:
    """Return in words of which joints the friction builds up with speed, and what was made of it."""
    ways: dict[str, list[str]] = {}
    for axis, way in problem.building_up.items():
        form = way.form if way.form == IN_PROPORTION else f"{way.form} of the speed"
        ways.setdefault(form, []).append(f"{way.speed:.2g} rad/s on joint {axis + 1}")
    return [
        f"Coulomb friction builds up {form} over {listed(speeds)}, as in simulators that round the sign of the "
        "velocity, and where a joint sticks from one sample to the next: no robot file can hold that; the torque was "
        "put right, as if friction were whole at every speed"
        for form, speeds in ways.items()
    ]


def late_velocities(measured: Measured) -> list[str]:
    """Return in words by how much given velocities lagged their positions, or ran ahead."""
    found, lag = [], measured.velocity_lag
    done = "put right" if measured.velocity_used else "too long to be put right, and no given velocity is used"
    for late, way in ((True, "behind"), (False, "ahead of")):
        moved = [] if lag is None else np.flatnonzero(lag > 0 if late else lag < 0)
        if len(moved):
            most = 1e3 * np.abs(lag[moved]).max()
            joints = numbered("joint", moved + 1)
            found.append(f"given velocities are up to {most:.2g} ms {way} their positions ({joints}): {done}")
    return found


def _of_temperature(problem: Problem) -> list[str]:
    """Return in words where the temperature says nothing that the trajectories do not say too."""
    if not problem.state.has_temperature:
        return ["no temperature was recorded: effects of temperature cannot be seen"]
    record = np.asarray(problem.train_state.record)
    labels = np.unique(record)
    warm = problem.train_state.temperature
    coincide = []
    for axis in problem.judged:
        known = [values[np.isfinite(values)] for values in (warm[record == label, axis] for label in labels)]
        means = [values.mean() for values in known if len(values)]
        within = [values.std() for values in known if len(values)]
        if len(means) < 2 or len(labels) >= FEW_RECORDS:
            continue
        if np.ptp(means) > SMALLEST_SPREAD and np.std(means) > APART * np.mean(within):
            coincide.append(axis + 1)
    if not coincide:
        return []
    told = (
        f"the temperature of {numbered('joint', coincide)} differs between the {len(labels)} training "
        "trajectories and hardly within them: an effect of temperature, named or not, rests on what differs between "
        "these trajectories, and anything else that differs between them may be its cause; record while the joints warm"
    )
    return [told]


def _motors_not_in_file(problem: Problem) -> list[str]:
    """Return in words of which joints the robot file has no motor inertia although it is felt, and what that means.

    What only one joint feels of the links turns with its motor alone.
    """
    if problem.state.torque_kind == "link_sensor":
        return []
    given = problem.robot.armature + problem.as_given[:, FRICTION.index("motor_inertia")]
    unknown = [axis + 1 for axis in problem.judged if given[axis] == 0.0]
    if not unknown:
        return []
    told = (
        f"the robot file has no motor inertia of {numbered('joint', unknown)}, as a URDF has none: it is found in "
        "these data and told among the retuned parameters, where inertia that the links lack can be a part of it; give "
        "'motor_inertia' if it is known"
    )
    return [told]


def beyond_the_time(problem: Problem, written: Iterable[Candidate]) -> list[str]:
    """Return in words which effects that follow time a robot file carries on to times that no training record holds.

    A wave or a growth that fits what was seen says how it went on only as far as its form is a law. Between the first
    and the last training record it is held from both sides; the gap on motion before or after them is a forecast.
    """
    time = problem.measured.time
    seen, asked = time[problem.train], time[problem.test]
    if not len(asked) or (seen.min() <= asked.min() and asked.max() <= seen.max()):
        return []
    return [
        f"joint {c.axis + 1}: {get_effect(c.effect).phrase} follows time, and test trajectories lie outside the time "
        "of the training trajectories: there it is carried on by its form alone; hold out trajectories between others "
        "to see how well it is known"
        for c in written
        if c.effect != LINK_MASS and c.axis is not None and get_effect(c.effect).follows_time
    ]


def beyond_the_temperature(problem: Problem, written: Iterable[Candidate]) -> list[str]:
    """Return in words which joints are warmer or colder in test than in training, where what is written follows it."""
    found = []
    following = (c for c in written if c.effect != LINK_MASS and get_effect(c.effect).follows_temperature)
    for axis in sorted({c.axis for c in following}):
        warm = problem.state.temperature[:, axis]
        seen, asked = (values[np.isfinite(values)] for values in (warm[problem.train], warm[problem.test]))
        if not len(asked) or max(seen.min() - asked.min(), asked.max() - seen.max()) <= SMALLEST_SPREAD:
            continue
        found.append(
            f"joint {axis + 1}: its temperature is {asked.min():.0f} to {asked.max():.0f} degC in the test "
            f"trajectories and {seen.min():.0f} to {seen.max():.0f} degC in training: what changes with it is carried "
            "on by its form alone; hold out trajectories of temperatures between others to see how well it is known"
        )
    return found
