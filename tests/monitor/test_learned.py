"""Learning a robot's own model from the logs of its baseline: what is read, which programs, what is handed on."""

import json
import shutil
from contextlib import nullcontext
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pyarrow as pa
import pytest
import yaml
from hypothesis import given, settings
from hypothesis import strategies as st
from monitor_logs import ROBOT, START, columns, layout, make_log, model, write_csv, write_parquet
from pyarrow import parquet

from jointwear.discovery.model.written_robot import WrittenRobot
from jointwear.files.errors import InputError
from jointwear.files.json_documents import write_json
from jointwear.monitor.learned import stage
from jointwear.monitor.learned.gather import Piece, baseline_pieces
from jointwear.monitor.learned.programs import programs_of
from jointwear.monitor.learned.selection import HELD_OUT, MOST_PIECES, choose, recording_of
from jointwear.monitor.learned.stage import dropped, learn_normal, steady, with_given_links, worse
from jointwear.monitor.learned_model import learnt_from, learnt_of_other, model_file
from jointwear.robots.robot import load_robot
from jointwear.robots.robot_file import read_robot_file

ENTRY = {"logs": ["logs/*"], "robot": str(ROBOT), "window": "1h", "baseline": {"windows": 10}}


def hourly(folder, count, temperature=None, seconds=5.0, friction=1.0, name="log"):
    """One log an hour, its Coulomb friction `friction` times the model's."""
    paths, robot = [], model().robot
    level = (robot.coulomb_positive - robot.coulomb_negative) / 2
    for hour in range(count):
        # Another part of the cycle each time.
        log = make_log(seconds + 7.0 * (hour % 5), seed=hour, noise=0.01)
        log = log.part(log.time >= log.time[-1] - seconds)
        torque = log.torque + (friction - 1) * level * np.sign(log.velocity)
        log = replace(log, time=log.time - log.time[0] + START + 3600.0 * hour, torque=torque)
        table = columns(log, "position", "velocity", "acceleration", "torque")
        if temperature is not None:
            table["temperature"] = np.full(len(log.time), temperature(hour))
        paths.append(str(write_parquet(folder / f"{name}_{hour:02d}.parquet", table)))
    return paths


@pytest.fixture(scope="module")
def logs(tmp_path_factory):
    folder = tmp_path_factory.mktemp("baseline")
    return hourly(folder, 14, lambda hour: 20.0 + hour % 7, friction=1.3)


def test_the_baseline_ends_where_the_entry_says(logs):
    for baseline, count in (
        ({"windows": 10}, 10),
        ({"until": "2026-01-01T06:00:00Z"}, 6),
        ({"until": START + 6 * 3600}, 6),
        ({"from": "2026-01-01T02:00:00Z", "until": "2026-01-01T06:00:00Z"}, 4),
        ({"windows": 100}, 14),
    ):
        pieces, refused = baseline_pieces(logs, layout(), ENTRY | {"baseline": baseline})
        assert (len(pieces), refused) == (count, [])
    assert pieces[3].warmth == 23.0


def test_a_log_that_cannot_be_read_is_told_and_left(logs, tmp_path):
    bad = str(write_csv(tmp_path / "bad.csv", {"time": [0.0], "what": [1.0]}))
    pieces, refused = baseline_pieces([bad, *logs], layout(), ENTRY)
    assert len(pieces) == 10
    assert len(refused) == 1
    assert "bad.csv" in refused[0]


def test_a_misdated_log_neither_ends_nor_begins_what_is_learnt_from(logs, tmp_path):
    """The second log, dated a year off, had left the first alone to learn from, without a word."""
    for days in (365, -365):
        folder = tmp_path / str(days)
        folder.mkdir()
        paths = [str(shutil.copy(log, folder)) for log in logs]
        table = parquet.read_table(paths[2])
        moved = pa.array(table["time"].to_numpy() + 86400 * days)
        parquet.write_table(
            table.set_column(table.schema.get_field_index("time"), table.schema.field("time"), moved), paths[2]
        )
        for baseline, count in (({"windows": 10}, 10), ({"until": "2026-01-01T06:00:00Z"}, 5)):
            pieces, (told,) = baseline_pieces(paths, layout(), ENTRY | {"baseline": baseline})
            assert len(pieces) == count
            assert paths[2] not in {p.log for p in pieces}
            assert f"{paths[2]}: its dates lie 365 days {'after' if days > 0 else 'before'} those of" in told


