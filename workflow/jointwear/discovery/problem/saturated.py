"""The noise of every axis, from a fit that holds more than any model of the robot does."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from jointwear.discovery import assumed
from jointwear.discovery.noise.noise import (
    HIGHEST_ORDER,
    ORDER_BESIDE_GAPS,
    WIDE,
    Whitener,
    coloured,
    estimate,
    highest_order,
    order_in_runs,
    whitenable,
)
from jointwear.discovery.noise.noise_spectrum import corrected, without_slow_torque
from jointwear.discovery.noise.ridge_fit import RidgeFit
from jointwear.discovery.problem.instruments import (
    FREQUENCIES,
    Cutoffs,
    axis_cutoffs,
    derived_noise,
    limited_inertial,
    limited_state,
    velocities,
)
from jointwear.discovery.problem.motor_lines import loud_waves, shown_waves, waves_in_band
from jointwear.discovery.problem.problem import Problem
from jointwear.discovery.problem.time_lines import loud_lines
from jointwear.discovery.structure import axis_bases
from jointwear.effects import State, library
from jointwear.measurement.derived.filtering import limit

#: Share of a column, by its square, that has to lie on samples whose predecessors are usable too.
SEEN = 0.5
#: Highest order of the noise model that the correction starts from: a higher one learns what the fit took off.
START = 2
#: Samples for each column of the fit from which it may hold still more columns: what Harrell (Regression Modeling
#: Strategies, 2015, section 4.4) asks for on average.
FEWEST_EACH = 15
#: Least noise of a torque over its RMS: below it, as in a simulated log, what is left is round-off of the fit.
LEAST_NOISE = 1e-6
#: Drawings of the noise by which it is asked what share of it the fit takes off.
DRAWN = 2
#: Times a density from which another is another one, where noise models of two orders are compared, and times the noise
#: of a fit from which that of one with fewer columns holds motion.
TWICE = 2.0
#: Frequencies [Hz] above which a step at a reversal is kept.
SHARP = (4.0, 6.0, 9.0)


def estimate_noise(problem: Problem) -> list[Whitener | None]:
    """Estimate the colour of the noise of every judged axis from a saturated fit."""
    result: list[Whitener | None] = [None] * problem.robot.joints
    for axis in problem.judged:
        result[axis] = axis_noise(problem, axis)
    label, rate = problem.measured.trajectory[problem.train], problem.measured.rate
    return without_slow_torque(result, problem.usable, label, rate)


def axis_noise(problem: Problem, axis: int, extra: np.ndarray | None = None) -> Whitener:
    """Estimate the colour of the noise of one axis from a saturated fit.

    The fit holds the base regression, the coarse structure bases and `extra` columns (N_train, k), so that
    what is left is noise whether or not an effect is hidden. It is done again with whitened columns and, where the
    noise of derived accelerations would let columns take a part of the noise for signal, with instruments.

    Of a log of few samples a second runs between reversals are short, and a fit of columns that are seen behind
    :data:`HIGHEST_ORDER` predecessors holds hardly any: a spring of 50 N m had left a noise of 8. Where one of columns
    that fewer predecessors show leaves less than half of the noise, it is this one that tells it.
    """
    order = order_in_runs(problem.usable[:, axis], problem.measured.trajectory[problem.train])
    plain = _noise_behind(problem, axis, extra, HIGHEST_ORDER)
    if order in (None, HIGHEST_ORDER):
        return plain
    fuller = _noise_behind(problem, axis, extra, order)
    holds_more = TWICE * noise_level(problem, axis, fuller) < noise_level(problem, axis, plain)
    return fuller if holds_more else plain


def _noise_behind(problem: Problem, axis: int, extra: np.ndarray | None, order: int) -> Whitener:
    """Return :func:`axis_noise` of a fit of columns that are seen behind `order` predecessors."""
    used, label = problem.usable[:, axis], problem.measured.trajectory[problem.train]
    y = problem.discrepancy[problem.train, axis]

    def fitted(columns: np.ndarray, highest: int) -> tuple[RidgeFit, np.ndarray, Whitener]:
        """Return the fit of columns, what it leaves, and the noise model of that."""
        plain = RidgeFit(columns, used, None)
        left = plain(y)
        return plain, left, estimate(left, used, label, highest)

    columns, rounding = _columns(problem, axis, extra, Cutoffs(), order)
    plain, left, white = fitted(columns, HIGHEST_ORDER)
    cutoffs = axis_cutoffs(problem, axis, white, with_late=False)
    highest = HIGHEST_ORDER
    if cutoffs != Cutoffs():
        highest = ORDER_BESIDE_GAPS
        # Columns that share the noise have taken a part of it: what they left says too little.
        columns, rounding = _columns(problem, axis, extra, cutoffs, order)
        plain, left, white = fitted(columns, highest)
    further = _further_columns(limited_state(problem, axis, cutoffs.timing), axis)
    further = loud_waves(problem, axis, further, white, plain, left, highest)
    if further.shape[1]:
        columns = np.concatenate([columns.T, _scaled(further, used).T]).T
        plain, left, white = fitted(columns, highest)
    of_motor = waves_in_band(problem, axis, limited_state(problem, axis, cutoffs.torque))
    loud = loud_waves(problem, axis, of_motor, white, plain, left, highest)
    if not loud.shape[1]:
        # At a constant speed a wave of the motor is a line over time too.
        loud = loud_lines(problem, axis, white, plain, left, highest)
    if loud.shape[1]:
        columns = np.concatenate([columns.T, _scaled(loud, used).T]).T
        *_, white = fitted(columns, highest)
    take_off = RidgeFit(columns, used, white)
    waves = shown_waves(problem, axis, of_motor, white, take_off)
    if waves.shape[1]:
        columns = np.concatenate([columns.T, _scaled(waves, used).T]).T
        white = estimate(RidgeFit(columns, used, white)(y), used, label, highest)
        take_off = RidgeFit(columns, used, white)
    left = take_off(y)
    white = _corrected(problem, left, take_off, used, label, highest)
    torque = problem.measured.torque[problem.train, axis][used]
    sigma = max(white.sigma, LEAST_NOISE * float(np.sqrt(np.mean(torque**2))))
    # What derivatives round off or add is no model of the arm: it is left in any prediction.
    derived = left + take_off.part(y, rounding)
    return replace(white, sigma=sigma, spread=_spread(problem, white, derived[used], take_off, used))


def _corrected(
    problem: Problem, left: np.ndarray, take_off: RidgeFit, used: np.ndarray, label: np.ndarray, highest: int
) -> Whitener:
    """Return the noise model of what a fit `left` (N,), put right for what it took off.

    Where the noise of derived accelerations is in it a higher order may tell more of what is slow. One that tells
    another density elsewhere has learnt the gaps between the lines of something that shakes the arm.
    """
    rate = problem.measured.rate
    start = estimate(left, used, label, START)

    def model(order: int) -> Whitener:
        return corrected(start, left, take_off, used, label, rate, order, problem.noise_drives)

    if highest <= HIGHEST_ORDER:
        return model(highest)
    long = model(highest_order(used, label))
    if len(long.lags) <= highest:
        return long
    short, frequency = model(highest), np.linspace(assumed.slow(), 0.5 * rate, FREQUENCIES)
    apart = np.abs(np.log(long.density(frequency, rate) / short.density(frequency, rate)))
    return long if np.max(apart) < np.log(TWICE) else short


def _spread(problem: Problem, white: Whitener, left: np.ndarray, take_off: RidgeFit, used: np.ndarray) -> float:
    """Return the standard deviation of the noise [N m] by what a fit `left` (m,) and takes off noise of the model."""
    drive = [piece[:, :DRAWN] for piece in problem.noise_drives(len(white.lags))]
    noise = coloured(white, drive)
    kept = np.mean(take_off(noise)[used] ** 2) / np.mean(noise[used] ** 2)
    return float(np.sqrt(np.mean(left**2) / kept))


def noise_level(problem: Problem, axis: int, white: Whitener) -> float:
    """Return the standard deviation of the noise of the torque of one axis [N m], that of derived accelerations too.

    A noise model knows little of the latter: the fit behind it takes off what derivatives round, and with it their
    noise. What it leaves without that holds whatever else it does not know too, so that it counts as far as the model
    and the known noise of the accelerations explain it.
    """
    if problem.measured.noise is None or not np.isfinite(white.spread):
        return white.marginal
    derived = float(np.mean(derived_noise(problem, axis)[1])) * 0.5 * problem.measured.rate
    return max(white.marginal, min(white.spread, float(np.hypot(white.marginal, np.sqrt(derived)))))


def _columns(
    problem: Problem, axis: int, extra: np.ndarray | None, cutoffs: Cutoffs, order: int
) -> tuple[np.ndarray, int]:
    """Return the columns (N_train, k) of the saturated fit of one axis, each of unit RMS, and how many of them, from
    the first, are what derivatives round off.

    Parameters
    ----------
    order : predecessors that a sample needs for the whitened fit to see it.
    """
    used, label = problem.usable[:, axis], problem.measured.trajectory[problem.train]
    rate, raw = problem.measured.rate, problem.train_state
    state = limited_state(problem, axis, cutoffs.torque)
    inertial = limited_inertial(problem, axis, cutoffs.torque)
    speeds = velocities(problem, axis, cutoffs)
    rounding = problem.rounding(axis)
    groups = [rounding, problem.friction_columns(state, axis, speeds), inertial]
    if extra is not None:
        groups.append(extra)
    groups += [b.columns for b in axis_bases(state, axis, used, coarse=True, velocity=speeds)]
    if used.sum() >= FEWEST_EACH * sum(g.shape[1] for g in groups):
        groups += _sequential_columns(limited_state(problem, axis, cutoffs.timing), axis)
        groups.append(_beside_reversals(raw, axis, label, rate))
        groups += _columns_of_neighbours(replace(state, velocity=speeds), axis)
    # Each column in one piece: they are whitened one by one.
    series = np.concatenate([g.T for g in groups])
    whole = np.zeros((2, len(used)))
    whole[0, used] = 1.0
    # A column that lives beside reversals, on samples without predecessors, is hardly seen by the whitened fit.
    whole[1, whitenable(used, label, order)] = 1.0
    # A few at a time: squares of all columns take as much memory as they do.
    squares = [whole @ (series[first : first + WIDE] ** 2).T for first in range(0, len(series), WIDE)]
    held, seen = np.concatenate(squares, axis=1)
    scale = np.sqrt(held / used.sum())
    keep = (scale > 1e-9) & (seen > SEEN * scale**2 * used.sum())
    if not keep.all():
        series, scale = series[keep], scale[keep]
    series /= scale[:, None]
    return series.T, int(keep[: rounding.shape[1]].sum())


def _scaled(columns: np.ndarray, used: np.ndarray) -> np.ndarray:
    """Return columns (N, k) of unit RMS over the samples that are used."""
    return columns / np.maximum(np.sqrt(np.mean(columns[used] ** 2, axis=0)), 1e-12)


def _beside_reversals(state: State, axis: int, label: np.ndarray, rate: float) -> np.ndarray:
    """Return what is sharp in the sign of the velocity, (N, 3): misfits beside reversals are not noise."""

    def sharp() -> np.ndarray:
        sense = state.direction[:, [axis]]
        return np.concatenate([sense - limit(sense, label, frequency, rate) for frequency in SHARP], axis=1)

    return state.of_motion(("sharp", axis, rate), sharp, state.velocity, state.record)


def _sequential_columns(state: State, axis: int) -> list[np.ndarray]:
    """Return the columns of effects that depend on the order of samples: no basis over an argument follows them."""
    return [
        effect.columns(state, axis, None, nonlinear)
        for effect in library().values()
        if effect.identifiable and effect.sequential
        for nonlinear in effect.grid(state, axis)
    ]


def _further_columns(state: State, axis: int) -> list[np.ndarray]:
    """Return the columns of forms that no point of a grid is like: they are held where they are loud."""
    return [
        effect.columns(state, axis, None, nonlinear)
        for effect in library().values()
        if not effect.unmet(state, axis)
        for nonlinear in effect.further(state, axis)
    ]


def _columns_of_neighbours(state: State, axis: int) -> list[np.ndarray]:
    """Return the columns of effects that turn with this axis and the next: what jumps with both follows no basis."""
    joints = state.position.shape[1]
    return [
        effect.columns(state, axis, source, nonlinear)
        for effect in library().values()
        if effect.needs_source
        for source in (axis - 1, axis + 1)
        if 0 <= source < joints
        for nonlinear in effect.grid(state, axis)
        if all(nonlinear.values())
    ]
