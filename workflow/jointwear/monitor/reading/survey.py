"""What the first log tells about all: cut-off, dead band, torque scale, lag. Every other log is read with it.

Only the first log decides, so that a log that arrives later changes nothing of what was worked out before.
"""

from __future__ import annotations

from dataclasses import asdict, dataclass, field, replace
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np

from jointwear.files.errors import InputError
from jointwear.files.json_documents import read_json, write_json
from jointwear.files.wording import count
from jointwear.measurement.clock import Clock, Ordered
from jointwear.measurement.derived.even_steps import reaches, step_of
from jointwear.measurement.derived.filtering import SAFELY
from jointwear.measurement.derived.spectral_floor import spectral_floor
from jointwear.measurement.formats import Chunk, Layout, read_log
from jointwear.measurement.formats.chunk import RowsLeftOut, joined
from jointwear.measurement.turns import unwrapped
from jointwear.monitor.reading.accumulate import moving
from jointwear.monitor.reading.carried import LoadsOnMotion, least_mass, with_loads
from jointwear.monitor.reading.derivation import Motion, derive_motion
from jointwear.monitor.reading.load_groups import together
from jointwear.monitor.reading.model import ModelTorque, TorqueModel
from jointwear.monitor.reading.plausibility import check_first
from jointwear.monitor.reading.rounded import written_steps
from jointwear.monitor.reading.standing_torque import silent
from jointwear.monitor.reading.torque_lag import Lag, lag_of, pieces_of
from jointwear.robots.flange import FlangeLoad

#: Samples of the first log that are looked at.
LOOK = 200_000
#: Slowest rate [Hz] at which velocity can be derived from position.
SLOWEST_RATE = 10.0
#: Highest cut-off [Hz]: no arm is moved faster, and the acceleration's noise grows with its power of 2.5.
HIGHEST_CUTOFF = 40.0
#: Dead band: this many standard deviations of the velocity's noise, this share of the fast speed, and this [rad/s].
NOISE, SHARE, LEAST = 5.0, 0.02, 1e-3
#: Travel [rad] of the first log up to which an axis counts as at rest in it: brakes, servo and wind move it less, and
#: a program that moves an axis moves it further.
AT_REST = 0.05
#: Share of the samples that are slower than the fast speed of an axis.
FAST = 0.95
#: Fewest samples of a piece that shows a spectrum, most pieces that are looked at, and usual steps after which a sample
#: is missing before the next: closed up, two neighbours a step apart look like noise.
SHORTEST_PIECE, MOST_PIECES, MISSING = 64, 200, 1.5
#: Floor of a piece over the usual one above which it is left out: a spike, a bump against a stop.
LOUDEST_PIECE = 10.0
#: Samples of it that tell how late its torque is, those of a block of a log; and how long its noise remembers.
LAG_LOOK, BLOCK_LOOK = 40_000, 30_000
#: Length of a block in times that the noise remembers, and fewest blocks in the motion of a window.
BLOCK_TIMES, FEWEST_BLOCKS = 5.0, 30
#: The memory of noise: samples of an axis from which it is asked, longest lag, pairs that a lag needs, and correlation
#: below which it is forgotten.
FEWEST_SAMPLES, LONGEST_LAG, FEWEST_PAIRS, FORGOTTEN = 50, 400, 20, 0.05


@dataclass(frozen=True)
class Survey:
    """What the first log tells. Lists have one value an axis.

    `cutoff` [Hz] of the filter for what is derived; `dead_band` [rad/s]; `torque_reference` [N m]; `rate` [Hz] of this
    log, others have their own; `dated`; `measured`: roles that the log has; `left`: share of the squared torque that
    the model leaves, or None; `late`, `late_error` [s]: how late the torque is, :mod:`.torque_lag`, None where that is
    not seen; `block` [s] of :class:`~.accumulate.WindowSettings`; `log`: the log itself; `noisy`: the axis moves, and
    its dead band comes from the noise of its velocity; `left_over`, `zero` and `zero_axis` (0-based) as of
    :class:`~.misfit.Misfit`, of no axis where the list is empty; `position_step` [rad] and `torque_step` [N m] in which
    numbers are written, None where there is none, of no axis where the list is empty.
    """

    dated: bool
    rate: float
    cutoff: list[float]
    dead_band: list[float]
    torque_reference: list[float]
    measured: list[str]
    left: list[float | None]
    block: float
    log: str = ""
    noisy: list[bool] = field(default_factory=list)
    late: list[float] = field(default_factory=list)
    late_error: list[float | None] = field(default_factory=list)
    left_over: list[float | None] = field(default_factory=list)
    zero: str = ""
    zero_axis: int | None = None
    position_step: list[float | None] = field(default_factory=list)
    torque_step: list[float | None] = field(default_factory=list)

    @property
    def lag(self) -> Lag | None:
        """How late the torque of the first log is; None where the survey does not say, or no axis shows it."""
        if not any(e is not None for e in self.late_error):
            return None
        error = np.array([np.inf if e is None else e for e in self.late_error])
        return Lag(np.array(self.late), error, np.zeros(len(error)))

    def write(self, path: str | Path) -> None:
        """Keep the survey as JSON."""
        write_json(path, asdict(self))


