"""Instruments for effects of timing: columns that do not share the noise of derived accelerations with the residual.

The residual holds -M e, with e the error of a derived acceleration. A column that says how the torque changes when it
is late or filtered is made of the nominal torque, so that it holds L M e with L the (second) derivative. The product
of the two has a mean whatever is missing in the model, on every recording: neither evidence nor recordings left out
see that it is noise. Columns of timing are therefore made of a band-limited nominal torque: below the cut-off the
nominal torque is motion, above it noise. Columns that are made of the torque or the acceleration itself share
their noise with the residual too, which takes a part off every coefficient; they hold far more motion than noise, so
that a far higher cut-off does. Steps of friction stay sharp.
This is the method of instrumental variables (Soderstrom and Stoica 1983; Janot, Vandanjon and Gautier 2014 for robots).
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from jointwear.discovery import assumed
from jointwear.discovery.noise.noise import Whitener
from jointwear.discovery.problem.problem import Problem
from jointwear.effects import State
from jointwear.effects.order import change_by_delay, first_derivative, second_derivative
from jointwear.measurement.derived.derived_noise import DerivedNoise
from jointwear.measurement.derived.filtering import HIGHEST, limit, zero_phase_gain
from jointwear.statistics.runs import runs

#: Evidence [nats] that noise which column and residual share may feign at most: what a parameter gains by chance on
#: average, half of a chi-square of one degree of freedom.
FEIGNED = 0.5
#: Dead time [s] up to which the noise of a late torque is asked for: the longest one that a search starts from.
LATE = 0.02
#: Frequencies at which spectra are compared, cut-offs that are tried, and how far below the highest the lowest is.
FREQUENCIES, CUTOFFS, LOWER = 512, 80, 100
#: Times the samples at one end that a record must have for its ends to be held.
SHORT = 4
#: Ridge of the regression that takes off a column what the base regression explains, as a share of its energy.
RIDGE = 1e-6


@dataclass(frozen=True)
class Cutoffs:
    """Cut-offs [Hz] of the instruments of one axis; infinite where nothing is filtered.

    Attributes
    ----------
    timing, torque : of columns of timing, and of columns of torque itself. swing : of columns of a link that swings,
        which are rates of torque below the swing alone: `assumed.OCTAVE` times as high as of timing.
    structure : of arguments of structure: columns over them may hold noise alone.
    late : of columns of a torque at another time.
    judged : where the noise of derived accelerations becomes most of the residual: errors in N m are compared below.
    """

    timing: float = np.inf
    torque: float = np.inf
    judged: float = np.inf
    structure: float = np.inf
    swing: float = np.inf
    late: float = np.inf


def axis_cutoffs(problem: Problem, axis: int, white: Whitener, with_late: bool = True) -> Cutoffs:
    """Return the cut-offs of the instruments of one axis under a noise model of its residual.

    Parameters
    ----------
    with_late : whether that of a torque at another time is asked, nearly half of the work; else it is that of rates.
    """
    measured = problem.measured
    if measured.noise is None:
        return Cutoffs()
    (frequency, density), rate = derived_noise(problem, axis), measured.rate
    whole = white.density(frequency, rate)
    judged = _judged(density / whole, frequency)
    # Noise that moves the arm is in torques and their rates as that of derived accelerations is.
    shaken = problem.shaken[axis] * whole
    derived, density = density, np.maximum(density, shaken)
    structure = cutoff_of(white, density, frequency, rate, 0)
    torque = _of_torque(problem, axis, white, np.stack([derived, shaken]), structure, frequency)
    # That is asked of all of the torque: sums of columns of motor and links may move far less, with as much noise.
    torque = max(structure, min(torque, float(problem.motion_ends[axis])))
    # What is motion in a column of timing is seen where noise alone could do no harm.
    timing = cutoff_of(white, density, frequency, rate)
    if np.isfinite(timing):
        timing = cutoff_of(white, density, frequency, rate, 2, _motion(problem, axis, white, timing))
    late, share = timing, density / whole
    if with_late:
        late = _late(problem, axis, white, timing, share / max(1.0, float(np.max(share))), frequency)
    return Cutoffs(timing, torque, judged, structure, assumed.OCTAVE * timing, late)


def _of_torque(
    problem: Problem, axis: int, white: Whitener, noise: np.ndarray, structure: float, frequency: np.ndarray
) -> float:
    """Return the cut-off [Hz] of columns of torque, of accelerations and of load.

    Motion and noise of a column are asked of the same inertia. That of a motor behind a high gear moves far more torque
    than a light last link does, and its noise is in the residual and in columns of the torque, but not in the load.

    Parameters
    ----------
    noise : (2, k) density [(N m)^2/Hz] of the noise of derived accelerations and of that which moves the arm.
    structure : cut-off [Hz] below which hardly anything is noise.
    """
    measured, state = problem.measured, limited_state(problem, axis, structure)
    rate, whole = measured.rate, white.density(frequency, measured.rate)
    rigid = state.load[:, axis] + state.drive.armature[axis] * state.acceleration[:, axis]
    energy, weight = (float(np.mean(white(x) ** 2)) for x in (rigid, problem.train_state.load[:, axis]))
    # Motion of the load above the structure cut-off counts as well: what the load moves alone is a lower bound too.
    energy = max(energy, weight)
    own, light = problem.mass_squares[axis, axis], problem.load_squares[axis, axis]
    if problem.shaken[axis]:
        # Of the load most is weight; what noise shares a column with is inertia alone, that of all joints alike.
        motion = np.mean(white(state.acceleration) ** 2, axis=0)
        energy = min(energy, float(problem.mass_squares[axis] @ motion))
        weight = min(weight, float(problem.load_squares[axis] @ motion))
    of_load = torque_noise(measured.noise, problem.load_squares, frequency)[axis]
    every, of_load = np.maximum(*noise), np.maximum(of_load, light / own * noise[1])
    columns = ((np.stack([every, every]), energy), (np.stack([np.sqrt(every * of_load), of_load]), weight))
    return min(_highest(white, shared / whole, frequency, rate, e) for shared, e in columns)


def _late(
    problem: Problem, axis: int, white: Whitener, timing: float, share: np.ndarray, frequency: np.ndarray
) -> float:
    """Return the cut-off [Hz] of columns of late torque, at least `timing`, that of rates of torque.

    A delay d turns noise of frequency w by the angle w d: of what that changes only 1 - cos(w d) lies along the noise
    of the residual, of second order in w d, where a second derivative lies along it altogether. So far higher
    frequencies tell of a delay. A filter takes noise off instead, which gains at every frequency: its columns end where
    rates of torque do.

    Parameters
    ----------
    share : (k,) density of the noise of derived accelerations over that of the residual, at most 1: the residual holds
        all of it, but the floor of positions is motion where friction shakes an arm up to half the rate.
    """
    if not np.isfinite(timing):
        return timing
    rate = problem.measured.rate
    along = 1.0 - np.cos(np.minimum(2 * np.pi * frequency * LATE, np.pi))
    # What is motion is seen where noise does no harm, as for columns of timing.
    limited = limited_state(problem, axis, timing)
    column = white(change_by_delay(limited, axis, LATE))
    energy = _beside_base(problem, axis, white, limited, timing, column)
    end = _highest(white, np.stack([along, 2.0 * along]) * share, frequency, rate, energy)
    return max(timing, min(end, float(problem.motion_ends[axis])))


def _motion(problem: Problem, axis: int, white: Whitener, cutoff: float) -> float:
    """Return the mean square of the whitened second derivative of the load below `cutoff`, without the base part."""
    limited = limited_state(problem, axis, cutoff)
    column = white(second_derivative(limited, limited.load[:, axis]))
    return _beside_base(problem, axis, white, limited, cutoff, column)


def _beside_base(
    problem: Problem, axis: int, white: Whitener, limited: State, cutoff: float, column: np.ndarray
) -> float:
    """Return the mean square of a whitened column (m,) without what the base regression below `cutoff` explains."""
    inertial = limited_inertial(problem, axis, cutoff)[:, problem.felt[axis]]
    base = white(np.concatenate([problem.friction_columns(limited, axis), inertial], axis=1))
    base = base / np.maximum(np.sqrt(np.mean(base**2, axis=0)), 1e-12)
    gram = base.T @ base
    gram += RIDGE * len(base) * np.eye(len(gram))
    return float(np.mean((column - base @ np.linalg.solve(gram, base.T @ column)) ** 2))


def _judged(share: np.ndarray, frequency: np.ndarray) -> float:
    """Return the lowest frequency [Hz] from which the noise of derived accelerations is half of the residual."""
    above = np.flatnonzero(share > 0.5)
    return float(frequency[above[0]]) if len(above) else np.inf


def torque_noise(noise: DerivedNoise, mass_squares: np.ndarray, frequency: np.ndarray) -> np.ndarray:
    """Return the density (n, k) [(N m)^2/Hz] of what the noise of accelerations makes of the nominal torques.

    Parameters
    ----------
    mass_squares : (n, n) mean squares over poses of the derivative of torque j by acceleration k [kg2 m4].
    """
    return mass_squares @ noise.acceleration(frequency)


def cutoff_of(
    white: Whitener, density: np.ndarray, frequency: np.ndarray, rate: float, order: int = 2, energy: float = 0.0
) -> float:
    """Return the cut-off [Hz] of the instruments of one axis, infinite where none is needed.

    Parameters
    ----------
    white : the noise model of the residual of the axis. density : (k,) of :func:`torque_noise` at `frequency` (k,).
    order : how often the torque is derived in the columns. energy : mean square of the whitened columns.

    Columns are filtered with gain h. What noise they share with the residual gains
    N/2 (mean of w h S_a/S_r)^2 / (energy + mean of w^2 h^2 S_a/S_r) nats, w = (2 pi f)^order, S_a the density of the
    noise of the torque and S_r that of the residual. The cut-off is the highest one at which that is :data:`FEIGNED`;
    without `energy` it holds for columns of noise alone.
    """
    power = (2 * np.pi * frequency) ** order
    share = density / white.density(frequency, rate)
    return _highest(white, np.stack([power, power**2]) * share, frequency, rate, energy)


def swing_cutoff(
    white: Whitener,
    density: np.ndarray,
    frequency: np.ndarray,
    rate: float,
    period: float,
    damping: float,
    energy: float,
) -> float:
    """Return the highest cut-off [Hz] of the columns of one swing at which shared noise feigns no evidence for it.

    The torque that a link lacks which swings is G load with G = w^2 / (w0^2 - w^2 + 2i damping w0 w). The nominal
    torque holds noise, the residual the same noise with the other sign: below the swing it speaks against the column,
    above it for it.

    Parameters
    ----------
    density : (k,) of the noise of the nominal torque at `frequency` (k,) [Hz]. period : [s] of the swing.
    energy : mean square of the whitened column where noise does no harm.
    """
    square = (period * frequency) ** 2
    below = (1.0 - square) ** 2 + (2.0 * damping) ** 2 * square
    share = density / white.density(frequency, rate)
    speaks, size = -square * (1.0 - square) / below * share, square**2 / below * share
    for cutoff in np.geomspace(HIGHEST * rate, HIGHEST * rate / LOWER, CUTOFFS):
        gain = zero_phase_gain(frequency, cutoff, rate)
        product, total = max(float(np.mean(speaks * gain)), 0.0), energy + np.mean(size * gain**2)
        if 0.5 * len(white.rows) * product**2 <= FEIGNED * total:
            return float(cutoff) if cutoff < HIGHEST * rate else np.inf
    return float(cutoff)


def derived_noise(problem: Problem, axis: int) -> tuple[np.ndarray, np.ndarray]:
    """Return frequencies (k,) [Hz] and the density (k,) [(N m)^2/Hz] there of what the noise of derived accelerations
    makes of the nominal torque of one axis."""
    measured = problem.measured
    frequency = np.linspace(0.0, 0.5 * measured.rate, FREQUENCIES + 1)[1:]
    return frequency, torque_noise(measured.noise, problem.mass_squares, frequency)[axis]


def nominal_noise(problem: Problem, axis: int, white: Whitener) -> tuple[np.ndarray, np.ndarray]:
    """Return frequencies (k,) [Hz] and density (k,) of the noise of the nominal torque of one axis at them."""
    frequency, density = derived_noise(problem, axis)
    return frequency, np.maximum(density, problem.shaken[axis] * white.density(frequency, problem.measured.rate))


def _highest(white: Whitener, shared: np.ndarray, frequency: np.ndarray, rate: float, energy: float) -> float:
    """Return the highest cut-off [Hz] at which noise feigns no more than :data:`FEIGNED`, infinite for no filter.

    Parameters
    ----------
    white : the noise model of the residual. shared : (2, k) density of the noise in a column that is not filtered over
        that of the residual, at `frequency` (k,) [Hz]: the part along the noise of the residual, and the square of all
        of it. rate : [Hz] of the samples. energy : mean square of the whitened column without noise.
    """
    cutoffs = np.geomspace(HIGHEST * rate, HIGHEST * rate / LOWER, CUTOFFS)
    gain = zero_phase_gain(frequency, cutoffs[:, None], rate)
    product, total = gain @ shared[0] / len(frequency), energy + gain**2 @ shared[1] / len(frequency)
    harmless = (0.5 * len(white.rows) * product**2 <= FEIGNED * total) | (total == 0)
    first = int(np.argmax(harmless)) if harmless.any() else len(cutoffs) - 1
    return np.inf if first == 0 and harmless[0] else float(cutoffs[first])


def limited_state(problem: Problem, axis: int, cutoff: float) -> State:
    """Return the training samples of a problem as :func:`band_limited` leaves them, once for each cut-off."""
    measured, known = problem.measured, problem.limited_states
    if (axis, cutoff) not in known:
        known[axis, cutoff] = band_limited(problem.train_state, axis, cutoff, measured.rate, measured.vague_ends)
    return known[axis, cutoff]


def limited_inertial(problem: Problem, axis: int, cutoff: float) -> np.ndarray:
    """Return the inertial directions (N_train, r) [N m] of one axis, ended at `cutoff` [Hz].

    Those that the axis does not feel are zeros, which no filter changes.
    """
    columns, felt = problem.inertial[:, axis][problem.train], problem.felt[axis]
    if np.isfinite(cutoff):
        columns[:, felt] = ended(problem, columns[:, felt], cutoff)
    return columns


def ended(problem: Problem, columns: np.ndarray, cutoff: float) -> np.ndarray:
    """Return columns (N_train, k) that end at `cutoff` [Hz], :func:`held_at_ends` before."""
    record, measured = np.asarray(problem.train_state.record), problem.measured
    return limit(held_at_ends(columns, record, measured.vague_ends), record, cutoff, measured.rate)


def band_limited(state: State, axis: int, cutoff: float, rate: float, ends: int = 0) -> State:
    """Return the state in which load and torque of `axis` end at `cutoff` [Hz]; Coulomb friction stays.

    So do the accelerations of all joints: another joint's acts on this one where they share a drive.
    Viscous friction ends there too: a velocity is derived as well, and late by a few samples its noise looks like that
    of an acceleration.

    Parameters
    ----------
    ends : samples at either end of a record that are not judged, and that a filter would carry to those that are: they
        keep the value of the one beside them.
    """
    if not np.isfinite(cutoff):
        return state
    level, record = state.drive.coulomb(axis, state.velocity[:, axis]), np.asarray(state.record)
    parts = np.column_stack([state.load[:, axis], state.torque[:, axis] - level, state.acceleration])
    limited = limit(held_at_ends(parts, record, ends), record, cutoff, rate)
    load, acceleration, torque = state.load.copy(), limited[:, 2:], state.torque.copy()
    load[:, axis], torque[:, axis] = limited[:, 0], limited[:, 1] + level
    return replace(state, load=load, torque=torque, acceleration=acceleration)


def held_at_ends(columns: np.ndarray, record: np.ndarray, ends: int) -> np.ndarray:
    """Return columns (m, k) of which the first and last `ends` samples of each record have the value beside them.

    There fitted accelerations are not known, and a filter would carry them to samples that are judged.
    """
    if ends < 1:
        return columns
    held = columns.copy()
    for piece in runs(record):
        if piece.stop - piece.start > SHORT * ends:
            held[piece.start : piece.start + ends] = columns[piece.start + ends]
            held[piece.stop - ends : piece.stop] = columns[piece.stop - ends - 1]
    return held


def velocities(problem: Problem, axis: int, cutoffs: Cutoffs) -> np.ndarray:
    """Return the velocities (N_train, n) [rad/s] of which columns of one axis are made; their signs stay.

    Where noise moves the arm it is in all velocities. Joints that start and stop together have velocities that differ
    by little else, so that columns over several of them hold noise alone.
    """
    state = problem.train_state
    if not problem.shaken[axis]:
        return state.velocity
    limited = limit(state.velocity, np.asarray(state.record), cutoffs.torque, problem.measured.rate)
    return np.where(limited * state.velocity > 0, limited, state.velocity)


def clock_of(problem: Problem, axis: int, cutoffs: Cutoffs) -> np.ndarray:
    """Return what sampling the torque of one axis late by `assumed.CLOCK` changes, (N_train, 1) [N m]."""
    limited = limited_state(problem, axis, cutoffs.timing)
    smooth = limited.torque[:, axis] - limited.drive.coulomb(axis, limited.velocity[:, axis])
    # Torque and position are sampled in one period of the log, however many of its samples are kept.
    return assumed.CLOCK / problem.measured.logged_rate * first_derivative(limited, smooth)[:, None]
