"""Window statistics: what they estimate, that pieces add up, that their standard deviations are honest."""

import itertools
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from monitor_logs import columns, layout, make_log, model, write_parquet
from scipy.signal import lfilter

from jointwear.files.errors import InputError
from jointwear.measurement.flags import Flag
from jointwear.measurement.formats.chunk import Chunk
from jointwear.monitor.reading.accumulate import Samples, WindowSettings, window_statistics
from jointwear.monitor.reading.derivation import derive_motion
from jointwear.monitor.reading.logs import log_statistics
from jointwear.monitor.reading.survey import survey_log
from jointwear.monitor.reading.window_files import read_statistics, write_statistics
from jointwear.monitor.reading.windows import HISTOGRAM_BINS, PER_WINDOW, REGRESSORS, merge

LENGTH = 12.0
SETTINGS = WindowSettings(LENGTH, np.full(6, 0.01), np.array([40, 60, 20, 2, 2, 1.0]), reach=5, block=0.2)


def statistics(log, settings=SETTINGS, **how):
    torque = model()(log.position, log.velocity, log.acceleration)
    return window_statistics(Samples(log.time, log.position, log.velocity, log.torque, torque, **how), settings)


def coefficients(found, row=0):
    """Least squares, axis by axis; columns that are zero give zero."""
    return np.stack(
        [
            np.linalg.pinv(g, hermitian=True, rcond=1e-12) @ m
            for g, m in zip(found.gram[row], found.moment[row], strict=True)
        ]
    )


def same(first, second):
    np.testing.assert_array_equal(first.labels, second.labels)
    for name in set(PER_WINDOW) - {"labels"}:
        np.testing.assert_allclose(getattr(first, name), getattr(second, name), rtol=1e-9, atol=1e-9, err_msg=name)


def test_known_changes_are_found():
    log = make_log(24.0, noise=0.0)
    v, size = log.velocity, np.array([0.5, 0.3, 0.2, 0.02, 0.02, 0.0])
    gravity = model().dynamics.gravity_torque(log.position)
    more = np.where(v > 0, size, 0) - np.where(v < 0, 2 * size, 0) + 0.1 * v + 0.05 * gravity
    found = statistics(replace(log, torque=log.torque + more))
    for j in range(5):
        fit = coefficients(found)[j]
        np.testing.assert_allclose(fit[:3], [size[j], 2 * size[j], 0.1], atol=1e-4)
        if j in (1, 2):
            assert fit[REGRESSORS.index("gravity")] == pytest.approx(0.05, abs=1e-4)


def test_an_axis_at_rest_counts_nothing():
    found = statistics(make_log(24.0))
    assert (found.count[:, 5] == 0).all()
    assert (found.flags[:, 5] & int(Flag.AT_REST) != 0).all()
    assert (found.flags[:, :5] == 0).all()
    assert (found.travel[:, 5] == 0).all()
    # Out and back is 110 degrees each way for axis 1.
    np.testing.assert_allclose(found.travel[:, 0], 2 * np.radians(110), rtol=1e-2)


@settings(max_examples=25, deadline=None)
@given(cuts=st.lists(st.integers(1, 1199), max_size=4, unique=True), seed=st.integers(0, 5))
def test_pieces_add_up(cuts, seed):
    log = make_log(24.0, seed=seed)
    stretch = np.cumsum(np.isin(np.arange(len(log.time)), cuts))
    torque = model()(log.position, log.velocity, log.acceleration)

    def of(part):
        cut = log.part(part)
        piece = type(torque)(torque.total[part], torque.gravity[part], torque.inertial[part])
        samples = Samples(cut.time, cut.position, cut.velocity, cut.torque, piece, stretch=stretch[part])
        return window_statistics(samples, SETTINGS)

    edges = [0, *sorted(cuts), len(log.time)]
    parts = merge([of(slice(a, b)) for a, b in itertools.pairwise(edges)])
    whole = of(slice(None))
    for name in ("gram", "moment", "square", "count", "samples", "travel", "torque_histogram", "torque_peak", "flags"):
        np.testing.assert_allclose(getattr(parts, name), getattr(whole, name), rtol=1e-9, atol=1e-9, err_msg=name)
    assert (parts.freedom <= whole.freedom).all()


def test_the_order_of_merging_does_not_matter():
    parts = [statistics(make_log(24.0, seed=k, start=12.0 * k)) for k in range(4)]
    same(merge(parts), merge([merge(parts[2:]), merge(parts[:2])]))


