"""Friction of a drive that two joints turn, with its name on one of them and no difference on the other."""

from types import SimpleNamespace

import numpy as np
import pytest

from jointwear.discovery import Settings
from jointwear.discovery.model.shared_friction import shared_friction, undecided_friction
from jointwear.discovery.problem.candidates import Candidate
from jointwear.discovery.verdict import Retuned

LEVEL, NOISE = 3.5, 0.28
CORRECTED = Retuned("coulomb_positive", 3, 0.1, 0.16, 0.001, "N m")


def _final(slow, fast, named=((1, 2),), other=1.0, both=False):
    """Return a model with drives named on joints of pairs `named`, 0-based; of the joints 1 and 2 the speeds are `slow`
    and `fast` [rad/s]. Where `both`, a drive has one name on the two."""
    velocity = np.stack([np.zeros_like(slow), slow, fast], axis=1)
    settings = SimpleNamespace(settings=Settings(), train_state=SimpleNamespace(velocity=velocity), judged=[0, 1, 2])
    white = SimpleNamespace(problem=settings, columns=lambda axis, x: x / NOISE)
    shares = {"own": 1.0, "other": other}
    drives = [
        SimpleNamespace(
            named=SimpleNamespace(candidate=Candidate("drive_coupling", *pair, shares, both=both)),
            parameters={"coulomb": LEVEL, **shares},
        )
        for pair in named
    ]
    return SimpleNamespace(estimates=drives, unwritten=(), outcome=SimpleNamespace(white=white, problem=settings))


TIME = np.linspace(0, 6.0, 400)
FAST = np.sin(TIME)


@pytest.mark.parametrize("other", [1.0, -1.0])
def test_coulomb_friction_that_may_be_that_of_a_drive_is_told(other):
    """Joint 6 got 3.5 N m more of Coulomb friction in place of the drive that had its name on joint 5."""
    (told,) = undecided_friction(_final(0.5 * FAST, FAST, other=other), [CORRECTED])
    assert told.startswith("joint 3 turns the drive too that has its name on joint 2")


def test_samples_at_which_the_drive_is_at_rest_tell_nothing():
    still = np.where(np.arange(400) % 50 == 0, -FAST - 1e-4 * np.sign(FAST), 0.5 * FAST)
    assert undecided_friction(_final(still, FAST), [CORRECTED])


def test_what_the_motion_tells_apart_is_decided():
    assert not undecided_friction(_final(2.0 * np.cos(TIME), FAST), [CORRECTED])


def test_nothing_is_told_where_nothing_was_corrected_or_both_have_the_name():
    final = _final(0.5 * FAST, FAST)
    assert not undecided_friction(final, [])
    assert not undecided_friction(final, [Retuned("viscous", 3, 0.1, 0.16, 0.001, "N m s/rad")])
    assert not undecided_friction(_final(0.5 * FAST, FAST, ((1, 2), (2, 1))), [CORRECTED])


def test_a_drive_that_is_written_on_both_joints_is_told_as_that():
    final = _final(0.5 * FAST, FAST, both=True)
    assert not undecided_friction(final, [CORRECTED])
    (told,) = shared_friction(final)
    assert told.startswith("joint 3 turns the drive too that has its name on joint 2: the robot file has its friction")
    assert not shared_friction(_final(0.5 * FAST, FAST))
