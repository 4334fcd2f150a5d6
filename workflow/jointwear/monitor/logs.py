"""One log to window statistics, block by block: memory does not grow with the length of the log."""

from __future__ import annotations

import itertools
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from jointwear.files.errors import InputError
from jointwear.measurement.clipped_torque import at_limit
from jointwear.measurement.clock import Clock, Ordered, join, part_of
from jointwear.measurement.flags import Flag
from jointwear.measurement.formats import Layout, read_log
from jointwear.measurement.formats.chunk import Chunk, unread_in_words
from jointwear.monitor.accumulate import WindowSettings, moving, window_statistics
from jointwear.monitor.carried import LoadsOnMotion, least_mass, with_loads
from jointwear.monitor.derivation import Motion, derive_motion
from jointwear.monitor.inspection import Inspector
from jointwear.monitor.model import ModelTorque, TorqueModel
from jointwear.monitor.plausibility import outside_limits
from jointwear.monitor.reversals import reach_of
from jointwear.monitor.survey import Survey, guard_of
from jointwear.monitor.windows import WindowStatistics, blank_statistics, merge
from jointwear.robots.flange import FlangeLoad

#: Samples of a block, and samples around it that are read along for filters and reversals.
BLOCK, HALO = 40_000, 400


@dataclass(frozen=True)
class LogStatistics:
    """Statistics of one log, time of its first and last sample [s] (NaN if none), and in words what was refused."""

    statistics: WindowStatistics
    first: float = float("nan")
    last: float = float("nan")
    refused: tuple[str, ...] = ()


def log_statistics(
    path: str, layout: Layout, model: TorqueModel, survey: Survey, length: float, block: int = BLOCK
) -> LogStatistics:
    """Return the statistics of one log.

    A block that contradicts the model is refused: its windows hold none of its samples and are flagged. A log that
    cannot be read (further) ends there, and says so; what was read before stays.

    Parameters
    ----------
    length : of a window [s]. block : samples worked on at a time.
    """
    settings = WindowSettings(
        length,
        np.array(survey.dead_band),
        np.array(survey.torque_reference),
        guard=guard_of(survey.rate),
        reach=reach_of(survey.rate),
        block=survey.block,
    )
    inspector = Inspector(model, survey, path)
    loads = FlangeLoad(model.robot)
    refused = inspector.refused
    parts: list[WindowStatistics] = []
    span = [np.inf, -np.inf]
    unread: list[tuple[int, str]] = []
    try:
        for around, kept in _blocks(path, layout, length, block, unread):
            time = around.chunk.time[kept]
            span = [min(span[0], float(time.min())), max(span[1], float(time.max()))]
            parts.append(_block_statistics(around, kept, model, loads, survey, settings, inspector))
            if len(parts) >= 32:
                parts = [merge(parts)]
    except InputError as error:
        refused.append(str(error))
    if words := unread_in_words(unread):
        refused.append(f"{path}: {words}")
    dated = survey.dated if not parts else parts[0].dated
    if dated != survey.dated:
        told = ("dates", "none") if dated else ("no dates", "some")
        refused.append(f"{path}: has {told[0]}, the first log has {told[1]}; the two cannot be put in order")
        parts = []
    empty = blank_statistics(np.zeros(0), length, settings.torque_reference, survey.dated)
    if not parts:
        return LogStatistics(empty, refused=tuple(dict.fromkeys(refused)))
    return LogStatistics(merge(parts), *span, tuple(dict.fromkeys(refused)))


def _blocks(
    path: str, layout: Layout, length: float, block: int, unread: list[tuple[int, str]]
) -> Iterator[tuple[Ordered, slice]]:
    """Yield blocks with what is around them, and which of their samples count; `unread` is filled as of chunks.

    Raises
    ------
    InputError : where a log breaks off, after what was read before has been yielded.
    """
    clock = Clock(length, path)
    waiting: list[Ordered] = []
    size = before = 0
    broken: list[InputError] = []
    for chunk in _until_broken(read_log(path, layout, block), broken):
        unread.append(chunk.unread)
        waiting.append(clock.order(chunk))
        size += len(waiting[-1].stretch)
        while size >= before + block + HALO:
            joined = join(waiting)
            stop = before + block
            yield part_of(joined, slice(0, stop + HALO)), slice(before, stop)
            rest = max(stop - HALO, 0)
            waiting = [part_of(joined, slice(rest, None))]
            size, before = len(waiting[0].stretch), stop - rest
    if size > before:
        yield join(waiting), slice(before, size)
    if broken:
        raise broken[0]


