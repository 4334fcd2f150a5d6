"""Discovery on small simulated data sets: names, axis, abstention, unknown, augmented robot, restrictions."""

import json
from dataclasses import replace

import numpy as np
import pytest
from discovery_cases import make_case

from jointwear.discovery import Discovery, discover, pipeline
from jointwear.discovery.findings import make_verdict
from jointwear.measurement.recording import split
from jointwear.measurement.refused import Refused
from jointwear.robots.robot import robot_from_data


def only(axis, torque):
    full = np.zeros((len(torque), 6))
    full[:, axis] = torque
    return full


def names(verdict: Discovery):
    return [(e["effect"], e["axis"]) for e in verdict.effects]


@pytest.fixture(scope="module")
def nothing(robot):
    """The verdict on a robot in which nothing is hidden."""
    return discover(make_case(robot, 1), robot)


def test_nothing_hidden_names_nothing(nothing):
    assert nothing.verdict == "none"
    assert not nothing.effects
    assert not nothing.data["retuned"]


@pytest.fixture(scope="module")
def contradicted(robot):
    """The verdict on the same robot, with a held-out record that is another one's."""
    case = split(make_case(robot, 1))
    held, torque = np.isin(case.trajectory, case.test), case.torque.copy()
    torque[held, 2] *= -1.0
    return discover(replace(case, torque=torque), robot)


def test_the_files_are_decided_before_the_held_out_records_are_looked_at(contradicted, monkeypatch):
    """A correction that no evidence asks for was written where held-out records alone contradict."""
    problem, final = contradicted.problem, contradicted.final
    little = final.delta_friction + np.array([0.0, 0.0, 1e-6, 0.0])
    fitted = pipeline.write_files(problem, replace(final, delta_friction=little, retuned_friction=little))
    for name in ("search_beside", "repeat", "with_kept_sizes"):
        monkeypatch.setattr(pipeline, name, lambda outcome, *_: outcome)
    monkeypatch.setattr(pipeline, "sound_files", lambda *_: fitted)
    found = pipeline.judge(contradicted.recording, final.outcome, [])
    assert (found.verdict, found.data["retuned"]) == ("unknown", [])
    for kind, file in contradicted.files.items():
        assert fitted[1][kind].data != file.data
        assert found.files[kind].data == file.data


def test_a_held_out_record_that_is_another_robots_is_not_nothing(contradicted, nothing):
    """Nothing was missing, said the heading, beside 40 times the noise on held-out motion."""
    verdict = contradicted
    assert verdict.verdict == "unknown"
    assert not verdict.effects
    told = [r for r in verdict.data["restrictions"] if "the test trajectories disagree with the model" in r]
    assert len(told) == 1
    assert told[0].startswith("joint 3: ")
    assert not any("disagree with the model" in r for r in nothing.data["restrictions"])


@pytest.mark.long
@pytest.mark.parametrize(("axis", "word"), [(2, "unknown"), (1, "effects"), (None, "unknown")])
def test_a_suspect_on_a_joint_above_the_noise_leaves_it_unknown(robot, axis, word):
    """What it stood for is there, and has no name; on a joint that noise explains there is nothing."""
    spring = make_case(robot, 3, lambda q, *_: only(2, 40.0 * q[:, 2]))
    found = discover(spring, robot)
    assert names(found) == [("joint_spring", 3)]
    one = found.final.estimates[0].named
    suspect = replace(one, candidate=replace(one.candidate, axis=axis))
    final = replace(found.final, suspects=((suspect, "its size is not the same"),))
    torques = {k: t + only(2, 0.5 * np.sin(found.sample_time)) * (k == "augmented") for k, t in found.torques.items()}
    torques["nominal"] = found.torques["nominal"]
    content = make_verdict("case", final, found.map, torques, [])
    assert [a.axis for a in content.above_the_noise] == [3]
    assert content.verdict == word
    told = [r for r in content.restrictions if r.startswith("joint 3: what the model lacks is like a suspected effect")]
    assert len(told) == (word == "unknown")


