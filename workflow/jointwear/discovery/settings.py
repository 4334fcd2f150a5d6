"""What decides a verdict: the one record of every limit, each with its meaning."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

#: Fields that the user gives, and limits of what is reported beside a verdict; the others decide it.
USERS = ("inertial_prior", "groups")
REPORTED = (
    "near_the_floor",
    "judged_speed",
    "visible",
    "parameter_error",
    "filter_error",
    "peak_error",
    "reversal_error",
)


@dataclass(frozen=True)
class Settings:
    """Limits of discovery. Those without a source were chosen on choosing cases; none is a limit of a score.

    Attributes
    ----------
    inertial_prior : relative standard deviation of the nominal inertial parameters; the user's.
    usual : share of the friction of its axis that an effect is usually worth, and share of the effect that a bend of
        its form is: the width of every prior of theirs; and share by which the mass of a link or the inertia of a motor
        is off where it is. An order of magnitude: evidence hardly asks for more. Families of effects that are further
        behind the best are not ranked again with forms that bend.
    most_on_axis : no more effects than this are named on one axis. Axes do not share places: what one lacks must not
        keep another from being asked.
    accept : evidence [nats], after the price of complexity and of searching, that an effect needs, and a parameter of
        the model to be called wrong. "Very strong" in the scale of Kass and Raftery (1995) starts at 5. By as much
        structure without a name has to explain more in the place of a name that is taken back for it. Half of it is
        enough for what only has to hold beside what has been found: a name beside the others or with inertial
        parameters known less, a bend of a form, a form that is less plain, a parameter set free, an effect without the
        block of time that gives most of it. As many nats an effect may cost one record left out: it belongs to the
        robot, not to a recording.
    certainty : probability that an effect lowers the squared error [N m] on records left out, paired by blocks.
    smallest_share : below this an effect does not matter to a simulation: the drop of the mean squared error on records
        left out, over the noise variance of the axis, and the RMS torque of anything, named or not, over that of its
        axis, to which any rigid-body model with its clock and its kinematics is exact. Of a torque constant only what
        friction and motor inertia cannot take over counts.
    form_error : relative standard deviation of the torque of a named effect, in each record and over position, speed
        and direction, because no form is known exactly (its square is the share of the nats of an effect that this
        costs); and the share of the nats of an effect that it may cost one record, and that must show as nats gained on
        records left out, of at least `accept` and up to twice as many nats as `accept`.
    parameter_error : relative standard deviation of a stated parameter beside that of the fit: sample times, kinematics
        and forms are never exact.
    filter_error : the same of the share of a fast wave that filters take: how much of it is in the acceleration, and
        how much in the torque, is up to the controller.
    peak_error : relative standard deviation of the largest torque of an effect: curves for the same physics that fit
        alike differ by this much where they are highest.
    reversal_error : how much higher, as the scale of a half-normal logarithm, that torque may be for effects that act
        after reversals than the samples show that can be judged: on choosing cases 0.8 to 2.7 times as high. Of effects
        of timing it is the scale either way: rates of torque hold noise (0.56 to 1.25 times).
    nearly_all : share of the squared error beyond the noise of an axis that makes a name stand beside any structure
        that is left there; and the error on left-out training records, over that of the given robot, above which what
        was fitted to an axis with such structure alone is not written; and the share of what is gained in all that a
        model changes of the squared errors of blocks of time there, below which what was fitted to the drive of the
        axis is not written: it costs a quarter of what it gains.
    not_worse : error on left-out training records, over that of the given robot, up to which a model is written: on all
        of them, on the worst one, and in the middle block of time.
    near_the_floor : distance of the held-out error from the noise floor up to which nothing but noise is left.
    visible : energy over noise variance from which this motion shows an effect: what `accept` needs after the price of
        complexity and search.
    judged_speed : the largest torque of an effect is stated for samples at least as fast [rad/s]: slower, friction
        depends on more than the speed.
    groups : (name, trajectory labels) of days or sessions; the user's.
    """

    inertial_prior: float = 0.05
    usual: float = 0.3
    most_on_axis: int = 2
    accept: float = 9.0
    certainty: float = 0.99
    smallest_share: float = 0.001
    form_error: float = 0.05
    parameter_error: float = 0.01
    filter_error: float = 0.3
    peak_error: float = 0.07
    reversal_error: float = 0.5
    nearly_all: float = 0.8
    not_worse: float = 1.03
    near_the_floor: float = 0.10
    visible: float = 40.0
    judged_speed: float = 0.025
    groups: tuple[tuple[str, tuple[int, ...]], ...] = ()

    @property
    def mass_sigmas(self) -> float:
        """Standard deviations that cost half of `accept`: 3.

        So many of its prior a link mass must be off to be an explanation of its own; an effect has to be needed where
        inertial parameters may be off by as much. By as many of its own a factor of all torque of an axis must be off:
        less, and its own interval says that it may be right. So does it where its load is not as many times what the
        fit corrects of the links there.
        """
        return math.sqrt(self.accept)

    @property
    def wrongest_mass(self) -> float:
        """Share by which a link mass may be wrong as a parameter; more is a body that is missing: 0.6.

        Two standard deviations of a link that is off by what is `usual`.
        """
        return 2.0 * self.usual

    @property
    def off_scale(self) -> float:
        """Factor by which the torque of an effect may miss the size that its one parameter gives it: 1.6.

        Two standard deviations of a size that is off by what is `usual`; beyond it the torque has another shape.
        """
        return 1.0 + 2.0 * self.usual

    @property
    def noise_sigmas(self) -> float:
        """Standard deviations that cost `accept`, which noise does not reach: 4.2.

        Of a share of an octave (each octave of each axis is asked), of the residual where a shared drive sticks, and of
        a residual that counts as structure.
        """
        return math.sqrt(2.0 * self.accept)

    @property
    def unexplained_p(self) -> float:
        """Structure is unexplained below this probability, if its torque is no less than `smallest_share` too: 1.5e-8.

        Its nats, before any price, are twice `accept`: a chi-square pays for none of the arguments that are searched.
        """
        return math.exp(-2.0 * self.accept)

    @property
    def weak_nats(self) -> float:
        """Evidence up to which half of `accept` is more than `form_error` of it: 90 nats.

        A name with less must be found again in every run without one group of recordings, and explains nothing that
        shakes an arm while structure is left on its own axis.
        """
        return 0.5 * self.accept / self.form_error


def settings_of(entry: Mapping[str, Any]) -> Settings:
    """Return the settings that the entry of a data set asks for."""
    given: dict[str, Any] = {}
    if entry.get("inertial_prior") is not None:
        given["inertial_prior"] = float(entry["inertial_prior"])
    groups = entry.get("group") or {}
    return Settings(**given, groups=tuple((str(name), tuple(labels)) for name, labels in groups.items()))
