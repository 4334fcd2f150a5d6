"""What shakes an arm at a frequency of its own is no noise, however loud it is."""

from types import SimpleNamespace

import numpy as np
import pytest
from discovery_cases import RATE, make_case
from scipy.signal import lfilter

from jointwear.discovery import Settings, discover
from jointwear.discovery.noise.noise_spectrum import FEWEST_OF_RECORD
from jointwear.discovery.problem.time_lines import loudest
from jointwear.discovery.search.residual_lines import Line, where_strongest


def _noise(rng, records=4, count=1000):
    series = [lfilter([1.0], [1.0, -0.9], rng.standard_normal(count + 200))[200:] for _ in range(records)]
    return np.concatenate(series), np.repeat(np.arange(records), count)


@pytest.mark.parametrize("height", [0.0, 1.5])
def test_a_line_stands_out_of_coloured_noise_whatever_its_phase(height):
    series, label = _noise(np.random.default_rng(5))
    time = np.arange(len(series)) / RATE + 0.37 * label
    used = np.random.default_rng(6).random(len(series)) > 0.2
    frequency, chance, _ = loudest(series + height * np.sin(2 * np.pi * 7.5 * time), used, label, RATE)
    if height:
        assert frequency == pytest.approx(7.5, abs=0.1)
        assert chance < 1e-8
    else:
        assert chance > 1e-4


def test_what_is_slow_and_records_that_are_short_are_not_asked():
    series, label = _noise(np.random.default_rng(7))
    slow = 30.0 * np.sin(2 * np.pi * 0.8 * np.arange(len(series)) / RATE)
    assert loudest(series + slow, np.ones(len(series), bool), label, RATE)[0] >= 2.0
    short = np.arange(FEWEST_OF_RECORD - 1) / RATE
    assert loudest(short, np.ones(len(short), bool), np.zeros(len(short)), RATE)[1] == 1.0


@pytest.mark.parametrize("labels", [(0, 1, 2), (2, 1, 0), (5, 3, 9)])
def test_a_line_is_placed_in_its_own_record_in_whatever_order_these_are_labelled(labels):
    count, rng = 1000, np.random.default_rng(8)
    late = np.repeat([False, False, True], count)
    label, instant = np.repeat(labels, count), np.arange(3 * count)
    residual = rng.standard_normal(3 * count) + 3.0 * late * np.sin(2 * np.pi * 7.0 * instant / RATE)
    state = SimpleNamespace(record=label, time=instant / RATE)
    for record in (-1, labels[2]):
        found = where_strongest(Line(50.0, 1e-9, 7.0, 0.0, record), residual, instant, state, RATE)
        assert found.any()
        assert late[found].all()


@pytest.mark.long
def test_a_beat_that_is_louder_than_the_noise_is_structure(robot):
    def beat(q, v, a, temperature, time, torque):
        full = np.zeros_like(q)
        full[:, 2] = 0.06 * torque[:, 2].std() * (np.sin(2 * np.pi * 6.0 * time) + np.sin(2 * np.pi * 6.3 * time))
        return full

    case = make_case(robot, 24, beat)
    found = discover(case, robot, Settings())
    assert found.verdict == "unknown"
    assert any((u["axis"], u["argument"]) == (3, "line over time") for u in found.data["unexplained"])
    size = case.torque[:, 2].std()
    # The beat has 0.06 of that.
    assert found.final.outcome.noise_floor[2] < 0.02 * size
