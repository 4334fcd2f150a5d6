"""Choose among candidates: the simplest one that no richer one beats clearly."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from jointwear.studies.recovery.fit import ExplanationFit
from jointwear.studies.recovery.plan import NOT_TOLD_APART, NOTHING

VERY_STRONG = 10.0  # difference of the criterion that counts as very strong evidence (Kass and Raftery 1995)


def parts(name: str) -> frozenset[str]:
    """Return the components of a candidate's name."""
    return frozenset() if name == NOTHING else frozenset(name.split("+"))


def choose(fits: Mapping[str, ExplanationFit], transferred: Mapping[str, float] | None = None) -> str:
    """Return the name of the chosen candidate.

    Parameters
    ----------
    fits : one fit for every candidate.
    transferred : mean squared weighted residual on left-out tasks, of some candidates. A richer candidate that
        was tested must be better there too than a simpler one that was tested.

    Notes
    -----
    From `nothing` on, the best single component is taken if it beats what stands by more than VERY_STRONG, then the
    best pair that holds it, so that a pair of two makeshifts never wins over one cause.
    """
    transferred = transferred or {}
    standing = NOTHING
    for size in (1, 2):
        richer = [n for n in fits if len(parts(n)) == size and parts(standing) < parts(n)]
        richer.sort(key=lambda n: fits[n].bic)
        for name in richer:
            if fits[name].bic > fits[standing].bic - VERY_STRONG:
                break
            if name in transferred and standing in transferred and transferred[name] >= transferred[standing]:
                continue
            standing = name
            break
        if len(parts(standing)) < size:
            break
    return standing


def runner_up(fits: Mapping[str, ExplanationFit], chosen: str) -> str:
    """Return the best candidate that does not hold the chosen one and is not the same in slow motion."""
    same = {chosen, *(c for p in parts(chosen) for c in NOT_TOLD_APART[p])}
    others = [n for n in fits if n not in same and not (parts(chosen) and parts(chosen) <= parts(n))]
    return min(others, key=lambda n: fits[n].bic)


def finalists(fits: Mapping[str, ExplanationFit], singles: int = 3, pairs: int = 2) -> Sequence[str]:
    """Return the candidates worth a transfer test: nothing, the best singles, the best pairs with the best single."""
    alone = sorted((n for n in fits if len(parts(n)) == 1), key=lambda n: fits[n].bic)
    both = sorted(
        (n for n in fits if len(parts(n)) == 2 and alone and parts(alone[0]) < parts(n)), key=lambda n: fits[n].bic
    )
    return [NOTHING, *alone[:singles], *both[:pairs]]
