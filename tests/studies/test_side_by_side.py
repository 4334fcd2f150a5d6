"""The paper, its text at its word and the closest experiment: what is compared, and as which experiments they run."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest
import yaml
from small_experiment import small_experiment

from jointwear.files.text_files import replace_text
from jointwear.reproduction.readings import ambiguities
from jointwear.robots.robot_file import read_robot_file
from jointwear.robots.task_file import read_task_file
from jointwear.running.configuration import prepare
from jointwear.studies.joint_fit.detection import PcaReading
from jointwear.studies.joint_fit.paper_fit import JointExperiment
from jointwear.studies.joint_fit.pose_search import Arm
from jointwear.studies.joint_fit.records import write_experiments
from jointwear.studies.recovery.export import robot_data, task_data, write_yaml
from jointwear.studies.side_by_side.experiments import write_closest
from jointwear.studies.side_by_side.figures import draw_hours
from jointwear.studies.side_by_side.summary import COMPARED, as_printed, beside, changed_readings, write_chapter

ROOT = Path(__file__).resolve().parents[2]
LITERAL = ROOT / "config/examples/literal.yaml"


def test_the_literal_reading_is_a_configuration_of_its_own():
    layers = [yaml.safe_load(path.read_text(encoding="utf-8")) for path in (ROOT / "config/config.yaml", LITERAL)]
    assert list(layers[1]) == ["reading"]
    config = prepare({**layers[0], "reading": {**layers[0]["reading"], **layers[1]["reading"]}})
    assert config["reading"]["cross_correlation"] == "means_removed"
    # Every point of it departs from the default, or the file would say nothing.
    changed = changed_readings(LITERAL)
    assert [c["name"] for c in changed] == list(layers[1]["reading"])
    # What the text is silent on stays.
    assert all("does not say" not in c["paper"] for c in changed)


def test_the_closest_experiment_runs_as_any_other(tmp_path):
    zeros = np.zeros((3, 6))
    experiment = JointExperiment(
        Arm(3.0, 0.1, 0.87654), PcaReading("centred", "four", 8), zeros, zeros + 0.5, np.full(3, 2.0), np.zeros(3)
    )
    write_experiments(tmp_path / "checked.nc", [experiment], "test", {})
    unloaded = ROOT / "config/robots/puma560.yaml"
    payload = robot_data(unloaded, ("mass", "com_x", "com_y", "com_z"), (3.0, 0.0, 0.0, 0.1), "puma560_joint")
    write_yaml(tmp_path / "robot.yaml", payload)
    write_yaml(tmp_path / "T1.yaml", task_data("T1", zeros[0], zeros[0] + 0.5, 30.0, 2.0))
    base = {a.name: a.default for a in ambiguities().values()}
    path = tmp_path / "run/config/config.yaml"
    write_closest(tmp_path / "checked.nc", tmp_path / "robot.yaml", [tmp_path / "T1.yaml"], base, path)
    own = yaml.safe_load(path.read_text(encoding="utf-8"))
    assert own["wear"] == {"shape": 0.8765}
    assert own["detection"] == {"consecutive_hours": 8}
    assert {c["name"] for c in changed_readings(path)} == {"scaling", "components"}
    assert read_robot_file(tmp_path / "run" / own["robot"])["payload"]["mass"] == 3.0
    assert read_task_file(tmp_path / "run/config/tasks/T1.yaml")["durations"] == [30.0, 30.0]


def test_rows_of_two_experiments_stand_beside_each_other():
    first = [{"axis": 1, "published": 5.0, "hour": 6.0}, {"axis": 2, "published": None, "hour": None}]
    second = [{**row, "hour": 7.0} for row in first]
    assert beside({"literal": first, "closest": second}, ("axis",), "hour") == [
        {"axis": 1, "published": 5.0, "literal": 6.0, "closest": 7.0},
        {"axis": 2, "published": None, "literal": None, "closest": 7.0},
    ]
    with pytest.raises(ValueError, match="cells of two experiments differ"):
        beside({"literal": first, "closest": second[::-1]}, ("axis",), "hour")


def test_a_cell_that_few_replicates_detect_has_no_hour():
    assert as_printed({"detection_probability": 0.4, "hour_median": 90.0})["hour_median"] is None
    assert as_printed({"detection_probability": 0.5, "hour_median": 90.0})["hour_median"] == 90.0
    assert as_printed({"reproduced": 3}) == {"reproduced": 3}


def test_the_chapter_quotes_the_tables_of_both(tmp_path):
    done = small_experiment()
    folders = {}
    for name in ("literal", "closest"):
        folder = tmp_path / name
        (folder / "results").mkdir(parents=True)
        (folder / "results/tables").symlink_to(Path(done.path("tables", "x")).parent)
        (folder / "config").mkdir()
        replace_text(folder / "config/config.yaml", "reading: {cross_correlation: means_removed}\n")
        folders[name] = folder
    write_chapter(folders, tmp_path / "chapter.json")
    chapter = json.loads((tmp_path / "chapter.json").read_text(encoding="utf-8"))
    assert set(chapter["tables"]) == set(COMPARED)
    assert len(chapter["tables"]["table_ii"]) == 15
    assert all(row["literal"] == row["closest"] for table in chapter["tables"].values() for row in table)
    assert chapter["experiments"]["literal"]["readings"][0]["chosen"] == "means_removed"
    assert chapter["experiments"]["closest"]["scores"]["table_iv"]["compared"] == 8
    draw_hours(tmp_path / "chapter.json", tmp_path / "hours.svg")
    assert "has the paper's outcome in 8" in (tmp_path / "hours.svg").read_text(encoding="utf-8")
