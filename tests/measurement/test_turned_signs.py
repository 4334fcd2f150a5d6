"""Which joints look turned around together, and which other signs are told though a recording is not refused."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from discovery_cases import make_case

from jointwear.discovery.preflight import checks_passed
from jointwear.measurement.checks.axes_check import check_axes
from jointwear.measurement.checks.checked import Checked, checked
from jointwear.measurement.checks.turned_signs import IN_DOUBT, TOLD, in_doubt, likeliest_signs, needed_signs
from jointwear.measurement.derived.motion import measure
from jointwear.measurement.refused import Refused
from jointwear.measurement.stated import Stated
from jointwear.robots.robot import load_robot

#: An arm with a plane of two joints, a base that turns about the vertical and a slender wrist.
QUAD = """
name: quad
gravity: [0, 0, -9.81]
dh:
  - {d: 0.4, a: 0, alpha: 1.570796326794897}
  - {d: 0, a: 0.5, alpha: 0}
  - {d: 0, a: 0.35, alpha: 1.570796326794897}
  - {d: 0.12, a: 0, alpha: 0}
links:
  - {mass: 8, com: [0, -0.1, 0.0], inertia: [0.06, 0.04, 0.06, 0, 0, 0]}
  - {mass: 7, com: [-0.25, 0, 0.05], inertia: [0.02, 0.15, 0.15, 0, 0, 0]}
  - {mass: 4, com: [-0.15, 0.02, 0], inertia: [0.01, 0.05, 0.05, 0, 0, 0]}
  - {mass: 1.5, com: [0.03, 0, -0.03], inertia: [0.003, 0.003, 0.002, 0, 0, 0]}
joints:
"""
JOINTS = [("base", 2.8, 100, 2e-4, 0.06), ("shoulder", 2.0, 120, 2e-4, 0.06), ("elbow", 2.4, 80, 1e-4, 0.04)]
JOINTS += [("wrist", 3.1, 50, 4e-5, 0.03)]


@pytest.fixture(scope="module")
def quad(tmp_path_factory):
    path = Path(tmp_path_factory.mktemp("arm")) / "quad.yaml"
    rows = [
        f"  - {{name: {name}, limits: [-{reach}, {reach}], gear_ratio: {gear}, motor_inertia: {rotor}, viscous: 0.001, "
        f"coulomb: {{positive: {level}, negative: -{level}}}}}"
        for name, reach, gear, rotor, level in JOINTS
    ]
    path.write_text(QUAD + "\n".join(rows) + "\n")
    return load_robot(path)


@pytest.fixture(scope="module")
def clean(quad):
    return make_case(quad, 3, noise=0.001)


def turned(recording, axes, torque_alone=False):
    signs = np.where(np.isin(np.arange(recording.joints), axes), -1.0, 1.0)
    position = recording.position if torque_alone else recording.position * signs
    return replace(recording, position=position, torque=recording.torque * signs)


def spring(q, *_):
    full = np.zeros_like(q)
    full[:, 1] = 60.0 * (q[:, 1] - 0.14)
    return full


def test_no_sign_is_in_doubt_where_all_are_right(quad, clean):
    assert not any(IN_DOUBT in line for line in checked(clean, quad).restrictions)


def test_a_shoulder_turned_around_is_no_torque_without_gravity(quad, clean):
    with pytest.raises(Refused, match="the sign of joint 2 looks flipped") as refused:
        checked(turned(clean, [1]), quad)
    assert "give 'sign' with -1 for it" in refused.value.suggestion


@pytest.mark.parametrize("axes", [[1, 2], [0, 1, 2, 3]])
def test_joints_turned_around_together_are_told_beside_another_mounting(quad, clean, axes):
    with pytest.raises(Refused, match="the sign of joints 2 and 3 looks flipped") as refused:
        checked(turned(clean, axes), quad)
    assert "give 'sign' with -1 for each" in refused.value.suggestion


def test_a_base_turned_around_is_told(quad, clean):
    """It mirrors the arm, and what it couples tells alone."""
    try:
        told = checked(turned(clean, [0]), quad).restrictions
    except Refused as refused:
        told = [str(refused)]
    assert any("joint 1 " in line and "'sign' with -1" in line for line in told)


@pytest.mark.parametrize("hidden", [None, spring])
def test_torques_that_all_are_turned_are_told_together(quad, hidden):
    case = turned(make_case(quad, 3, hidden, noise=0.001), range(4), torque_alone=True)
    with pytest.raises(Refused, match=r"sign of the torque of joints 1, .* and 4 looks flipped") as refused:
        checked(case, quad)
    assert "give 'scale' with -1 for every joint" in refused.value.suggestion
    # Where a spring hides the size of a torque, and so of what is known of scales, signs alone tell it.
    with pytest.raises(Refused, match="sign of the torque of joints 1, 2, 3 and 4 looks flipped"):
        check_axes("arm", quad, measure(case))


def test_signs_in_doubt_are_not_said_to_be_tried_and_worse(quad):
    sure = Checked(measured=None, restrictions=[], axes_asked=True, signs_sure=True, zero_told=False)
    assert any("no other sign" in line for line in checks_passed(quad, "rad", sure))
    assert not any("sign" in line for line in checks_passed(quad, "rad", replace(sure, signs_sure=False)))
    assert not any("axes" in line for line in checks_passed(quad, "rad", replace(sure, axes_asked=False)))


def nats_of(best, each):
    """Nats of a joint that is turned wrongly: `each` a joint."""
    return lambda axes: -float(sum(each[j] for j in axes ^ frozenset(best)))


def test_the_likeliest_signs_are_found_from_two_joints_that_only_fit_together():
    together = {frozenset(): 0.0, frozenset({1}): -5.0, frozenset({2}): -5.0, frozenset({1, 2}): 90.0}
    assert likeliest_signs(lambda axes: together.get(axes, -100.0), 4) == {1, 2}


def test_joints_whose_sign_hardly_tells_are_not_needed():
    nats = nats_of({0, 1, 2}, [10.0, 300.0, 200.0, 50.0])
    assert likeliest_signs(nats, 4) == {0, 1, 2}
    assert needed_signs(nats, frozenset({0, 1, 2}), 40.0) == {1, 2}
    assert needed_signs(nats, frozenset({0, 1, 2}), 400.0) == frozenset()


@pytest.mark.parametrize(("better", "told"), [(TOLD - 1, False), (TOLD + 1, True)])
def test_other_signs_are_told_from_what_right_logs_reach(better, told):
    parts = np.ones((3, 4, 2))
    words = list(in_doubt(lambda p: np.abs(p[0, 3] - 0.9), nats_of({1}, [50.0, better]), parts, Stated()))
    assert bool(words) is told
    assert all("joint 2 would fit" in line and "give 'sign' with -1 for it" in line for line in words)
