"""A target that nothing makes is answered in one line, with what was meant."""

import os

import pytest
from scratch_project import copy_project

from jointwear.files.errors import InputError
from jointwear.running.targets import asked_for, check_targets

RULES = ("all", "fleet", "monitor", "check_data", "notify")
FILES = ("results/monitor/{monitored}/monitor.html", "results/fleet/fleet.csv", "results/{a}_{b}/x.csv")
MADE = ("results/monitor/press_1/monitor.html", "results/fleet/fleet.csv")


def check(*targets):
    check_targets(targets, RULES, lambda file: file in MADE, FILES)


def test_rules_and_files_that_are_made_pass():
    check()
    check("fleet", *MADE, "./results/fleet/fleet.csv")


@pytest.mark.parametrize(
    ("target", "meant"),
    [
        ("fleat", "fleet"),
        ("Fleet", "fleet"),
        ("check-data", "check_data"),
        ("results/monitor/press_1/monitr.html", MADE[0]),
        ("results/montor/press_1/monitor.html", MADE[0]),
        ("results/fleet/fleet.csvv", MADE[1]),
        (os.path.abspath(MADE[1]), MADE[1]),
    ],
)
def test_the_nearest_target_is_named(target, meant):
    with pytest.raises(InputError, match=f"nothing makes it; did you mean '{meant}'"):
        check("all", target)


def test_a_file_of_values_belongs_to_an_option(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    with pytest.raises(InputError, match=r"target 'plant\.yaml': nothing makes it"):
        check("monitor", "plant.yaml")
    (tmp_path / "plant.yaml").touch()
    with pytest.raises(InputError, match=r"given as --configfile plant\.yaml"):
        check("monitor", "plant.yaml")


def test_without_a_call_nothing_is_asked_for():
    assert asked_for() == []


@pytest.mark.long
def test_snakemake_ends_with_the_line_before_any_job(tmp_path):
    project = copy_project(tmp_path)
    for arguments, meant in [(["fleat"], "'fleet'"), (["monitor", "config/config.yaml"], "--configfile")]:
        done = project.plan(*arguments, ok=False)
        assert done.returncode == 1
        assert "jointwear: target " in done.stderr
        assert meant in done.stderr
        assert "Exception" not in done.stderr
    done = project.plan("results/monitor/press_3/monitor.html", ok=False)
    assert done.returncode == 1
    assert "jointwear: " in done.stderr
    assert "'monitor.robots' has no 'press_3'" in done.stderr
    assert "Traceback" not in done.stderr
    assert "KeyError" not in done.stderr