def test_the_baseline_is_of_the_earliest_logs_whatever_their_names(logs, tmp_path):
    """What comes later by time, though before by name, had ended it."""
    paths = [str(shutil.copy(log, tmp_path / f"{(k + 9) % 14:02d}.parquet")) for k, log in enumerate(logs)]
    pieces, refused = baseline_pieces(sorted(paths), layout(), ENTRY | {"baseline": {"windows": 8}})
    assert ([p.log for p in pieces], refused) == (paths[:8], [])


def test_undated_logs_whose_clock_starts_anew_follow_each_other(tmp_path):
    paths = []
    for k in range(4):
        paths.append(str(write_parquet(tmp_path / f"{k}.parquet", columns(make_log(12.0, seed=k)))))
    pieces, _ = baseline_pieces(paths, layout(), ENTRY | {"window": "12s"})
    assert [round(p.begin) for p in pieces] == [0, 12, 24, 36]


def path(centre, phase, length=1.0, n=3):
    angle = np.linspace(phase, phase + 2 * np.pi * length, 300)
    return np.stack([centre + np.cos(angle + j) for j in range(n)], axis=1)


@given(st.lists(st.tuples(st.sampled_from([0.0, 4.0, 9.0]), st.floats(0, 6.28)), min_size=2, max_size=12))
@settings(max_examples=30, deadline=None)
def test_pieces_over_one_path_are_one_program_wherever_they_begin(drawn):
    label = programs_of([path(centre, phase) for centre, phase in drawn])
    for a, (one, _) in enumerate(drawn):
        for b, (other, _) in enumerate(drawn):
            assert (label[a] == label[b]) == (one == other)
    assert np.sum(label == 0) == np.bincount(label).max()


def test_parts_of_a_cycle_are_joined_by_what_they_share():
    parts = [path(0.0, phase, 0.5) for phase in np.arange(0, 6.2, 0.8)]
    assert set(programs_of([*parts, path(5.0, 0.0)])) == {0, 1}
    assert programs_of([np.zeros((50, 3))] * 2).tolist() == [0, 0]
    assert programs_of([]).tolist() == []


def test_what_is_learnt_from_spans_the_temperatures(logs):
    pieces, _ = baseline_pieces(logs, layout(), ENTRY | {"baseline": {"windows": 14}})
    many = [replace_begin(p, k) for k in range(4) for p in pieces]
    chosen = choose(many)
    assert len(chosen) <= MOST_PIECES < len(many)
    assert {min(p.warmth for p in chosen), max(p.warmth for p in chosen)} == {20.0, 26.0}
    assert [p.begin for p in chosen] == sorted(p.begin for p in chosen)
    recording = recording_of(chosen, "arm")
    assert not set(recording.train) & set(recording.test)
    assert len(recording.test) >= len(chosen) // HELD_OUT
    assert recording.velocity is not None
    assert recording.temperature.shape == recording.position.shape


def replace_begin(piece, day):
    return Piece(piece.log, replace(piece.chunk, time=piece.chunk.time + 86400.0 * day))


def test_a_robot_learns_its_friction_and_the_monitor_takes_it(logs, tmp_path, monkeypatch):
    told = learn_normal("arm", ENTRY, tmp_path / "results/learned/arm", logs)
    assert told["adopted"] in ("augmented", "retuned")
    assert told["programs"][0]["temperature"] == [20.0, 26.0]
    learnt, given_arm = load_robot(tmp_path / "results/learned/arm/robot.yaml"), model().robot
    moving = [0, 1, 2]
    ratio = (learnt.coulomb_positive / given_arm.coulomb_positive)[moving]
    assert np.abs(ratio - 1.3).max() < 0.1
    assert np.nanmax(np.array(told["error"]["augmented"][0][:3]) / told["error"]["given"][0][:3]) < 0.7
    assert json.loads((tmp_path / "results/learned/arm/verdict.json").read_text())["dataset"] == "arm"
    monkeypatch.chdir(tmp_path)
    entry = ENTRY | {"logs": [str(Path(logs[0]).parent / "*.parquet")]}
    assert model_file("arm", entry) == "results/learned/arm/robot.yaml"
    assert model_file("arm", entry | {"window": "2h", "scale": 1.0}) == "results/learned/arm/robot.yaml"
    assert model_file("arm", entry | {"use_learned": False}) == str(ROBOT)
    assert model_file("other", ENTRY) == str(ROBOT)