@pytest.mark.long
def test_one_wrong_parameter_is_retuned(robot):
    recording = make_case(robot, 2)
    viscous = robot.viscous * np.array([1, 1, 1.3, 1, 1, 1])
    verdict = discover(recording, replace(robot, viscous=viscous))
    assert verdict.verdict == "retuned"
    entry = next(r for r in verdict.data["retuned"] if r["parameter"] == "viscous")
    assert entry["axis"] == 3
    assert entry["value"] == pytest.approx(robot.viscous[2] / robot.gear_ratio[2] ** 2, rel=0.03)


@pytest.mark.parametrize(
    ("effect", "axis", "torque"),
    [
        ("stribeck_friction", 2, lambda q, v, a, t, s, tau: 3.0 / (1 + (v[:, 1] / 0.08) ** 2) * np.sign(v[:, 1])),
        ("position_dependent_friction", 3, lambda q, v, a, t, s, tau: 0.8 * np.sin(3 * q[:, 2] + 1) * np.sign(v[:, 2])),
        (
            "temperature_dependent_viscous_friction",
            1,
            lambda q, v, a, t, s, tau: -2.5 * np.tanh((t - 30) / 15) * v[:, 0],
        ),
        ("joint_spring", 5, lambda q, v, a, t, s, tau: 0.15 * np.sinh(1.2 * q[:, 4])),
    ],
)
def test_a_hidden_effect_is_named_and_added(robot, effect, axis, torque):
    recording = make_case(robot, 10 + axis, lambda *x: only(axis - 1, torque(*x)))
    verdict = discover(recording, robot)
    assert verdict.verdict == "effects"
    assert names(verdict) == [(effect, axis)]
    gap = verdict.data["gap"]
    assert gap["augmented"][axis - 1] < 0.5 * gap["retuned"][axis - 1] + 0.5 * gap["noise_floor"][axis - 1]
    entry = verdict.effects[0]
    assert entry["tie_set"][0] == effect
    assert 0 < entry["peak_torque"]["low"] <= entry["peak_torque"]["value"] <= entry["peak_torque"]["high"]


@pytest.mark.long
def test_a_product_of_positions_is_unknown(robot):
    recording = make_case(robot, 30, lambda q, v, a, t, s, tau: only(1, 4 * (q[:, 1] - 1.5) * q[:, 4]))
    verdict = discover(recording, robot)
    assert verdict.verdict == "unknown"
    assert verdict.data["unexplained"][0]["axis"] == 2
    assert not verdict.effects


@pytest.mark.long
def test_test_motion_takes_no_part(robot):
    hidden = make_case(
        robot, 12, lambda q, v, a, t, s, tau: only(1, 3 * np.exp(-np.abs(v[:, 1]) / 0.1) * np.sign(v[:, 1]))
    )
    spoiled = replace(hidden, torque=np.where((hidden.trajectory == 3)[:, None], 0.0, hidden.torque))
    first, second = discover(hidden, robot), discover(spoiled, robot)
    assert [e["parameters"] for e in first.effects] == [e["parameters"] for e in second.effects]
    assert first.data["gap"]["augmented"] != second.data["gap"]["augmented"]


@pytest.mark.long
def test_augmented_robot_file_gives_the_torque_of_the_verdict(robot):
    from jointwear.discovery.model.written_robot import simulate_robot
    from jointwear.measurement.derived.motion import measure
    from jointwear.measurement.recording import split

    recording = make_case(
        robot, 21, lambda q, v, a, t, s, tau: only(2, 0.8 * np.sin(3 * q[:, 2] + 1) * np.sign(v[:, 2]))
    )
    verdict = discover(recording, robot)
    augmented = robot_from_data(verdict.augmented_robot)
    torque, _ = simulate_robot(augmented, measure(split(recording)))
    np.testing.assert_allclose(torque, verdict.torques["augmented"], rtol=1e-6, atol=1e-6)


