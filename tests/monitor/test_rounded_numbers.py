"""Numbers that a log writes in coarser steps than the first one did are told as that, and blame no axis."""

from dataclasses import replace

import numpy as np
import pytest
from monitor_logs import columns, flagged, make_log, read, write_parquet
from monitor_windows import SETTINGS, residuals, statistics_of

from jointwear.measurement.flags import Flag
from jointwear.monitor.findings.loud import LOUD, UNEVEN, loud_findings
from jointwear.monitor.findings.read_findings import ROUNDED, reading_findings
from jointwear.monitor.judging.observed import observe
from jointwear.monitor.reading.program_labels import label_text
from jointwear.monitor.reading.rounded import coarser, loud_by_rounding, written_steps


def rounded(log, position=1e-5, torque=1e-3):
    return replace(
        log,
        position=position * np.round(log.position / position),
        torque=torque * np.round(log.torque / torque),
    )


def test_the_steps_of_numbers_are_told():
    random = np.random.default_rng(1)
    values = random.normal(0, 2.0, (6000, 3))
    values[:, 0], values[:, 1] = np.round(values[:, 0]), 1e-3 * np.round(values[:, 1] / 1e-3)
    one, milli, none = written_steps(values)
    assert (one, none) == (1.0, None)
    assert milli == pytest.approx(1e-3)
    assert coarser(values, [1e-3, 1e-3, 1e-3]).tolist() == [True, False, False]
    assert coarser(values, [1.0, None, None]).tolist() == [False, True, False]
    assert not coarser(values, []).any()


@pytest.mark.parametrize(
    ("change", "flag"),
    [
        ({"torque": 1.0}, Flag.COARSE_TORQUE),
        ({"position": np.radians(0.1)}, Flag.COARSE_POSITION),
        ({"torque": 2e-3, "position": 2e-5}, None),
    ],
)
def test_a_log_in_coarser_steps_is_marked(tmp_path, change, flag):
    first = write_parquet(tmp_path / "first.parquet", columns(rounded(make_log(48.0))))
    later = write_parquet(tmp_path / "later.parquet", columns(rounded(make_log(48.0, seed=2), **change)))
    found = read(later, first)
    assert not flagged(read(first), Flag.COARSE_TORQUE | Flag.COARSE_POSITION)
    for other in (Flag.COARSE_TORQUE, Flag.COARSE_POSITION):
        assert flagged(found, other) == (other == flag)
    assert not flagged(found, Flag.SILENT)


@pytest.mark.parametrize(("flag", "kind"), [(Flag.COARSE_TORQUE, ROUNDED[0]), (Flag.COARSE_POSITION, ROUNDED[1])])
@pytest.mark.parametrize("louder", [1.0, 6.0])
def test_coarser_numbers_that_matter_are_told_in_place_of_a_loud_axis(flag, kind, louder):
    residual = residuals(80, np.zeros((80, 3)), 1)
    late = np.arange(80) >= 60
    noise = np.random.default_rng(2).standard_normal(residual.shape)
    residual[late, :, 2] += 0.05 * np.sqrt(louder**2 - 1) * noise[late, :, 2]
    plain = statistics_of(residual)
    axis = 2 if flag == Flag.COARSE_TORQUE else 0
    flags = plain.flags.copy()
    flags[late, axis] |= int(flag)
    marked = replace(plain, flags=flags)
    baseline, shift = np.arange(80) < 40, np.arange(80) // 8
    loud = [f["kind"] for f in loud_findings(plain, shift, baseline, [[], [], []])]
    assert loud == ([LOUD] if louder > 1 else [])
    assert not [f for f in loud_findings(marked, shift, baseline, [[], [], []]) if f["kind"] in (LOUD, UNEVEN)]
    told = [f for f in reading_findings(marked, baseline) if f["kind"] in ROUNDED]
    assert [f["kind"] for f in told] == ([kind] if louder > 1 else [])
    assert all("coarser steps than in the normal period" in f["words"] for f in told)
    assert loud_by_rounding(marked, baseline).any() == (louder > 1)
    # Logs that always were so are no news.
    always = replace(plain, flags=plain.flags | int(flag))
    assert not [f for f in reading_findings(always, baseline) if f["kind"] in ROUNDED]


@pytest.mark.parametrize(("before", "told"), [(1, True), (2, False)])
def test_steps_that_the_baseline_has_too_are_no_news(before, told):
    """An encoder step of 11.46 of the last digits is read as eleven of them or as one."""
    residual, late = residuals(80, np.zeros((80, 3)), 1), np.arange(80) >= 60
    residual[late, :, 2] += 0.3 * np.random.default_rng(2).standard_normal(residual[late, :, 2].shape)
    plain = statistics_of(residual)
    marked = late | np.isin(np.arange(80), 7 * np.arange(1, before + 1))
    marked = replace(plain, flags=plain.flags | np.where(marked, int(Flag.COARSE_POSITION), 0)[:, None] * [1, 0, 0])
    found = reading_findings(marked, np.arange(80) < 40)
    assert any(f["kind"] in ROUNDED for f in found) == told


def test_a_torque_of_a_few_values_is_neither_at_a_limit_nor_a_load():
    plain, late = statistics_of(residuals(20, np.zeros((20, 3)), 1)), np.arange(20)[:, None] >= 12
    odd = np.where(late, int(Flag.SATURATED | Flag.CONTRADICTED), 0) * np.array([0, 0, 1])
    told = [f["kind"] for f in reading_findings(replace(plain, flags=plain.flags | odd), np.arange(20) < 12)]
    assert told == ["contradicted", "saturated"]
    coarse = np.where(odd > 0, int(Flag.COARSE_TORQUE), 0)
    assert reading_findings(replace(plain, flags=plain.flags | odd | coarse), np.arange(20) < 12) == []


def test_what_rounding_adds_is_no_part_that_is_carried():
    residual = residuals(80, np.zeros((80, 3)), 3)
    late = np.arange(80) >= 60
    residual[late] += 0.6 * np.random.default_rng(4).standard_normal(residual[late].shape) * [1.0, 0.4, 0.2]
    plain = statistics_of(residual)
    marked = replace(plain, flags=plain.flags | np.where(late, int(Flag.COARSE_POSITION), 0)[:, None])
    baseline = np.arange(80) < 40
    assert observe(plain, baseline, SETTINGS).products
    assert not observe(marked, baseline, SETTINGS).products
    # A program that ran in such logs alone tells none either.
    named = np.array([label_text(np.array(["press" if k else "weld"])) for k in late], dtype=object)
    assert not observe(replace(marked, labels=named), baseline, SETTINGS).products
