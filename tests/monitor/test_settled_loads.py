"""A load at the flange that a window does not show clearly by itself is told by the windows that do."""

from dataclasses import replace

import numpy as np
import pytest
from monitor_logs import ROBOT, columns, make_log, model, read, write_parquet

from jointwear.files.errors import InputError
from jointwear.monitor import stages
from jointwear.monitor.reading.assembly import Piece
from jointwear.monitor.reading.loads_of_windows import PER_LOAD
from jointwear.monitor.reading.model import TorqueModel
from jointwear.monitor.reading.piece_files import read_pieces, write_pieces
from jointwear.monitor.reading.settled_loads import with_settled_loads
from jointwear.monitor.reading.windows import PER_WINDOW
from jointwear.robots.robot import Link

#: Mass [kg] and centre [m] of a part and of another one; noise, over the torque, that shows the part and that blurs it.
PART, OTHER = (6.0, (0.2, 0.0, 0.1)), (4.0, (-0.2, 0.0, 0.1))
QUIET, LOUD = 0.05, 0.14


@pytest.fixture(scope="module")
def piece_of(tmp_path_factory):
    """Return the piece of a log, by its number: its noise and what the robot carries in it."""
    folder = tmp_path_factory.mktemp("logs")
    first = write_parquet(folder / "first.parquet", columns(make_log(48.0, 0)))

    def made(number, noise, part=None):
        log = make_log(48.0, number, start=48.0 * number, noise=noise)
        if part is not None:
            body = Link(part[0], np.array(part[1]), 0.003 * np.eye(3))
            motion = log.position, log.velocity, log.acceleration
            laden = TorqueModel(replace(model().robot, payload=body))(*motion).total
            log = replace(log, torque=log.torque + laden - model()(*motion).total)
        path = write_parquet(folder / f"{number}.parquet", columns(log))
        found = read(path, first)
        assert not found.refused
        return Piece(str(path), found.statistics, found.first, found.last, loads=found.loads)

    return made


def left(piece):
    """What the windows leave of the torque of the second axis [N m]."""
    return np.sqrt(piece.statistics.noise_variance[:, 1])


def test_windows_that_show_a_load_clearly_tell_it_of_those_that_do_not(piece_of):
    clear, blurred = [piece_of(k, QUIET, PART) for k in (1, 2)], piece_of(5, LOUD, PART)
    assert all(p.loads.clear.all() and p.loads.doubtful is None for p in clear)
    assert not blurred.loads.clear.any()
    alone = with_settled_loads([blurred])[0]
    assert alone.statistics is blurred.statistics
    for order in ([*clear, blurred], [blurred, *clear]):
        *_, told = sorted(with_settled_loads(order), key=lambda p: p.log)
        assert (left(told) < 0.8 * left(blurred)).all()
        for name in PER_WINDOW:
            np.testing.assert_array_equal(getattr(told.statistics, name), getattr(blurred.loads.doubtful, name))


def test_windows_are_judged_with_what_all_logs_show(piece_of, monkeypatch, tmp_path):
    pieces, judged = [piece_of(1, QUIET, PART), piece_of(2, QUIET, PART), piece_of(5, LOUD, PART)], []

    def assembled(given, zone):
        judged.extend(given)
        raise InputError("that is all")

    monkeypatch.setattr(stages, "assemble", assembled)
    with pytest.raises(InputError):
        stages.judge_pieces(pieces, ROBOT, {}, tmp_path / "state.json", tmp_path / "alarms.csv")
    assert judged[2].statistics.square == pytest.approx(pieces[2].loads.doubtful.square)


def test_windows_without_the_load_or_with_another_one_stay_as_they_were_read(piece_of):
    clear = [piece_of(k, QUIET, PART) for k in (1, 2)]
    without, other = piece_of(4, LOUD), piece_of(3, LOUD, OTHER)
    assert len(without.loads) == 0
    assert len(other.loads) > 0
    assert not other.loads.clear.any()
    for piece in (without, other):
        assert with_settled_loads([*clear, piece])[-1].statistics is piece.statistics


def test_one_window_that_shows_a_load_tells_nothing_of_others(piece_of):
    one, blurred = piece_of(1, QUIET, PART), piece_of(5, LOUD, PART)
    again = [replace(one, log=f"{k}.csv") for k in range(5)]
    once = [replace(p, loads=replace(p.loads, moments=np.repeat(p.loads.moments[:1], 4, axis=0))) for p in again]
    assert with_settled_loads([*once, blurred])[-1].statistics is blurred.statistics


def test_loads_of_windows_come_back_from_a_file(piece_of, tmp_path):
    pieces = [piece_of(1, QUIET, PART), piece_of(5, LOUD, PART), piece_of(4, LOUD)]
    write_pieces(pieces, tmp_path / "pieces.nc", {})
    for one, other in zip(pieces, read_pieces(tmp_path / "pieces.nc"), strict=True):
        for name in PER_LOAD:
            assert np.array_equal(getattr(one.loads, name), getattr(other.loads, name)), name
        assert (one.loads.doubtful is None) == (other.loads.doubtful is None)
    back = read_pieces(tmp_path / "pieces.nc")
    for one, other in zip(with_settled_loads(pieces), with_settled_loads(back), strict=True):
        for name in PER_WINDOW:
            np.testing.assert_array_equal(getattr(one.statistics, name), getattr(other.statistics, name))
