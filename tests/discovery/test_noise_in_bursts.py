"""What hides most of a torque and comes in bursts is no noise of a sensor."""

from types import SimpleNamespace

import numpy as np
import pytest

from jointwear.discovery.held_out import Ringing, noise_in_bursts, without_bursts
from jointwear.discovery.noise.bursts import FEWEST_CHANGES, heaviest_noise, loudest_share, rings, struck_together
from jointwear.discovery.presentation.page import heading, lead
from jointwear.discovery.settings import Settings
from jointwear.discovery.verdict import Gap

RATE, COUNT = 250.0, 6000


@pytest.fixture
def rng():
    return np.random.default_rng(5)


@pytest.fixture
def motion():
    return 4.0 * np.sin(2 * np.pi * 0.4 * np.arange(COUNT) / RATE)


def coloured(rng, memory=0.9):
    """Return normal noise of unit size that forgets slowly."""
    drive, noise = rng.normal(size=COUNT), np.zeros(COUNT)
    for k in range(1, COUNT):
        noise[k] = memory * noise[k - 1] + np.sqrt(1 - memory**2) * drive[k]
    return noise


def ringing(rng):
    """Return what rings at 25 Hz each time the load turns over, of unit size, beside a little noise."""
    since = (np.arange(COUNT) % 300) / RATE
    swing = np.exp(-since / 0.08) * np.sin(2 * np.pi * 25.0 * since)
    return swing / np.std(swing) + 0.1 * rng.normal(size=COUNT)


ALL, ONE = np.ones(COUNT, dtype=bool), np.zeros(COUNT, dtype=int)


def test_normal_noise_has_one_share_whatever_its_colour(rng):
    for noise in (rng.normal(size=COUNT), coloured(rng)):
        assert loudest_share(noise, ALL, ONE) == pytest.approx(0.28, abs=0.02)
    assert heaviest_noise() == pytest.approx(loudest_share(rng.laplace(size=COUNT).cumsum(), ALL, ONE), abs=0.03)


def test_ringing_as_large_as_the_torque_is_no_noise(rng, motion):
    left = 2.4 * ringing(rng)
    assert rings(2.4, left, motion + left, ALL, ONE)


def test_neither_a_large_noise_nor_small_bursts_ring(rng, motion):
    """The light wrist of a Panda in another bench has a noise of 0.84 of its torque, with nothing hidden."""
    assert not rings(3.5, 3.5 * coloured(rng), motion, ALL, ONE)
    assert not rings(0.4, 0.4 * ringing(rng), motion, ALL, ONE)
    # Noise whose size follows a speed.
    assert not rings(3.5, 3.5 * rng.normal(size=COUNT) * np.sin(np.arange(COUNT) / 50.0), motion, ALL, ONE)


def together(left):
    sizes = np.abs(np.random.default_rng(1).normal(size=(*left.shape, 3)))
    return struck_together(left, np.ones(left.shape, bool), ONE, sizes, range(left.shape[1]), Settings())


def struck(rng, instants, joints):
    """Return normal noise of joints that something strikes at some instants, each as hard as eight times the noise."""
    left = rng.normal(size=(COUNT, joints))
    left[instants] += 8.0 * rng.choice([-1.0, 1.0], size=(len(instants), joints))
    return left


def test_small_bursts_of_several_joints_at_the_same_instants_are_no_noise(rng):
    blows = rng.choice(COUNT, 150, replace=False)
    left = np.concatenate([struck(rng, blows, 2), rng.normal(size=(COUNT, 1))], axis=1)
    assert together(left) == {0: (1,), 1: (0,)}


def test_sensors_with_heavy_tails_are_loud_each_by_itself(rng):
    assert together(rng.standard_t(3, size=(COUNT, 4))) == {}
    alone = [struck(rng, rng.choice(COUNT, 150, replace=False), 1) for _ in range(2)]
    assert together(np.concatenate(alone, axis=1)) == {}


def test_normal_noise_that_joints_share_is_noise(rng):
    """What is derived from one encoder is in the torques of all joints."""
    shared = rng.normal(size=(COUNT, 1)) @ np.array([[1.0, 0.7, -0.4]])
    assert together(shared + 0.2 * rng.normal(size=shared.shape)) == {}
    swings = np.abs(np.sin(np.arange(COUNT) / 80.0))[:, None]
    left = shared * swings
    assert struck_together(left, np.ones(left.shape, bool), ONE, np.stack([swings] * 3, 1), range(3), Settings()) == {}


@pytest.mark.parametrize("few", [0, 1, 50])
def test_of_few_samples_nothing_is_struck(rng, few):
    left = struck(rng, np.arange(0, COUNT, 40), 2)
    usable = np.zeros(left.shape, bool)
    usable[:few] = True
    assert struck_together(left, usable, ONE, np.ones((COUNT, 2, 1)), range(2), Settings()) == {}
    assert struck_together(np.zeros((COUNT, 2)), ~usable, ONE, np.ones((COUNT, 2, 1)), range(2), Settings()) == {}


