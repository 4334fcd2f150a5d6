"""Stored studies: their chapters, their pages, and the copies of the recovered experiment."""

import json
import re
import shutil
from pathlib import Path

import numpy as np
import pytest
import yaml

from jointwear.files.errors import InputError
from jointwear.publishing.report.study_page import write_study_page
from jointwear.robots.robot_file import read_robot_file
from jointwear.robots.task_file import read_task_file
from jointwear.studies.recovery import figures
from jointwear.studies.recovery.adoption import adopt_experiment, compare_copies
from jointwear.studies.recovery.export import task_data, write_yaml
from jointwear.studies.recovery.validation_figure import draw_validation

ROOT = Path(__file__).resolve().parents[2]
STORED = sorted(path.parent for path in (ROOT / "data/studies").glob("*/chapter.json"))


@pytest.mark.parametrize("folder", STORED, ids=lambda p: p.name)
def test_a_stored_study_makes_a_page_that_stands_alone(folder, tmp_path):
    page = tmp_path / "index.html"
    write_study_page(folder.name, folder / "chapter.json", sorted(folder.glob("*.svg")), page)
    text = page.read_text(encoding="utf-8")
    assert text.count("<svg") == len(list(folder.glob("*.svg")))
    assert 'src="http' not in text
    # The answer comes first, in one sentence.
    assert re.search(r"<main.*?<p>(<b>)?", text, re.DOTALL)[1] == "<b>"
    assert "None" not in text
    assert "nan" not in text.split("<main")[1].replace("nano", "")


def test_a_study_without_a_template_is_named(tmp_path):
    (tmp_path / "chapter.json").write_text("{}")
    with pytest.raises(InputError, match=r"no template NN_unheard\.html\.j2"):
        write_study_page("unheard", tmp_path / "chapter.json", [], tmp_path / "index.html")


@pytest.mark.parametrize("picture", figures.PICTURES)
def test_figures_of_the_recovery_are_drawn_from_its_chapter(picture, tmp_path):
    stored = ROOT / "data/studies/recovery"
    figures.draw(picture, stored / "chapter.json", tmp_path / "figure.svg")
    assert (tmp_path / "figure.svg").read_bytes() == (stored / f"{picture}.svg").read_bytes()


def test_the_figure_of_the_validation_is_drawn_from_its_chapter(tmp_path):
    stored = ROOT / "data/studies/recovery_validation"
    draw_validation(stored / "chapter.json", tmp_path / "figure.svg")
    assert (tmp_path / "figure.svg").read_bytes() == (stored / "named.svg").read_bytes()


def test_the_default_experiment_is_the_recovered_one():
    found = json.loads((ROOT / "data/studies/recovery/chapter.json").read_text(encoding="utf-8"))
    payload = read_robot_file(ROOT / "config/robots/puma560_paper.yaml")["payload"]
    ensemble = found["ensemble"]
    pairs = zip(ensemble["mass"], ensemble["com_z"], strict=True)
    assert any(abs(m - payload["mass"]) < 1e-3 and abs(z - payload["com"][2]) < 1e-4 for m, z in pairs)
    shape = yaml.safe_load((ROOT / "config/config.yaml").read_text(encoding="utf-8"))["wear"]["shape"]
    assert any(abs(s - shape) < 1e-3 for s in ensemble["shape"])


@pytest.fixture
def recovered(tmp_path):
    """A recovered experiment beside copies of the shipped one."""
    shutil.copytree(ROOT / "config", tmp_path / "config")
    robot = read_robot_file(ROOT / "config/robots/puma560.yaml")
    write_yaml(tmp_path / "robot.yaml", {**robot, "payload": {"mass": 1.25, "com": [0.0, 0.0, 0.2]}})
    write_yaml(tmp_path / "T1.yaml", task_data("T1", np.zeros(6), np.full(6, 0.5), 25.0, 3.0))
    write_yaml(tmp_path / "wear.yaml", {"wear": {"shape": 2.25}})
    return tmp_path


def test_adoption_changes_the_copies_and_nothing_else(recovered):
    robot, task, config = (
        recovered / f"config/{n}" for n in ("robots/puma560_paper.yaml", "tasks/T1.yaml", "config.yaml")
    )
    before = read_robot_file(robot), config.read_text(encoding="utf-8")
    adopt_experiment(recovered / "robot.yaml", [recovered / "T1.yaml"], recovered / "wear.yaml", robot, [task], config)
    after = read_robot_file(robot)
    assert after["payload"]["mass"] == 1.25
    assert [j["torque_limit"] for j in after["joints"]] == [j["torque_limit"] for j in before[0]["joints"]]
    assert "snakemake recover" in after["provenance"]["source"]
    assert read_task_file(task)["durations"] == [25.0, 35.0]
    changed = set(config.read_text(encoding="utf-8").splitlines()) - set(before[1].splitlines())
    assert changed == {"  shape: 2.25"}
    compare_copies([recovered / "robot.yaml", recovered / "T1.yaml"], [robot, task], recovered / "copies.csv", 0.02)


def test_copies_that_are_out_of_date_are_named(recovered):
    copies = [recovered / "config/robots/puma560_paper.yaml", recovered / "config/tasks/T1.yaml"]
    with pytest.raises(InputError, match=r"payload\.com\[2\] is .*, recovered 0\.2; .*adopt_recovered"):
        compare_copies([recovered / "robot.yaml", recovered / "T1.yaml"], copies, recovered / "copies.csv", 0.02)
    assert "False" in (recovered / "copies.csv").read_text(encoding="utf-8")
