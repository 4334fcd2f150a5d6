"""Coulomb friction that builds up with the speed of its joint instead of turning over with its sign.

Simulators round the sign of the velocity: by a tanh or an arctan, or in proportion to speed as MuJoCo's friction loss
does where its reference is soft for the inertia of a joint. The step that a robot file has is wrong there, and that
looks like a Stribeck curve, a bristle, or viscous friction with an exponent near zero, of which none is there. Where
rounding tells what a step and a curve of the friction do not, the torque is put right: it gets what the friction lacks.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from scipy.linalg import qr
from scipy.optimize import minimize_scalar
from scipy.stats import chi2

from jointwear.effects.tables import hats, knots_of
from jointwear.measurement.derived.motion import Measured

IN_PROPORTION = "in proportion to speed"
#: How friction builds up over speed in units of its own: the form by its word, and the speeds [rad/s] that are tried.
FORMS: dict[str, tuple[Callable[[np.ndarray], np.ndarray], np.ndarray]] = {
    IN_PROPORTION: (lambda x: np.minimum(x, 1.0), np.geomspace(0.01, 0.8, 12)),
    "as a tanh": (np.tanh, np.geomspace(0.005, 0.5, 12)),
    "as an arctan": (lambda x: np.arctan(x) * 2.0 / np.pi, np.geomspace(0.001, 0.2, 12)),
}
#: Exponents of curved friction, and speeds [rad/s] and exponents of Stribeck's, that a rounded sign has to beat.
EXPONENTS = (0.3, 0.45, 0.6, 0.75, 1.4, 2.0, 3.0)
STRIBECK = [(float(v), d) for v in np.geomspace(0.025, 0.4, 8) for d in (1.0, 2.0)]
#: Samples of an axis that the fit is made of, at most, and fewest for each of its columns.
SAMPLES, FEWEST_EACH = 6000, 5
#: Share of its level that friction lacks at least where a joint is slow.
LEFT = 0.1
#: Share of the square of fast samples below which slow ones are quieter: half.
QUIET = 0.5
#: Knots over the position of an axis.
KNOTS = 8
#: Parts of the records, at most, whose friction may have another level.
PARTS = 8
#: Share to which a speed is searched.
CLOSE = 0.01
#: Part of the longest direction of the other columns below which one says nothing of its own.
LEAST = 1e-6


@dataclass(frozen=True)
class BuiltUp:
    """How the friction of one axis builds up.

    Attributes
    ----------
    form : a key of :data:`FORMS`. speed : its own unit of speed [rad/s].
    positive, negative : Coulomb friction in either direction of motion [N m], negative is below 0.
    noise : standard deviation of what the fit leaves [N m].
    excess : friction of a slow joint above Coulomb friction, which builds up as well [N m].
    """

    form: str
    speed: float
    positive: float
    negative: float
    noise: float
    excess: float = 0.0

    def lacking(self, velocity: np.ndarray) -> np.ndarray:
        """Return what friction at velocities (...,) [rad/s] lacks of its whole level, in the sense of it [N m]."""
        return np.where(velocity > 0, self.positive, self.negative) * self._left(velocity)

    def slow(self, velocity: np.ndarray) -> np.ndarray:
        """Return at which velocities (...,) less than nine tenths of it are there: an arctan ends nowhere."""
        return self._left(velocity) > LEFT

    def unsure(self, velocity: np.ndarray, share: float) -> np.ndarray:
        """Return at which slow velocities (...,) it is not known to within the noise, if `share` of it is not."""
        error = np.abs(self.lacking(velocity)) * share + self.excess * self._left(velocity)
        return (error > self.noise) & self.slow(velocity)

    def _left(self, velocity: np.ndarray) -> np.ndarray:
        return 1.0 - FORMS[self.form][0](np.abs(velocity) / self.speed)


def built_up_friction(
    usable: np.ndarray,
    velocity: np.ndarray,
    acceleration: np.ndarray,
    missing: np.ndarray,
    beside: np.ndarray,
    level: np.ndarray,
    least: float,
    form_error: float,
) -> list[BuiltUp | None]:
    """Return how the friction of each axis builds up, None of one whose friction turns over with the velocity.

    Rounding has to explain more than a step does, by `least` nats both while a joint speeds up and while it slows down
    (a bristle, play or a delay are in one of these only), more by as much than any curve that brakes the joint beside a
    step, and no less than one that does not. One formula makes the friction of a simulated arm: what one axis shows so
    is asked of the others, where it has to explain by `least` more than a step in all, and no less than a curve that
    brakes. Where most axes show one it is asked with any curve beside it and beside a step, and the form of most of
    them is asked of an axis with another one, where it may explain less by twice `form_error`.

    Parameters
    ----------
    usable : (N, n) samples of each axis to look at. velocity, acceleration : (N, n) [rad/s], [rad/s2].
    missing : (N, n) measured less nominal torque [N m].
    beside : (N, n, r) what else an axis may lack, as torque of errors of the inertia [N m].
    level : (N, n) Coulomb friction in the nominal torque [N m]. least : evidence [nat].
    form_error : share of what it explains by which a form may be off.
    """
    axes = [_axis(axis, usable, velocity, acceleration, missing + level, beside) for axis in range(usable.shape[1])]
    found = [None if axis is None else axis.rounded(least) for axis in axes]
    shown = [(f.form, f.speed) for f in found if f is not None]
    if not shown:
        return found
    found = [
        axis.rounded_alike(shown, least) if own is None and axis is not None else own
        for own, axis in zip(found, axes, strict=True)
    ]
    if 2 * sum(f is not None for f in found) <= len(axes):
        return found
    most = max(FORMS, key=lambda form: sum(form == other for other, _ in shown))
    usual = [pair for pair in shown if pair[0] == most]
    return [
        own
        if axis is None or (own is not None and own.form == most)
        else axis.rounded_as_usual(own, usual, least, form_error)
        for own, axis in zip(found, axes, strict=True)
    ]


def built_up_anywhere(
    usable: np.ndarray,
    record: np.ndarray,
    position: np.ndarray,
    velocity: np.ndarray,
    acceleration: np.ndarray,
    missing: np.ndarray,
    inertial: np.ndarray,
    level: np.ndarray,
    least: float,
    form_error: float,
    pulls: Callable[[], np.ndarray],
) -> list[BuiltUp | None]:
    """Return what :func:`built_up_friction` does, of axes that show it beside any torque over their position and
    gravity from another direction too, and beside friction of another level in each record.

    A spring that a file lacks, or a base that leans, beside moves that are slow in few places, looks like friction that
    builds up. So does friction that differs from record to record, of which one is slower than another.

    Parameters
    ----------
    record : (N,) label of the record of each sample. position : (N, n) [rad]. pulls : derivative (N, n, 3) of the
        torques by gravity [kg m], asked where an axis shows it. The others are those of :func:`built_up_friction`.
    """

    def found(beside: np.ndarray) -> list[BuiltUp | None]:
        return built_up_friction(usable, velocity, acceleration, missing, beside, level, least, form_error)

    alone = found(inertial)
    if not any(alone):
        return alone
    over_position = np.concatenate([inertial, _over_position(usable, position)], axis=-1)
    gates = [found(np.concatenate([over_position, pulls()], axis=-1))]
    levels = records_apart(usable, record, velocity)
    if levels.shape[-1]:
        gates.append(found(np.concatenate([inertial, levels], axis=-1)))
    shown = [all(own) for own in zip(alone, *gates, strict=True)]
    return [own if there else None for own, there in zip(found(over_position), shown, strict=True)]


def records_apart(usable: np.ndarray, record: np.ndarray, velocity: np.ndarray) -> np.ndarray:
    """Return columns (N, n, k) of by how much friction of each axis differs in all records but the first with samples
    that are `usable` (N, n); of many records, of :data:`PARTS` of them that follow each other."""
    labels, first = np.unique(record[usable.any(axis=1)], return_index=True)
    parts = np.array_split(labels[np.argsort(first)], min(len(labels), PARTS))
    columns = np.zeros((*velocity.shape, max(len(parts) - 1, 0)))
    for k, part in enumerate(parts[1:]):
        columns[..., k] = np.sign(velocity) * np.isin(record, part)[:, None]
    return columns


def _over_position(usable: np.ndarray, position: np.ndarray) -> np.ndarray:
    """Return columns (N, n, k) over the position (N, n) of each axis, with knots where it is `usable` (N, n)."""
    columns = np.zeros((*position.shape, KNOTS))
    for axis in range(position.shape[1]):
        if usable[:, axis].any():
            own = hats(position[:, axis], knots_of(position[usable[:, axis], axis], KNOTS))
            columns[:, axis, : own.shape[1]] = own
    return columns


def _axis(
    axis: int,
    usable: np.ndarray,
    velocity: np.ndarray,
    acceleration: np.ndarray,
    torque: np.ndarray,
    what_else: np.ndarray,
) -> _Axis | None:
    """Return the samples of one axis without all that is no Coulomb friction, None where they are too few."""
    rows = np.flatnonzero(usable[:, axis])
    rows = rows[:: max(1, -(-len(rows) // SAMPLES))]
    v = velocity[rows, axis]
    beside = [v, acceleration[rows, axis], what_else[rows, axis]]
    for other in (axis - 1, axis + 1):
        if 0 <= other < usable.shape[1]:
            # A neighbour may share the drive.
            o = velocity[rows, other]
            beside += [np.sign(v + o), np.sign(v - o), o]
    columns = np.column_stack(beside)
    if len(rows) < FEWEST_EACH * columns.shape[1]:
        return None
    scale = np.sqrt(np.mean(columns**2, axis=0))
    q, r, _ = qr(columns[:, scale > 0] / scale[scale > 0], mode="economic", pivoting=True)
    size = np.abs(np.diag(r))
    q = q[:, size > LEAST * size[0]]
    y = torque[rows, axis]
    return _Axis(v, acceleration[rows, axis], q, y - q @ (q.T @ y))


@dataclass(frozen=True)
class _Axis:
    """Samples of one axis: velocity and acceleration (N,), an orthonormal basis (N, k) of what is no Coulomb friction,
    and the torque (N,) without that."""

    velocity: np.ndarray
    acceleration: np.ndarray
    beside: np.ndarray
    torque: np.ndarray

    def rounded(self, least: float) -> BuiltUp | None:
        """Return the form and speed that fit best, if they explain enough."""
        tried = {form: [self._square(form, float(unit)) for unit in units] for form, (_, units) in FORMS.items()}
        if min(map(min, tried.values())) >= np.sum(self._step**2):
            return None
        # Each form between the speeds of its grid: at an end of it there is no speed, but another form or none.
        _, form, speed = min(self._searched(form, squares) for form, squares in tried.items())
        units = FORMS[form][1]
        if not units[0] * (1.0 + 2.0 * CLOSE) < speed < units[-1] / (1.0 + 2.0 * CLOSE):
            return None
        found, left = self._built_up(form, speed)
        if found is None or min(self._over_step(left, found)) < least or self._quiet(left, found, least):
            return None
        braking, any_curve = self._over_curves(left, found)
        return found if braking >= least and any_curve > 0 else None

    def rounded_alike(self, shown: Sequence[tuple[str, float]], least: float) -> BuiltUp | None:
        """Return the best of the forms and speeds that other axes show, if it explains enough."""
        found, left = self._built_up(*min(shown, key=lambda pair: self._square(*pair)))
        if found is None:
            return None
        gained = self._over_step(left, found)
        return found if sum(gained) >= least and min(gained) >= 0 and self._over_curves(left, found)[0] >= 0 else None

    def rounded_as_usual(
        self, own: BuiltUp | None, usual: Sequence[tuple[str, float]], least: float, form_error: float
    ) -> BuiltUp | None:
        """Return the best of the forms and speeds that most axes show, if it explains enough beside any curve.

        That is `least` more than a step does beside any curve, and nearly as much as the `own` form of the axis: to
        within two standard deviations of a form.
        """
        form, unit = min(usual, key=lambda pair: self._square(*pair))
        found, _ = self._built_up(form, unit)
        if found is None:
            return own
        square, excess, _ = self._beside_curves(self._rounded_senses(form, unit))
        step, *_ = self._step_beside_curves
        noise = float(np.sqrt(square / len(self.torque)))
        if step - square < 2.0 * least * noise**2:
            return own
        if own is not None:
            best, *_ = self._beside_curves(self._rounded_senses(own.form, own.speed))
            if square - best > 2.0 * form_error * (step - best):
                return own
        return replace(found, noise=noise, excess=excess)

    @cached_property
    def _step_beside_curves(self) -> tuple[float, float, float]:
        return self._beside_curves(self._senses)

    def _beside_curves(self, senses: np.ndarray) -> tuple[float, float, float]:
        """Return the least square that (N, 2) friction of either sense leaves beside none or a curve that brakes, the
        excess of that curve at rest [N m], and the least square beside any curve."""
        least = float(np.sum(self._fit(senses)[0] ** 2))
        braking = least, 0.0
        rounding = np.sign(self.velocity) * senses.sum(axis=1)
        for curve, at_rest in self._curves():
            rest, (positive, negative, size) = self._fit(senses, rounding * curve)
            square = float(np.sum(rest**2))
            least = min(least, square)
            if positive >= 0 >= negative and size >= 0:
                braking = min(braking, (square, float(at_rest * size)))
        return *braking, least

    def _searched(self, form: str, squares: Sequence[float]) -> tuple[float, str, float]:
        """Return the least square that a form leaves, the form, and the speed [rad/s] at which it does, near the least
        of the `squares` at the speeds of its grid."""
        units = FORMS[form][1]
        nearest = int(np.argmin(squares))
        around = np.log(units[[max(nearest - 1, 0), min(nearest + 1, len(units) - 1)]])
        search = minimize_scalar(
            lambda x: self._square(form, float(np.exp(x))),
            bounds=tuple(around),
            method="bounded",
            options={"xatol": CLOSE},
        )
        return float(search.fun), form, float(np.exp(search.x))

    def _built_up(self, form: str, unit: float) -> tuple[BuiltUp | None, np.ndarray]:
        """Return friction of a form, None where it is none in one direction, and what it leaves of the torque (N,)."""
        left, (positive, negative) = self._rounded(form, unit)
        if positive <= 0 or negative >= 0:
            return None, left
        noise = float(np.sqrt(np.mean(left**2)))
        return BuiltUp(form, unit, float(positive), float(negative), noise), left

    def _over_step(self, left: np.ndarray, found: BuiltUp) -> list[float]:
        """Return the nats that a rounded sign gains over a step while the joint speeds up, and while it slows down."""
        up = self.velocity * self.acceleration > 0
        gained = (self._step**2 - left**2) / (2.0 * found.noise**2)
        return [float(np.sum(gained[half])) for half in (up, ~up)]

    def _quiet(self, left: np.ndarray, found: BuiltUp, least: float) -> bool:
        """Return whether slow samples have less than half of the square that is left of fast ones, and not by chance.

        Noise is the same at any speed. Something else is missing then, where the joint is fast, and the slow samples
        are bent to it.
        """
        slow = found.slow(self.velocity)
        share = float(np.mean(left[slow] ** 2) / np.mean(left[~slow] ** 2)) if slow.any() and not slow.all() else 1.0
        many = int(np.sum(slow))
        return share < QUIET and bool(chi2.logcdf(share * many, many) < -least)

    def _over_curves(self, left: np.ndarray, found: BuiltUp) -> tuple[float, float]:
        """Return the nats that a rounded sign gains over the best curve of the friction beside a step.

        They come twice: over curves that brake the joint beside a step that does, and over any. One that takes friction
        back beside a step that is too large rounds the sign in a form of its own.
        """
        braking, _, least = self._step_beside_curves
        own = float(np.sum(left**2))
        return (braking - own) / (2.0 * found.noise**2), (least - own) / (2.0 * found.noise**2)

    def _curves(self) -> list[tuple[np.ndarray, bool]]:
        """Return curves (N,) of the friction over the speed, each with whether it is all there at rest."""
        speed = np.abs(self.velocity)
        curves = [(speed**p, False) for p in EXPONENTS]
        return curves + [(np.exp(-((speed / w) ** d)), True) for w, d in STRIBECK]

    @cached_property
    def _senses(self) -> np.ndarray:
        """(N, 2) ones where the joint turns forward, and where backward."""
        return np.column_stack([self.velocity > 0, self.velocity < 0]).astype(float)

    @cached_property
    def _step(self) -> np.ndarray:
        """(N,) what friction that turns over with the velocity leaves of the torque."""
        return self._fit(self._senses)[0]

    def _square(self, form: str, unit: float) -> float:
        return float(np.sum(self._rounded(form, unit)[0] ** 2))

    def _rounded_senses(self, form: str, unit: float) -> np.ndarray:
        return self._senses * FORMS[form][0](np.abs(self.velocity) / unit)[:, None]

    def _rounded(self, form: str, unit: float) -> tuple[np.ndarray, np.ndarray]:
        return self._fit(self._rounded_senses(form, unit))

    def _fit(self, *friction: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Return what columns of friction leave of the torque, (N,), and their coefficients."""
        x = np.column_stack(friction)
        x -= self.beside @ (self.beside.T @ x)
        theta = np.linalg.lstsq(x, self.torque, rcond=None)[0]
        return self.torque - x @ theta, theta


def with_whole_friction(measured: Measured, built_up: Sequence[BuiltUp | None], share: float) -> Measured:
    """Return samples with the torque of whole friction, without those where `share` of what was added counts.

    Friction may be off by as much: it follows load, position or temperature, and the one level that was added does not.
    """
    torque, usable = measured.torque.copy(), measured.usable.copy()
    for axis, found in enumerate(built_up):
        if found is not None:
            v = measured.velocity[:, axis]
            torque[:, axis] += found.lacking(v)
            usable[:, axis] &= ~found.unsure(v, share)
    return replace(measured, torque=torque, usable=usable)
