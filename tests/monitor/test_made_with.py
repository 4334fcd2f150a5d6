"""A kept baseline knows what its windows were made with."""

from monitor_logs import ROBOT

from jointwear.monitor.stages import made_with


def test_the_digest_follows_the_robot_and_how_logs_are_read_and_nothing_else(tmp_path):
    robot = tmp_path / "robot.yaml"
    robot.write_bytes(ROBOT.read_bytes())
    entry = {"units": {"position": "deg"}, "limits": {"coulomb_increase_percent": 20}, "events": []}
    first = made_with(robot, entry)
    assert made_with(robot, {**entry, "limits": {"coulomb_increase_percent": 10}}) == first
    assert made_with(robot, {**entry, "units": {"position": "rad"}}) != first
    assert made_with(robot, {**entry, "program": {"columns": ["task"]}}) != first
    robot.write_bytes(ROBOT.read_bytes() + b"# learnt\n")
    assert made_with(robot, entry) != first
