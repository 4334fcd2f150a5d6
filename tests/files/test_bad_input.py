"""What a user gets wrong is answered in one line: file, key, what is allowed, the nearest valid value."""

import copy
import re

import pytest
import yaml

from jointwear.files.documents import read_yaml
from jointwear.files.errors import InputError
from jointwear.robots.robot import load_robot
from jointwear.robots.robot_file import read_robot_file
from jointwear.robots.task_file import read_task_file
from jointwear.running.configuration import check_experiment, experiment_of, prepare, reading_of


@pytest.fixture
def config(root):
    return read_yaml(root / "config/config.yaml")


def put(data, path, value):
    data = copy.deepcopy(data)
    *parents, last = path.split(".")
    inner = data
    for key in parents:
        inner = inner[int(key) if isinstance(inner, list) else key]
    inner[int(last) if isinstance(inner, list) else last] = value
    return data


def test_the_default_config_is_valid(config, root, monkeypatch):
    monkeypatch.chdir(root)
    prepared = prepare(config)
    check_experiment(prepared)
    assert prepared["wear"]["increase_percent"] == [10.0, 20.0]
    assert isinstance(prepared["sampling"]["interval"], float)
    assert "onset_rule" in reading_of(prepared, "detection")


def test_number_types_do_not_matter(config):
    assert prepare(put(config, "wear.shape", 2)) == prepare(put(config, "wear.shape", 2.0))
    assert prepare(put(config, "noise.encoder", "1e-4")) == prepare(put(config, "noise.encoder", 1e-4))


def test_the_experiment_is_the_same_whatever_is_monitored(config):
    more = {"monitor": {"robots": {"arm": MONITORED}}, "discover": {"datasets": {"x": {"measured": "a", "robot": "b"}}}}
    assert experiment_of(prepare({**config, **more})) == experiment_of(prepare(config))
    assert not {"monitor", "discover"} & experiment_of(prepare(config)).keys()


MONITORED = {"logs": ["1"], "robot": "config/robots/puma560.yaml", "baseline": {"windows": 8}}


@pytest.mark.parametrize(
    ("key", "value"),
    [
        ("logs", ["1"]),
        ("joints", ["1", "2", "3", "4", "5", "6"]),
        ("variables", {"position": ["1", "2", "3", "4", "5", "6"], "time": "0"}),
        ("units", {"time": "1"}),
        ("topic", "4711"),
        ("program", {"columns": ["7"]}),
        ("program", {"columns": "7"}),
        ("program", {"logs": {"*": "12", "b*": "0815"}}),
        ("events", [{"time": "20260201", "kind": "service", "note": "4711"}]),
        ("events", [{"time": "2026-02-01", "kind": "service", "note": "0815"}]),
        ("baseline", {"until": "20260115"}),
        ("window", "3600"),
    ],
)
def test_text_that_looks_like_a_number_stays_text_where_text_is_allowed(config, key, value):
    """A serial number, a column of a CSV file, a day without hyphens."""
    prepared = prepare({**config, "monitor": {"robots": {"arm": {**MONITORED, key: value}}}})
    assert prepared["monitor"]["robots"]["arm"][key] == value


def test_the_names_of_a_data_set_may_look_like_numbers(config):
    entry = {"measured": "1", "robot": "2", "topic": "3", "joints": ["4"], "variables": {"position": ["5", "6"]}}
    assert prepare({**config, "discover": {"datasets": {"x": entry}}})["discover"]["datasets"]["x"] == entry


