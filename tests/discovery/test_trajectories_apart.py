"""Joints on which training and test trajectories disagree about the model are no joints where nothing is missing."""

from dataclasses import replace

import numpy as np
import pytest

from jointwear.discovery import held_out
from jointwear.discovery.findings import make_verdict


def _verdict(found, monkeypatch, axis, left, noise):
    """Return the verdict where joint `axis`, 0-based, leaves and has as noise these multiples of its own noise."""
    measured = held_out.measure_gap

    def changed(problem, torques, floor):
        gap = measured(problem, torques, floor)
        own = gap.noise_floor[axis]
        augmented, floors = list(gap.augmented), list(gap.noise_floor)
        augmented[axis], floors[axis] = left * own, noise * own
        return replace(gap, augmented=tuple(augmented), noise_floor=tuple(floors))

    monkeypatch.setattr(held_out, "measure_gap", changed)
    return make_verdict("a", found.final, found.map, found.torques, [])


def _named_axis(found):
    (axis,) = {e["axis"] for e in found.effects}
    return axis - 1


@pytest.mark.parametrize(("ratio", "word"), [(13.7, "unknown"), (3.0, "effects")])
def test_a_name_on_another_joint_does_not_silence_one_far_above_its_noise(found, monkeypatch, ratio, word):
    """Of a drive that two joints share one joint got the name, and the other stood 13.7 times above its noise."""
    axis = (_named_axis(found) + 1) % 6
    verdict = _verdict(found, monkeypatch, axis, ratio, 1.0)
    assert verdict.verdict == word
    told = [words for words in verdict.restrictions if "the training trajectories do not" in words]
    assert len(told) == (word == "unknown")
    assert all(words.startswith(f"joint {axis + 1}: ") for words in told)


@pytest.mark.parametrize(("ratio", "word"), [(7.0, "unknown"), (3.0, "effects")])
def test_a_joint_that_is_off_in_training_alone_is_not_explained(found, monkeypatch, ratio, word):
    """An encoder lost counts: 2 N m of training were taken for noise, 0.29 N m were left of the test trajectory, and
    the verdict was that nothing is missing."""
    axis = (_named_axis(found) + 1) % 6
    verdict = _verdict(found, monkeypatch, axis, 1.0, ratio)
    assert verdict.noise_untold == (axis + 1,)
    assert verdict.verdict == word
    told = [words for words in verdict.restrictions if "the training trajectories disagree" in words]
    assert len(told) == (word == "unknown")
    assert all("up to 7 times" in words for words in told)


def test_what_does_not_matter_is_not_said_to_be_apart(found, monkeypatch):
    """Below a thousandth of the torque even exact models differ."""
    axis = (_named_axis(found) + 1) % 6
    problem = found.problem
    torque = float(np.sqrt(np.nanmean(problem.measured.torque[:, axis] ** 2)))
    small = 1e-5 * torque / found.content.gap.noise_floor[axis]
    assert _verdict(found, monkeypatch, axis, 10 * small, small).verdict == "effects"


@pytest.mark.parametrize("ratio", [13.7, 1.0])
def test_a_joint_with_a_name_of_its_own_is_told_by_its_ratio(found, monkeypatch, ratio):
    verdict = _verdict(found, monkeypatch, _named_axis(found), ratio, 1.0)
    assert verdict.verdict == "effects"
    assert bool(verdict.above_the_noise) == (ratio > 2.0)