def guard_of(rate: float) -> int:
    """Return how many samples around a reversal are left out: none where they lie far apart."""
    return 1 if reaches(rate, SLOWEST_RATE) else 0


def read_survey(path: str | Path) -> Survey:
    """Read what :meth:`Survey.write` wrote.

    Raises
    ------
    InputError : naming the file, if it is missing, damaged, or no survey.
    """
    try:
        return Survey(**read_json(path))
    except TypeError as error:
        raise InputError(f"{path}: is no survey ({error}); delete it and run again") from None


def survey_log(path: str, layout: Layout, model: TorqueModel, length: float, dead_band: Any = None) -> Survey:
    """Survey the first log of a robot.

    Parameters
    ----------
    length : of a window [s]. dead_band : [rad/s] of the config, a number or one an axis, or None.

    Raises
    ------
    InputError : if the log cannot be read, or contradicts the model; the latter
        :class:`~jointwear.measurement.refused.Refused`, with what to mend.
    """
    chunk, stretch = _first_samples(path, layout, length)
    step = step_of(chunk.time, stretch)
    rate = 1.0 / step
    roles = [r for r in ("position", "velocity", "acceleration", "temperature") if getattr(chunk, r) is not None]
    derived = "velocity" not in roles or "acceleration" not in roles
    if derived and not reaches(rate, SLOWEST_RATE):
        lacking = " and ".join(r for r in ("velocity", "acceleration") if r not in roles)
        raise InputError(
            f"{path}: is sampled at {rate:.3g} Hz, from which {lacking} cannot be derived: log {lacking} (named under "
            f"'variables'), or at least {SLOWEST_RATE:g} Hz"
        )
    cutoff, noise = _spectra(chunk, stretch, rate, derived)
    motion = derive_motion(chunk, stretch, cutoff)
    dead_bands, noisy = _dead_band(motion, noise, dead_band)
    unread = silent(chunk.torque, motion.position, np.abs(motion.velocity) > dead_bands, stretch, step)
    chunk = replace(chunk, torque=np.where(unread, np.nan, chunk.torque)) if unread.any() else chunk
    left, misfit = check_first(chunk, stretch, motion, model.robot, dead_bands, path)
    first = _First(chunk, stretch, motion, model, dead_bands, rate)
    lag = _lag(first, length)
    return Survey(
        dated=chunk.dated,
        rate=rate,
        cutoff=cutoff.tolist(),
        dead_band=dead_bands.tolist(),
        torque_reference=_torque_reference(chunk.torque).tolist(),
        measured=roles,
        left=left,
        block=_block_length(first, length),
        log=str(path),
        noisy=noisy.tolist(),
        late=lag.late.tolist(),
        late_error=[float(e) if np.isfinite(e) else None for e in lag.error],
        left_over=misfit.left_over,
        zero=misfit.zero,
        zero_axis=misfit.zero_axis,
        position_step=written_steps(chunk.position),
        torque_step=written_steps(chunk.torque),
    )


def _first_samples(path: str, layout: Layout, length: float) -> tuple[Chunk, np.ndarray]:
    """Return the first :data:`LOOK` samples of a log in order of time, and the label (m,) of the stretch of each.

    Raises
    ------
    InputError : if it cannot be read, or holds too little for a survey.
    """
    clock = Clock(length, path)
    parts: list[Ordered] = []
    seen = rows = 0
    try:
        for chunk in read_log(path, layout, 50_000):
            parts.append(clock.order(chunk))
            rows += len(chunk.time)
            seen += len(parts[-1].stretch)
            if seen >= LOOK:
                break
    except RowsLeftOut:  # told with the windows of the log
        if not parts:
            raise
    chunk = joined([p.chunk for p in parts])
    stretch = np.concatenate([p.stretch for p in parts])
    if len(stretch) < 2:
        still = f" whose time goes on, in {count(rows, 'row')}" if rows > len(stretch) else ""
        raise InputError(f"{path}: holds {count(len(stretch), 'sample')}{still}; that is too short for a survey")
    dead = np.flatnonzero(~np.isfinite(chunk.position).any(axis=0))
    if len(dead):
        raise InputError(
            f"{path}: the position of joint {dead[0] + 1} is never a finite number; every torque depends on it"
        )
    if not np.isfinite(chunk.torque).any():
        raise InputError(f"{path}: no torque of any joint is a finite number (N m, after 'scale' or 'torque_constant')")
    return chunk, stretch