def test_histogram_counts_every_sample():
    log = make_log(24.0)
    found = statistics(log)
    assert found.torque_histogram.sum() == log.torque.size
    narrow = statistics(log, replace(SETTINGS, torque_reference=np.full(6, 1e-6)))
    assert narrow.torque_histogram[:, :5, 1 : HISTOGRAM_BINS - 1].sum() <= log.torque.size * 0.001
    np.testing.assert_allclose(found.torque_peak.max(axis=0), np.abs(log.torque).max(axis=0))


def test_standard_deviations_are_honest_under_coloured_noise():
    log, rho, size = make_log(2880.0, noise=0.0), 0.8, 0.3
    random = np.random.default_rng(7)
    noise = lfilter([1.0], [1.0, -rho], size * np.sqrt(1 - rho**2) * random.standard_normal(log.torque.shape), axis=0)
    found = statistics(replace(log, torque=log.torque + noise), replace(SETTINGS, length=48.0, block=0.8))
    assert found.windows == 60
    np.testing.assert_allclose(found.autocorrelation[:, :5].mean(axis=0), rho, atol=0.05)
    np.testing.assert_allclose(np.sqrt(found.noise_variance[:, :5].mean(axis=0)), size, rtol=0.05)
    for j in range(5):
        inverse = np.linalg.pinv(found.gram[:, j], hermitian=True, rcond=1e-12)
        fit = np.einsum("wpk,wk->wp", inverse, found.moment[:, j])[:, 0]
        told = np.sqrt(np.mean((inverse @ found.score[:, j] @ inverse)[:, 0, 0]))
        naive = np.sqrt(np.mean(inverse[:, 0, 0] * found.noise_variance[:, j]))
        assert 0.7 < told / np.std(fit) < 1.3
        assert naive < 0.6 * np.std(fit)
    assert (found.effective_count[:, :5] < 0.2 * found.count[:, :5]).all()


