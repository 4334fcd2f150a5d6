"""Studies run again for what they read, and for nothing else."""

import re
import shutil

import pytest
from scratch_project import Project

from jointwear.running.modules import LIBRARY, imported_by

TARGETS = [
    "results/joint_fit/posterior.csv",
    "results/joint_fit_controls/papers/ours_0.nc",
    "results/recovery/prediction.nc",
    "results/monitor_study/factory/temperature/factory.nc",
]
#: In place of the hours that a script of a study takes.
STAND_IN = "from pathlib import Path\nfor path in snakemake.output:\n    Path(path).touch()\n"


@pytest.fixture(scope="module")
def studied(built, tmp_path_factory):
    """The tiny experiment with studies whose scripts only make their files."""
    folder = tmp_path_factory.mktemp("studied") / "project"
    shutil.copytree(built.folder, folder, symlinks=True)
    project = Project(folder)
    for script in project.planned(*TARGETS):
        (folder / f"workflow/scripts/{script}.py").write_text(STAND_IN)
    project.snakemake("--cores", "2", *TARGETS)
    assert project.planned(*TARGETS) == {}
    return project


@pytest.mark.parametrize(
    ("change", "again"),
    [
        ("normal={test_hours: 30}", {"write_joint_posterior"}),
        ("sampling={interval: 5}", {"write_joint_posterior"}),
        ("reading={lag_sign: reversed_sign}", {"write_joint_posterior"}),
        ("reading={training_length: days_60}", {"write_joint_posterior"}),
        ("reading={noise_draws: three_draws}", {"write_joint_posterior", "predict_detection"}),
        ("reading={pca_input: histogram}", {"write_joint_posterior", "predict_detection"}),
        ("reading={onset_rule: single_hour}", {"write_joint_posterior", "predict_detection"}),
        ("reading={q_limit: empirical_quantile}", {"write_joint_posterior", "predict_detection", "measure_factory"}),
        ("reading={torque_sign: signed}", {"write_joint_posterior", "predict_detection", "measure_factory"}),
    ],
)
def test_a_study_runs_again_for_the_keys_that_it_reads(studied, change, again):
    assert set(studied.planned(*TARGETS, "--config", change)) == again


def test_the_report_does_not_run_again_for_the_settings_of_studies(built):
    assert built.planned("--config", "recover={solutions: 40}") == {}


@pytest.mark.long
@pytest.mark.parametrize("experiment", ["literal", "closest"])
def test_the_comparison_depends_on_every_stage_that_it_runs(built, experiment):
    tables = [f"results/tables/table_{name}.nc" for name in ("ii", "iv", "v", "vi")]
    target = f"results/side_by_side/{experiment}/{tables[0]}"
    told = built.plan("--workflow-profile", "none", target).stdout
    inputs = set(re.search(r"rule tabulate_beside:\n +input: (.*)\n", told)[1].split(", "))
    # In a directory of its own it runs everything, as here when everything is asked for again.
    stages = set(built.planned("--forceall", *tables))
    assert {"simulate_training", "fit_normal_model", "tabulate_results"} <= stages
    for stage in stages:
        modules = imported_by(LIBRARY / f"../scripts/{stage}.py")
        missing = {f"workflow/jointwear/{path.relative_to(LIBRARY)}" for path in modules} - inputs
        assert missing == set(), stage
    assert {"config/config.yaml", "config/paper/published.yaml"} <= inputs
    own = {"config/robots/puma560_paper.yaml", *(f"config/tasks/T{k}.yaml" for k in (1, 2, 3))}
    assert inputs & own == (own if experiment == "literal" else set())
