"""A robot file that leaves most of a joint is told with the joint and the share; a right one, or a load, is not."""

from dataclasses import replace

import numpy as np
import pytest
from discovery_cases import make_case

from jointwear.measurement.checks.checked import checked
from jointwear.measurement.checks.left_over import left_in_words, left_over
from jointwear.measurement.derived.motion import measure
from jointwear.robots.robot import Link, load_robot


@pytest.fixture(scope="module")
def puma():
    return load_robot("config/robots/puma560.yaml")


@pytest.fixture(scope="module")
def recording(puma):
    return make_case(puma, 3)


def test_a_file_with_a_body_along_another_direction_is_told_with_its_share(puma, recording):
    """Sign, order and quarter turns explain none of it: it was accepted without a word."""
    arm = puma.links[1]
    wrong = replace(puma, links=(puma.links[0], replace(arm, com=arm.com[[1, 2, 0]]), *puma.links[2:]))
    told = checked(recording, wrong).restrictions
    (words,) = [line for line in told if "leaves" in line]
    assert "of the squared torque of joint 2" in words
    assert "another arm" in words


def test_a_right_file_and_a_load_that_it_lacks_are_not_told(puma, recording):
    assert left_in_words(measure(recording), puma) == []
    body = Link(2.5, np.array([0.03, 0.0, 0.08]), np.eye(3) * 2.5 * 0.04**2)
    loaded = make_case(replace(puma, payload=body), 3)
    assert left_in_words(measure(loaded), puma) == []


def test_noise_from_sample_to_sample_is_not_laid_to_the_file(puma, recording):
    noisy = recording.torque.copy()
    noisy[:, 5] += 5.0 * np.random.default_rng(1).standard_normal(len(noisy))
    assert not left_over(measure(replace(recording, torque=noisy)), puma)[5] > 0.2


def test_a_zero_some_degrees_off_is_told_before_the_run(puma, recording):
    off = replace(recording, position=recording.position + np.radians([0, 20, 0, 0, 0, 0]))
    told = checked(off, puma).restrictions
    (words,) = [line for line in told if "another zero" in line]
    assert "joint 2" in words
    assert "add -" in words
    right = checked(recording, puma).restrictions
    assert not any("another zero" in line for line in right)
