"""The profiles of clusters: what they say of rules holds for rules that there are, and short jobs are sent together."""

import math
import re
from collections import Counter

import pytest
import yaml
from scratch_project import ROOT, copy_project

PROFILES = ("slurm", "kubernetes")


def read(name):
    return yaml.safe_load((ROOT / f"workflow/profiles/{name}/config.yaml").read_text())


def rules():
    texts = (path.read_text() for path in (ROOT / "workflow/rules").glob("*.smk"))
    return {name for text in texts for name in re.findall(r"^rule (\w+):|^use rule \w+ as (\w+)", text, re.MULTILINE)}


@pytest.mark.parametrize("name", PROFILES)
def test_a_profile_names_rules_that_there_are_and_groups_of_a_size(name):
    profile, known = read(name), {own for pair in rules() for own in pair if own}
    assert profile["groups"].keys() <= known
    assert profile["set-resources"].keys() <= known
    assert set(profile["groups"].values()) == profile["group-components"].keys()


@pytest.mark.parametrize("name", PROFILES)
def test_rules_that_run_discovery_have_what_discovery_has(name):
    given = read(name)["set-resources"]
    assert given["learn_robot"] == given["answer_world"] == given["discover_dataset"]


def test_both_profiles_say_the_same():
    slurm, kubernetes = map(read, PROFILES)
    memory = [{rule: given["mem_mb"] for rule, given in p["set-resources"].items()} for p in (slurm, kubernetes)]
    assert memory[0] == memory[1]
    assert (slurm["groups"], slurm["group-components"]) == (kubernetes["groups"], kubernetes["group-components"])


@pytest.mark.long
@pytest.mark.parametrize("name", PROFILES)
def test_jobs_of_a_group_are_sent_as_many_at_a_time_as_the_profile_says(tmp_path, name):
    """Without a size for its group every diagnosis was sent by itself: 39 of the 52 submissions of grouped jobs."""
    project, profile = copy_project(tmp_path), read(name)
    kept = {key: profile[key] for key in ("groups", "group-components")}
    (tmp_path / "grouped").mkdir()
    (tmp_path / "grouped/config.yaml").write_text(yaml.safe_dump(kept))
    wear = "wear={axes: [1,2,3,4,5,6], increase_percent: [10,20], shape: 1.5, hours: 24}"
    options = ("--profile", "grouped", "--workflow-profile", "none", "--config", "tasks=[T1,T2,T3]", wear)
    jobs = project.planned(*options)
    assert sum(jobs.values()) > 130
    sent = Counter(re.findall(r"Group job (\w+)", project.plan(*options).stdout))
    for group, size in profile["group-components"].items():
        held = sum(jobs[rule] for rule, own in profile["groups"].items() if own == group)
        assert sent[group] == math.ceil(held / size), group
