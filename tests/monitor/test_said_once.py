"""A refusal says what to mend, and says it once, in `monitor` and in `fleet`."""

import pytest
from monitor_logs import ROBOT, columns, make_log, write_parquet

from jointwear.monitor.fleet.watch import watch_robot
from jointwear.monitor.reading.reading_stages import survey_logs
from jointwear.running.script import reported

MENDED = "state units: {torque: mN m}"


def test_what_to_mend_is_said_once(tmp_path, capsys):
    table = columns(make_log(36.0))
    log = write_parquet(
        tmp_path / "log.parquet", table | {f"torque_{j}": table[f"torque_{j}"] * 1e3 for j in range(1, 7)}
    )
    entry = {"logs": ["log*"], "robot": str(ROBOT), "window": "12s", "baseline": {"windows": 8}}
    with pytest.raises(SystemExit), reported():
        survey_logs(str(log), ROBOT, entry, tmp_path / "survey.json")
    assert capsys.readouterr().err.count(MENDED) == 1
    row = watch_robot("arm", entry, [str(log)], tmp_path / "robots")
    assert (row["result"], row["reason"].count(MENDED)) == ("refused", 1)
