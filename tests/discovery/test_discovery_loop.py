"""The loop back to the paper: a task that is repeated while a joint wears and its oil follows the day."""

import numpy as np
import pytest
import yaml

from jointwear import effects
from jointwear.discovery import Settings, discover, load_recording
from jointwear.robots.robot import load_robot


@pytest.fixture(scope="module")
def verdict():
    with open("config/examples/discover_warm_task.yaml", encoding="utf-8") as stream:
        entry = yaml.safe_load(stream)["discover"]["datasets"]["warm_task"]
    recording = load_recording(entry, "warm_task")
    return discover(recording, load_robot(entry["robot"]), Settings(entry["inertial_prior"]))


def test_wear_and_temperature_are_told_apart(verdict):
    assert verdict.verdict == "effects"
    found = {(e["effect"], e["axis"]) for e in verdict.effects}
    assert found == {("wear_drift", 1), ("temperature_dependent_viscous_friction", 1)}


def test_the_gap_shrinks_to_the_noise_and_retuning_alone_does_not_close_it(verdict):
    gap = {k: v[0] for k, v in verdict.data["gap"].items() if isinstance(v, list)}
    assert gap["augmented"] < 1.1 * gap["noise_floor"]
    assert gap["retuned"] > 2.5 * gap["noise_floor"]
    others = [np.array(verdict.data["gap"][k][1:], dtype=float) for k in ("augmented", "nominal")]
    assert np.all(others[0] < 1.02 * others[1])


def test_the_augmented_robot_holds_both_effects(verdict):
    entries = verdict.augmented_robot["effects"]
    assert {e["effect"] for e in entries} == {"wear_drift", "temperature_dependent_viscous_friction"}
    assert all(e["effect"] in effects.library() for e in entries)
