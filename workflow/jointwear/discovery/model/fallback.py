"""Put a model back, axis by axis, where it predicts records left out worse than the robot that was given.

A fit may buy a better likelihood with parameters that make slow torque worse, or that hold for the records it has
seen. A robot file is used for motion to come: on no axis may it be worse than the one it replaces.
"""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import dataclass, replace

import numpy as np

from jointwear.discovery.estimates.misfit import misfit_of
from jointwear.discovery.linear import Fit, Term
from jointwear.discovery.model.left_out import Asked, LeftOut
from jointwear.discovery.problem.whitening import INERTIAL, White

#: Words of the step that gives up what was fitted to the drive of a joint.
DRIVE = "friction and motor inertia as given"
#: Words of the step that gives up all of a joint.
EVERYTHING = "everything of this joint as given"
#: Words of the step that gives up what acts on one joint alone, and leaves what other joints lean on.
OWN = "everything of this joint alone as given"
#: Words of the steps that leave the links, and all of a joint, as given, and to the others what it does not feel.
FELT = "the links as far as this joint feels them"
HELD = f"friction and motor inertia as given, and {FELT}"
HELD_WITHOUT = f"{OWN}, and {FELT}"
#: Words of the steps that take corrections of the links back, in part and all of them.
CLOSER, LINKS = "inertia of the links closer to that given", "inertia of the links as given"
#: Standard deviations, over that of their prior, that are left to corrections of the links before they are given up.
HALVINGS = tuple(0.5**k for k in range(1, 8))


@dataclass(frozen=True)
class PutBack:
    """One step by which a model was put back on an axis, as it was taken; the verdict tells those of an axis as one.

    Attributes
    ----------
    axis : 1-based. ratio : error on records left out, over that of the given robot, that led to it.
    step : what was given up, in words.
    held : of the links the axis keeps no change that it feels. in_part : its drive is written as a share of what was
        fitted.
    """

    model: str
    axis: int
    ratio: float
    step: str
    held: bool = False
    in_part: bool = False


@dataclass(frozen=True)
class Step:
    """Something that can be given up for the sake of an axis.

    Attributes
    ----------
    words, terms : what it is in words, and the terms that go.
    instead : terms that take their place.
    links : largest standard deviation, over that of their prior, that corrections of the links keep; at 0 they are
        given up. All axes share the links: for the sake of one they are given up as little as it needs.
    deaf : 0-based axis that says nothing of the links from here on, though they act on it: without parameters of its
        own, what it lacks would bend them.
    hold : precision (k, k) by which coefficients of the links are held for that axis, so that it feels no change of
        them; None where it does.
    of_drive : it gives up what was fitted to the drive of a joint, and nothing else.
    """

    words: str
    terms: tuple[Term, ...] = ()
    links: float = np.inf
    deaf: int | None = None
    hold: np.ndarray | None = None
    of_drive: bool = False
    instead: tuple[Term, ...] = ()

    @property
    def of_many(self) -> bool:
        """Whether an effect goes that acts on more than one axis."""
        return any(len(t.blocks) > 1 for t in self.terms)

    def taken_off(self, terms: list[Term]) -> list[Term]:
        """Return `terms` without what this step gives up."""
        left = [t for t in terms if not any(t is own for own in self.terms)] + list(self.instead)
        return [self._of_links(t) if t.label == INERTIAL else t for t in left if t.label != INERTIAL or self.links > 0]

    def touches(self, terms: list[Term]) -> bool:
        """Return whether this step gives up anything of `terms`."""
        return any(
            any(t is own for own in self.terms)
            or (t.label == INERTIAL and (np.any(t.std > self.links) or self.deaf in t.blocks))
            for t in terms
        )

    def _of_links(self, links: Term) -> Term:
        if np.any(links.std > self.links):
            links = replace(links, std=np.minimum(links.std, self.links))
        if self.deaf in links.blocks:
            links = replace(links, blocks={axis: x for axis, x in links.blocks.items() if axis != self.deaf})
        if self.hold is not None:
            loose = np.diag(links.std**-2.0)
            links = links.turned(self.hold + (loose if links.turn is None else links.turn @ loose @ links.turn.T))
        return links


#: A step that gives up nothing.
AS_FITTED = Step("as fitted")
#: What can be given up of the links, the least first.
OF_LINKS = (*(Step(CLOSER, links=width) for width in HALVINGS), Step(LINKS, links=0.0))


