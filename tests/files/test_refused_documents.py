"""Documents that would be believed though they are broken: numbers, sizes, kinds of files, values in messages."""

import json
import os

import numpy as np
import pytest
import yaml

from jointwear.files.documents import read_yaml
from jointwear.files.errors import InputError, shown
from jointwear.files.json_documents import read_json, write_json
from jointwear.files.numbers import LARGEST
from jointwear.files.schemas import check
from jointwear.reproduction.features import histograms
from jointwear.robots.robot_file import read_robot_file
from jointwear.robots.task_file import read_task_file
from jointwear.robots.trajectory import load_task
from jointwear.running.configuration import prepare

NOT_FINITE = [".nan", ".inf", "-.inf", "1e999", "1" + "0" * 400, "1.0e+308", "-1.0e+19"]


def put(text, path, value):
    """Return YAML text with the value of a dotted path replaced by `value` as it is."""
    data = yaml.safe_load(text)
    *parents, last = [int(k) if k.isdigit() else k for k in path.split(".")]
    inner = data
    for key in parents:
        inner = inner[key]
    inner[last] = "PLACE"
    return yaml.safe_dump(data).replace("PLACE", value)


@pytest.mark.parametrize("number", NOT_FINITE)
@pytest.mark.parametrize(
    "path",
    [
        "noise.disturbance_share",
        "noise.encoder",
        "noise.time_step",
        "wear.shape",
        "wear.increase_percent.0",
        "detection.confidence",
        "detection.variance_share",
        "sampling.interval",
        "seed",
        "replicates",
    ],
)
def test_no_number_of_the_configuration_may_be_infinite(tmp_path, root, path, number):
    text = put((root / "config/config.yaml").read_text(), path, number)
    (tmp_path / "config.yaml").write_text(text)
    with pytest.raises(InputError) as error:
        read_yaml(tmp_path / "config.yaml")
    last = path.replace(".0", "[0]")
    assert f"'{last}' is" in str(error.value)
    assert len(str(error.value)) < 300
    # What comes by --config is read by Snakemake; the same check holds.
    with pytest.raises(InputError, match="config: "):
        prepare(yaml.safe_load(text))


@pytest.mark.parametrize("number", NOT_FINITE)
@pytest.mark.parametrize(
    "path",
    [
        "gravity.2",
        "dh.0.d",
        "dh.1.a",
        "dh.0.alpha",
        "links.1.mass",
        "links.1.com.0",
        "links.1.inertia.0",
        "joints.0.viscous",
        "joints.0.motor_inertia",
        "joints.0.gear_ratio",
        "joints.0.coulomb.positive",
        "joints.0.torque_limit",
        "joints.0.limits.0",
        "payload.mass",
    ],
)
def test_no_number_of_a_robot_may_be_infinite(tmp_path, root, path, number):
    (tmp_path / "arm.yaml").write_text(put((root / "config/robots/puma560_paper.yaml").read_text(), path, number))
    with pytest.raises(InputError, match=r"arm\.yaml: '"):
        read_robot_file(tmp_path / "arm.yaml")


@pytest.mark.parametrize("number", NOT_FINITE)
@pytest.mark.parametrize("path", ["phase", "durations.0", "waypoints.0.0"])
def test_no_number_of_a_task_may_be_infinite(tmp_path, root, path, number):
    data = yaml.safe_load((root / "config/tasks/T1.yaml").read_text())
    data.setdefault("phase", 0.0)
    (tmp_path / "T1.yaml").write_text(put(yaml.safe_dump(data), path, number))
    with pytest.raises(InputError, match=r"T1\.yaml: '"):
        read_task_file(tmp_path / "T1.yaml")


def test_waypoints_of_different_length_are_refused_without_a_robot_too(tmp_path):
    (tmp_path / "T9.yaml").write_text("name: T9\nwaypoints: [[0, 0], [1]]\ndurations: [30, 30]\n")
    with pytest.raises(InputError, match=r"'waypoints\[1\]' has 1 position,"):
        load_task(tmp_path / "T9.yaml")


def test_a_torque_that_is_not_finite_has_no_histogram(default_reading):
    torque = np.zeros((1, 1, 4, 1))
    torque[0, 0, 0] = np.nan
    with pytest.raises(InputError, match="not finite"):
        histograms(torque, np.ones((1, 1, 1)), 12, default_reading)


def bomb(levels=9):
    lines = ["a0: &a0 [1, 1, 1, 1, 1, 1, 1, 1, 1, 1]"]
    lines += [f"a{i}: &a{i} [{', '.join([f'*a{i - 1}'] * 10)}]" for i in range(1, levels)]
    return "\n".join(lines)


