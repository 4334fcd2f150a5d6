"""Windows of which the estimate is far less sure than is usual."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from monitor_windows import COULOMB, PER_WINDOW, VISCOUS, motion, residuals, statistics_of

from jointwear.monitor.normal.series import by_programs, friction_series
from jointwear.monitor.normal.unsure import ODD, USUAL, beyond_usual, not_of_program, odd_windows

WINDOWS, FIRST = 40, 20
BASELINE = np.arange(WINDOWS) < FIRST
PROGRAM = np.zeros(WINDOWS, dtype=int)


def of_windows(factor):
    """Series of windows whose error by blocks is that of their noise, times `factor` (w, n)."""
    s = statistics_of(residuals(WINDOWS, np.zeros((WINDOWS, 3)), 1))
    x = motion()
    score = np.einsum("snp,snq->npq", x, x) * (s.residual_square / (PER_WINDOW - 5)).mean(axis=0)[:, None, None]
    s = replace(s, score=score * factor[..., None, None] ** 2)
    return s, friction_series(s, COULOMB, VISCOUS, BASELINE)


def test_a_window_as_sure_as_usual_keeps_its_variance():
    one = np.ones((WINDOWS, 3))
    _, plain = of_windows(one)
    _, usual = of_windows(one * [1.0, 30.0, 1.0])
    for name, series in plain.items():
        assert np.array_equal(series.variance, usual[name].variance, equal_nan=True)


def test_a_window_that_is_less_sure_than_usual_counts_for_less():
    factor = np.ones((WINDOWS, 3))
    factor[30, 0] = 6.0
    _, plain = of_windows(np.ones((WINDOWS, 3)))
    _, series = of_windows(factor)
    for name in ("coulomb", "friction", "viscous", "beside_bodies"):
        more = series[name].variance / plain[name].variance
        assert more[30, 0] == pytest.approx(1 + 36 - USUAL**2, rel=0.2), name
        more[30, 0] = 1.0
        assert np.allclose(more, 1.0), name


def test_a_window_that_no_longer_shows_its_friction_says_so():
    factor = np.ones((WINDOWS, 3))
    factor[30, 0] = 1000.0
    _, series = of_windows(factor)
    assert np.isnan(series["friction"].value[30, 0])
    assert np.argwhere(series["friction"].unsure).tolist() == [[30, 0]]


def test_single_windows_of_a_program_that_err_by_far_more_than_it_does_are_left_out():
    factor = np.ones((WINDOWS, 3))
    factor[[5, 30], 0] = 1.5 * ODD
    s, series = of_windows(factor)
    found = by_programs(series, s, COULOMB, PROGRAM, BASELINE)
    for one in found.values():
        assert np.argwhere(np.isnan(one.value)).tolist() == [[5, 0], [30, 0]]
        assert np.argwhere(one.unsure).tolist() == [[5, 0], [30, 0]]


def test_an_error_that_a_program_often_has_or_that_is_not_known_makes_no_window_odd():
    error = np.ones((WINDOWS, 1))
    error[35] = 10.0
    assert np.flatnonzero(odd_windows(error, PROGRAM, BASELINE)).tolist() == [35]
    often = error.copy()
    often[:FIRST:3] = 10.0
    assert not odd_windows(often, PROGRAM, BASELINE).any()
    late = np.where(BASELINE, 0, 1)
    assert not odd_windows(error, late, BASELINE).any()
    assert not odd_windows(error, np.full(WINDOWS, -1), BASELINE).any()


def test_a_state_that_a_program_has_in_its_baseline_is_no_news():
    odd, known = np.zeros((WINDOWS, 1), dtype=bool), np.ones((WINDOWS, 1), dtype=bool)
    odd[30:] = True
    assert not_of_program(odd, known, PROGRAM, BASELINE)[30:].all()
    odd[:10] = True
    assert not not_of_program(odd, known, PROGRAM, BASELINE).any()


def test_where_the_baseline_tells_no_error_nothing_is_added():
    assert not beyond_usual(np.zeros((WINDOWS, 2)), BASELINE).any()
    assert not beyond_usual(np.ones((WINDOWS, 2)), np.zeros(WINDOWS, dtype=bool)).any()


def test_friction_that_is_only_not_seen_drives_nothing():
    """Below zero by five of its own errors it does; where its program was so in the normal period no sign is turned."""
    growth = np.zeros((WINDOWS, 3))
    growth[30:, 0] = -1.8
    s = statistics_of(residuals(WINDOWS, growth, 1))
    assert friction_series(s, COULOMB, VISCOUS, BASELINE)["friction"].driving[30:, 0].all()
    wide = replace(s, score=s.gram * (COULOMB.mean(axis=1) ** 2 * PER_WINDOW)[:, None, None])
    assert not friction_series(wide, COULOMB, VISCOUS, BASELINE)["friction"].driving.any()
    program = (np.arange(WINDOWS) % 4 == 3).astype(int)
    growth[:, 0] = np.where(program == 1, -1.8, 0.0)
    s = statistics_of(residuals(WINDOWS, growth, 1))
    series = friction_series(s, COULOMB, VISCOUS, BASELINE)
    assert series["friction"].driving[program == 1, 0].all()
    assert not by_programs(series, s, COULOMB, program, BASELINE)["friction"].driving.any()
