"""One log to window statistics, block by block: memory does not grow with the length of the log."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field, replace

import numpy as np

from jointwear.files.errors import InputError
from jointwear.measurement.checks.clipped_torque import at_limit
from jointwear.measurement.checks.held_rows import without_lines
from jointwear.measurement.clock import Clock, Ordered, join, part_of
from jointwear.measurement.derived.even_steps import step_of
from jointwear.measurement.derived.jumps import without_jumps_of
from jointwear.measurement.derived.torque_spikes import without_spikes_of
from jointwear.measurement.flags import Flag
from jointwear.measurement.formats import Layout, ends_within_a_row, read_log
from jointwear.measurement.formats.chunk import Chunk, unread_in_words
from jointwear.monitor.reading.accumulate import Samples, WindowSettings, window_statistics
from jointwear.monitor.reading.carried import clear_ones, least_mass
from jointwear.monitor.reading.derivation import Motion, derive_motion
from jointwear.monitor.reading.inspection import Inspector
from jointwear.monitor.reading.loads_of_windows import (
    LoadsOfWindows,
    all_loads,
    doubtful_windows,
    loads_of_windows,
    no_loads,
)
from jointwear.monitor.reading.model import ModelTorque, TorqueModel
from jointwear.monitor.reading.plausibility import outside_limits
from jointwear.monitor.reading.reversals import reach_of
from jointwear.monitor.reading.rounded import coarser
from jointwear.monitor.reading.scattered_stamps import stamps_scatter
from jointwear.monitor.reading.seen_block import SeenBlock, model_torque
from jointwear.monitor.reading.standing_torque import mostly, silent, standing
from jointwear.monitor.reading.survey import Survey, guard_of
from jointwear.monitor.reading.torque_lag import LARGEST, off_in_time, read_later, rest_of
from jointwear.monitor.reading.windows import WindowStatistics, blank_statistics, merge
from jointwear.robots.flange import FlangeLoad

#: Samples of a block, and samples around it that are read along for filters and reversals.
BLOCK, HALO = 40_000, 400
#: Blocks whose statistics are put together at a time.
TOGETHER = 32


@dataclass(frozen=True)
class LogStatistics:
    """Statistics of one log, time of its first and last sample [s] (NaN if none), in words what was refused, whether it
    is `cut` off within its last row, and the `loads` that its windows show."""

    statistics: WindowStatistics
    first: float = float("nan")
    last: float = float("nan")
    refused: tuple[str, ...] = ()
    cut: bool = False
    loads: LoadsOfWindows = field(default_factory=no_loads)


def log_statistics(
    path: str, layout: Layout, model: TorqueModel, survey: Survey, length: float, block: int = BLOCK
) -> LogStatistics:
    """Return the statistics of one log.

    A block that contradicts the model is refused: its windows hold none of its samples and are flagged. A log that
    cannot be read (further) ends there, and says so; what was read before stays.

    Parameters
    ----------
    length : of a window [s]. block : samples worked on at a time.

    Notes
    -----
    A window that lies in two blocks is worked out part by part: loads, delays and what contradicts the model are found
    in each alone. What it tells thus depends on where blocks end, and most of all its zeros, which need the most data.
    """
    settings = WindowSettings(
        length,
        np.array(survey.dead_band),
        np.array(survey.torque_reference),
        block=survey.block,
    )
    inspector = Inspector(model, survey, path)
    loads = FlangeLoad(model.robot)
    refused = inspector.refused
    parts: list[WindowStatistics] = []
    laden: list[WindowStatistics] = []
    shown: list[LoadsOfWindows] = []
    span = [np.inf, -np.inf]
    unread: list[tuple[int, str]] = []
    try:
        for around, kept in _blocks(path, layout, length, block, unread):
            time = around.chunk.time[kept]
            span = [min(span[0], float(time.min())), max(span[1], float(time.max()))]
            own, with_doubtful, of_block = _block_statistics(
                around, kept, model, loads, survey, settings, inspector, path
            )
            parts.append(own)
            laden.append(with_doubtful)
            shown.append(of_block)
            if len(parts) >= TOGETHER:
                parts, laden = [merge(parts)], [merge(laden)]
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
    cut = ends_within_a_row(path, layout)
    found = all_loads(shown, doubtful_windows(shown, laden))
    return LogStatistics(merge(parts), *span, tuple(dict.fromkeys(refused)), cut, found)


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
    path: str,
) -> tuple[WindowStatistics, WindowStatistics, LoadsOfWindows]:
    """Return the statistics of the `kept` samples of a block with the loads that it clearly shows, the same with all
    that it shows, and these loads; read at the time of the first log."""
    around = replace(around, chunk=without_spikes_of(around.chunk, around.stretch))
    chunk = around.chunk
    step = step_of(chunk.time, around.stretch)
    settings = replace(settings, guard=guard_of(1 / step), reach=reach_of(1 / step))
    measured = without_jumps_of(without_lines(chunk, around.stretch), around.stretch)
    motion = derive_motion(measured, around.stretch, np.array(survey.cutoff))
    moves = np.abs(motion.velocity) > settings.dead_band
    unread = silent(chunk.torque, motion.position, moves, around.stretch, step)
    if unread.any():
        chunk = replace(chunk, torque=np.where(unread, np.nan, chunk.torque))
        around = replace(around, chunk=chunk)
    marks = inspector(around, motion, kept)
    marks |= np.where(coarser(chunk.position, survey.position_step), int(Flag.COARSE_POSITION), 0)
    marks |= np.where(coarser(chunk.torque, survey.torque_step), int(Flag.COARSE_TORQUE), 0)
    frozen = mostly(unread, moves, chunk.time, settings.length)
    marks |= np.where(frozen, int(Flag.TORQUE_FROZEN), np.where(unread, int(Flag.SILENT), 0))
    far = outside_limits(measured.position, model.robot)
    flags, usable = _flagged(around, motion, marks, far, settings.dead_band)
    torque = model_torque(model, around, motion, usable, settings.dead_band)
    # An axis whose torque is none says nothing of the load that all axes carry.
    sound = (flags & int(Flag.CONTRADICTED | Flag.TORQUE_FROZEN)) == 0
    seen, values = SeenBlock(around, motion, loads, least_mass(model.robot), settings, survey, step), chunk.torque
    shown = seen.shown_loads(torque, values, usable & sound)
    certain = clear_ones(shown)
    loaded, clear = seen.carrying(torque, certain)
    later = seen.later(loaded, values, usable & clear & sound)
    if abs(later) > LARGEST:
        inspector.tell(off_in_time(path))
        flags, usable = flags | int(Flag.REFUSED), np.zeros_like(usable)
    elif later:
        flags = flags | int(Flag.LATER)
        values, there = read_later(chunk.torque, chunk.time, around.stretch, usable, later)
        later += rest_of(seen.lag(loaded, values, there & clear & sound), survey.lag)
        values, usable = read_later(chunk.torque, chunk.time, around.stretch, usable, later)
        shown = seen.shown_loads(torque, values, usable & sound)
        certain = clear_ones(shown)
        loaded, clear = seen.carrying(torque, certain)

    def read_with(loaded: ModelTorque, clear: np.ndarray) -> WindowStatistics:
        samples = Samples(
            chunk.time,
            motion.position,
            motion.velocity,
            values,
            loaded,
            usable=usable & clear,
            stretch=around.stretch,
            temperature=motion.temperature,
            flags=flags,
            program=chunk.program,
            dated=chunk.dated,
        )
        result = window_statistics(samples, settings, kept)
        seen.add_zeros(result, loaded, values, usable & clear & sound, model.dynamics, kept)
        return result

    result = read_with(loaded, clear)
    laden = result if len(certain) == len(shown) else read_with(*seen.carrying(torque, shown))
    return result, laden, loads_of_windows(shown, chunk.time, result.start, settings.length)


def _flagged(
    around: Ordered, motion: Motion, marks: np.ndarray, far: np.ndarray, dead_band: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Return the flags (m, n) of a block, and which of its samples (m, n) may be used.

    Parameters
    ----------
    marks : (m, n) flags of what contradicts the model. far : (m, n) positions outside the limits of their joints.
    dead_band : (n,) [rad/s].
    """
    chunk = around.chunk
    flags = around.flags[:, None] | motion.flags | marks
    saturated, _ = at_limit(chunk.torque, chunk.position, around.stretch)
    flags[saturated] |= int(Flag.SATURATED)
    flags[far] |= int(Flag.OUTSIDE_LIMITS)
    if stamps_scatter(chunk.time, around.stretch):
        flags |= int(Flag.SCATTERED)
    flags[:, standing(chunk.torque, motion.velocity, dead_band)] |= int(Flag.TORQUE_FROZEN)
    # Every torque depends on every position.
    usable = motion.usable & ~saturated & (marks & int(Flag.REFUSED) == 0) & ~far.any(axis=1)[:, None]
    return flags, usable
