"""Logs and results that several test files look at."""

import json
from dataclasses import replace

import numpy as np
import pytest
from fleet_rows import FLEET, NOW
from monitor_logs import ROBOT, START, columns, make_log, survey_once, write_parquet
from monitor_states import EVIL, HOURS, WORN

from jointwear.monitor.fleet import watch
from jointwear.monitor.fleet.summary import summarise_fleet
from jointwear.monitor.judging.state import read_state
from jointwear.monitor.presentation.page import write_page
from jointwear.monitor.reading import reading_stages
from jointwear.monitor.reading.reading_stages import accumulate_windows, survey_logs
from jointwear.monitor.stages import judge_windows


@pytest.fixture(scope="module")
def good(tmp_path_factory):
    """A log in which nothing is wrong."""
    return write_parquet(tmp_path_factory.mktemp("good") / "good.parquet", columns(make_log(48.0)))


@pytest.fixture(scope="module")
def surveyed_once():
    """The stages survey a first log with the same content, read in the same way, once a process."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(reading_stages, "survey_log", survey_once)
        yield


@pytest.fixture(scope="module")
def no_pages():
    """Pages say what the state says; drawing them would take most of the time of some tests: they are empty."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(watch, "write_page", lambda state, output, *_: output.write_text(""))
        yield


@pytest.fixture(scope="session")
def monitored(tmp_path_factory):
    """A robot monitored over 60 hours, 12 s of motion in each; axis 3 wears from hour 40 on. One log is refused."""
    folder = tmp_path_factory.mktemp("monitored")
    parts = []
    for hour in range(HOURS):
        log = make_log(12.0, seed=hour, start=START + 3600.0 * hour, noise=0.02)
        more = 0.05 * max(hour - 40, 0) * np.sign(log.velocity[:, WORN])
        log.torque[:, WORN] += more
        parts.append(log)
    names = ("time", "position", "velocity", "acceleration", "torque")
    whole = {n: np.concatenate([getattr(p, n) for p in parts]) for n in names}
    log = replace(parts[0], **whole)
    entry = {"logs": ["x"], "robot": str(ROBOT), "window": "1h", "baseline": {"windows": 36}}
    logs = [str(write_parquet(folder / f"{EVIL.replace('/', '')}.parquet", columns(log)))]
    logs.append(str(folder / "cut.parquet"))
    (folder / "cut.parquet").write_bytes((folder / logs[0]).read_bytes()[:-100])
    survey_logs(logs[0], ROBOT, entry, folder / "survey.json")
    windows = [str(folder / f"{k}.nc") for k in range(2)]
    for path, log in zip(windows, logs, strict=True):
        accumulate_windows([log], folder / "survey.json", ROBOT, entry, path)
    judge_windows(windows, ROBOT, entry, folder / "state.nc", folder / "alarms.csv", folder / "recall.json", "cell_3")
    write_page(read_state(folder / "state.nc"), folder / "monitor.html", folder / "figures")
    return folder, windows, entry


@pytest.fixture(scope="session")
def built_fleet(tmp_path_factory):
    """The folder with the page, table, metrics and history of the fleet of `fleet_rows`."""
    folder = tmp_path_factory.mktemp("fleet")
    (folder / "batch.json").write_text(json.dumps({"robots": FLEET}))
    names = ("fleet.csv", "index.html", "metrics.prom", "history.parquet", "rows.json")
    files = (folder / name for name in names)
    message = {"channel": "shift", "since": NOW, "attempts": 1, "title": "t", "body": "b"}
    (folder / "outbox.json").write_text(json.dumps({"told": {}, "waiting": [message] * 2}))
    more = {"time_zone": "America/New_York", "now": NOW, "outbox": folder / "outbox.json"}
    summarise_fleet([folder / "batch.json"], folder / "robots", *files, **more)
    return folder