def put_back(
    white: White, terms: list[Term], steps: dict[int, list[Step]], model: str, open_axes: Collection[int] = ()
) -> tuple[list[Term], tuple[PutBack, ...]]:
    """Give up parts of a model until no axis is predicted worse than by the given robot.

    Parameters
    ----------
    steps : 0-based axis -> what can be given up for its sake, the least loss first.
    model : name of the model in the verdict.
    open_axes : 0-based axes on which structure is left that nothing explains: what acts on such an axis alone is kept
        only where it gains clearly, and where a record to come would surely be no worse.

    Returns
    -------
    the terms that are kept, and what was given up and why.
    """
    limit = white.problem.settings.not_worse
    kept, given_up = list(terms), []
    held: set[int] = set()
    others = {id(t): t for of_axis in steps.values() for s in of_axis for t in s.instead}
    ask = Asked(white, [*kept, *others.values()])
    asked = ask(kept)
    while True:
        ratio = asked.surely
        bad = [j for j in np.argsort(-ratio) if ratio[j] > limit]
        best = ((int(j), _mending(white, ask, kept, steps.get(int(j), []), int(j), ratio)) for j in bad)
        chosen = next((found for found in best if found[1]), None)
        chosen = chosen or _little_gained(white, ask, kept, steps, open_axes, asked)
        chosen = chosen or _held_in_the_open(white, ask, kept, set(open_axes) - held, asked)
        chosen = chosen or _links_in_vain(ask, kept, asked)
        if chosen is None:
            return kept, tuple(given_up)
        axis, step = chosen
        if step.hold is not None:
            held.add(axis)
        if ratio[axis] > limit or axis in open_axes:
            # Elsewhere the parameters follow noise alone: that they stay as given is no loss to tell of.
            is_held = step.hold is not None
            given_up.append(PutBack(model, axis + 1, float(f"{ratio[axis]:.4g}"), step.words, held=is_held))
        kept = step.taken_off(kept)
        asked = ask(kept)


def _mending(
    white: White, ask: Asked, kept: list[Term], steps: list[Step], axis: int, ratio: np.ndarray
) -> Step | None:
    """Return what is given up for the sake of an axis, as :func:`best_step` says, or the axis held if that is better.

    Links as given mend an axis and take what was found of them from all others. Where it is held, as firmly as is best
    for all axes together, they are lost only as far as it feels them. An effect that acts on it alone goes too, but
    only where no step helps.
    """
    limit = white.problem.settings.not_worse
    found = best_step(ask, kept, steps, axis, ratio, limit)
    best, so_far = found, ratio if found is None else ask(found.taken_off(kept)).surely
    own = Step(HELD, tuple(t for s in steps if s.of_drive for t in s.terms))
    if found is None and any(t.effect and set(t.blocks) == {axis} for t in kept):
        own = Step(HELD_WITHOUT, tuple(t for s in steps for t in s.terms if set(t.blocks) == {axis}))
    for width in HALVINGS:
        held = _held(white, kept, own, axis, width)
        if held is None:
            continue
        after = ask(held.taken_off(kept)).surely
        mends = after[axis] <= limit and not np.any(after > np.maximum(limit, ratio))
        if mends and _together_better(after, so_far):
            best, so_far = held, after
    return best


def _held(white: White, kept: list[Term], step: Step, axis: int, width: float) -> Step | None:
    """Return a step by which an axis is held too; None where it hardly feels the links, or has an effect of its own.

    What the links change of the torque of the axis has a prior, of as much in each direction as `width` times what the
    axis lacks. What it lacks itself is not heard any more.
    """
    links = next((t for t in kept if t.label == INERTIAL and axis in t.raw), None)
    if links is None or any(t.effect and set(t.blocks) == {axis} for t in step.taken_off(kept)):
        return None
    felt = links.raw[axis]
    may = width**2 * float(np.sum(white.raw_targets[axis] ** 2))
    if np.sum((felt * links.std) ** 2) <= may:
        return None
    felt = felt if links.turn is None else felt @ links.turn.T
    return replace(step, deaf=axis, hold=felt.T @ felt / max(may, 1e-300))


def _little_gained(
    white: White,
    ask: Asked,
    kept: list[Term],
    steps: dict[int, list[Step]],
    open_axes: Collection[int],
    asked: LeftOut,
) -> tuple[int, Step] | None:
    """Return an axis on which the model gains little or not nearly always, and what acts on it alone; None if none.

    A parameter of a drive is the same at all times. One that is better in some stretches and worse in others is a mean
    over what comes and goes, or follows noise: the next recording may hold more of the others. Where structure is left
    that nothing explains, the records say how differently a recording to come may turn out.
    """
    settings = white.problem.settings
    nearly_all = settings.nearly_all
    for axis in white.problem.judged:
        is_open = axis in open_axes
        little = asked.gained[axis] < nearly_all or (is_open and asked.ratio[axis] > nearly_all)
        if not little and not (is_open and _unsteady(white, kept, axis, asked)):
            continue
        own = [s for s in steps.get(axis, []) if s.terms and all(set(t.blocks) == {axis} for t in s.terms)]
        own = [s for s in own if (is_open or s.of_drive) and s.touches(kept)]
        if not own:
            continue
        together = Step(", ".join(s.words for s in own), tuple(t for s in own for t in s.terms))
        for step in [together, replace(together, deaf=axis)] if is_open else [together]:
            then = ask(step.taken_off(kept))
            # An axis that is above the limit by one slow record alone speaks against no step of another.
            worst = np.maximum(settings.not_worse, asked.ratio)
            fine = then.ratio <= worst
            if not little:
                # What only may turn out worse is given up where no other axis leans on it through the links.
                fine = then.ratio <= settings.not_worse * asked.ratio
                fine[axis] = min(then.ratio[axis], then.surely[axis]) <= worst[axis]
            if np.all(fine):
                return axis, step
    return None