def _until_broken(chunks: Iterator[Chunk], broken: list[InputError]) -> Iterator[Chunk]:
    """Yield chunks until reading fails; the error goes into `broken`."""
    try:
        yield from chunks
    except InputError as error:
        broken.append(error)


def _block_statistics(
    around: Ordered,
    kept: slice,
    model: TorqueModel,
    loads: FlangeLoad,
    survey: Survey,
    settings: WindowSettings,
    inspector: Inspector,
) -> WindowStatistics:
    chunk, robot = around.chunk, model.robot
    motion = derive_motion(chunk, around.stretch, np.array(survey.cutoff))
    flags = around.flags[:, None] | motion.flags
    saturated, _ = at_limit(chunk.torque, chunk.position, around.stretch)
    flags[saturated] |= int(Flag.SATURATED)
    usable = motion.usable & ~saturated
    marks = inspector(around, motion, kept)
    flags = flags | marks
    usable = usable & (marks & int(Flag.REFUSED) == 0)
    far = outside_limits(chunk.position, robot)
    flags[far] |= int(Flag.OUTSIDE_LIMITS)
    usable = usable & ~far.any(axis=1)[:, None]
    frozen = _frozen(chunk.torque, motion.velocity, np.array(survey.dead_band))
    flags[:, frozen] |= int(Flag.TORQUE_FROZEN)
    if usable.any():
        # Only samples of axes that move are held against their gravity torque.
        moved = (np.abs(motion.velocity) > settings.dead_band).any(axis=1)
        torque = model(
            motion.position, motion.velocity, motion.acceleration, chunk.time, motion.temperature, around.stretch, moved
        )
    else:
        zeros = np.zeros_like(chunk.position)
        torque = ModelTorque(zeros, zeros, zeros)
    torque, clear = _with_loads(around, motion, torque, usable, loads, least_mass(robot), settings, survey)
    usable = usable & clear
    return window_statistics(
        chunk.time,
        motion.position,
        motion.velocity,
        chunk.torque,
        torque,
        settings,
        usable=usable,
        stretch=around.stretch,
        temperature=motion.temperature,
        flags=flags,
        program=chunk.program,
        kept=kept,
        dated=chunk.dated,
    )


def _with_loads(
    around: Ordered,
    motion: Motion,
    torque: ModelTorque,
    usable: np.ndarray,
    loads: FlangeLoad,
    least: float,
    settings: WindowSettings,
    survey: Survey,
) -> tuple[ModelTorque, np.ndarray]:
    """Return the torque of the model with the loads that each window shows, and the samples clear of a switch."""
    residual = around.chunk.torque - torque.total
    used = usable & np.isfinite(residual)
    used &= moving(motion.velocity, around.stretch, settings.dead_band, settings.guard)
    label = np.floor(around.chunk.time / settings.length)
    cuts = np.flatnonzero((np.diff(label) != 0) | (np.diff(around.stretch) != 0)) + 1
    pieces = [slice(a, b) for a, b in itertools.pairwise([0, *cuts.tolist(), len(label)])] if len(label) else []
    along = LoadsOnMotion(loads, motion.position, motion.velocity, motion.acceleration)
    return with_loads(torque, residual, motion.velocity, used, pieces, 1 / max(survey.rate, 1e-3), along, least)


def _frozen(torque: np.ndarray, velocity: np.ndarray, dead_band: np.ndarray, fewest: int = 200) -> np.ndarray:
    """Return the axes (n,) whose torque keeps one value though they move both ways."""
    if len(torque) < fewest:
        return np.zeros(torque.shape[1], dtype=bool)
    # One value throughout shows in the first samples already: mostly nothing is left to look at.
    first = torque[:fewest]
    same = ~(np.isfinite(first[0]) & np.isfinite(first) & (first != first[0])).any(axis=0)
    for j in np.flatnonzero(same):
        known = torque[np.isfinite(torque[:, j]), j]
        same[j] = len(known) > 0 and np.ptp(known) == 0
    both = (velocity > dead_band).sum(axis=0), (velocity < -dead_band).sum(axis=0)
    return same & (np.minimum(*both) > 20)
