"""Measured velocities and accelerations against the positions that they belong to."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from jointwear.measurement.derived.even_steps import GAP, pieces_of, reaches
from jointwear.measurement.derived.filtering import SHORTEST
from jointwear.measurement.derived.smoothing import SLOWEST
from jointwear.measurement.formats.chunk import Chunk
from jointwear.measurement.possible import likely_unit
from jointwear.measurement.recording import Recording
from jointwear.measurement.refused import FEWEST_OF_JOINT, Refused
from jointwear.measurement.turns import unwrapped
from jointwear.measurement.units import POSITION_WORDS, size_of, sizes_of

#: Ratios of a derivative to what the positions say that count as right: filters take a part off fast motion.
LOWEST, HIGHEST = 0.8, 1.25
#: How far, relative, the ratio of a velocity in revolutions may be off: those in rpm lie near that of a clock that is
#: ten times off.
CLOSELY = 0.03
#: Length of the pieces that are compared [s]; longest step of time [s] at which they can be.
PIECE, LONGEST_STEP = 0.2, 0.1
#: Ratios of a derivative to that of its position that mean degrees in one of them.
_PER_DEGREE = 180 / np.pi


def check_derivatives(samples: Chunk | Recording, stretch: np.ndarray, name: str) -> None:
    """Compare what measured velocities and accelerations add up to with the change of position, over pieces of 0.2 s.

    Parameters
    ----------
    stretch : (m,) label of the uninterrupted run that each sample belongs to.

    Raises
    ------
    Refused : where one differs by more than a fifth, with the ratio and the key that mends it.
    """
    steps = np.diff(samples.time)
    whole = np.diff(stretch) == 0
    usual = float(np.median(steps[whole])) if whole.any() else np.inf
    if len(samples.time) < FEWEST_OF_JOINT or not 0 < usual <= LONGEST_STEP:
        return
    reach = max(1, round(PIECE / usual))
    position, steps = unwrapped(samples.position), np.where(whole, steps, 0.0)
    for role, order in (("velocity", 1), ("acceleration", 2)):
        given = getattr(samples, role)
        if given is None:
            continue
        path = np.nan_to_num(given)
        for _ in range(order):
            path = np.concatenate([0 * path[:1], np.cumsum(0.5 * (path[1:] + path[:-1]) * steps[:, None], axis=0)])
        # The second difference of a path takes off what integration left open, its velocity at the start.
        ends = slice(order * reach, None), slice(None, -order * reach)
        same = stretch[ends[0]] == stretch[ends[1]]
        finite = np.isfinite(given) & np.isfinite(position)
        told, moved = (_differences(x, reach, order) for x in (path, position))
        good = same[:, None] & finite[ends[1]] & (_differences(np.cumsum(~finite, axis=0), order * reach, 1) == 0)
        for j in range(position.shape[1]):
            one, other = told[good[:, j], j], moved[good[:, j], j]
            if len(one) < FEWEST_OF_JOINT or np.abs(other).sum() < 0.05 * reach:
                continue
            ratio = float(one @ other) / float(other @ other)
            if not LOWEST < ratio < HIGHEST:
                hint, remedy = _remedy(role, ratio, samples.units)
                raise Refused(
                    f"{name}: the {role} of joint {j + 1} is {ratio:.3g} times the change of its position{hint}",
                    remedy,
                    by_keys=bool(hint),
                )


def check_rate(recording: Recording, name: str) -> None:
    """Check that the samples are close enough for a smoothed motion, and enough of them in one piece.

    Raises
    ------
    Refused : where they are not, with the unit of time that would mend it.
    """
    steps = np.diff(recording.time)[np.diff(recording.trajectory) == 0]
    if len(steps) and np.median(steps) > 0 and not reaches(1.0 / float(np.median(steps)), SLOWEST):
        unit = likely_unit(float(np.median(steps)), recording.units.get("time", "s"))
        if np.all(steps == 1.0):
            raise Refused(
                f"{name}: the time rises by 1 from sample to sample, as numbers of rows do; no motion is resolved",
                f"write the time of each row [s]; where it is a time, state its unit, as units: {{time: {unit}}}",
                by_keys=True,
            )
        raise Refused(
            f"{name}: the samples are {np.median(steps):.3g} s apart (allowed: at most {1 / SLOWEST:g} s); "
            "no motion is resolved",
            f"record more often, or state the unit of the time, as units: {{time: {unit}}}",
            by_keys=True,
        )
    pieces = pieces_of(recording.time, recording.trajectory)
    longest = max((p.stop - p.start for p in pieces), default=0)
    if len(recording.time) and longest < SHORTEST:
        gaps = f"half of the steps are shorter than {np.median(steps):.3g} s" if len(steps) else "each is one sample"
        raise Refused(
            f"{name}: no piece without a gap has {SHORTEST} samples (the longest has {longest} of "
            f"{len(recording.time)}; {gaps}, and more than {GAP:g} of these are a gap); no motion is resolved",
            "give each sample the time at which it was taken, not that at which it was received or written",
        )


def _differences(values: np.ndarray, reach: int, order: int) -> np.ndarray:
    """Return differences of an order over `reach` samples, (m - order * reach, n)."""
    for _ in range(order):
        values = values[reach:] - values[:-reach]
    return values


def _remedy(role: str, ratio: float, stated: Mapping[str, str]) -> tuple[str, str]:
    """Return what the ratio of a derivative to the change of position looks like, and the remedy, a key
    where it looks like something.

    What is stated in another unit than radians is what is looked at first.
    """
    unit = {"velocity": "deg/s", "acceleration": "deg/s2"}[role]
    position = _other_position(ratio, stated.get("position") or "rad")
    if position and stated.get("position") not in (None, "rad"):
        return position
    if LOWEST < ratio / _PER_DEGREE < HIGHEST and stated.get(role) != unit:
        return "; it looks like degrees", f"state units: {{{role}: {unit}}}"
    if LOWEST < ratio * _PER_DEGREE < HIGHEST and stated.get(role) == unit:
        return "; it looks like radians", f"state units: {{{role}: {unit.replace('deg', 'rad')}}}"
    if role == "velocity" and stated.get(role) in (None, "rad/s"):
        for unit in ("rpm", "rev/s"):
            if abs(ratio * sizes_of(role)[unit] - 1.0) < CLOSELY:
                return "; it looks like revolutions", f"state units: {{{role}: {unit}}}"
    return position or ("", f"mend the units or the sign of the {role}, or leave it out: it is then derived")


def _other_position(ratio: float, stated: str) -> tuple[str, str] | None:
    """Return in words the unit of the positions that a ratio stands for, and the remedy; None where it is none."""
    sizes = sizes_of("position")
    for unit, size in sizes.items():
        if unit != stated and LOWEST < ratio * size_of("position", stated) / size < HIGHEST:
            return f"; the positions look like {POSITION_WORDS[unit]}", f"state units: {{position: {unit}}}"
    return None
