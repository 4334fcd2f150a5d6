"""A thermometer that shows one value throughout the baseline is as good as none, also once it is mended."""

import numpy as np
import pytest

from jointwear.monitor.normal.conditions import Conditions
from jointwear.monitor.normal.learning import learn_axes
from jointwear.monitor.normal.series import Series

DAYS, PER, AXES = 14, 8, 3
SHIFT = np.repeat(np.arange(DAYS), PER)
HOUR = np.tile(np.arange(PER) + 0.5, DAYS)
BASELINE = np.repeat((SHIFT < 8)[:, None], AXES, axis=1)


def learnt(of_first):
    """The normal state of the first axis, whose thermometer shows `of_first` (w,); oil of all warms up every day."""
    rng = np.random.default_rng(1)
    warm = 1 - np.exp(-HOUR / 2.5)
    temperature = 25 + 10 * warm[:, None] + 0.1 * rng.standard_normal((len(SHIFT), AXES))
    level = (
        -0.15 * warm[:, None]
        + rng.normal(0, 0.008, DAYS)[SHIFT][:, None]
        + 0.01 * rng.standard_normal((len(SHIFT), AXES))
    )
    temperature[:, 0] = of_first(temperature[:, 0])
    start, flat = 86400.0 * SHIFT + 3600.0 * HOUR, np.ones((len(SHIFT), AXES))
    conditions = Conditions(
        start, start + 3600.0, temperature, np.zeros((*flat.shape, 5)), flat, np.zeros(len(SHIFT)), None
    )
    return learn_axes([Series(level, 1e-4 * flat, flat[0], flat[0])], ["friction"], conditions, BASELINE, SHIFT)[0]


@pytest.mark.parametrize("mended", [False, True])
def test_one_value_throughout_the_baseline_is_no_temperature(mended):
    """The page said so, and the model took it for one: mended, it left nothing judged for good."""
    none = learnt(lambda right: np.nan * right)
    dead = learnt(lambda right: np.where(BASELINE[:, 0] | (not mended), 0.0, right))
    assert dead.dispersion == none.dispersion
    assert np.array_equal(dead.design.matrix, none.design.matrix)
    assert not dead.design.beyond.any()


def test_a_thermometer_that_moves_is_one():
    assert (
        learnt(lambda right: right).design.matrix.shape[1] > learnt(lambda right: np.nan * right).design.matrix.shape[1]
    )
