"""Entries of discover.datasets: what the schema takes, and robots that other data sets make."""

import pytest

from jointwear.files.errors import InputError
from jointwear.files.schemas import check
from jointwear.running.configuration import config_schema
from jointwear.running.datasets import check_datasets, written_for

PUMA, MEASURED = "config/robots/puma560.yaml", "data/examples/puma560_hidden.nc"


@pytest.mark.parametrize(
    ("entry", "words"),
    [
        ({"measured": MEASURED, "robot": PUMA, "tset": [1]}, r"unknown key 'datasets\.arm\.tset'; did you mean 'test'"),
        ({"measured": MEASURED, "robot": PUMA, "intertial_prior": 0.1}, "did you mean 'inertial_prior'"),
        ({"measured": MEASURED}, r"'datasets\.arm\.robot' is missing"),
        ({"measured": MEASURED, "robot": PUMA, "torque_kind": "moto"}, "did you mean 'motor'"),
        ({"measured": MEASURED, "robot": PUMA, "inertial_prior": -1}, "out of range"),
        ({"measured": MEASURED, "robot": PUMA, "encoder_step": "fine"}, "must be a number"),
    ],
)
def test_wrong_keys_are_named(entry, words):
    with pytest.raises(InputError, match=words):
        check({"datasets": {"arm": entry}}, config_schema()["properties"]["discover"], "config")


def test_every_key_of_the_contract_is_taken():
    entry = {
        "measured": MEASURED,
        "robot": PUMA,
        "variables": {"position": "q"},
        "units": {"position": "rad"},
        "train": [0],
        "test": [1],
        "inertial_prior": 0.05,
        "encoder_step": 4.8e-5,
        "torque_kind": "link_sensor",
        "encoder_side": "link",
        "group": {"monday": [0], "tuesday": [1]},
    }
    check({"datasets": {"arm": entry}}, config_schema()["properties"]["discover"], "config")


def datasets(**robots):
    return {"discover": {"datasets": {name: {"measured": MEASURED, "robot": robot} for name, robot in robots.items()}}}


def test_the_robot_of_another_data_set_is_made_first(root):
    assert written_for("results/discover/first/robot.yaml") == "first"
    assert written_for("./results/discover/first/robot.yaml") == "first"
    assert written_for(PUMA) is None
    check_datasets(datasets(first=PUMA, second="results/discover/first/robot.yaml"))


def test_a_robot_that_nothing_makes_is_named(root):
    with pytest.raises(InputError, match="has no data set 'frist' that would make it; did you mean 'first'"):
        check_datasets(datasets(first=PUMA, second="results/discover/frist/robot.yaml"))


def test_a_robot_file_that_is_not_there_is_told_with_the_nearest(root):
    with pytest.raises(InputError, match=r"robots/puma56\.yaml: no such file; did you mean 'puma560\.yaml'"):
        check_datasets(datasets(first="config/robots/puma56.yaml"))


def test_a_link_in_a_circle_is_told_and_is_no_hint_at_itself(root, tmp_path):
    loop = tmp_path / "loop.csv"
    loop.symlink_to(loop)
    (tmp_path / "loops.csv").touch()
    with pytest.raises(InputError, match=r"loop\.csv: is one of symbolic links that lead in a circle; [^?]*$"):
        check_datasets({"discover": {"datasets": {"arm": {"measured": str(loop), "robot": PUMA}}}})


def test_data_sets_do_not_wait_for_each_other(root):
    with pytest.raises(InputError, match="waits for"):
        check_datasets(datasets(first="results/discover/second/robot.yaml", second="results/discover/first/robot.yaml"))


@pytest.mark.parametrize(
    ("robots", "words"),
    [
        ({"a": "b", "b": "a"}, "'discover.datasets.a.robot' .* data set 'b' makes, which waits for that of 'a'"),
        ({"a": "a"}, "'discover.datasets.a.robot' .* data set 'a' makes, which waits for itself"),
        ({"x": "a", "a": "b", "b": "a"}, "'discover.datasets.x.robot' .* data set 'a' makes, .* that of 'b' and 'a'"),
    ],
)
def test_who_waits_for_whom_is_told(root, robots, words):
    with pytest.raises(InputError, match=words):
        check_datasets(datasets(**{name: f"results/discover/{made}/robot.yaml" for name, made in robots.items()}))


@pytest.mark.parametrize(("name", "near"), [("prüfstand", "pr_fstand"), ("my arm", "my_arm"), ("7", "dataset_7")])
def test_the_name_of_a_data_set_has_a_nearest(name, near):
    entries = {"datasets": {name: {"measured": MEASURED, "robot": PUMA}}}
    with pytest.raises(InputError, match=f"'datasets' has the name '{name}'; .*nearest valid name is '{near}'"):
        check(entries, config_schema()["properties"]["discover"], "config")


@pytest.mark.parametrize(
    ("entry", "words"),
    [
        (
            {"variables": {"positon": "q"}},
            "'discover.datasets.arm.variables' has the role 'positon'; did you mean 'position'",
        ),
        ({"group": {"mon": [0, 1], "tue": [1, 2]}}, "arm.group.tue' holds trajectory 1, and so does 'mon'; allowed"),
        ({"joints": list("abcdef")}, "'discover.datasets.arm.joints' is for ROS 2 bags and says nothing of"),
        ({"topic": "/joint_states"}, "'discover.datasets.arm.topic' is for ROS 2 bags"),
        ({"units": {"torque": "Nn"}}, "'discover.datasets.arm.units.torque' is 'Nn'"),
        (
            {"scale": [1.0, 2.0]},
            r"has 2 values, robot 'puma560' has 6 joints \(allowed: one number for all joints, or 6, one for each\)$",
        ),
        ({"torque_constant": [0.1] * 5}, "one for each.; the nearest valid value is 0.1, for all joints"),
        ({"sign": [1, -1]}, "has 2 values, robot 'puma560' has 6 joints .allowed: 6 values, one for each joint.$"),
        ({"train": [0, 3], "test": [3]}, "arm.test' holds trajectory 3, and so does 'train'; allowed: in one of them"),
        ({"joints": ["one"]}, "'discover.datasets.arm.joints' names 1 joint"),
    ],
)
def test_what_an_entry_tells_of_its_data_is_checked_before_any_job(root, entry, words):
    with pytest.raises(InputError, match=words):
        check_datasets({"discover": {"datasets": {"arm": {"measured": MEASURED, "robot": PUMA, **entry}}}})


def test_a_folder_that_is_no_bag_is_named_with_a_log_in_it(root, tmp_path):
    entry = {"measured": str(tmp_path), "robot": PUMA}
    with pytest.raises(InputError, match=r"arm\.measured' is .*: is a folder without metadata\.yaml, .* name a file$"):
        check_datasets({"discover": {"datasets": {"arm": entry}}})
    (tmp_path / "day.csv").touch()
    with pytest.raises(InputError, match=r"and so no ROS 2 bag; name a file, as '.*/day\.csv'$"):
        check_datasets({"discover": {"datasets": {"arm": entry}}})
    (tmp_path / "metadata.yaml").touch()
    check_datasets({"discover": {"datasets": {"arm": entry}}})
