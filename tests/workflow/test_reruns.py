"""config/README.md lists for every key what reruns; here it is held to that."""

import re

import pytest
from scratch_project import merged

from jointwear.reproduction import readings
from jointwear.running.configuration import config_schema

# For every key of the config another valid value, and for keys that Snakemake's plan cannot see, none.
EDITS = {
    "seed": 7,
    "replicates": 4,
    "robot": "config/robots/puma560.yaml",
    "tasks": ["T2"],
    "wear.axes": [1],
    "wear.increase_percent": [25],
    "wear.shape": 2.5,
    "wear.hours": 25,
    "normal.test_hours": 30,
    "sampling.interval": 5,
    "sampling.samples": 30,
    "noise.disturbance_share": 0.02,
    "noise.encoder": 2e-4,
    "noise.time_step": 0.25,
    "histogram.bins": 10,
    "detection.confidence": 0.99,
    "detection.variance_share": 0.8,
    "detection.consecutive_hours": 3,
    "report.replicate": 2,
}
# Rules that only gather results run again with whatever they gather.
GATHERING = re.compile(r"^(tabulate|draw|build_report|summarise)")


def documented(root):
    """Key -> set of rules from the table of config/README.md."""
    rows = re.findall(r"^\| `([a-z_.]+)` \|.*\| ([^|]*) \|$", (root / "config/README.md").read_text(), re.MULTILINE)
    return {key: set(re.findall(r"`(\w+)`", rules)) for key, rules in rows}


def keys_of(schema, prefix=""):
    for key, inner in schema["properties"].items():
        if "properties" in inner:
            yield from keys_of(inner, f"{prefix}{key}.")
        else:
            yield f"{prefix}{key}"


def nested(key, value):
    for part in reversed(key.split(".")):
        value = {part: value}
    return value


def readings_edits():
    for a in readings.ambiguities().values():
        yield f"reading.{a.name}", next(v for v in a.alternatives if v != a.default)


ALL_EDITS = {**EDITS, **dict(readings_edits())}


def test_every_key_is_documented(root):
    described = documented(root)
    keys = set(keys_of(config_schema()))
    assert keys - described.keys() == set()
    assert described.keys() - keys == set()


@pytest.mark.parametrize("key", ALL_EDITS)
def test_an_edit_reruns_what_the_table_says(built, root, key, request):
    original = built.config_file.read_text()
    request.addfinalizer(lambda: built.config_file.write_text(original))
    built.write_config(merged(built.config(), nested(key, ALL_EDITS[key])))
    jobs = set(built.planned())
    working = {rule for rule in jobs if not GATHERING.match(rule)}
    assert working == documented(root)[key]
    if key != "seed":
        assert jobs