@pytest.mark.parametrize("text", ["5e4", "5E4", "+5.e+4", "5.0e4"])
def test_what_snakemake_reads_as_text_is_a_number_where_one_is_allowed(config, text):
    """Of a file that Snakemake has read, 5e4 without quotation marks arrives as text."""
    given = {**MONITORED, "window": text, "baseline": {"until": text}, "scale": text, "torque_constant": [text] * 6}
    entry = prepare({**config, "monitor": {"robots": {"arm": given}}})["monitor"]["robots"]["arm"]
    assert entry["window"] == entry["baseline"]["until"] == entry["scale"] == 50000.0
    assert entry["torque_constant"] == [50000.0] * 6
    assert not isinstance(entry["window"], str)


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("replicates: '120'", "'replicates' is '120', must be a whole number (allowed: >= 1"),
        ("replicates: '120'", "; the nearest valid value is 120"),
        ("wear: {increase_percent: [10, '5e1']}", "'wear.increase_percent[1]' is '5e1', must be a number"),
        ("wear: {increase_percent: [10, '5e1']}", "; the nearest valid value is 50"),
    ],
)
def test_a_number_in_quotation_marks_is_refused_in_a_configuration_as_in_a_robot_file(tmp_path, config, text, words):
    """In the file as it was written: 5e4 without them is a number."""
    (tmp_path / "my.yaml").write_text(text)
    with pytest.raises(InputError) as refused:
        prepare(config, [tmp_path / "my.yaml"])
    assert str(refused.value).startswith(f"{tmp_path / 'my.yaml'}: ")
    assert words in str(refused.value)
    (tmp_path / "my.yaml").write_text(text.replace("'", ""))
    prepare(config, [tmp_path / "my.yaml"])


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        ("mass: 3.0", "mass: 1.0e+308", "(allowed: <= 100000); the nearest valid value is 100000"),
        ("mass: 3.0", "mass: -1.0e+308", "(allowed: >= 0); the nearest valid value is 0"),
        ("d: 0.0", "d: -1.0e+19", "(allowed: >= -100); the nearest valid value is -100"),
        ("name: only", "name: ''", "'joints[0].name' is '', which is blank (allowed: 1 to 100); the nearest valid"),
        ("name: only", "name: ' '", "'joints[0].name' is ' ', which is blank (allowed: 1 to 100); the nearest valid"),
        (
            "name: only",
            f"name: {'x' * 100_000}",
            "'joints[0].name' has 100000 characters (allowed: 1 to 100); the near",
        ),
    ],
)
def test_a_robot_file_names_the_limit_of_the_key(tmp_path, old, new, words):
    text = (
        "name: x\ndh:\n  - {d: 0.0, a: 1.0, alpha: 0.0}\nlinks:\n"
        "  - {mass: 3.0, com: [-0.5, 0, 0], inertia: [0.1, 0.3, 0.3, 0, 0, 0]}\njoints:\n"
        "  - {name: only, limits: [-1, 1]}\n"
    )
    (tmp_path / "x.yaml").write_text(text)
    read_robot_file(tmp_path / "x.yaml")
    (tmp_path / "x.yaml").write_text(text.replace(old, new))
    with pytest.raises(InputError) as refused:
        read_robot_file(tmp_path / "x.yaml")
    assert words in str(refused.value)
    assert len(str(refused.value)) < 400


def test_text_that_holds_a_number_is_one_where_no_text_is_allowed(config):
    prepared = prepare(put(put(config, "replicates", "120"), "wear.increase_percent", ["10", ".5"]))
    assert prepared["replicates"] == 120
    assert isinstance(prepared["replicates"], int)
    assert prepared["wear"]["increase_percent"] == [10.0, 0.5]