def _held_in_the_open(
    white: White, ask: Asked, kept: list[Term], open_axes: Collection[int], asked: LeftOut
) -> tuple[int, Step] | None:
    """Return an axis of `open_axes` that does not nearly always gain by links alone, and how firmly it is held.

    Its drive is as given, as nothing explains what it lacks. What the others make of the links helps it here and harms
    it there, and a record to come may hold more of the one or the other. It is held as firmly as costs the others no
    more than the margin over the given robot. None if there is none.
    """
    settings = white.problem.settings
    for axis in sorted(open_axes):
        if asked.gained[axis] >= settings.nearly_all or any(t.drive[:1] == (axis,) for t in kept):
            continue
        for width in reversed(HALVINGS):
            step = _held(white, kept, Step(FELT), axis, width)
            if step is None:
                continue
            then = ask(step.taken_off(kept)).ratio
            others = np.arange(len(then)) != axis
            loses = np.any((then > settings.not_worse * asked.ratio)[others])
            if not loses and then[axis] <= max(settings.not_worse, asked.ratio[axis]):
                return axis, step
    return None


def _links_in_vain(ask: Asked, kept: list[Term], asked: LeftOut) -> tuple[int, Step] | None:
    """Return the axis that gains most by links closer to those given, and how close, if none loses; None if none.

    What nothing explains on one axis bends the links, and with them the torque of axes that lack nothing.
    """
    for step in reversed(OF_LINKS):
        if step.touches(kept):
            then = ask(step.taken_off(kept)).ratio
            if np.all(then <= asked.ratio):
                return int(np.argmin(then - asked.ratio)), step
    return None


def _unsteady(white: White, kept: list[Term], axis: int, asked: LeftOut) -> bool:
    """Return whether a record to come is expected to turn out worse on an axis, and its scatter is not noise alone."""
    if asked.steady[axis] >= 0.0:
        return False
    return bool(misfit_of(white, Fit(white.targets, kept))[axis] > 1.0)


def best_step(
    ask: Asked, kept: list[Term], steps: list[Step], axis: int, ratio: np.ndarray, limit: float
) -> Step | None:
    """Return the first step that mends an axis, else the one that helps most, else all at once; None if none is left.

    A step by which the model becomes worse than the given robot on another axis comes after all that do not. What costs
    other axes, as links and effects of the whole arm do that they lean on, is given up only where all axes together
    gain by it: the product of their ratios falls. Where that leaves nothing that helps, all goes that acts on the axis
    alone.

    Parameters
    ----------
    steps : what can be given up for the sake of `axis`. ratio : (n,) error of the model as it is over that of the given
        robot. limit : ratio at which an axis is mended.
    """
    others = np.arange(len(ratio)) != axis
    found: dict[bool, list[tuple[float, Step]]] = {False: [], True: []}
    costly: list[Step] = []
    for step in steps:
        if not step.touches(kept):
            continue
        after = ask(step.taken_off(kept)).surely
        harms = bool(np.any((after > np.maximum(limit, ratio))[others]))
        if (harms or step.of_many) and not _together_better(after, ratio):
            costly.append(step)
            continue
        if after[axis] <= limit and not harms:
            return step
        found[harms].append((float(after[axis]), step))
    if not any(found.values()) and not costly:
        return None
    for harms in (False, True):
        mending = next((step for value, step in found[harms] if value <= limit), None)
        if mending is not None:
            return mending
        least, best = min(found[harms], key=lambda f: f[0], default=(np.inf, None))
        if least < ratio[axis]:
            return best
    everything = Step(EVERYTHING, tuple(t for s in steps for t in s.terms), min(s.links for s in steps))
    own = Step(OWN, tuple(t for s in steps for t in s.terms if set(t.blocks) == {axis}))
    if _together_better(ask(everything.taken_off(kept)).surely, ratio):
        return everything
    if own.touches(kept) and _together_better(ask(own.taken_off(kept)).surely, ratio):
        return own
    return None


def _together_better(after: np.ndarray, before: np.ndarray) -> bool:
    """Return whether the product of the ratios (n,) of all axes falls; of axes that cannot be judged they are 0."""
    judged = (after > 0) & (before > 0)
    return bool(np.sum(np.log(after[judged])) < np.sum(np.log(before[judged])))
