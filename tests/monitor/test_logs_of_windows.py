"""What lies in few logs alone names them, and logs that were refused in part tell nothing near what was refused."""

import numpy as np
import pytest

from jointwear.measurement.flags import Flag
from jointwear.monitor.findings.told_together import told_together
from jointwear.monitor.normal.products import Product, product_findings
from jointwear.monitor.reading.assembly import Piece, assemble
from jointwear.monitor.reading.logs_of_windows import logs_of_windows
from jointwear.monitor.reading.windows import blank_statistics

HOUR = 3600.0


def piece(log: str, begin: int, hours: int) -> Piece:
    statistics = blank_statistics(HOUR * np.arange(begin, begin + hours), HOUR, np.ones(3), dated=True)
    statistics.count[:], statistics.samples[:] = 50, 60
    statistics.square[:] = 1.0 + begin
    return Piece(log, statistics, HOUR * begin, HOUR * (begin + hours) - 1)


def days(*names: str) -> list[Piece]:
    return [piece(name, 24 * k, 8) for k, name in enumerate(names)]


def test_windows_come_from_their_logs():
    whole = assemble(days("a.csv", "b.csv", "c.csv"))
    logs = logs_of_windows(whole.pieces, whole.statistics)
    np.testing.assert_array_equal(logs.number, np.repeat([0, 1, 2], 8))
    assert not logs.doubtful.any()
    assert logs.few(np.arange(8, 16)) == ["b.csv"]
    assert logs.few(np.arange(24)) == []


def test_what_is_near_refused_samples_of_a_log_is_doubtful():
    one, month = piece("day.csv", 0, 8), piece("month.csv", 100, 100)
    one.statistics.flags[2] = int(Flag.REFUSED)
    month.statistics.flags[50] = int(Flag.REFUSED)
    whole = assemble([one, month, piece("next.csv", 201, 8)])
    doubtful = logs_of_windows(whole.pieces, whole.statistics).doubtful
    assert doubtful[:8].all()
    np.testing.assert_array_equal(np.flatnonzero(doubtful[8:108]), np.arange(50 - 24, 50 + 25))
    assert not doubtful[108:].any()


@pytest.mark.parametrize(
    ("flag", "told"),
    [
        (0, "look at that first;"),
        (Flag.REFUSED, "samples of it were refused"),
        (Flag.TORQUE_FROZEN, "the torque of axis 2 keeps one value in it"),
    ],
)
def test_a_part_that_one_log_alone_shows_names_that_log(flag, told):
    pieces = days("a.csv", "b.csv", "c.csv")
    pieces[1].statistics.flags[:, 1] |= int(flag)
    whole = assemble(pieces)
    logs = logs_of_windows(whole.pieces, whole.statistics)
    program = np.where(logs.number == 1, 5, 0)
    (found,) = product_findings(whole.statistics, program, (Product(5, (1, 3)),), np.zeros(24, bool), logs)
    assert "All of it lies in b.csv" in found["words"]
    assert told in found["words"]
    # One that goes on from log to log is a part.
    (found,) = product_findings(whole.statistics, np.full(24, 5), (Product(5, (1, 3)),), np.zeros(24, bool), logs)
    assert "lies in" not in found["words"]
    assert "logs" not in found


def test_several_of_them_name_their_logs_together():
    whole = assemble(days("a.csv", "b.csv", "c.csv", "d.csv"))
    logs = logs_of_windows(whole.pieces, whole.statistics)
    products = (Product(5, (1, 3)), Product(6, (1, 2)))
    found = product_findings(whole.statistics, logs.number + 4, products, np.zeros(32, bool), logs)
    (told,) = told_together(found)
    assert "All of it lies in b.csv and c.csv" in told["words"]
    without_logs = {k: v for k, v in found[1].items() if k != "logs"}
    (told,) = told_together([found[0], without_logs])
    assert told["words"].endswith("Look at b.csv first.")
