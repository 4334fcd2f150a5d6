"""Rows of two robots in one file are told as that; what one arm does, and what a faulty encoder says, is not."""

import numpy as np
import pytest

from jointwear.files.errors import InputError
from jointwear.measurement.formats.chunk import Chunk
from jointwear.measurement.formats.two_sources import check_one_source

RATE = 50.0
TIME = np.arange(0, 40, 1 / RATE)


def moved(time, phase=0.0):
    return np.stack([0.9 * np.sin(2 * np.pi * f * time + phase) for f in (0.31, 0.2, 0.53)], axis=1)


def chunk(time, position):
    return Chunk(time, position, 1.0 + position)


def merged(*sources):
    time, position = (np.concatenate(parts) for parts in zip(*sources, strict=True))
    order = np.argsort(time, kind="stable")
    return chunk(time[order], position[order])


@pytest.mark.parametrize("apart", [0.0, 0.1, 0.4])
@pytest.mark.parametrize("others", [1, 2])
def test_rows_of_several_robots_are_refused_in_words(apart, others):
    sources = [(TIME + k * apart / RATE, moved(TIME, 1.3 * k)) for k in range(others + 1)]
    with pytest.raises(InputError, match="two robots, or two sources, seem to be in one file; write the rows of each"):
        check_one_source("log.csv", merged(*sources))


def test_a_second_robot_that_is_logged_less_often_or_in_a_part_alone_is_found():
    slow = TIME[::2]
    half = TIME > 20.0
    for other in ((slow, moved(slow, 1.3)), (TIME[half], moved(TIME[half], 1.3))):
        with pytest.raises(InputError, match="two sources"):
            check_one_source("log.csv", merged((TIME, moved(TIME)), other))


@pytest.mark.parametrize("rows", [1, 3])
def test_one_robot_is_one_source(rows):
    random = np.random.default_rng(1)
    q = moved(TIME)[np.arange(len(TIME)) // rows * rows]
    one = [q, q + 1e-3 * random.standard_normal(q.shape), np.degrees(q), (q + np.pi) % (2 * np.pi) - np.pi]
    still = np.full_like(q, np.pi) * np.where(np.arange(len(q)) % 2, 1, -1)[:, None]
    faulty = q.copy()
    faulty[::2, 1] = 0.0
    torn = q.copy()
    torn[::40] = 0.0
    noise = random.uniform(-1, 1, (len(TIME), 6))
    for position in (*one, still, faulty, torn, noise, q * np.nan):
        check_one_source("log.csv", chunk(TIME, position))
    # A light arm between two places at 10 Hz, twice a second, is back at nearly every other row.
    quick = 0.45 * np.sin(2 * np.pi * 2.4 * np.arange(400) / 10.0)[:, None] * np.ones(3)
    check_one_source("log.csv", chunk(np.arange(400) / 10.0, quick))
    # Where the arm is minutes later says nothing of where it was in between.
    check_one_source("log.csv", chunk(60.0 * np.arange(len(TIME)), np.where(np.arange(len(q)) % 2, 1, -1)[:, None] * q))
    check_one_source("log.csv", chunk(TIME[:2], q[:2]))
