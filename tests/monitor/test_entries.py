"""An entry of a robot is checked before any job: one line with the key, what is allowed and the nearest."""

import pytest
import yaml
from monitor_logs import ROBOT

from jointwear.files.errors import InputError
from jointwear.monitor.local_time import zone_of
from jointwear.monitor.robot_entries import check_robots
from jointwear.running.configuration import prepare

SIX = [f"axis_{k}" for k in range(6)]


def check(**more):
    entry = {"logs": ["logs/*.csv"], "robot": str(ROBOT), "baseline": {"windows": 8}, **more}
    check_robots({"monitor": {"robots": {"cell_3": entry}}})


@pytest.mark.parametrize(
    ("more", "words"),
    [
        ({"units": {"positon": "deg"}}, r"cell_3\.units' has the role 'positon'; did you mean 'position'"),
        (
            {"units": {"position": "degreess"}},
            r"units\.position' is 'degreess'; did you mean 'deg'\? \(allowed: rad,",
        ),
        ({"units": {"torque": "V"}}, r"units\.torque' is 'V' .*\(allowed: N m, mN m, kN m, kgf m, .*A, mA, %"),
        (
            {"baseline": {"until": "31.01.2026"}},
            r"until' is '31\.01\.2026'; did you mean '2026-01-31'\? \(allowed: ISO",
        ),
        (
            {"baseline": {"until": "2026-02-30"}},
            r"until' is '2026-02-30'; that day does not exist, the nearest valid value is '2026-02-28' \(allowed",
        ),
        ({"baseline": {"until": "31/1/26"}}, r"until' is '31/1/26'; did you mean '2026-01-31'\? \(allowed: ISO"),
        (
            {"baseline": {"until": "01/02/2026"}},
            r"did you mean '2026-02-01' \(day first\) or '2026-01-02' \(month first\)\?",
        ),
        ({"baseline": {"until": "31.02.2026"}}, r"until' is '31\.02\.2026' \(allowed: ISO"),
        (
            {"events": [{"time": "1.2.2026 06:00", "kind": "service"}]},
            r"events\[0\]\.time' is .* did you mean '2026-02-01T06:00'",
        ),
        ({"variables": {"torques": SIX}}, r"variables' has the role 'torques'; did you mean 'torque'"),
        ({"variables": {"torque": SIX[:5]}}, r"variables\.torque' has 5 names; allowed: one, or 6, one a joint"),
        ({"variables": {"time": ["day", "hour", "s"]}}, r"variables\.time' has 3 names; allowed: one, or two: date"),
        ({"variables": {"torque": [*SIX[:5], SIX[0]]}}, r"variables\.torque' has 'axis_0' twice"),
        ({"baseline": {"from": "2026-02-01", "until": "2026-01-01"}}, r"baseline\.from' is '2026-02-01', not before"),
        ({"events": [{"time": "2126-01-01", "kind": "service"}]}, r"events\[0\]\.time' is '2126-01-01', which is yet"),
        ({"events": [{"time": "2026-01-01", "axes": [7], "kind": "service"}]}, r"axis 7.*\(allowed: 1 to 6\)"),
        (
            {"events": [{"time": "2026-01-01", "axes": [0], "kind": "service"}]},
            r"axis 0.*1 to 6\); the nearest.* 1$",
        ),
        (
            {"robot": "config/robots"},
            r"robot' is 'config/robots', a folder; name a file, as 'config/robots/kinova",
        ),
    ],
)
def test_what_no_log_is_needed_for_is_refused_before_any_job(more, words):
    with pytest.raises(InputError, match=words):
        check(**more)


def test_lengths_of_time_name_their_key():
    robots = {"cell_3": {"logs": ["x"], "robot": str(ROBOT), "baseline": {"windows": 8}}}
    with pytest.raises(InputError, match=r"'monitor\.stale_after': '3 days' is no length of time"):
        check_robots({"monitor": {"robots": robots, "stale_after": "3 days"}})


@pytest.mark.parametrize(
    ("name", "hint"), [("MESZ", False), ("GMT+1", False), ("Berlin", True), ("Europe/Berln", True)]
)
def test_no_zone_is_advised_that_is_another(name, hint):
    with pytest.raises(InputError, match="IANA names") as told:
        check(time_zone=name)
    assert ("did you mean 'Europe/Berlin'" in str(told.value)) == hint
    assert ("did you mean" in str(told.value)) == hint


@pytest.mark.parametrize(
    ("time", "words"),
    [
        ("2026-03-29T02:30:00", r"does not exist in Europe/Berlin.*did you mean '2026-03-29T03:30:00\+02:00'"),
        ("2026-10-25 02:30", r"comes twice .*write '2026-10-25T02:30:00\+02:00' or '2026-10-25T02:30:00\+01:00'$"),
    ],
)
def test_times_that_the_clock_on_the_wall_shows_never_or_twice_are_told(time, words):
    """They had been taken as one of the two without a word."""
    event = {"kind": "service"}
    with pytest.raises(InputError, match=r"cell_3\.events\[0\]\.time' is .*" + words):
        check(time_zone="Europe/Berlin", events=[{**event, "time": time}])
    with pytest.raises(InputError, match=r"cell_3\.baseline\.until' is .*" + words):
        check(time_zone="Europe/Berlin", baseline={"until": time})
    check(time_zone="Europe/Berlin", events=[{**event, "time": f"{time}+01:00"}])
    check(events=[{**event, "time": time}])


def test_a_time_may_have_two_columns():
    check(variables={"time": ["date", "clock"]})


