"""What a model with effects can give up for the sake of a joint that it makes worse, and what is left of it then."""

from __future__ import annotations

from dataclasses import replace

from jointwear.discovery.estimates.references import effect_term
from jointwear.discovery.estimates.refine import free_parameters
from jointwear.discovery.estimates.refined_model import RefinedModel
from jointwear.discovery.linear import Term
from jointwear.discovery.model.fallback import DRIVE, EVERYTHING, HELD_WITHOUT, OF_LINKS, OWN, PutBack, Step
from jointwear.discovery.problem.candidates import Candidate
from jointwear.discovery.problem.whitening import White
from jointwear.effects import get_effect

#: First word of a step that gives up an effect.
WITHOUT = "without"
#: First words of a step that gives up the bend of the form of an effect, and keeps the effect.
PLAIN = "the plain form of"


def steps_of(
    white: White, base: list[Term], model: RefinedModel, plainer: list[list[tuple[Candidate, Term]]]
) -> dict[int, list[Step]]:
    """Return what can be given up for the sake of each axis, a link mass by all axes that carry the link.

    Parameters
    ----------
    plainer : of each effect, as of :func:`plainer_forms`.
    """
    steps = {}
    for axis in white.problem.judged:
        own = tuple(t for t in base if t.drive[:1] == (axis,))
        steps[axis] = [Step(DRIVE, own, of_drive=True), *OF_LINKS]
        for one in model.masses:
            if axis in one.term.blocks:
                # Of a link that no other joint feels it is as good as motor inertia.
                alone = set(one.term.blocks) == {axis}
                words = f"mass of link {one.candidate.axis + 1} as given"
                steps[axis].append(Step(words, (one.term,), of_drive=alone))
        for effect, others in zip(model.effects, plainer, strict=True):
            candidate, bend = effect.candidate, () if effect.bend is None else effect.bend[1:]
            if candidate.axis is None or axis in candidate.axes:
                whole = (effect.term, *bend)
                if bend:
                    # A bend follows what noise and structure do where the effect itself is nothing.
                    steps[axis].append(Step(f"{PLAIN} {candidate.effect}", bend))
                for other, plain in others:
                    words = f"{PLAIN} {candidate.effect}"
                    if candidate.both:
                        words = f"{candidate.effect} on joint {other.axis + 1} alone"
                    steps[axis].append(Step(words, whole, instead=(plain,)))
                    whole = (*whole, plain)
                steps[axis].append(Step(f"{WITHOUT} {candidate.effect}", whole))
    return steps


def plainer_forms(white: White, candidate: Candidate, term: Term) -> list[tuple[Candidate, Term]]:
    """Return an effect in its plain forms, the one that says most first, which could stand in the place of its own.

    That of a drive that two joints turn is its half on the joint that it is named on.
    """
    if candidate.both:
        half = candidate.halves[0]
        return [(half, effect_term(white, half, term))]
    if candidate.axis is None or not free_parameters(candidate):
        return []
    plain = get_effect(candidate.effect).plain(white.problem.train_state, candidate.axis)
    found = [replace(candidate, nonlinear=dict(p)) for p in reversed(plain)]
    return [(c, effect_term(white, c, term)) for c in found if c.nonlinear != candidate.nonlinear]


def given_up_of_effects(given_up: tuple[PutBack, ...], lost: list[Candidate]) -> tuple[PutBack, ...]:
    """Return what was given up of effects, those that went with everything else of their joint by their names."""
    result = []
    for step in given_up:
        whole = step.step == EVERYTHING
        own = [c.effect for c in lost if (whole if c.axis is None else c.axis + 1 == step.axis)]
        if step.step.startswith(WITHOUT):
            result.append(step)
        elif step.step in (EVERYTHING, OWN, HELD_WITHOUT) and own:
            result.append(replace(step, step=f"{WITHOUT} {', '.join(own)}", held=False))
    return tuple(result)
