"""Files that predict training motion worse than the given robot are mended, or written as given."""

from dataclasses import replace

import numpy as np
import pytest

from jointwear.discovery.estimates.outcome import Unexplained
from jointwear.discovery.model import sound_files
from jointwear.discovery.model.fallback import AS_FITTED, OF_LINKS, OWN, Step


def test_a_bad_file_of_one_kind_leaves_the_other_alone(rooted, monkeypatch):
    problem, bad = rooted.problem, rooted.torques["retuned"]
    monkeypatch.setattr(sound_files, "worse_axes", lambda _, torque: {0: 1.2} if np.allclose(torque, bad) else {})
    final, files, torques = sound_files.sound_files(problem, rooted.final.outcome)
    assert np.array_equal(torques["augmented"], rooted.torques["augmented"])
    assert files["augmented"].data == rooted.files["augmented"].data
    assert not np.allclose(torques["retuned"], bad)
    assert [e.named.candidate.key for e in final.estimates] == [e.named.candidate.key for e in rooted.final.estimates]


def test_links_of_a_bad_file_are_closer_to_those_given_before_they_are_as_given(rooted, monkeypatch):
    """For one joint that links of a quarter of their freedom mend, links as given would take from all others."""
    whole, asked = rooted.final, []
    told = replace(whole, delta_inertial=whole.delta_inertial.copy(), retuned_inertial=whole.retuned_inertial.copy())
    mass = 10 * (rooted.problem.robot.joints - 1)
    for inertial in (told.delta_inertial, told.retuned_inertial):
        inertial[mass] += 0.4

    def of(_, links=AS_FITTED):
        asked.append(links.links)
        width = min(links.links, 1.0)
        return replace(told, delta_inertial=width * told.delta_inertial, retuned_inertial=width * told.retuned_inertial)

    def torque(width):
        return sound_files.write_files(rooted.problem, of(None, Step("", links=width)))[2]["augmented"]

    nominal = sound_files.write_files(rooted.problem, of(None, OF_LINKS[-1]))[2]["augmented"]
    most = 1.1 * np.max(np.abs(torque(0.25) - nominal))
    monkeypatch.setattr(sound_files, "finalise", of)
    monkeypatch.setattr(sound_files, "worse_axes", lambda _, t: {1: 1.5} if np.max(np.abs(t - nominal)) > most else {})
    asked.clear()
    final, _, torques = sound_files.sound_files(rooted.problem, rooted.final.outcome)
    # Each width is fitted once for both files.
    assert asked == [np.inf, 0.0, 0.5, 0.25]
    assert final.delta_inertial == pytest.approx(0.25 * told.delta_inertial)
    assert torques["augmented"] == pytest.approx(torque(0.25))
    # Where links as given do not mend a file, no other width is asked.
    given = rooted.torques["nominal"]
    monkeypatch.setattr(sound_files, "worse_axes", lambda _, t: {} if np.allclose(t, given) else {1: 1.5})
    asked.clear()
    sound_files.sound_files(rooted.problem, rooted.final.outcome)
    assert asked == [np.inf, 0.0]


def test_where_every_file_is_worse_the_robot_is_written_as_given_and_the_name_stays(rooted, monkeypatch):
    nominal = rooted.torques["nominal"]
    monkeypatch.setattr(sound_files, "worse_axes", lambda _, torque: {} if np.allclose(torque, nominal) else {1: 1.5})
    final, _, torques = sound_files.sound_files(rooted.problem, rooted.final.outcome)
    assert torques["augmented"] == pytest.approx(nominal, abs=1e-6)
    assert not final.estimates
    assert [e.named.candidate.effect for e in final.unwritten] == ["nonlinear_viscous_friction"]
    assert {f.model for f in final.fallbacks if f.step.startswith("everything as given")} == {"augmented", "retuned"}
    told = next(f.step for f in final.fallbacks if f.model == "augmented" and f.step.startswith("everything"))
    assert "named but not written: nonlinear_viscous_friction" in told


def test_for_one_joint_only_what_acts_on_it_alone_is_as_given(rooted, monkeypatch):
    nominal, axis = rooted.torques["nominal"], 2
    own = nominal[:, axis]
    monkeypatch.setattr(sound_files, "worse_axes", lambda _, t: {} if np.allclose(t[:, axis], own) else {axis: 1.5})
    final, _, torques = sound_files.sound_files(rooted.problem, rooted.final.outcome)
    assert torques["augmented"][:, axis] == pytest.approx(own, abs=1e-6)
    assert np.all(final.delta_friction[axis] == 0.0)
    assert [e.named.candidate.effect for e in final.unwritten] == ["nonlinear_viscous_friction"]
    told = [f.step for f in final.fallbacks if f.step.startswith(OWN)]
    assert told == [f"{OWN}", f"{OWN}; named but not written: nonlinear_viscous_friction"]


@pytest.mark.parametrize("left", [True, False])
def test_an_effect_that_the_file_does_without_is_a_suspect_beside_structure(rooted, monkeypatch, left):
    """What nobody can name may be all that it has found; where nothing is left it keeps its name."""
    harmful = rooted.torques["augmented"]
    monkeypatch.setattr(sound_files, "worse_axes", lambda _, torque: {2: 3.0} if np.allclose(torque, harmful) else {})
    monkeypatch.setattr(sound_files, "finalise", lambda outcome, *_: replace(rooted.final, outcome=outcome))
    unexplained = [Unexplained(2, "time", "s", 0.0, 1.0, 1e-20, 40.0)] if left else []
    outcome = replace(rooted.final.outcome, unexplained=unexplained, suspects=[])
    final, _, _ = sound_files.sound_files(rooted.problem, outcome)
    assert not final.estimates
    name = "nonlinear_viscous_friction"
    assert [e.named.candidate.effect for e in final.unwritten] == ([] if left else [name])
    assert [one.candidate.effect for one, _ in final.suspects] == ([name] if left else [])
    assert final.fallbacks[-1].step == (f"without {name}" if left else f"{name} named but not written")


def test_a_file_that_a_few_samples_speak_for_is_worse(rooted):
    """Friction that turns at ten samples outweighs a column that is noise everywhere else."""
    problem, axis, rng = rooted.problem, 1, np.random.default_rng(3)
    used = np.flatnonzero(problem.train)[problem.usable[:, axis]]
    lacking = np.zeros_like(problem.discrepancy)
    lacking[used, axis] = 0.1 * rng.standard_normal(len(used))
    lacking[used[:10], axis] = 100.0
    odd, useful = replace(problem, discrepancy=lacking), problem.measured.torque - lacking
    useful[used[:10], axis] += 60.0
    noisy = useful.copy()
    noisy[used[10:], axis] += 0.3 * rng.standard_normal(len(used) - 10)
    assert not sound_files.worse_axes(odd, useful)
    assert sound_files.worse_axes(odd, noisy)[axis] == pytest.approx(np.sqrt(10.0), rel=0.1)
    assert np.sum((problem.measured.torque - noisy)[used, axis] ** 2) < 0.5 * np.sum(lacking[used, axis] ** 2)
