"""Friction that grows in one direction alone, on axes that carry gravity, is no load and is told at its size."""

from types import SimpleNamespace

import numpy as np
import pytest
from monitor_windows import COULOMB, SETTINGS, motion, residuals, statistics_of

from jointwear.monitor.findings.offsets import OFFSET, offset_findings
from jointwear.monitor.judging.judge import judge

WINDOWS, BASELINE, MEAN = 264, 120, 20.0


def carrying(swing: float) -> np.ndarray:
    """Regressors (s, n, 5) of axes whose gravity torque varies by `swing` [N m] about its mean."""
    x = motion()
    x[..., 3] = MEAN + swing * x[..., 3] / x[..., 3].std(axis=0)
    return x


def judged(x: np.ndarray, extra: np.ndarray):
    return judge(statistics_of(residuals(WINDOWS, np.zeros((WINDOWS, 3)), 13, extra), x=x), BASELINE, SETTINGS)


def since_baseline() -> np.ndarray:
    """A ramp (w,) from 0 at the end of the baseline to 1."""
    return np.clip((np.arange(WINDOWS) - BASELINE) / (WINDOWS - BASELINE), 0, 1)


@pytest.mark.long
@pytest.mark.parametrize("swing", [0.5, 1.6, 5.0, 20.0])
@pytest.mark.parametrize(("forwards", "backwards"), [(0.5, 0.0), (0.0, 0.8), (0.3, 0.2)])
def test_growth_in_one_direction_is_told_at_its_size_as_coulomb_friction(forwards, backwards, swing):
    x, extra = carrying(swing), np.zeros((WINDOWS, *motion().shape[:2]))
    growth = forwards * COULOMB[0, 0] * x[:, 0, 0] + backwards * COULOMB[0, 1] * x[:, 0, 1]
    extra[..., 0] = since_baseline()[:, None] * growth
    result = judged(x, extra)
    told = [a for a in result.alarms if a["detector"] == "model"]
    assert {(a["axis"], a["quantity"].split()[0]) for a in told} == {(1, "coulomb")}
    whole = 100 * (forwards * COULOMB[0, 0] + backwards * COULOMB[0, 1]) / COULOMB[0].sum()
    mean = np.mean(whole * since_baseline()[-12:])
    found, std = (np.mean(values["coulomb_percent"][-12:, 0]) for values in (result.estimates, result.std))
    assert found == pytest.approx(mean, abs=max(3 * std, 1.0))


@pytest.mark.parametrize("swing", [5.0, 20.0])
@pytest.mark.parametrize("constant", [-2.0, 0.0, 2.0])
def test_another_load_raises_nothing(constant, swing):
    x, extra = carrying(swing), np.zeros((WINDOWS, *motion().shape[:2]))
    extra[BASELINE + 24 :, :, :2] = (0.15 * x[..., 3] + constant)[:, :2]
    result = judged(x, extra)
    assert not [a for a in result.alarms if a["detector"] == "model"]


@pytest.mark.parametrize("offset", [-6.0, 6.0])
def test_an_offset_that_drifts_is_neither_friction_nor_a_service(offset):
    x, extra = carrying(5.0), np.zeros((WINDOWS, *motion().shape[:2]))
    extra[..., 0] = offset * since_baseline()[:, None]
    result = judged(x, extra)
    assert not [a for a in result.alarms if a["detector"] == "model"]
    assert "proposed_service" not in {f["kind"] for f in result.findings}
    assert np.nanmax(np.abs(result.estimates["coulomb_percent"][-12:, 0])) < 2


def offsets(axes: list[int], offset: float, hours: int) -> list[dict]:
    """Findings on an offset of 0-based axes, a share of their Coulomb friction, that lasts some hours."""
    x, extra = carrying(5.0), np.zeros((WINDOWS, *motion().shape[:2]))
    extra[BASELINE : BASELINE + hours, :, axes] = offset * COULOMB[axes].mean(axis=1)
    return [f for f in judged(x, extra).findings if f["kind"] == OFFSET]


@pytest.mark.parametrize(("offset", "size"), [(0.5, "4"), (-0.5, "−4")])
def test_an_offset_of_one_axis_is_told_while_it_lasts(offset, size):
    (found,) = offsets([0], offset, 96)
    assert found["axes"] == [1]
    assert f"The torque of axis 1 is off by {size} N m" in found["words"]
    assert found["time"] == 3600.0 * BASELINE
    assert found["end"] == 3600.0 * (BASELINE + 96)


@pytest.mark.parametrize(("axes", "offset", "hours"), [([0], 0.05, 96), ([0], 0.5, 16), ([0, 1], 0.5, 96)])
def test_small_or_short_offsets_and_those_of_several_axes_are_not_told(axes, offset, hours):
    assert offsets(axes, offset, hours) == []


def told_of(first: float, second: float, grown: float = 0.0, alone: int = 0) -> list[dict]:
    """Findings on the first of two axes that is off by `first` and `second` of its friction in two programs, while it
    grows by `grown`, over six days after six of the baseline; the last `alone` days run the first program alone."""
    days, per = 12, 8
    shift = np.repeat(np.arange(days), per)
    program = np.where((np.arange(days * per) % 2 == 1) & (shift < days - alone), 1, 0)
    after = shift >= 6
    offset = 0.01 * np.random.default_rng(4).standard_normal((days * per, 2))
    offset[after, 0] += np.where(program == 0, first, second)[after]
    growth = np.where(after[:, None], [grown, 0.0], 0.0)
    start = 3600.0 * np.arange(days * per)
    statistics = SimpleNamespace(windows=days * per, axes=2, start=start, end=start + 3600.0)
    size = np.array([5.0, 5.0])
    return offset_findings(statistics, size * offset, size, program, shift, ~after, [[], []], growth)


def test_a_zero_is_off_in_every_program_alike():
    """Grown friction, which gravity that hardly varies cannot be told from in a program, was told as a zero."""
    (found,) = told_of(-0.16, -0.12)
    assert "The torque of axis 1 is off by −0.6 N m" in found["words"]
    assert not told_of(-0.16, -0.01)
    assert not told_of(-0.16, 0.16)
    # A program that ran shortly before tells too; once there is but one, that one does.
    assert not told_of(-0.16, 0.0, alone=3)
    assert told_of(-0.16, 0.0, alone=5)


def test_an_offset_that_is_less_than_what_friction_grew_by_may_be_of_it():
    assert not told_of(-0.16, -0.16, grown=0.3)
    assert told_of(-0.16, -0.16, grown=0.1)