def test_few_samples_say_nothing(rng, motion):
    few = np.arange(COUNT) < FEWEST_CHANGES
    assert not rings(2.4, 2.4 * ringing(rng), motion, few, ONE)
    assert not rings(2.4, 2.4 * ringing(rng), motion, ~ALL, ONE)
    assert loudest_share(np.zeros(COUNT), ALL, ONE) == 0.0


def test_a_floor_of_ringing_is_what_is_left_and_told_once(rng, motion):
    """Of the second joint it is said already that more than noise is left, of the third no noise is known."""
    left = 2.4 * ringing(rng)
    torque = np.repeat((motion + left)[:, None], 4, axis=1)
    torque[:, 3] = motion + 0.01 * left
    model = np.repeat(motion[:, None], 4, axis=1)
    still = np.zeros(torque.shape)
    measured = SimpleNamespace(
        torque=torque, usable=np.ones(torque.shape, bool), trajectory=ONE, velocity=still, acceleration=still
    )
    gap = Gap((9.0,) * 4, (9.0,) * 4, (2.2, 2.2, 2.2, 0.024), (2.4, 2.4, None, 0.024))
    problem = SimpleNamespace(measured=measured, settings=Settings())
    told, ringing_joints = without_bursts(problem, model, gap, {1})
    assert told.noise_floor == (2.2, 2.4, None, 0.024)
    assert ringing_joints == {1: Ringing(2.4)}
    (words,) = noise_in_bursts(ringing_joints)
    assert words.startswith("joint 1: what looks like noise there, 2.4 N m, hides the torque")
    assert "lost motion in the gear" in words


@pytest.mark.parametrize(("share", "told"), [(0.2, {1: (3,), 3: (1,)}), (0.02, {})])
def test_joints_that_are_struck_together_are_told_where_it_matters(rng, motion, share, told):
    """Beside the second nothing is asked: that more than noise is left there is said already."""
    noise = share * np.std(motion)
    left = noise * struck(rng, rng.choice(COUNT, 150, replace=False), 3)
    model = np.repeat(motion[:, None], 3, axis=1)
    measured = SimpleNamespace(
        torque=model + left,
        usable=np.ones(left.shape, bool),
        trajectory=ONE,
        velocity=rng.normal(size=left.shape),
        acceleration=rng.normal(size=left.shape),
    )
    gap = Gap((9.0,) * 3, (9.0,) * 3, (noise,) * 3, (noise,) * 3)
    problem = SimpleNamespace(measured=measured, settings=Settings())
    _, found = without_bursts(problem, model, gap, {1})
    assert {axis: one.beside for axis, one in found.items()} == told
    for words in noise_in_bursts(found):
        assert "comes in bursts, at the same instants as on joint" in words


def test_a_page_says_that_a_joint_rings_and_not_that_data_are_coarse():
    gap = {"nominal": [9.0, 5.0], "retuned": [9.0, 1.0], "augmented": [9.0, 1.0], "noise_floor": [9.0, 1.0]}
    content = {"verdict": "unknown", "effects": [], "unexplained": [], "above_the_noise": [], "suspects": []}
    content |= {"gap": gap, "noise_untold": [1], "rings": [1]}
    assert heading(content) == "Something rings on joint 1: what is missing there cannot be told"
    assert lead(content)[0].startswith("On joint 1 what looks like noise comes in bursts")
    coarse = {**content, "rings": [], "gap": {**gap, "noise_floor": [None, 1.0]}}
    assert heading(coarse) == "Too coarse in time to say what is missing on joint 1"
    assert "too coarse in time" in lead(coarse)[0]
    # An estimate that was too high alone is neither.
    assert "structure beyond the noise" in lead({**content, "rings": []})[0]


def test_what_stays_above_the_noise_is_not_said_to_be_nothing():
    """Three joints above the noise stood beside "No effect is missing": a pedestal gave way at 9 Hz."""
    gap = {"nominal": [2.0], "retuned": [1.5], "augmented": [1.5], "noise_floor": [1.0]}
    content = {"verdict": "retuned", "effects": [], "unexplained": [], "suspects": [], "gap": gap}
    content |= {"to_the_noise": False, "above_the_noise": [{"axis": 1, "ratio": 1.5}]}
    assert lead(content)[0].startswith("No effect was found;")
    assert "a base that gives way" in lead(content)[1]
    assert heading(content) == "Parameters are wrong, no effect was found, and more than noise is left on joint 1"
    assert heading({**content, "verdict": "none"}).startswith("No effect was found, and")
