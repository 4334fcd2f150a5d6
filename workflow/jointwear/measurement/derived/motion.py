"""Velocity and acceleration from measured positions, decimation, and the samples that can be judged.

The rule for the cut-off: :func:`~.spectral_floor.spectral_floor` tells where the signal in each
joint's position ends; the zero-phase low-pass filter (Butterworth, order 4, forward and backward) is set to
twice that frequency, so that it leaves the signal alone. Where the sampling resolves the motion and no sample is
missing, least-squares splines take the place of the filter: see :mod:`jointwear.measurement.derived.smoothing`.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import partial

import numpy as np

from jointwear.measurement.derived.derived_noise import DerivedNoise, quantisation_density
from jointwear.measurement.derived.even_steps import evenly, pieces_of
from jointwear.measurement.derived.filtering import HIGHEST, SAFELY, SHORTEST, derivatives, low_pass, zero_phase_gain
from jointwear.measurement.derived.fitted_motion import FittedMotion, fit_motion
from jointwear.measurement.derived.fused_velocity import fuse, made_of_positions
from jointwear.measurement.derived.jumps import jumps_of, without_jumps
from jointwear.measurement.derived.missing_samples import bridge, curved, few_short, long_gaps, reached
from jointwear.measurement.derived.smoothing import CLEAR_OF_END, END, LONGEST_END, widest_band
from jointwear.measurement.derived.spectral_floor import resting, spectral_floor
from jointwear.measurement.derived.torque_spikes import spikes_of, without_spikes
from jointwear.measurement.derived.velocity_lag import put_in_time
from jointwear.measurement.recording import Recording, elapsed_time

#: Rates above this are decimated [Hz], to about TARGET.
HIGHEST_RATE, TARGET_RATE = 260.0, 100.0
#: Samples below this share of the speed of the axis, and below this speed [rad/s], count as rest.
SLOW_SHARE, SLOW = 0.02, 0.02
#: Share of the samples that are slower than what counts as the speed of an axis.
FAST = 0.95
#: Periods of the cut-off after which the transient of the filter at an end has fallen to a thousandth.
TRANSIENT = 3.0
#: Share of the sampling rate that the spectrum of a resolved motion stays below.
RESOLVED = 0.155
#: Multiple of the end of a motion at which a signal ends that holds more: one step of the encoder at rest, to and fro.
SHAKEN = 2.0
#: Accelerations keep what lies below this [Hz]: friction that jumps at reversals shakes an arm up to there.
LOWEST_CUTOFF = 20.0


@dataclass(frozen=True)
class Measured:
    """Samples ready for the comparison with a model; arrays (m, n) unless stated.

    `usable` marks samples that can be judged: the joint moves, away from filter edges, everything finite.
    `cutoff` (n,) [Hz] of the filter that made the derivatives, NaN where they were given; `fitted` says that splines
    whose band ends there did. `rate` [Hz].
    `speed_floor` (n,) [rad/s] below which a joint counts as at rest. `band` [Hz] above which the torque was filtered
    away, infinite where it was left alone. `reach` (n,) [Hz] up to which the positions hold a signal, where
    accelerations were derived; else None. `noise` is that of the accelerations. `velocity_lag` (n,) [s] by which given
    velocities lagged their positions; they have been put right, or none is used where `velocity_used` is false.
    `jumped` and `spiked` mark the samples as they were recorded, before any rate was changed, whose position or torque
    is none of the arm and was left out; None where nobody asked.
    """

    time: np.ndarray
    trajectory: np.ndarray
    position: np.ndarray
    velocity: np.ndarray
    acceleration: np.ndarray
    torque: np.ndarray
    temperature: np.ndarray
    usable: np.ndarray
    cutoff: np.ndarray
    rate: float
    speed_floor: np.ndarray
    band: float = np.inf
    reach: np.ndarray | None = None
    fitted: bool = False
    noise: DerivedNoise | None = None
    velocity_lag: np.ndarray | None = None
    velocity_used: bool = True
    jumped: np.ndarray | None = None
    spiked: np.ndarray | None = None

    @property
    def passes(self) -> Callable[[np.ndarray], np.ndarray] | None:
        """Frequencies [Hz] (...,) -> share that the filter of the torque lets pass; None where it was left alone."""
        if not np.isfinite(self.band):
            return None
        # The band is half the rate that is left, of a log that was faster.
        return partial(zero_phase_gain, cutoff=self.band, rate=self.noise.rate)

    @property
    def logged_rate(self) -> float:
        """Rate of the log [Hz], before it was reduced."""
        return self.rate if self.noise is None else self.noise.rate

    @property
    def parts(self) -> np.ndarray:
        """Position, velocity, acceleration and torque (m, 4, n); torque that was not measured is zero."""
        return np.stack([self.position, self.velocity, self.acceleration, np.nan_to_num(self.torque)], axis=1)

    def part(self, rows: slice | np.ndarray) -> Measured:
        """Return the samples `rows` alone, with what is known of all; marks of samples as they were recorded stay."""
        names = ("time", "trajectory", "position", "velocity", "acceleration", "torque", "temperature", "usable")
        return replace(self, **{name: getattr(self, name)[rows] for name in names})

    @property
    def vague_ends(self) -> int:
        """Samples at either end of a record whose fitted accelerations are far more uncertain than those inside.

        Of least-squares splines these are 140 times as uncertain at the very end, 10 times at half a spacing of the
        knots, 4 times at one and 1.5 at two: within one spacing of the joint that has the widest.
        """
        known = self.cutoff[np.isfinite(self.cutoff)] if self.fitted else np.zeros(0)
        return math.ceil(0.5 / float(known.min()) * self.rate) if len(known) else 0

    @property
    def derives(self) -> Callable[[int, np.ndarray], np.ndarray] | None:
        """(axis, frequencies [Hz] (...,)) -> share left of a wave in the acceleration; None where that was given."""
        return None if self.noise is None or not np.isfinite(self.noise.band).any() else self.noise.passed


def decimation(rate: float) -> int:
    """Return the number of samples of a log of `rate` [Hz] of which one is kept."""
    return max(1, round(rate / TARGET_RATE)) if rate > HIGHEST_RATE else 1


def measure(recording: Recording) -> Measured:
    """Derive what was not measured, reduce high rates, and mark the samples that can be judged.

    A sample that is missing of one joint makes that joint unusable there. Where more of the motion
    of a joint are missing in a row than are bridged (:mod:`.missing_samples`), no joint is used:
    every torque depends on every position. What is missing is bridged for the filter only; positions that jump away and
    come back are missing (:mod:`.jumps`). Samples that are not evenly spaced are put on an even
    grid first: see :mod:`.even_steps`. Torques that stand far out of all others are missing too
    (:mod:`jointwear.measurement.derived.torque_spikes`).
    """
    raw = _raw(recording)
    velocity_used, rate, factor = raw.velocity is not None, raw.rate, decimation(raw.rate)
    highest = SAFELY * (rate / factor) if factor > 1 else HIGHEST * rate
    densities, floors, orders = _noise_of_signals(raw, recording.encoder_step)
    cutoff, floor = _cutoffs(raw)
    if factor > 1:
        cutoff = np.fmin(np.where(np.isfinite(cutoff), cutoff, np.inf), highest)
    raw, splines = _splined(raw) if factor == 1 else (raw, None)
    if splines is not None:
        cutoff, floor = splines.band if raw.derived else cutoff, splines.noise
        # Nothing of the noise of given velocities is in accelerations that were made without them.
        densities[1:, splines.of_positions] = 0.0
    raw, cutoff, fused = _fused(raw, cutoff, floors, highest)
    fitted = splines is not None
    samples = _stretches(raw, cutoff, factor, fitted)
    speed_floor = _speed_floor(samples.velocity, floor)
    guard = 2 if factor > 1 else 1
    moves = moving(samples.velocity, samples.trajectory, speed_floor, guard)
    band = np.where(np.isfinite(cutoff), cutoff, np.inf)
    return replace(
        samples,
        usable=samples.usable & moves,
        speed_floor=speed_floor,
        reach=raw.reach if raw.derived else None,
        noise=DerivedNoise(densities, orders, band, fitted, rate, fused),
        velocity_lag=raw.velocity_lag,
        velocity_used=velocity_used,
        jumped=raw.jumped,
        spiked=raw.spiked,
    )


@dataclass(frozen=True)
class _Raw:
    """A recording on an even grid, what is missing bridged; arrays (m, n) unless stated.

    `pieces` are its uninterrupted stretches, `rate` [Hz]. `velocity` and `acceleration` are None where they were not
    given; `derived` says that one of them was not. `finite` marks samples whose motion was measured, `felt` those whose
    torque was. `reach` (n,) [Hz] up to which the positions hold a signal, `velocity_lag` (n,) [s] as of
    :class:`Measured`. `spectra` holds, by how often a given signal is to be differentiated, its noise density (n,)
    [unit^2/Hz] and up to where (n,) [Hz] it reaches. `jumped` and `spiked` are those of :class:`Measured`.
    """

    time: np.ndarray
    trajectory: np.ndarray
    pieces: list[slice]
    rate: float
    position: np.ndarray
    velocity: np.ndarray | None
    acceleration: np.ndarray | None
    torque: np.ndarray
    temperature: np.ndarray
    finite: np.ndarray
    felt: np.ndarray
    reach: np.ndarray
    derived: bool
    velocity_lag: np.ndarray | None
    spectra: dict[int, tuple[np.ndarray, np.ndarray]]
    jumped: np.ndarray
    spiked: np.ndarray


def _raw(recording: Recording) -> _Raw:
    """Return a recording on an even grid, its velocities in time with its positions."""
    jumped, spiked = jumps_of(recording), spikes_of(recording)
    recording = without_spikes(without_jumps(recording, jumped), spiked)
    recording, time = evenly(recording, elapsed_time(recording.time, recording.trajectory))
    pieces = pieces_of(time, recording.trajectory)
    step = float(np.median(np.concatenate([np.diff(time[p]) for p in pieces if p.stop - p.start > 1] or [[1.0]])))
    rate = 1.0 / step if step > 0 else 1.0
    temperature = np.full(recording.position.shape, np.nan)
    if recording.temperature is not None:
        given = np.asarray(recording.temperature, dtype=float)
        temperature[:] = given[:, None] if given.ndim == 1 else given
    motion = [x for x in (recording.position, recording.velocity, recording.acceleration) if x is not None]
    finite = np.all([np.isfinite(x) for x in motion], axis=0)
    finite[np.any([long_gaps(x, pieces) for x in motion], axis=0)] = False
    position = bridge(recording.position, pieces)
    velocity = None if recording.velocity is None else bridge(recording.velocity, pieces)
    spectra = {2: _floors_of_positions(position, pieces, rate)}
    reach, lag = spectra[2][1], None
    if velocity is not None:
        velocity, lag = put_in_time(time, pieces, position, velocity, reach, rate)
    if velocity is not None:
        spectra[1] = _floors(velocity, pieces, rate)
    acceleration = None if recording.acceleration is None else bridge(recording.acceleration, pieces)
    if acceleration is not None:
        spectra[0] = _floors(acceleration, pieces, rate)
    return _Raw(
        time=time,
        trajectory=recording.trajectory,
        pieces=pieces,
        rate=rate,
        position=position,
        velocity=velocity,
        acceleration=acceleration,
        torque=bridge(recording.torque, pieces),
        temperature=temperature,
        finite=finite,
        felt=np.isfinite(recording.torque),
        reach=reach,
        derived=velocity is None or acceleration is None,
        velocity_lag=lag,
        spectra=spectra,
        jumped=jumped,
        spiked=spiked,
    )


def _floors(signal: np.ndarray, pieces: list[slice], rate: float) -> tuple[np.ndarray, np.ndarray]:
    """Return :func:`spectral_floor` of every joint of a signal (m, n): noise densities (n,) and ends (n,) [Hz]."""
    density, end = np.array([spectral_floor([x[p] for p in pieces], rate) for x in signal.T]).T
    return density, end


def _floors_of_positions(position: np.ndarray, pieces: list[slice], rate: float) -> tuple[np.ndarray, np.ndarray]:
    """Return :func:`_floors` of positions (m, n), of a joint that is shaken at rest those without its rests."""
    density, end = _floors(position, pieces, rate)
    still = resting(position, pieces)
    rests = np.flatnonzero((still != position).any(axis=0))
    if len(rests):
        apart, motion = _floors(still[:, rests], pieces, rate)
        shaken = end[rests] > SHAKEN * motion
        density[rests[shaken]], end[rests[shaken]] = apart[shaken], motion[shaken]
    return density, end


def _noise_of_signals(raw: _Raw, encoder_step: float | None) -> tuple[np.ndarray, np.ndarray, tuple[int, ...]]:
    """Return the noise of the signals that accelerations come from.

    Returns
    -------
    densities (k, n) [unit^2/Hz] that the acceleration holds, those that the spectra show, and how often each of the k
    signals is differentiated.
    """
    orders = (0,) if raw.acceleration is not None else (2,) if raw.velocity is None else (2, 1)
    floors = np.array([raw.spectra[k][0] for k in orders])
    densities = floors.copy()
    if orders == (2, 1):
        # What a filter hides of the noise of the positions is there all the same.
        same = made_of_positions(raw.time, raw.pieces, raw.position, raw.velocity, floors, raw.rate)
        densities[1][same] = 0.0
    if orders[0] == 2 and encoder_step is not None:
        densities[0] = np.maximum(densities[0], quantisation_density(encoder_step, raw.rate))
    return densities, floors, orders


def _cutoffs(raw: _Raw) -> tuple[np.ndarray, np.ndarray]:
    """Return the cut-off (n,) [Hz] of the filter of every joint, NaN where none is needed, and the noise of its
    velocity (n,) [rad/s]."""
    rate = raw.rate
    density, end = raw.spectra[2 if raw.velocity is None else 1]
    cutoff = np.clip(2.0 * end, LOWEST_CUTOFF, HIGHEST * rate) if raw.derived else np.full(len(end), np.nan)
    limit = np.where(np.isfinite(cutoff), cutoff, 0.5 * rate)
    # Differentiation multiplies the noise density by (2 pi f)^2.
    scale = (2 * np.pi) ** 2 * limit**3 / 3 if raw.velocity is None else limit
    return cutoff, np.sqrt(density * scale)


def _splined(raw: _Raw) -> tuple[_Raw, FittedMotion | None]:
    """Return the recording with the motion of splines, and these; None where they are of no use."""
    # Splines are of use where all is given too: effects depend on what comes after the sign of a velocity.
    missing = ~raw.finite
    if not (np.max(raw.reach, initial=0.0) < RESOLVED * raw.rate and few_short(missing, raw.pieces)):
        return raw, None
    if missing.any():
        position = curved(raw.position, missing, raw.pieces)
        velocity = None if raw.velocity is None else curved(raw.velocity, missing, raw.pieces)
        raw = replace(raw, position=position, velocity=velocity)
    raw = replace(raw, pieces=[p for p in raw.pieces if p.stop - p.start >= SHORTEST])
    if not raw.pieces:
        return raw, None
    found = fit_motion(raw.time, raw.pieces, raw.position, raw.velocity, raw.rate)
    if raw.derived and np.mean(found.band >= widest_band(raw.rate)) > 0.5:
        # One joint may be too coarse or too slow for its encoder. Where most ask for all the knots there are, it is
        # the motion that is not resolved: friction that jumps at the reversal of one joint shakes them all.
        return replace(raw, reach=np.maximum(raw.reach, found.band)), None
    acceleration = found.acceleration if raw.acceleration is None else raw.acceleration
    return replace(raw, position=found.position, velocity=found.velocity, acceleration=acceleration), found


def _fused(raw: _Raw, cutoff: np.ndarray, floors: np.ndarray, highest: float) -> tuple[_Raw, np.ndarray, np.ndarray]:
    """Return the recording with given velocities that know the positions, where accelerations come from them.

    Parameters
    ----------
    cutoff : (n,) [Hz] of the filter. floors : (k, n) of :func:`_noise_of_signals`. highest : cut-off [Hz].

    Returns
    -------
    the recording, the cut-off (n,) [Hz], and of which joints (n,) bool the velocity is that of both signals.
    """
    if raw.velocity is None or raw.acceleration is not None:
        return raw, cutoff, np.zeros(raw.position.shape[1], bool)
    velocity, fused = fuse(raw.time, raw.pieces, raw.position, raw.velocity, floors, raw.rate)
    # What the positions show is in these velocities too, though their own floor may hide where it ends.
    wider = np.clip(2.0 * raw.reach, cutoff, np.maximum(cutoff, highest))
    return replace(raw, velocity=velocity), np.where(fused, wider, cutoff), fused


def _stretches(raw: _Raw, cutoff: np.ndarray, factor: int, fitted: bool) -> Measured:
    """Return all stretches that are long enough, at the rate that is kept; `usable` knows nothing of rest yet."""
    parts = [
        _reduced(raw, p, cutoff, factor, fitted)
        for p in raw.pieces
        if p.stop - p.start >= SHORTEST or not (raw.derived or factor > 1)
    ]
    n, rate = raw.position.shape[1], raw.rate / factor
    empty = np.zeros((0, n))
    nothing = [np.zeros(0), np.zeros(0, int), *([empty] * 5), empty.astype(bool)]
    return Measured(
        *(np.concatenate(group) for group in zip(nothing, *parts, strict=True)),
        cutoff=cutoff,
        rate=rate,
        speed_floor=np.zeros(n),
        band=0.5 * rate if factor > 1 else np.inf,
        fitted=fitted,
    )


def _speed_floor(velocity: np.ndarray, noise: np.ndarray) -> np.ndarray:
    """Return the speed (n,) [rad/s] below which a joint counts as at rest; `noise` (n,) [rad/s] of its velocity."""
    if not len(velocity):
        return noise
    fast = np.quantile(np.abs(velocity), FAST, axis=0)
    # Close to a reversal no friction is a clean step: what happens there must not be taken for a delay.
    slow = np.minimum(SLOW_SHARE * fast, SLOW)
    return np.maximum(np.maximum(5 * noise, slow), 1e-6)


def _reduced(raw: _Raw, p: slice, cutoff: np.ndarray, factor: int, splines: bool) -> list[np.ndarray]:
    """Return one stretch with its derivatives at the rate that is kept.

    Returns
    -------
    time and label (k,), position, velocity, acceleration, torque, temperature, and what is away from gaps and from the
    edges of filters (k, n).
    """
    n, rate = raw.position.shape[1], raw.rate
    t, q, tau = raw.time[p], raw.position[p], raw.torque[p]
    v = None if raw.velocity is None else raw.velocity[p]
    a = None if raw.acceleration is None else raw.acceleration[p]
    if (raw.derived or factor > 1) and not splines:
        q = np.stack([low_pass(q[:, j], cutoff[j], rate, motion=True) for j in range(n)], axis=1)
        first, second = derivatives(t, q)
        if v is None:
            v, a = first, second if a is None else a
        elif a is None:
            filtered = np.stack([low_pass(v[:, j], cutoff[j], rate, motion=True) for j in range(n)], axis=1)
            a = derivatives(t, filtered)[0]
    if factor > 1:
        # Half power at the new Nyquist frequency: an emptier band would be blown up by whitening.
        limit = 0.5 * rate / factor
        tau, v, a = (low_pass(x, limit, rate) for x in (tau, v, a))
    ok = raw.finite[p].copy()
    if raw.derived or factor > 1:
        clear = min(CLEAR_OF_END * 0.5 / min(cutoff[np.isfinite(cutoff)], default=np.inf), LONGEST_END)
        for j in range(n):
            known = cutoff[j] if np.isfinite(cutoff[j]) else SAFELY * rate / factor
            # A band that ends at `known` is that of a spline with knots 1 / (2 known) apart.
            # The torque of a joint is that of the accelerations of all joints.
            reaches = max(END * 0.5 / known, clear) if splines else TRANSIENT / known
            edge = min(int(np.ceil(reaches * rate)) + 1, len(ok) // 4)
            ok[:edge, j] = ok[len(ok) - edge :, j] = False
            # A gap spoils its surroundings as far as the filter reaches.
            if not raw.finite[p][:, j].all():
                ok[:, j] &= ~reached(~raw.finite[p][:, j], edge)
    for j in np.flatnonzero(~raw.felt[p].all(axis=0)):
        # A torque that is missing reaches as far as its filter does; splines and filters of the motion have none of it.
        around = int(np.ceil(TRANSIENT / limit * rate)) if factor > 1 else 0
        ok[:, j] &= ~reached(~raw.felt[p][:, j], around)
    keep = slice(factor // 2, None, factor)
    return [x[keep] for x in (t, raw.trajectory[p], q, v, a, tau, raw.temperature[p], ok)]


def moving(velocity: np.ndarray, trajectory: np.ndarray, floor: np.ndarray, guard: int) -> np.ndarray:
    """Return where each joint moves faster than its floor and does not reverse within `guard` samples."""
    moving = np.abs(velocity) > floor
    sense = np.sign(velocity)
    for shift in range(1, guard + 1):
        turn = (sense[shift:] != sense[:-shift]) & (trajectory[shift:] == trajectory[:-shift])[:, None]
        moving[shift:] &= ~turn
        moving[:-shift] &= ~turn
    return moving