def test_payload_goes_into_the_robot_file(robot):
    from jointwear.robots.dynamics import Dynamics
    from jointwear.robots.robot import Link

    loaded = replace(robot, payload=Link(1.2, np.array([0.0, 0.0, 0.1]), np.zeros((3, 3))))
    verdict = discover(make_case(loaded, 5), robot)
    assert names(verdict) == [("payload", None)]
    payload = verdict.augmented_robot["payload"]
    assert payload["mass"] == pytest.approx(1.2, abs=0.15)
    assert payload["mass"] * payload["com"][2] == pytest.approx(0.12, abs=0.02)
    assert verdict.augmented_robot["effects"] == []
    Dynamics(robot_from_data(verdict.augmented_robot))


def test_json_has_the_agreed_layout(nothing):
    content = json.loads(nothing.to_json())
    assert set(content) >= {
        "dataset",
        "verdict",
        "effects",
        "retuned",
        "unexplained",
        "gap",
        "not_identifiable",
        "next_experiment",
    }
    assert {n["effects"][0] for n in content["not_identifiable"]} >= {"backlash"}
    assert set(content["gap"]) == {"unit", "per", "nominal", "retuned", "augmented", "noise_floor"}


def swapped(recording, order):
    return replace(recording, position=recording.position[:, order], torque=recording.torque[:, order])


@pytest.mark.long
@pytest.mark.parametrize(
    ("change", "words"),
    [
        (lambda r: replace(r, position=np.degrees(r.position)), "look like degrees"),
        (lambda r: swapped(r, [0, 2, 1, 3, 4, 5]), "joints 2 and 3 look swapped"),
        (
            lambda r: replace(r, position=r.position * [1, -1, 1, 1, 1, 1], torque=r.torque * [1, -1, 1, 1, 1, 1]),
            "sign of joint 2",
        ),
        (lambda r: replace(r, torque=r.torque * [1, 1, -1, 1, 1, 1]), "sign of the torque of joint 3"),
        (lambda r: replace(r, position=r.position[:, :5], torque=r.torque[:, :5]), "has 5 joints"),
        (lambda r: replace(r.part(np.arange(30))), "at least 40"),
        (lambda r: replace(r, position=np.tile(r.position[:1], (len(r.time), 1))), "no axis moves"),
    ],
)
def test_wrong_recordings_are_refused(robot, change, words):
    with pytest.raises(Refused, match=words) as caught:
        discover(change(make_case(robot, 3)), robot)
    assert caught.value.suggestion


def test_angles_of_the_motors_are_no_degrees_alone(robot):
    recording = make_case(robot, 3)
    with pytest.raises(Refused) as caught:
        discover(replace(recording, position=recording.position * robot.gear_ratio), robot)
    assert "divide those of each joint by its gear_ratio" in caught.value.suggestion
    with pytest.raises(Refused) as caught:
        discover(replace(recording, position=np.degrees(recording.position)), replace(robot, gear_ratio=np.ones(6)))
    assert "gear_ratio" not in caught.value.suggestion


@pytest.mark.long
def test_weak_recordings_state_their_restrictions(robot):
    recording = make_case(robot, 3)
    torque = recording.torque.copy()
    torque[500:700, 2] = np.nan
    verdict = discover(replace(recording, torque=torque, temperature=None), robot)
    words = " ".join(verdict.data["restrictions"])
    assert "not finite" in words
    assert "no temperature" in words
    assert verdict.verdict == "none"
    still = recording.position.copy()
    still[recording.trajectory == 3] = still[recording.trajectory == 3][0]
    verdict = discover(replace(recording, position=still), robot)
    assert "no joint moves in the test trajectories" in " ".join(verdict.data["restrictions"])
    assert verdict.data["gap"]["nominal"] == [None] * 6