def test_joints_of_a_table_are_told_where_columns_are_named_by_them():
    names = {"position": "{}/position", "torque": "{}/effort"}
    check(logs=["logs/*.csv"], variables=names, joints=list("abcdef"))
    with pytest.raises(InputError, match=r"'monitor\.robots\.cell_3\.joints' is for ROS 2 bags"):
        check(logs=["logs/*.csv"], joints=list("abcdef"))


def test_of_two_zones_the_message_says_which():
    with pytest.raises(
        InputError, match=r"\.time_zone' is 'x' \(the zone of times in the logs that name none; allowed"
    ):
        check(time_zone="x")
    with pytest.raises(
        InputError, match=r"'monitor\.time_zone' is 'x' \(the zone in which pages and messages tell times"
    ):
        zone_of("x")


def test_what_is_allowed_passes():
    check(
        units={"time": "ms", "position": "Grad", "torque": "Ampere", "temperature": "K"},
        variables={"torque": SIX, "position": "q", "time": "t", "temperature": ["cabinet"] * 6},
        baseline={"from": "2026-01-01", "until": "2026-02-01"},
        events=[{"time": "2026-01-01", "axes": [6], "kind": "service"}],
    )


@pytest.mark.parametrize(
    ("name", "words"),
    [
        ("+01:00", "'Etc/GMT-1' is this offset all year"),
        ("UTC-5", "'Etc/GMT+5' is this offset all year"),
        ("+05:30", "IANA names"),
        ("CEST", "an abbreviation is no zone: name the place"),
    ],
)
def test_what_is_no_zone_is_told_what_to_give(name, words):
    with pytest.raises(InputError) as told:
        check(time_zone=name)
    assert words in str(told.value)
    for part in str(told.value).split("'"):
        if part.startswith("Etc/"):
            assert zone_of(part) is not None


@pytest.mark.parametrize(
    ("more", "words"),
    [
        ({"baseline": {}}, "has 0 entries, at least 1 (allowed: from, until, windows)"),
        ({"events": None}, "is empty, must be a list"),
        ({"events": [{"time": 1.0}]}, "kind' is missing (allowed: service, sensor, program, acknowledged)"),
        ({"sign": -1}, "is -1, must be a list; one for each axis, as [1, 1, -1, 1, 1, 1]"),
        (
            {"limits": {"coulomb_increase_percent": 0.2}},
            "<= 10000: no axis shows less beside its own scatter); the nearest valid value is 1, or 20 if a share",
        ),
        (
            {"false_alarms_per_1000_h": 1.0e-9},
            "(allowed: >= 0.01 and <= 1000: 0.01 is one in 100,000 h, as many as an arm",
        ),
    ],
)
def test_what_is_allowed_is_said(root, more, words):
    entry = {"logs": ["x"], "robot": str(ROBOT), "baseline": {"windows": 8}, **more}
    config = yaml.safe_load((root / "config/config.yaml").read_text())
    with pytest.raises(InputError) as told:
        prepare({**config, "monitor": {"robots": {"cell": entry}}})
    assert words in str(told.value)


def test_a_name_is_short_enough_for_a_file():
    entry = {"logs": ["logs/*.csv"], "robot": str(ROBOT), "baseline": {"windows": 8}}
    check_robots({"monitor": {"robots": {"x" * 100: entry}}})
    with pytest.raises(InputError, match=r"a name of 300 characters \(allowed: up to 100") as error:
        check_robots({"monitor": {"robots": {"x" * 300: entry}}})
    assert len(str(error.value)) < 200


@pytest.mark.parametrize(("robots", "words"), [(1, "'a0'$"), (2, "'a0' and 'a1'$"), (7, "'a3', 'a4' and 2 more$")])
def test_a_robot_file_that_is_wrong_is_told_with_the_robots_that_have_it(tmp_path, robots, words):
    """Of a joint of a forbidden kind nobody could say whose it was in a fleet."""
    flat = '<joint name="elbow" type="planar"><parent link="base"/><child link="upper"/></joint>'
    (tmp_path / "arm.urdf").write_text(f'<robot name="arm"><link name="base"/><link name="upper"/>{flat}</robot>')
    (tmp_path / "arm.yaml").write_text("name: arm\nurdf: arm.urdf\n")
    sound = {"logs": ["logs/*.csv"], "robot": str(ROBOT), "baseline": {"windows": 8}}
    wrong = {f"a{k}": {**sound, "robot": str(tmp_path / "arm.yaml")} for k in range(robots)}
    told = rf"arm\.urdf: joint 'elbow' \(planar\); only .*arm\.yaml is the robot file of .*{words}"
    with pytest.raises(InputError, match=told) as error:
        check_robots({"monitor": {"robots": {"sound": sound, **wrong}}})
    assert "sound" not in str(error.value)
    assert "\n" not in str(error.value)


@pytest.mark.parametrize(
    ("name", "near"), [("Zelle 3/Arm", "Zelle_3_Arm"), ("3 arm", "robot_3_arm"), ("cell-4", "cell_4"), ("öß", "")]
)
def test_a_name_that_no_robot_may_have_is_told_with_the_nearest_that_it_may(name, near):
    robots = {name: {"logs": ["logs/*.csv"], "robot": str(ROBOT), "baseline": {"windows": 8}}}
    with pytest.raises(InputError) as told:
        check_robots({"monitor": {"robots": robots}})
    assert f"'monitor.robots' has the name '{name}'; a robot's name is letters, digits and _" in str(told.value)
    assert str(told.value).endswith(f"; the nearest valid name is '{near}'" if near else "a letter first")
