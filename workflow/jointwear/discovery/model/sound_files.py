"""The two robot files of a verdict, none of which follows the motion worse than the robot that was given.

What is fitted are linear corrections; what is written are bodies that may exist and parameters within their bounds, and
the torque of a file holds for every sample in motion, those beside reversals too. So the files themselves are asked.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace
from functools import cache

import numpy as np

from jointwear.discovery.estimates.effect_estimates import Estimate
from jointwear.discovery.estimates.outcome import Outcome, Suspected
from jointwear.discovery.model.estimation import finalise
from jointwear.discovery.model.fallback import OF_LINKS, OWN, PutBack, Step
from jointwear.discovery.model.final_model import Final
from jointwear.discovery.model.known_band import with_known_bands
from jointwear.discovery.model.left_out import mean_squares
from jointwear.discovery.model.steps_back import WITHOUT
from jointwear.discovery.model.written_robot import WrittenRobot, simulate_robot, written_robot
from jointwear.discovery.problem.problem import Problem
from jointwear.discovery.search.standing_alone import left_open

#: A model with its robot files, "retuned" and "augmented", and the torque (m, n) [N m] of these and the given robot.
Written = tuple[Final, dict[str, WrittenRobot], dict[str, np.ndarray]]


def sound_files(problem: Problem, outcome: Outcome) -> Written:
    """Return the estimates of an outcome with robot files that follow no axis worse than the given robot.

    The first that does is taken: the whole model; without the effects of the axes that are worse; with the links closer
    to those given, by halves, or as they are; and at last the robot as it was given.
    """
    written = _without_harmful(problem, *write_files(problem, finalise(outcome)))
    bad = [kind for kind in written[1] if worse_axes(problem, written[2][kind])]
    if not bad:
        return written
    with_links = cache(lambda step: write_files(problem, finalise(outcome, step)))
    return _exchanged(problem, written, {kind: _with_fewer_links(problem, with_links, kind) for kind in bad})


def _with_fewer_links(problem: Problem, with_links: Callable[[Step], Written], kind: str) -> Written:
    """Return the model whose links are as far from those given as its file of one kind can have them.

    Links as given mend a bad file, and take from all joints what was found of the links: half of their freedom or less
    may do. Asked is that only where links as given mend it, without an effect that the file would lose.
    """
    rigid = with_links(OF_LINKS[-1])
    if kind == "augmented":
        rigid = _without_harmful(problem, *rigid)
    if worse_axes(problem, rigid[2][kind]):
        return rigid
    closer = (with_links(step) for step in OF_LINKS[:-1])
    return next((model for model in closer if not worse_axes(problem, model[2][kind])), rigid)


def write_files(problem: Problem, final: Final) -> Written:
    """Return a model with its robot files and the torque that each of them gives."""
    files = {"retuned": written_robot(final, False), "augmented": written_robot(final)}
    torques = {"nominal": problem.given_torque} | {kind: _torque(problem, file) for kind, file in files.items()}
    ended = with_known_bands(final, torques["augmented"])
    if ended is not final:
        files["augmented"] = written_robot(ended)
        torques["augmented"] = _torque(problem, files["augmented"])
    return ended, files, torques


def _torque(problem: Problem, file: WrittenRobot) -> np.ndarray:
    with file.robot() as arm:
        return simulate_robot(arm, problem.measured)[0]


def unchanged_files(problem: Problem, final: Final) -> Written:
    """Return a model whose files are the given robot, for data that contradict none of its parameters.

    Corrections that no evidence asks for are as likely to be worse as better on motion to come.
    """
    for kind in ("retuned", "augmented"):
        final = _as_given(final, kind, {})
    return write_files(problem, replace(final, fallbacks=()))


def _exchanged(problem: Problem, first: Written, second: Mapping[str, Written]) -> Written:
    """Return `first` with the files of some kinds from another model, one for each kind.

    Where that is bad too the axes that are worse keep what is given of them alone, and if that does not help the file
    is the given robot.
    """
    final = first[0]
    for kind, instead in second.items():
        other = _sound(problem, first, instead, kind)
        kept = tuple(f for f in final.fallbacks if f.model != kind) + tuple(
            f for f in other.fallbacks if f.model == kind
        )
        if kind == "augmented":
            own = {"retuned_friction": final.retuned_friction, "retuned_inertial": final.retuned_inertial}
            final = replace(other, **own, fallbacks=kept)
        else:
            own = {"retuned_friction": other.retuned_friction, "retuned_inertial": other.retuned_inertial}
            final = replace(final, **own, fallbacks=kept)
    return write_files(problem, final)


def _sound(problem: Problem, first: Written, second: Written, kind: str) -> Final:
    """Return the second of two models, or what has to be given up of either for its file to be worse on no axis."""
    still = worse_axes(problem, second[2][kind])
    if not still:
        return second[0]
    for model, bad in ((first[0], worse_axes(problem, first[2][kind])), (second[0], still)):
        trial = _as_given(model, kind, bad, alone=True)
        if not worse_axes(problem, write_files(problem, trial)[2][kind]):
            return trial
    return _as_given(second[0], kind, still)


def _as_given(final: Final, kind: str, bad: dict[int, float], alone: bool = False) -> Final:
    """Return a model of which one kind of file is the given robot; its effects stay named where nothing is left.

    Parameters
    ----------
    bad : 0-based axis -> how bad its file is. alone : give up only what acts on these axes alone.
    """
    drives = final.outcome.problem.as_given
    friction, inertial = drives, np.zeros_like(final.delta_inertial)
    lost = final.estimates if kind == "augmented" else ()
    if alone:
        before = (final.delta_friction, final.delta_inertial)
        before = before if kind == "augmented" else (final.retuned_friction, final.retuned_inertial)
        friction, inertial = before[0].copy(), before[1]
        friction[list(bad)] = drives[list(bad)]
        lost = tuple(e for e in lost if not bad.keys().isdisjoint(e.named.candidate.axes))
    doubtful, suspects = _suspected(final.outcome, [e for e in lost if e.named.candidate.axis in (None, *bad)])
    named = [e for e in lost if not any(e is x for x in doubtful)]
    words = OWN if alone else "everything as given"
    for told, effects in (("named but not written:", named), (WITHOUT, doubtful)):
        if effects:
            words += f"; {told} {', '.join(dict.fromkeys(e.named.candidate.effect for e in effects))}"
    given_up = tuple(PutBack(kind, axis + 1, float(f"{r:.4g}"), words) for axis, r in bad.items())
    final = replace(final, fallbacks=final.fallbacks + given_up, suspects=final.suspects + suspects)
    if kind == "retuned":
        return replace(final, retuned_friction=friction, retuned_inertial=inertial)
    kept = tuple(e for e in final.estimates if not any(e is x for x in lost))
    unwritten = (*final.unwritten, *named)
    return replace(final, delta_friction=friction, delta_inertial=inertial, estimates=kept, unwritten=unwritten)


def _suspected(outcome: Outcome, estimates: list[Estimate]) -> tuple[list[Estimate], tuple[Suspected, ...]]:
    """Return which effects that a file does without have to be suspected, and these as suspects.

    Beside structure on its own joints it is one: what nobody can name may be all that it has found.
    """
    found = {n.candidate.key: n for n in outcome.named}
    doubtful = [e for e in estimates if left_open(outcome, found[e.named.candidate.key])]
    reason = "with it the robot file follows the motion worse than the given robot"
    return doubtful, tuple((e.named, reason) for e in doubtful)


def _without_harmful(problem: Problem, final: Final, files, torques) -> Written:
    """Leave effects out of the file, not out of the verdict, on axes where the file follows the motion worse for them.

    A column of rates of change carries the noise of derived accelerations: it may be there, and its torque useless.
    """
    bad = worse_axes(problem, torques["augmented"])
    left_out = tuple(e for e in final.estimates if not bad.keys().isdisjoint(e.named.candidate.axes))
    if not left_out:
        return final, files, torques
    trial = replace(final, estimates=tuple(e for e in final.estimates if not any(e is x for x in left_out)))
    written = write_files(problem, trial)
    if len(worse_axes(problem, written[2]["augmented"])) >= len(bad):
        return final, files, torques
    doubtful, suspects = _suspected(final.outcome, list(left_out))
    named = tuple(e for e in left_out if not any(e is x for x in doubtful))
    given_up = tuple(
        PutBack("augmented", axis + 1, float(f"{bad[axis]:.4g}"), form.format(e.named.candidate.effect))
        for effects, form in ((named, "{} named but not written"), (doubtful, f"{WITHOUT} {{}}"))
        for e in effects
        for axis in e.named.candidate.axes
        if axis in bad
    )
    trial = replace(
        trial,
        unwritten=final.unwritten + named,
        suspects=final.suspects + suspects,
        fallbacks=final.fallbacks + given_up,
    )
    return trial, written[1], written[2]


def worse_axes(problem: Problem, torque: np.ndarray) -> dict[int, float]:
    """Return the axes on which a model follows the training motion worse than the given robot, with the ratio.

    Asked are the samples that can be judged, and all in motion: a file is used beside reversals too. Of what can be
    judged the block of time in the middle is asked as well: a few samples at which friction turns outweigh all others
    together, and so hide a column of rates of torque that is noise everywhere else.
    """
    worst = np.zeros(problem.robot.joints)
    for samples in (problem.measured.usable, problem.moving):
        used = samples & problem.train[:, None]
        error = np.sum(np.where(used, (problem.measured.torque - torque) ** 2, 0.0), axis=0)
        given = np.sum(np.where(used, problem.given_discrepancy**2, 0.0), axis=0)
        worst = np.maximum(worst, np.sqrt(error / np.maximum(given, 1e-300)) * used.any(axis=0))
    for axis in problem.judged:
        worst[axis] = max(worst[axis], middle_ratio(problem, axis, torque))
    return {axis: float(worst[axis]) for axis in problem.judged if worst[axis] > problem.settings.not_worse}


def middle_ratio(problem: Problem, axis: int, torque: np.ndarray) -> float:
    """Return the RMS error on one axis in the training block of time in the middle, over that of the given robot.

    Parameters
    ----------
    torque : (m, n) of a file at the samples of `problem` [N m].
    """
    used = problem.usable[:, axis]
    left = (problem.measured.torque - torque)[problem.train, axis][used]
    means, _ = mean_squares(problem.block_of_sample[used], left, problem.given_discrepancy[problem.train, axis][used])
    error, given = np.median(means, axis=1)
    return float(np.sqrt(error / max(given, 1e-300)))