@pytest.mark.parametrize(
    ("path", "value", "words"),
    [
        ("replicate", 5, ["unknown key 'replicate'", "did you mean 'replicates'"]),
        ("detection.confidense", 0.9, ["'detection.confidense'", "did you mean 'confidence'"]),
        ("detection.confidence", "high", ["'detection.confidence'", "'high'", "must be a number"]),
        ("detection.confidence", 1.5, ["'detection.confidence'", "1.5", "nearest valid value is 0.99999"]),
        ("detection.confidence", 95, ["nearest valid value is 0.99999, or 0.95 if 95 % is meant"]),
        ("detection.confidence", "95 %", ["must be a number", "nearest valid value is 0.95"]),
        ("noise.encoder", "0,001", ["must be a number (allowed: >= 0 and <= 0.1)"]),
        ("noise.encoder", "0,05", ["must be a number", "nearest valid value is 0.05"]),
        ("wear.increase_percent", ["10%"], ["must be a number", "nearest valid value is 10"]),
        ("replicates", 0, ["'replicates'", "nearest valid value is 1"]),
        ("replicates", 2.5, ["'replicates'", "whole number"]),
        ("seed", -1, ["'seed'", ">= 0"]),
        ("tasks", ["T1", "T1"], ["'tasks'", "'T1' twice"]),
        ("tasks", [], ["'tasks'", "at least 1"]),
        ("wear.axes", [1, 1], ["'wear.axes'", "1 twice"]),
        ("wear.axes", ["one"], ["'wear.axes[0]'", "whole number"]),
        ("wear.axes", 2, ["'wear.axes' is 2, must be a list", "nearest valid value is [2]"]),
        ("tasks", "T1", ["'tasks' is 'T1', must be a list", "nearest valid value is ['T1']"]),
        ("detection.confidence", "1:1", ["must be a number (allowed: >= 0.5 and <= 0.99999)"]),
        ("wear.shape", -2, ["'wear.shape'", "nearest valid value is 0.1"]),
        ("reading.onset_rule", "sometimes", ["'reading.onset_rule'", "allowed: consecutive_hours, single_hour"]),
        ("reading.onsetrule", "single_hour", ["'reading.onsetrule'", "did you mean 'onset_rule'"]),
        ("reading.kl_direction", "hour_from_referense", ["did you mean 'hour_from_reference'"]),
        ("report.replicate", 1000, ["'report.replicate'", "nearest valid value is 100"]),
        ("sampling.samples", 600, ["'sampling'", "3600 s"]),
    ],
)
def test_a_wrong_config(config, path, value, words):
    with pytest.raises(InputError) as error:
        prepare(put(config, path, value))
    message = str(error.value)
    assert "\n" not in message
    for word in words:
        assert word in message


@pytest.mark.parametrize(
    ("path", "value", "words"),
    [
        ("wear.axes", [7], ["'wear.axes' holds 7", "axes 1 to 6", "nearest valid value is 6"]),
        ("tasks", ["T9"], ["'T9'", "did you mean", "T1, T2, T3"]),
        ("robot", "config/robots/puma561.yaml", ["'robot' is", "no such file", "did you mean 'puma560.yaml'"]),
    ],
)
def test_a_config_that_does_not_fit_its_files(config, root, monkeypatch, path, value, words):
    monkeypatch.chdir(root)
    with pytest.raises(InputError) as error:
        check_experiment(prepare(put(config, path, value)))
    for word in words:
        assert word in str(error.value)


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("a: 1\na: 2\n", ["line 2", "'a' is given twice"]),
        ("a: [1\n", ["line"]),
        ("a:\n\tb: 1\n", ["line 2: begins with a tab; YAML is indented with spaces"]),
        ("- 1\n", ["must be a mapping"]),
        ("a: 1\n---\nb: 1\n", ["begins another document; one file holds one"]),
        ("a:\n  b [1]\n  c: 1\n", ["line 2: is no 'key: value'; a colon and a space follow the key"]),
    ],
)
def test_a_broken_yaml_file(tmp_path, text, words):
    path = tmp_path / "x.yaml"
    path.write_text(text)
    with pytest.raises(InputError) as error:
        read_yaml(path)
    assert "\n" not in str(error.value)
    for word in ["x.yaml", *words]:
        assert word in str(error.value)


@pytest.fixture
def robot(root):
    return read_yaml(root / "config/robots/puma560.yaml")


