"""A clock at another speed is refused with its factor; wrong drives, loads and mountings are no other clock."""

from dataclasses import replace

import numpy as np
import pytest
from discovery_cases import make_case

from jointwear.measurement.checks.checked import checked
from jointwear.measurement.checks.time_scale import check_time_scale
from jointwear.measurement.checks.torque_scale import thinned
from jointwear.measurement.derived.motion import measure
from jointwear.measurement.refused import Refused
from jointwear.robots.robot import load_robot


@pytest.fixture(scope="module")
def puma():
    return load_robot("config/robots/puma560.yaml")


@pytest.fixture(scope="module")
def plain(puma):
    return replace(make_case(puma, 3), velocity=None, acceleration=None)


def ask(recording, robot):
    thin = thinned(measure(recording))
    check_time_scale("arm", robot, thin.parts, thin.usable)


@pytest.mark.long
@pytest.mark.parametrize("factor", [0.5, 0.8, 1.25, 2.0])
def test_a_clock_at_another_speed_is_refused_with_its_factor(plain, puma, factor):
    with pytest.raises(Refused, match="inertial torques of all joints") as refused:
        checked(replace(plain, time=factor * plain.time), puma)
    told = float(refused.value.suggestion.split("divide the times by ")[1].split(",")[0])
    assert told == pytest.approx(factor, rel=0.02)
    checked(replace(plain, time=factor * plain.time / told), puma)


@pytest.mark.parametrize(("factor", "size"), [(0.1, "less than 0.062"), (10.0, "more than 16")])
def test_a_factor_beyond_those_that_are_looked_for_is_no_mend(plain, puma, factor, size):
    with pytest.raises(
        Refused, match=f"are {size} times what the motion asks for: the time is more than 4 times off"
    ) as told:
        ask(replace(plain, time=factor * plain.time), puma)
    assert "divide" not in told.value.suggestion
    assert "check the lengths" in told.value.suggestion


@pytest.mark.parametrize("changed", [{}, {"armature": 2.0}, {"armature": 0.0}, {"viscous": 3.0}])
def test_wrong_drives_in_the_robot_file_are_no_other_clock(plain, puma, changed):
    ask(plain, replace(puma, **{name: factor * getattr(puma, name) for name, factor in changed.items()}))


def test_torques_in_another_unit_are_no_other_clock(plain, puma):
    ask(replace(plain, torque=0.6 * plain.torque), puma)


def test_noise_without_inertial_torque_tells_nothing(plain, puma):
    noise = np.random.default_rng(5).standard_normal(plain.torque.shape)
    ask(replace(plain, torque=plain.torque.std(axis=0) * noise), puma)


def test_a_belt_that_slips_is_no_other_clock(plain, puma):
    """Its position moves where no torque does, at the largest accelerations of the log; the others keep their size."""
    time = plain.time - plain.time[0]
    slips = np.linspace(0.1, 0.9, 9) * np.ptp(time)
    slipped = plain.position.copy()
    slipped[:, 1] += 0.06 * np.clip((time[:, None] - slips) / 0.05, 0.0, 1.0).sum(axis=1)
    ask(replace(plain, position=slipped), puma)