@pytest.mark.parametrize(
    ("text", "words"),
    [
        (bomb(), ["line 6", "more than 200000 values"]),
        ("a: &x\n  b: *x\n", ["line 1", "an anchor holds itself"]),
        ("a: &x [*x]\n", ["line 1", "an anchor holds itself"]),
        ("a: " + "[" * 80 + "]" * 80, ["more than 50 levels"]),
        ("a: " + "[" * 100_000, ["more than 50 levels"]),
        ("a0: &a0 [1]\n" + "".join(f"a{i}: &a{i} [*a{i - 1}]\n" for i in range(1, 2000)), ["levels deep, aliases"]),
        ("? [a, b]\n: 1\n", ["line 1", "a key must be text"]),
        ("a: 2026-13-45\n", ["not valid YAML"]),
        ("a: !!int text\n", ["line 1", "'text'"]),
        ("a: !!python/object/apply:os.system [true]\n", ["line 1"]),
        ("a: 1" + "0" * 5000, ["not valid YAML"]),
        ("a: '\x00'\n", ["x.yaml"]),
        ("a: " + "x" * 5_000_000, ["5000003 bytes", "at most 4194304"]),
        ("<<: 1\n", ["line 1"]),
    ],
)
def test_a_yaml_file_out_of_proportion_is_refused_at_once(tmp_path, text, words):
    (tmp_path / "x.yaml").write_text(text)
    with pytest.raises(InputError) as error:
        read_yaml(tmp_path / "x.yaml")
    assert str(error.value).isprintable()
    for word in words:
        assert word in str(error.value)


@pytest.mark.parametrize("number", ["010", "1:30", "-1:30:05.5", "1_000", "0x1F", "0b11", "1_0.5", "007"])
def test_a_number_that_readers_of_yaml_disagree_on_is_refused(tmp_path, number):
    (tmp_path / "x.yaml").write_text(f"b: 1\na: {number}\n")
    with pytest.raises(InputError, match=r"line 2: .* decimal digits"):
        read_yaml(tmp_path / "x.yaml")
    (tmp_path / "x.yaml").write_text(f"a: '{number}'\nb: [0, -0.5, +3, 1., 1e-4, 2.5E+3]\n")
    assert read_yaml(tmp_path / "x.yaml") == {"a": number, "b": [0, -0.5, 3, 1.0, 1e-4, 2500.0]}


def test_digits_of_other_scripts_are_text(root):
    config = yaml.safe_load((root / "config/config.yaml").read_text())
    for text in ("٣", "3\n", "³"):
        with pytest.raises(InputError, match="'seed' is"):
            prepare({**config, "seed": text})


def test_only_regular_files_are_opened(tmp_path):
    os.mkfifo(tmp_path / "pipe.yaml")
    (tmp_path / "loop.yaml").symlink_to(tmp_path / "loop.yaml")
    (tmp_path / "folder.yaml").mkdir()
    for name, words in (
        ("pipe.yaml", "is a named pipe"),
        ("loop.yaml", "symbolic links"),
        ("folder.yaml", "is a folder"),
        ("a\x00b.yaml", r"a\\x00b\.yaml: is no path"),
        ("x" * 300 + ".yaml", "name too long"),
    ):
        with pytest.raises(InputError, match=f"(?i){words}"):
            read_yaml(tmp_path / name)


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("{", "cannot be read as JSON"),
        ('{"a": NaN}', "holds NaN"),
        ('{"a": -Infinity}', "Infinity"),
        ('{"a": 1e999}', "not finite"),
        ("[1]", "must hold a mapping, holds list"),
        ("[" * 100_000, "nested too deeply"),
    ],
)
def test_json_is_read_by_one_reader_with_one_line(tmp_path, text, words):
    (tmp_path / "x.json").write_text(text)
    with pytest.raises(InputError, match=words) as error:
        read_json(tmp_path / "x.json")
    assert "x.json" in str(error.value)
    (tmp_path / "x.json").write_text(json.dumps({"a": [1, 2.5, None]}))
    assert read_json(tmp_path / "x.json") == {"a": [1, 2.5, None]}


CONTENT = {"a": [1, 2.5, None, float("nan"), np.float32(0.1)], "b": {"c": "Bühne <1>", 2: True}, "n": np.arange(2)}


