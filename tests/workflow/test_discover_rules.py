"""Jobs of discover: how many a data set takes, and robots that come from another data set."""

import pytest
import yaml
from scratch_project import copy_project

EXAMPLE = "config/examples/discover_puma560.yaml"


@pytest.fixture(scope="module")
def project(tmp_path_factory):
    return copy_project(tmp_path_factory.mktemp("discover"))


def test_three_jobs_per_data_set(project):
    planned = project.planned("discover", "--configfile", EXAMPLE)
    assert planned == {"check_dataset": 1, "discover_dataset": 1, "report_discovery": 1, "discover": 1}
    assert project.planned("check_data", "--configfile", EXAMPLE) == {"check_dataset": 1, "check_data": 1}


def test_the_example_says_that_no_data_set_is_named(project):
    told = "the configuration names no data set under 'discover.datasets'; this is the shipped example, puma560_hidden"
    assert project.plan("check_data").stderr.count(told) == 1
    assert told not in project.plan("check_data", "--configfile", EXAMPLE).stderr


@pytest.mark.parametrize("profile", ["default", "slurm", "kubernetes"])
def test_a_data_set_that_is_refused_stops_no_other(project, profile):
    told = yaml.safe_load((project.folder / "workflow/profiles" / profile / "config.yaml").read_text())
    assert told["keep-going"] is True


def chained(project, name, **datasets):
    """Write a config whose data sets differ in their robot alone."""
    shown = yaml.safe_load((project.folder / EXAMPLE).read_text())["discover"]["datasets"]["puma560_hidden"]
    entries = {key: {**shown, "robot": robot or shown["robot"]} for key, robot in datasets.items()}
    (project.folder / name).write_text(yaml.safe_dump({"discover": {"datasets": entries}}))
    return name


def test_the_robot_of_another_data_set_is_made_first_or_taken_as_it_is(project):
    written = "results/discover/first/robot.yaml"
    both = chained(project, "both.yaml", first=None, second=written)
    assert project.planned("discover", "--configfile", both)["discover_dataset"] == 2
    alone = chained(project, "alone.yaml", second=written)
    refused = project.plan("discover", "--configfile", alone, ok=False)
    assert refused.returncode != 0
    assert "no data set 'first' that would make it" in refused.stderr
    target = project.folder / written
    target.parent.mkdir(parents=True)
    target.write_text((project.folder / "config/robots/puma560.yaml").read_text())
    assert project.planned("discover", "--configfile", alone)["discover_dataset"] == 1


def test_a_check_tells_at_once_that_discovery_would_refuse_the_data(project):
    shown = yaml.safe_load((project.folder / EXAMPLE).read_text())
    shown["discover"]["datasets"]["puma560_hidden"]["test"] = [9]
    (project.folder / "wrong.yaml").write_text(yaml.safe_dump(shown))
    done = project.snakemake("check_data", "--configfile", "wrong.yaml")
    assert "discovery would refuse puma560_hidden: " in done.stderr
    assert "'test' names trajectory 9, which is not in the data" in done.stderr
    assert "which is not in the data" in (project.folder / "results/discover/puma560_hidden/check.html").read_text()


def test_a_file_of_a_bag_that_is_overwritten_is_checked_again(project):
    bag = project.folder / "bag"
    bag.mkdir()
    (bag / "metadata.yaml").write_text("rosbag2_bagfile_information: {}\n")
    (bag / "bag.db3").write_bytes(b"no bag")
    entry = {"measured": "bag", "robot": "config/robots/puma560.yaml"}
    (project.folder / "bag.yaml").write_text(yaml.safe_dump({"discover": {"datasets": {"arm": entry}}}))
    project.snakemake("check_data", "--configfile", "bag.yaml")
    assert "check_dataset" not in project.planned("check_data", "--configfile", "bag.yaml")
    (bag / "bag.db3").write_bytes(b"another")
    assert project.planned("check_data", "--configfile", "bag.yaml")["check_dataset"] == 1
