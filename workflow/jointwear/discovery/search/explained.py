"""What share of what its axes lack an effect explains on motion that is left out."""

from __future__ import annotations

from jointwear.discovery.estimates.outcome import Named
from jointwear.discovery.linear import Term
from jointwear.discovery.problem.whitening import Folds, White
from jointwear.discovery.search.acceptance import follows_time, left_out_of, stiff
from jointwear.discovery.search.crossval import CrossValidated, cross_validate


def explained(white: White, before: list[Term], trial: Named, found: CrossValidated) -> float:
    """Return the share of what its axes lack that an effect explains on records left out, where its form may bend.

    Parameters
    ----------
    found : what the effect predicts in the form in which it passes the gates. No form is known exactly: what a bend of
        it takes up is the effect's own, not structure beside it.
    """
    return _or_bent(white, before, trial, found, left_out_of(white, trial.candidate))


def explained_elsewhere(white: White, before: list[Term], trial: Named) -> float:
    """Return the same of whole records, each of which may be of another motion; 1 for what changes with time.

    The parts of one record share its motion: where the other records go nowhere near, a form that fits one part fits
    the next, whatever it stands for.
    """
    if follows_time(trial.candidate):
        return 1.0
    return _or_bent(white, before, trial, cross_validate(white, before, [trial.term], white.folds), white.folds)


def _or_bent(white: White, before: list[Term], trial: Named, found: CrossValidated, parts_of: Folds) -> float:
    if trial.form is None or stiff(trial.candidate):
        return found.share
    return max(found.share, cross_validate(white, before, trial.terms, parts_of).share)