def test_what_was_written_is_read_and_is_json(tmp_path):
    write_json(tmp_path / "x.json", CONTENT)
    assert "NaN" not in (tmp_path / "x.json").read_text(encoding="utf-8")
    found = read_json(tmp_path / "x.json")
    assert found == {"a": [1, 2.5, None, None, float(np.float32(0.1))], "b": {"c": "Bühne <1>", "2": True}, "n": [0, 1]}
    # The layout of the file is no part of its content.
    text = (tmp_path / "x.json").read_text(encoding="utf-8")
    (tmp_path / "x.json").write_text(json.dumps(json.loads(text)), encoding="utf-8")
    assert read_json(tmp_path / "x.json") == found


def test_no_flipped_bit_of_a_json_file_is_believed(tmp_path):
    path = tmp_path / "x.json"
    write_json(path, CONTENT)
    whole, found = path.read_bytes(), read_json(path)
    for place in range(len(whole)):
        for bit in range(8):
            path.write_bytes(whole[:place] + bytes([whole[place] ^ 1 << bit]) + whole[place + 1 :])
            try:
                read = read_json(path)
            except InputError:
                continue
            # Blanks between the values, or the name of the checksum itself.
            assert {key: read[key] for key in found} == found


def test_a_number_changed_by_hand_is_found(tmp_path):
    write_json(tmp_path / "x.json", CONTENT)
    (tmp_path / "x.json").write_text((tmp_path / "x.json").read_text().replace("2.5", "2.6"))
    with pytest.raises(InputError, match=r"x\.json: was changed or damaged since it was written; delete it and run"):
        read_json(tmp_path / "x.json")


def test_values_are_cut_and_stay_on_one_line(root):
    schema = {"type": "object", "properties": {"a": {"type": "number"}}, "additionalProperties": False}
    for data in ({"a": "x" * 10_000}, {"y" * 10_000: 1}, {"a": list(range(10_000))}, {"a": "one\ntwo\x1b[31m"}):
        with pytest.raises(InputError) as error:
            check(data, schema, "x.yaml")
        assert len(str(error.value)) < 250
        assert str(error.value).isprintable()
    assert shown(10**5000).startswith("a int of") or len(shown(10**5000)) <= 80
    assert len(str(InputError("x" * 10_000))) <= 2000


def test_the_largest_number_allowed_is_allowed(tmp_path):
    (tmp_path / "x.yaml").write_text(f"a: {LARGEST:.1f}\nb: -1000000000000000000\n")
    assert read_yaml(tmp_path / "x.yaml")["a"] == LARGEST


@pytest.mark.parametrize(
    ("entry", "words"),
    [
        (None, "'discover.datasets.x' is empty, must be a mapping"),
        ({}, r"'discover.datasets.x.measured' is missing"),
        ({"measured": 5, "robot": "a"}, "must be text"),
        ({"measured": "a", "robot": "b", "inertial_prior": -1}, "out of range"),
        ({"measured": "a", "robot": "b", "trian": [1]}, "did you mean 'train'"),
    ],
)
def test_a_wrong_data_set_is_named_before_any_job(root, entry, words):
    config = yaml.safe_load((root / "config/config.yaml").read_text())
    with pytest.raises(InputError, match=words):
        prepare({**config, "discover": {"datasets": {"x": entry}}})
    with pytest.raises(InputError, match="a name is letters, digits"):
        prepare({**config, "discover": {"datasets": {"../x": {"measured": "a", "robot": "b"}}}})


def test_a_configuration_that_holds_itself_is_refused(root):
    config = yaml.safe_load((root / "config/config.yaml").read_text())
    config["wear"]["axes"] = config["wear"]
    with pytest.raises(InputError, match="holds itself"):
        prepare(config)


@pytest.mark.parametrize(
    ("key", "meaning"), [("on", "true"), ("no", "false"), ("null", "nothing"), ("~", "nothing"), ("Yes", "true")]
)
def test_a_name_that_yaml_takes_for_a_value_needs_quotation_marks(tmp_path, key, meaning):
    path = tmp_path / "plant.yaml"
    path.write_text(f"monitor:\n  robots:\n    {key}: {{}}\n")
    with pytest.raises(InputError, match=f"line 3: YAML reads '{key}' as {meaning}; put a name between quotation"):
        read_yaml(path)
    path.write_text(f"monitor:\n  robots:\n    '{key}': {{}}\n")
    assert read_yaml(path)["monitor"]["robots"] == {key: {}}


def test_a_number_in_place_of_bodies_is_one_line(root, tmp_path):
    content = yaml.safe_load((root / "config/robots/puma560.yaml").read_text()) | {"links": 3}
    (tmp_path / "arm.yaml").write_text(yaml.safe_dump(content))
    with pytest.raises(InputError, match="'links' is 3, must be a list"):
        read_robot_file(tmp_path / "arm.yaml")
