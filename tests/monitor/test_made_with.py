"""A kept baseline knows what its windows were made with."""

import pytest
import yaml
from monitor_logs import ROBOT

from jointwear.monitor.made_with import made_with
from jointwear.running.modules import LIBRARY, imported_by


def test_the_digest_follows_the_robot_and_how_logs_are_read_and_nothing_else(tmp_path):
    robot = tmp_path / "robot.yaml"
    robot.write_bytes(ROBOT.read_bytes())
    entry = {"units": {"position": "deg"}, "limits": {"coulomb_increase_percent": 20}, "events": []}
    first = made_with(robot, entry)
    assert made_with(robot, {**entry, "limits": {"coulomb_increase_percent": 10}}) == first
    assert made_with(robot, {**entry, "units": {"position": "rad"}}) != first
    assert made_with(robot, {**entry, "program": {"columns": ["task"]}}) != first
    robot.write_text(ROBOT.read_text().replace("viscous: ", "viscous: 1"))
    assert made_with(robot, entry) != first


@pytest.mark.parametrize(
    "other",
    [
        {"window": "60min"},
        {"window": 3600},
        {"scale": 1, "sign": [1] * 6},
        {"time_zone": "UTC"},
        {"variables": {"position": "position"}},
        {"units": {"torque": " N m", "position": "degrees"}},
    ],
)
def test_other_words_for_the_same_change_nothing(tmp_path, other):
    robot = tmp_path / "robot.yaml"
    robot.write_bytes(ROBOT.read_bytes())
    entry = {"units": {"position": "deg", "torque": "N m"}, "window": "1h"}
    first = made_with(robot, entry)
    data = yaml.safe_load(ROBOT.read_text())
    data |= {"provenance": {"source": "elsewhere"}, "gravity": [0, 0, -9.81]}
    robot.write_text(f"# a comment\n{yaml.safe_dump(data)}")
    assert made_with(robot, entry | other) == first


@pytest.mark.parametrize("script", ["survey_logs", "accumulate_windows"])
def test_an_edit_of_the_judgement_reads_no_log_again(script):
    read = imported_by(LIBRARY.parent / "scripts" / f"{script}.py")
    names = {path.stem for path in read if LIBRARY / "monitor" in path.parents}
    assert "survey" in names
    assert not {"stages", "judge", "decision", "baseline", "findings", "state", "forecast"} & names