@dataclass(frozen=True)
class _First:
    """The first samples of a log and what the model leaves of their torque."""

    chunk: Chunk
    stretch: np.ndarray
    motion: Motion
    model: TorqueModel
    dead_band: np.ndarray
    rate: float

    @cached_property
    def torque(self) -> ModelTorque:
        """Torques of the model along the first LAG_LOOK samples."""
        part, motion = slice(0, LAG_LOOK), self.motion
        temperature = None if motion.temperature is None else motion.temperature[part]
        q, v, a = motion.position[part], motion.velocity[part], motion.acceleration[part]
        return self.model(q, v, a, self.chunk.time[part], temperature, self.stretch[part])

    def left(self, part: slice) -> tuple[np.ndarray, np.ndarray]:
        """Return what the model leaves of the torque of some of them [N m], and where axes move, both (m, n)."""
        residual = self.chunk.torque[part] - self.torque.total[part]
        used = moving(self.motion.velocity[part], self.stretch[part], self.dead_band, guard_of(self.rate))
        return residual, used & self.motion.usable[part] & np.isfinite(residual)


def _lag(first: _First, length: float) -> Lag:
    """Return how late the torque of the first log is, of its first LAG_LOOK samples; unknown where these lie far
    apart."""
    n, rate, motion = len(first.dead_band), first.rate, first.motion
    if not reaches(rate, SLOWEST_RATE):
        return Lag(np.zeros(n), np.full(n, np.inf), np.zeros(n))
    part = slice(0, LAG_LOOK)
    residual, used = first.left(part)
    q, v, a = motion.position[part], motion.velocity[part], motion.acceleration[part]
    robot, time, stretch = first.model.robot, first.chunk.time[part], first.stretch[part]
    pieces = pieces_of(time, stretch, length)
    groups = together(pieces, np.floor(time / length), stretch, 1 / rate)
    along = LoadsOnMotion(FlangeLoad(robot), q, v, a)
    torque, clear = with_loads(first.torque, residual, v, used, groups, 1 / rate, along, least_mass(robot))
    return lag_of(first.chunk.torque[part], torque, (v, a), used & clear, pieces, time, along)


def _spectra(chunk: Chunk, stretch: np.ndarray, rate: float, derived: bool) -> tuple[np.ndarray, np.ndarray]:
    """Return the cut-off [Hz] and the noise of the velocity [rad/s], each (n,); rule of
    :mod:`jointwear.measurement.derived.motion`.

    Samples far apart show no spectrum: their noise counts as 0.
    """
    n = chunk.position.shape[1]
    if not reaches(rate, SLOWEST_RATE):
        return np.full(n, SAFELY * rate), np.zeros(n)
    cutoff, noise = np.full(n, min(SAFELY * rate, HIGHEST_CUTOFF)), np.zeros(n)
    source = unwrapped(chunk.position) if chunk.velocity is None else chunk.velocity
    edges = np.flatnonzero(np.diff(stretch)) + 1
    missing = np.flatnonzero(np.diff(chunk.time) * rate > MISSING) + 1
    for j in range(n):
        density, end = spectral_floor(_pieces(source[:, j], edges, missing, rate), rate)
        if derived:
            cutoff[j] = min(2.0 * end, SAFELY * rate, HIGHEST_CUTOFF)
        limit = cutoff[j] if derived else 0.5 * rate
        scale = (2 * np.pi) ** 2 * limit**3 / 3 if chunk.velocity is None else limit
        noise[j] = np.sqrt(density * scale)
    return cutoff, noise