def test_scores_of_few_samples_are_raised_by_what_the_fit_took_of_them():
    log = make_log(LENGTH, noise=0.05, seed=4)
    every = slice(None, None, max(1, len(log.time) // 40))
    few = replace(
        log, **{n: getattr(log, n)[every] for n in ("time", "position", "velocity", "acceleration", "torque")}
    )
    found = statistics(few, replace(SETTINGS, reach=0, block=1e-3))
    for j in range(5):
        count, freedom = found.count[0, j], found.freedom[0, j]
        assert 8 < count < 60
        assert count > freedom > 0
        # A block of one sample each: the sum of x x' e^2, of which the last two columns may be nothing.
        whole = np.trace(found.score[0, j]) * freedom / count
        fit = coefficients(found)[j]
        torque = model()(few.position, few.velocity, few.acceleration)
        used = np.abs(few.velocity[:, j]) > 0.01
        turned = np.diff(few.velocity[:, j] > 0) != 0
        used[1:] &= ~turned
        used[:-1] &= ~turned
        x = np.stack(
            [few.velocity[:, j] > 0, -1.0 * (few.velocity[:, j] < 0), few.velocity[:, j], torque.gravity[:, j],
             torque.inertial[:, j]], axis=1,
        )  # fmt: skip
        error = (few.torque - torque.total)[:, j] - x @ fit
        assert whole == pytest.approx(np.sum((x[used] * error[used, None]) ** 2), rel=0.01)


def test_a_file_holds_everything(tmp_path):
    found = statistics(make_log(24.0))
    write_statistics(found, tmp_path / "w.nc", "test", {"a": 1}, {"logs": "[]"})
    back = read_statistics(tmp_path / "w.nc")
    same(found, back)
    np.testing.assert_allclose(back.torque_reference, found.torque_reference)
    assert back.dated is False
    (tmp_path / "w.nc").write_bytes((tmp_path / "w.nc").read_bytes()[:500])
    with pytest.raises(InputError, match=r"w\.nc"):
        read_statistics(tmp_path / "w.nc")


def test_blocks_give_what_the_whole_log_gives(tmp_path):
    path = str(write_parquet(tmp_path / "log.parquet", columns(make_log(120.0))))
    survey = survey_log(path, layout(), model(), LENGTH)
    whole = log_statistics(path, layout(), model(), survey, LENGTH, block=100_000).statistics
    small = log_statistics(path, layout(), model(), survey, LENGTH, block=700).statistics
    for name in ("gram", "moment", "count", "samples", "flags", "torque_histogram"):
        first, second = getattr(whole, name), getattr(small, name)
        np.testing.assert_allclose(first, second, rtol=1e-5, atol=1e-5 * np.abs(first).max(), err_msg=name)


def test_samples_far_apart_with_measured_motion(tmp_path):
    # As in the paper: a sample every 10 s or so, here at other instants of the cycle in every window.
    log = make_log(12.0 * 1501, rate=1 / 9.7)
    more = 0.4 * np.sign(log.velocity) * np.array([1, 1, 0.5, 0.1, 0.1, 0])
    table = columns(replace(log, torque=log.torque + more), "position", "velocity", "acceleration", "torque")
    path = str(write_parquet(tmp_path / "log.parquet", table))
    survey = survey_log(path, layout(), model(), 3600.0)
    found = log_statistics(path, layout(), model(), survey, 3600.0)
    assert found.refused == ()
    assert (found.statistics.share_used[:4, :5] > 0.85).all()
    assert not found.statistics.flags[:, :5].any()
    sums = {n: getattr(found.statistics, n).sum(axis=0, keepdims=True) for n in ("gram", "moment")}
    fit = coefficients(replace(found.statistics, **sums))[:5, 0]
    np.testing.assert_allclose(fit, 0.4 * np.array([1, 1, 0.5, 0.1, 0.1]), rtol=0.2, atol=0.03)


@settings(max_examples=10, deadline=None)
@given(st.lists(st.sampled_from([20, 30, 90, 400]), min_size=1, max_size=6), st.booleans(), st.integers(0, 99))
def test_stretches_that_are_filtered_together_give_what_each_gives_alone(lengths, measured, seed):
    random = np.random.default_rng(seed)
    stretch = np.repeat(np.arange(len(lengths)), lengths)
    m = len(stretch)
    inner = np.concatenate([np.arange(k) for k in lengths]) / 50
    # One stretch in three has uneven stamps.
    time = 3600.0 * stretch + inner + np.where(stretch % 3 == 2, random.uniform(0, 0.01, m), 0.0)
    position, velocity = (np.cumsum(random.standard_normal((m, 2)), axis=0) / 50 for _ in range(2))
    whole = Chunk(time=time, position=position, torque=position, velocity=velocity if measured else None)
    cutoff = np.array([5.0, 7.3])
    together = derive_motion(whole, stretch, cutoff)
    for k in range(len(lengths)):
        rows = stretch == k
        part = replace(
            whole, time=time[rows], position=position[rows], torque=position[rows],
            velocity=velocity[rows] if measured else None,
        )  # fmt: skip
        alone = derive_motion(part, stretch[rows], cutoff)
        for name in ("position", "velocity", "acceleration", "usable"):
            np.testing.assert_allclose(getattr(together, name)[rows], getattr(alone, name), rtol=1e-9, atol=1e-9)


@pytest.mark.long
def test_derived_motion_finds_the_same_friction_as_measured(tmp_path):
    log = make_log(120.0)
    log = replace(log, torque=log.torque + 0.4 * np.sign(log.velocity) * np.array([1, 1, 0.5, 0.1, 0.1, 0]))
    found = {}
    for roles in ((), ("velocity",), ("velocity", "acceleration")):
        table = columns(log, "position", "torque", *roles)
        path = str(write_parquet(tmp_path / f"{len(roles)}.parquet", table))
        survey = survey_log(path, layout(), model(), 120.0)
        found[len(roles)] = coefficients(log_statistics(path, layout(), model(), survey, 120.0).statistics)
    truth = 0.4 * np.array([1, 1, 0.5, 0.1, 0.1])
    for fit in found.values():
        np.testing.assert_allclose(fit[:5, 0], truth, rtol=0.15, atol=0.03)
        np.testing.assert_allclose(fit[:5, 1], truth, rtol=0.15, atol=0.03)


@pytest.mark.parametrize(
    "change",
    [
        lambda s: {"torque_reference": -s.torque_reference},
        lambda s: {"torque_reference": np.where(np.arange(6) == 2, np.nan, s.torque_reference)},
        lambda s: {"start": s.start - 1e300},
    ],
)
def test_kept_windows_with_impossible_values_are_refused(tmp_path, change):
    found = statistics(make_log(24.0))
    write_statistics(replace(found, **change(found)), tmp_path / "w.nc", "windows", {})
    with pytest.raises(InputError, match=r"w\.nc: a torque reference or a time in it is impossible"):
        read_statistics(tmp_path / "w.nc")