def test_a_learnt_model_of_something_else_is_not_used(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    robot, folder = tmp_path / "given.yaml", tmp_path / "results/learned/arm"
    robot.write_bytes(ROBOT.read_bytes())
    entry = ENTRY | {"robot": str(robot)}
    folder.mkdir(parents=True)
    (folder / "robot.yaml").write_bytes(ROBOT.read_bytes())
    assert "another robot file is not used; run learn_normal" in learnt_of_other("arm", entry)
    write_json(
        folder / "learned.json", {"learnt_from": learnt_from(entry | {"sign": -1}, ["logs/a.csv", "logs/b.csv"])}
    )
    used = entry | {"sign": [-1] * 6}
    assert (learnt_of_other("arm", used), model_file("arm", used)) == ("", "results/learned/arm/robot.yaml")
    for change, why in (
        ({"sign": 1}, "logs that were read with other keys"),
        ({"logs": ["elsewhere/*"]}, "other logs"),
    ):
        assert why in learnt_of_other("arm", used | change)
        assert model_file("arm", used | change) == str(robot)
    assert learnt_of_other("arm", used | {"logs": ["logs/**/*.csv", "more/*"]}) == ""
    robot.write_text(robot.read_text() + "# comment\n")
    assert learnt_of_other("arm", used) == ""
    data = yaml.safe_load(robot.read_text())
    data |= {key: data[key][:3] for key in ("dh", "links", "joints")}
    robot.write_text(yaml.safe_dump(data))
    assert "another robot file" in learnt_of_other("arm", used)
    assert model_file("arm", used) == str(robot)


def test_a_model_that_follows_any_axis_worse_is_not_handed_on(logs, tmp_path, monkeypatch):
    (tmp_path / "robot.yaml").write_text("an earlier one")

    found = SimpleNamespace(
        verdict="retuned",
        problem=SimpleNamespace(measured=None),
        files={kind: WrittenRobot({"effects": [], "joints": []}, None) for kind in stage.KINDS},
        to_json=lambda: "{}",
    )
    monkeypatch.setattr(stage, "discover", lambda recording, arm: found)
    monkeypatch.setattr(WrittenRobot, "robot", lambda self: nullcontext())
    rows = ([1.0, 1.0], [0.5, 1.2], [0.7, 1.1], [1.2, 0.2], [1.1, 0.2])
    errors = iter([[np.array(row)] for row in rows])
    monkeypatch.setattr(stage, "_errors", lambda *_: next(errors))
    assert learn_normal("arm", ENTRY, tmp_path, logs)["adopted"] == "given"
    assert not (tmp_path / "robot.yaml").exists()


def test_too_short_a_baseline_is_refused(logs, tmp_path):
    with pytest.raises(InputError, match=r"monitor\.robots\.arm\.baseline' holds 3 uninterrupted pieces .* a later"):
        learn_normal("arm", ENTRY, tmp_path, logs[:3])
    with pytest.raises(InputError, match=r"holds 1 uninterrupted piece of motion"):
        learn_normal("arm", ENTRY, tmp_path, logs[:1])


def test_effects_that_follow_time_are_not_handed_on():
    effects = [{"effect": "wear_drift", "axis": 2}, {"effect": "stribeck_friction", "axis": 1}]
    file = WrittenRobot({"name": "arm", "effects": effects}, None)
    assert [e["effect"] for e in steady(file).data["effects"]] == ["stribeck_friction"]
    assert dropped(file) == ["wear_drift of axis 2"]


def test_another_load_keeps_the_given_links_and_what_it_makes_worse():
    given_file = read_robot_file(ROBOT)
    joints = [{**joint, "viscous": 1.0} for joint in given_file["joints"]]
    effects = [{"effect": "stribeck_friction", "axis": axis} for axis in (1, 2)]
    data = {"name": "arm", "links": "others", "payload": {"mass": 1.0}, "joints": joints, "effects": effects}
    found = with_given_links(WrittenRobot(data, None), ROBOT, spared=[1]).data
    assert found["links"] == given_file["links"]
    assert found.get("payload") == given_file.get("payload")
    assert [j["viscous"] == 1.0 for j in found["joints"]] == [True, False, True, True, True, True]
    assert [e["axis"] for e in found["effects"]] == [1]


def test_worse_means_on_any_axis_and_no_motion_says_nothing():
    given_arm = [np.array([1.0, np.nan])]
    assert worse([np.array([1.1, np.nan])], given_arm)
    assert not worse([np.array([0.2, np.nan])], given_arm)