def _pieces(signal: np.ndarray, edges: np.ndarray, missing: np.ndarray, rate: float) -> list[np.ndarray]:
    """Return the pieces of a signal (m,) that its noise is told from: without a hole, where there are such.

    Parameters
    ----------
    edges, missing : samples at which a stretch begins, and before which a sample is missing. rate : [Hz].
    """
    whole = [x[np.isfinite(x)] for x in np.split(signal, edges)]
    whole = [x for x in whole if len(x) >= SHORTEST_PIECE][:MOST_PIECES]
    finite = np.isfinite(signal)
    if finite.all() and not len(np.setdiff1d(missing, edges)):
        return whole
    cuts = np.unique(np.concatenate([edges, missing, np.flatnonzero(np.diff(finite)) + 1]))
    # Of the second differences as many as a spectrum takes are left.
    sound = [x for x in np.split(signal, cuts) if len(x) >= SHORTEST_PIECE + 2 and np.isfinite(x[0])]
    if not sound:
        return whole
    sound = sorted(sound, key=len, reverse=True)[:MOST_PIECES]
    floors = np.array([spectral_floor([x], rate)[0] for x in sound])
    return [x for x, floor in zip(sound, floors, strict=True) if floor <= LOUDEST_PIECE * np.median(floors)]


def _dead_band(motion: Motion, noise: np.ndarray, given: Any) -> tuple[np.ndarray, np.ndarray]:
    """Return the dead band [rad/s] and whether it comes from noise, each (n,); `given` in the config is taken as is."""
    n = len(noise)
    if given is not None:
        return np.broadcast_to(np.asarray(given, dtype=float), (n,)).copy(), np.zeros(n, dtype=bool)
    speed = np.where(motion.usable, np.abs(motion.velocity), np.nan)
    fast = np.array([np.nanquantile(s, FAST) if np.isfinite(s).any() else 0.0 for s in speed.T])
    position = np.where(motion.usable, motion.position, np.nan)
    moves = np.array([np.isfinite(q).any() and np.nanmax(q) - np.nanmin(q) > AT_REST for q in position.T])
    if moves.any():
        # What an axis at rest does in this log is no motion of it: its own speed says nothing of how it moves later.
        fast[~moves] = np.median(fast[moves])
    by_speed = np.maximum(SHARE * fast, LEAST)
    return np.maximum(NOISE * noise, by_speed), moves & (NOISE * noise > by_speed)


def _torque_reference(torque: np.ndarray) -> np.ndarray:
    """Largest |torque| of each axis; 1 N m where the log has none."""
    largest = np.array([np.nanmax(np.abs(t)) if np.isfinite(t).any() else 0.0 for t in torque.T])
    return np.where(largest > 0, largest, 1.0)


def _block_length(first: _First, length: float) -> float:
    """Return the length of a block [s]: BLOCK_TIMES the time that the noise remembers, FEWEST_BLOCKS fit a window."""
    part = slice(0, BLOCK_LOOK)
    time, stretch, v = first.chunk.time[part], first.stretch[part], first.motion.velocity[part]
    gravity, inertial = first.torque.gravity[part], first.torque.inertial[part]
    residual, used = first.left(part)
    step = 1 / first.rate if first.rate else 1.0
    memory = 1.0
    for j in range(v.shape[1]):
        u = used[:, j]
        if u.sum() < FEWEST_SAMPLES:
            continue
        design = np.stack([v[:, j] > 0, v[:, j] < 0, v[:, j], gravity[:, j], inertial[:, j]], axis=1)
        fit = np.linalg.lstsq(design[u].astype(float), residual[u, j], rcond=1e-9)[0]
        error = np.where(u, residual[:, j] - design @ fit, 0.0)
        memory = max(memory, _memory(error, u, stretch))
    windows = len(np.unique(np.floor(time / length)))
    in_motion = step * float(used.sum(axis=0).max(initial=0)) / windows
    return float(max(min(BLOCK_TIMES * memory * step, in_motion / FEWEST_BLOCKS), 2 * step))


def _memory(error: np.ndarray, used: np.ndarray, stretch: np.ndarray) -> float:
    """Return 1 + 2 sum of the autocorrelations up to the first below FORGOTTEN, in samples; arrays (m,)."""
    power, total = float(np.sum(error**2)) / max(int(used.sum()), 1), 1.0
    if power <= 0:
        return total
    for lag in range(1, min(LONGEST_LAG, len(error) - 1)):
        pair = used[lag:] & used[:-lag] & (stretch[lag:] == stretch[:-lag])
        pairs = int(pair.sum())
        if pairs < FEWEST_PAIRS:
            break
        rho = float(np.sum(error[lag:] * error[:-lag] * pair)) / pairs / power
        if rho < FORGOTTEN:
            break
        total += 2 * rho
    return total
