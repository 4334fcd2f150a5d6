"""Studies run again for what they read, and for nothing else."""

import re

import pytest

from jointwear.running.modules import LIBRARY, imported_by


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