@pytest.mark.parametrize(
    ("path", "value", "words"),
    [
        ("joints.0.coulomb.positive", -0.4, ["joints[0].coulomb.positive", "-0.4", ">= 0"]),
        ("joints.2.coulomb.negative", 0.1, ["joints[2].coulomb.negative", "0.1", "<= 0"]),
        ("links.1.mass", -3.9, ["links[1].mass", "-3.9", ">= 0", "without its sign it is 3.9"]),
        ("links.1.com", [-170, 0, 0], ["'links[1].com' is [-170, 0, 0], in m; this looks like mm: [-0.17, 0, 0]"]),
        ("name", "ABB IRB 120/0.58", ["letters, digits, _ and -", "nearest valid value is 'ABB_IRB_120_0_58'"]),
        ("inertia_check", False, ["'inertia_check' is false, must be text (allowed: full, none); YAML reads"]),
        ("joints.0.gearratio", 3, ["'joints[0].gearratio'", "did you mean 'gear_ratio'"]),
        ("joints.1.gear_ratio", 0, ["'joints[1].gear_ratio' is 0"]),
        ("joints.1.limits", [-45, 225], ["'joints[1].limits'", "looks like degrees: [-0.785398, 3.92699]"]),
        ("joints.1.gear_ratio", "80:1", ["must be a number", "nearest valid value is 80"]),
        ("joints.1.gear_ratio", "-76.5 : 1", ["nearest valid value is -76.5"]),
        ("joints.1.limits", [1, -1], ["lower limit must come first"]),
        ("joints.1.name", "joint_1", ["'joints[1].name'", "earlier joint"]),
        ("dh.0.alpha", 90, ["dh[0].alpha", "6.28", "looks like degrees: 1.5708"]),
        ("links.1.mass", -1, ["links[1].mass", ">= 0"]),
        ("links.1.inertia", [1, 2, 3], ["links[1].inertia", "3 entries", "allowed: 6 (xx yy zz xy yz xz"]),
        ("links.1.inertia", [1, 1, 1, 2, 0, 0], ["links[1].inertia", "negative principal moments"]),
        ("links", [], ["'links' has 0 entries, 'dh' has 6"]),
        ("payload.mass", "heavy", ["payload.mass", "'heavy'"]),
        ("gravity", 9.81, ["'gravity'", "a list"]),
        ("urdf", "a.urdf", ["either as 'dh'"]),
        ("effects", [{"effect": "payload", "axis": 7}], ["effects[0].axis", "1 to 6", "nearest valid value is 6"]),
        ("colour", "red", ["unknown key 'colour'"]),
        ("convention", "modified", ["unknown key 'convention'", "'dh' is a standard DH table", "allowed: name"]),
        ("dh.1.sigma", 1, ["unknown key 'dh[1].sigma'", "every joint is revolute"]),
        ("joints.1.type", "prismatic", ["unknown key 'joints[1].type'", "every joint is revolute"]),
    ],
)
def test_a_wrong_robot_file(tmp_path, robot, path, value, words):
    file = tmp_path / "arm.yaml"
    file.write_text(yaml.safe_dump(put(robot, path, value)))
    with pytest.raises(InputError) as error:
        read_robot_file(file)
    message = str(error.value)
    assert "\n" not in message
    for word in ["arm.yaml", *words]:
        assert word in message


def test_a_decimal_comma_between_braces_is_told_with_the_value_that_it_ends(tmp_path, robot):
    (tmp_path / "arm.yaml").write_text(yaml.safe_dump(robot, sort_keys=False).replace("mass: 4.8", "mass: 4\n  8:"))
    with pytest.raises(InputError, match=r"'links\[2\]\.8'; a comma ends the value of 'mass', 4: write its decimals"):
        read_robot_file(tmp_path / "arm.yaml")


@pytest.mark.parametrize("after", ["      window: 1h\n", "      variables:\n        time: Time\n", "    two: {}\n", ""])
def test_a_colon_without_its_space_is_told_on_its_own_line(tmp_path, after):
    """The parser notices at the next line only, and says in its words what is wrong there."""
    file = tmp_path / "plant.yaml"
    file.write_text(f"monitor:\n  robots:\n    one:\n      logs: [a.csv]\n      robot:arm.yaml\n{after}")
    with pytest.raises(InputError, match=r"plant.yaml: line 5: is no 'key: value'; a space follows the colon$"):
        read_yaml(file)


URDF = """<robot name="two"><link name="base"/><link name="a"><inertial><mass value="1"/>
<inertia ixx="0.1" iyy="0.1" izz="0.1" ixy="0" ixz="0" iyz="0"/></inertial></link><link name="b"/>
<joint name="first" type="revolute"><parent link="base"/><child link="a"/>
<limit lower="-1" upper="1" effort="5" velocity="2"/><dynamics damping="0.2" friction="0.3"/></joint>
<joint name="second" type="continuous"><parent link="a"/><child link="b"/></joint></robot>"""


