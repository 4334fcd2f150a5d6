"""Logs whose time stamps scatter from one day on are told as that, and blame no axis."""

from dataclasses import replace

import numpy as np
import pytest
from monitor_logs import columns, flagged, make_log, read, write_parquet

from jointwear.measurement.flags import Flag
from jointwear.monitor.findings.read_findings import SCATTERED, reading_findings
from jointwear.monitor.reading.scattered_stamps import stamps_scatter


def scattered(log, share):
    """Stamps that are off by a share of the step (standard deviation), as a loaded computer writes them."""
    step = float(np.median(np.diff(log.time)))
    off = share * step * np.random.default_rng(3).standard_normal(len(log.time))
    return replace(log, time=log.time + off)


@pytest.mark.parametrize(("decimals", "lost", "rate"), [(3, 0.0, 60.0), (2, 0.0, 30.0), (6, 0.1, 50.0), (0, 0.0, 20.0)])
def test_rounded_stamps_and_lost_samples_are_no_scatter(decimals, lost, rate):
    time = np.round(np.arange(4000) / rate, decimals)
    time = time[np.random.default_rng(1).random(len(time)) >= lost]
    assert not stamps_scatter(time, np.zeros(len(time), int))


def test_stamps_that_scatter_after_the_baseline_are_told(tmp_path):
    log = make_log(48.0, rate=20.0)
    first = write_parquet(tmp_path / "first.parquet", columns(log))
    later = write_parquet(tmp_path / "later.parquet", columns(scattered(log, 0.3)))
    assert not flagged(read(first), Flag.SCATTERED)
    found = read(later, first=first)
    assert flagged(found, Flag.SCATTERED)
    windows = found.statistics
    early = np.arange(windows.windows) < 1
    for part, told in ((windows, []), (replace(windows, flags=windows.flags * ~early[:, None]), [SCATTERED])):
        assert [f["kind"] for f in reading_findings(part, early) if f["kind"] == SCATTERED] == told
