"""The plants of the tier "world": both engines agree on the arm, and what is hidden acts where it is said to."""

from dataclasses import replace

import numpy as np
import pinocchio as pin
import pytest

from jointwear.studies.sieve import REST
from jointwear.studies.world.arms import ARMS, chain_of
from jointwear.studies.world.case import generate
from jointwear.studies.world.chains import urdf_text
from jointwear.studies.world.plan import EFFECTS, OUTSIDE, Case
from jointwear.studies.world.plant import DriveParameters, compile_plant, draft
from jointwear.studies.world.scores import score
from jointwear.studies.world.truth import Judge

pytestmark = pytest.mark.plants


@pytest.mark.parametrize("name", sorted(ARMS))
def test_both_engines_move_the_same_arm(name, tmp_path):
    mujoco = pytest.importorskip("mujoco")
    chain = chain_of(name)
    n = chain.joints
    plant = compile_plant(draft(chain, DriveParameters(*np.full((3, n), 0.5)), 1e-3))
    rng = np.random.default_rng(1)
    q, v, a = rng.normal(size=(3, n))
    plant.data.qpos[:], plant.data.qvel[:], plant.data.qacc[:] = q, v, a
    mujoco.mj_inverse(plant.model, plant.data)
    model = pin.buildModelFromXML(urdf_text(chain, name))
    expected = pin.rnea(model, model.createData(), q, v, a) + 0.5 * (a + v)
    given = plant.data.qfrc_inverse - 0.0
    friction = given - expected
    assert np.all(np.abs(friction) <= 0.5 + 1e-6)


def test_a_case_without_anything_hidden_is_the_robot_file_and_noise(tmp_path):
    for index in range(20):
        made = generate(Case("choose", "nothing", index), tmp_path / str(index))
        if made.facts["inertial_error"] == 0:
            np.testing.assert_allclose(made.torque, made.given, atol=2e-3 * np.nanstd(made.torque))
            spread = np.nanstd(made.measured - made.torque, axis=0) / np.array(made.facts["noise"])
            np.testing.assert_allclose(spread, 1, atol=0.5)
            return
    raise AssertionError("no case with a right robot file")


def test_the_same_case_gives_the_same_arrays(tmp_path):
    one, again = (generate(Case("choose", "single", 4), tmp_path / x) for x in "ab")
    np.testing.assert_array_equal(one.recording.torque, again.recording.torque)
    np.testing.assert_array_equal(one.recording.position, again.recording.position)
    other = generate(Case("report", "single", 4), tmp_path / "c")
    assert other.recording.torque.shape != one.recording.torque.shape or not np.array_equal(
        other.recording.torque, one.recording.torque
    )


@pytest.mark.parametrize("name", [*EFFECTS, *OUTSIDE])
def test_what_is_hidden_acts_where_it_says(name, tmp_path, monkeypatch):
    seen = {}

    def spy(self, samples):
        plain = before(self, samples)
        seen.update(samples=samples, plain=plain)
        return plain

    before = Judge.plain
    monkeypatch.setattr(Judge, "plain", spy)
    subjects, kind = (EFFECTS, "single") if name in EFFECTS else (OUTSIDE, "outside")
    made = generate(Case("choose", kind, subjects.index(name)), tmp_path)
    (hidden,) = made.facts["effects"]
    assert hidden["effect"] == name
    # Between the plant and the robot that really moves there is nothing but what is hidden.
    peak = np.array(hidden["peak"])
    acting = {hidden["axis"], *hidden["also"]}
    scale = np.nanstd(made.torque, axis=0)
    assert peak.max() > 0
    if hidden["axis"] is not None and name not in ("joint_flexibility",):
        quiet = [k for k in range(len(peak)) if k + 1 not in acting]
        assert np.all(peak[quiet] < 0.02 * scale[quiet] + 0.05 * peak.max())
    assert np.isfinite(made.recording.torque).all()
    assert np.all(np.abs(seen["samples"].velocity).max(axis=0) > REST)


def test_a_case_of_two_hides_both(tmp_path):
    made = generate(Case("choose", "two", 1), tmp_path)
    assert len({e["effect"] for e in made.facts["effects"]}) == 2


def test_answers_are_judged(tmp_path):
    from jointwear.studies.world.stages import solve_case

    row = solve_case(Case("choose", "nothing", 0))
    assert row["kind"] == "nothing"
    assert row["seconds"] > 0
    assert score([row])["false_names"]["count"] == 1
    assert replace(chain_of("ur5")).joints == 6