def test_a_urdf_brings_limits_and_friction_and_the_robot_file_overrides(tmp_path):
    (tmp_path / "two.urdf").write_text(URDF)
    (tmp_path / "two.yaml").write_text("name: two\nurdf: two.urdf\njoints:\n  - {name: first, viscous: 0.9}\n")
    robot = load_robot(tmp_path / "two.yaml")
    assert robot.joint_names == ("first", "second")
    assert robot.viscous.tolist() == [0.9, 0]
    assert robot.coulomb_positive.tolist() == [0.3, 0]
    assert robot.torque_limit[0] == 5
    assert robot.lower[0] == -1


@pytest.mark.parametrize(
    ("yaml_text", "urdf", "words"),
    [
        ("name: x\nurdf: none.urdf\n", URDF, ["none.urdf", "does not exist"]),
        ("name: x\nurdf: tow.udrf\n", URDF, ["tow.udrf", "does not exist", "did you mean 'two.urdf'"]),
        ("name: x\nurdf: two.urdf\n", "<robot", ["two.urdf", "not valid XML"]),
        ("name: x\nurdf: two.urdf\njoints: [{name: frist}]\n", URDF, ["'frist'", "did you mean 'first'"]),
        (
            "name: x\nurdf: two.urdf\njoints: [{name: first}, {name: first, viscous: 1}]\n",
            URDF,
            ["'joints[1].name' is 'first'", "an earlier joint has"],
        ),
        ("name: x\nurdf: two.urdf\n", URDF.replace("continuous", "prismatic"), ["'second' (prismatic)", "fixed"]),
        ("name: x\nurdf: two.urdf\nlinks: []\n", URDF, ["'links' is only for robots given by 'dh'"]),
    ],
)
def test_a_wrong_urdf(tmp_path, yaml_text, urdf, words):
    (tmp_path / "two.urdf").write_text(urdf)
    (tmp_path / "x.yaml").write_text(yaml_text)
    with pytest.raises(InputError) as error:
        read_robot_file(tmp_path / "x.yaml")
    for word in words:
        assert word in str(error.value)


TASK = {"name": "T9", "unit": "deg", "waypoints": [[0.0] * 6, [10.0] * 6], "durations": [30, 30]}


@pytest.mark.parametrize(
    ("path", "value", "words"),
    [
        ("waypoints.1.0", 170.0, ["'waypoints[1][0]' is 170 deg", "-160 to 160 deg", "nearest valid value is 160"]),
        ("waypoints.1", [0.0] * 5, ["'waypoints[1]' has 5 positions", "6 joints"]),
        ("durations", [30], ["'durations' has 1 entry"]),
        ("durations", [30, 31], ["whole number of cycles", "nearest valid value"]),
        ("durations", [30, -30], ["'durations[1]'", ">= 0.001"]),
        ("phase", 60, ["'phase' is 60", "below the cycle"]),
        ("name", "T8", ["'name' is 'T8'", "must be 'T9'"]),
        ("unit", "degrees", ["'unit'", "allowed: rad, deg"]),
        ("wayponts", [], ["did you mean 'waypoints'"]),
    ],
)
def test_a_wrong_task_file(tmp_path, root, path, value, words):
    file = tmp_path / "T9.yaml"
    file.write_text(yaml.safe_dump(put(TASK, path, value)))
    with pytest.raises(InputError) as error:
        read_task_file(file, read_robot_file(root / "config/robots/puma560.yaml"))
    message = str(error.value)
    assert "\n" not in message
    for word in ["T9.yaml", *words]:
        assert word in message


@pytest.mark.parametrize("cycle", [37.0, 61.0, 7.3, 3601.0, 0.0071])
def test_the_cycle_that_is_named_as_the_nearest_is_taken(tmp_path, cycle):
    file = tmp_path / "T9.yaml"
    file.write_text(yaml.safe_dump(TASK | {"durations": [cycle * 0.4, cycle * 0.6]}))
    with pytest.raises(InputError, match="a whole number of cycles must fit an hour") as error:
        read_task_file(file)
    named = float(re.search(r"nearest valid value is (\S+) s", str(error.value))[1])
    file.write_text(yaml.safe_dump(TASK | {"durations": [round(named * 0.4, 5), round(named * 0.6, 5)]}))
    assert read_task_file(file)["durations"][0] == pytest.approx(0.4 * named, abs=1e-5)
