"""Lines and chirps over time in what a model leaves: structure without a name, as of a machine beside the arm."""

from __future__ import annotations

from collections import Counter
from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from scipy.special import gammaincc, gammaincinv

from jointwear.discovery.noise.spectra import SURROUNDINGS
from jointwear.discovery.structure import TIME_BIN, time_bins
from jointwear.effects.state import State

#: Chirps are looked for below this frequency [Hz]: what shakes an arm at a rate that changes is a machine beside it.
FASTEST_CHIRP = 20.0
#: Sweeps in one record [Hz] up to which neighbouring rates of chirps differ by one cell, and by `COARSER` cells.
SLOW_SWEEP, WIDEST_SWEEP, COARSER = 5.0, 20.0, 4
#: Samples that a record must have to be asked.
FEWEST_OF_RECORD = 100


def _level(power: np.ndarray, records: int = 1) -> np.ndarray:
    """Return the mean power (r, k) around each cell of spectra (r, k), at least 1, from medians that no line moves.

    Parameters
    ----------
    records : of which the spectra are means.
    """
    rates, size = power.shape
    if size < 3 * SURROUNDINGS:
        return np.ones((1, 1))
    blocks = power.reshape(rates, -1, SURROUNDINGS)
    median = np.maximum(np.median(blocks, axis=2) * records / gammaincinv(records, 0.5), 1.0)
    padded = np.concatenate([median[:, :1], median, median[:, -1:]], axis=1)
    return np.repeat(np.maximum(np.maximum(padded[:, :-2], median), padded[:, 2:]), SURROUNDINGS, axis=1)


@dataclass(frozen=True)
class Line:
    """A line or chirp over time: power is in units of the noise (mean 1 if there is none)."""

    power: float
    p_value: float
    frequency: float
    rate: float
    record: int


def _lines(series: np.ndarray, rate: float, filled: int) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return frequencies (k,) [Hz], the chirp rate 0 and power (1, k) of one record."""
    size = 2 ** int(np.ceil(np.log2(len(series))))
    power = np.abs(np.fft.fft(series, size)[None, : size // 2]) ** 2 / filled
    return np.arange(size // 2) * rate / size, np.zeros(1), power


@lru_cache(maxsize=8)
def _sweeps(count: int, rate: float) -> tuple[np.ndarray, np.ndarray]:
    """Return the rates (r,) [Hz/s] of chirps that are asked of `count` samples, and what takes each off (r, size).

    `size` is that of the band below :data:`FASTEST_CHIRP`, turned back into a short series of its own.
    """
    span = count / rate
    fine = np.arange(1, int(SLOW_SWEEP * span) + 1)
    cells = np.concatenate([fine, np.arange(fine[-1] + COARSER, WIDEST_SWEEP * span, COARSER)])
    rates = np.concatenate([-cells[::-1], [0], cells]) / span**2
    band = min(max(int(FASTEST_CHIRP * span), 1), count // 2 + 1)
    size = 2 ** int(np.ceil(np.log2(band)))
    t = np.arange(size) * span / size
    return rates, np.exp(-1j * np.pi * np.outer(rates, t**2))


def _chirps(series: np.ndarray, rate: float, filled: int) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return the same for chirps below :data:`FASTEST_CHIRP`: frequencies (k,), rates (r,) [Hz/s], power (r, k).

    Only the band in which chirps are looked for is turned back: its spectrum is a short series of its own, above whose
    band lie sweeps from below zero: what is slow, which all records have.
    """
    span = len(series) / rate
    rates, sweeps = _sweeps(len(series), rate)
    size = sweeps.shape[1]
    turned = np.fft.ifft(np.fft.rfft(series)[: max(int(FASTEST_CHIRP * span), 1)], size)
    spectra = np.fft.fft(sweeps * turned, 2 * size, axis=1)
    frequency = np.arange(2 * size) / (2 * span)
    within = spectra[:, : _in_band(frequency, rate)]
    return frequency[: within.shape[1]], rates, (within.real**2 + within.imag**2) / filled


def _in_band(frequency: np.ndarray, rate: float) -> int:
    """Return how many of the frequencies (k,) [Hz] of chirps lie in their band, in whole `SURROUNDINGS` if it is
    wide."""
    count = int(np.searchsorted(frequency, min(FASTEST_CHIRP, 0.5 * rate)))
    return count - count % SURROUNDINGS if count >= 3 * SURROUNDINGS else count


def _largest(power: np.ndarray, records: int = 1) -> tuple[int, int, float]:
    """Return place and size of the cell of spectra (r, k), means of `records`, that stands out most around it.

    Surroundings count as 1 at least: once a cell stands out by more than another spectrum reaches at all, that one and
    all below it need not be asked.
    """
    highest = power.max(axis=1)
    best = (0, 0, -np.inf)
    for row in np.argsort(-highest, kind="stable"):
        if highest[row] <= best[2]:
            break
        over = power[row] / _level(power[[row]], records)[0]
        cell = int(np.argmax(over))
        if over[cell] > best[2]:
            best = (int(row), cell, float(over[cell]))
    return best


def strongest_line(residual: np.ndarray, rows: np.ndarray, state: State, rate: float) -> Line | None:
    """Search the whitened residual of one axis for a line or linear chirp over time, in each record and in all.

    Chirps are sought in all records together where these are as long as each other: a machine that starts with each of
    them sweeps in the same way, and shows in their mean before it shows in any.

    The residual is put back on its time grid (zero where there is no sample) and Fourier-transformed; its lower part is
    multiplied by exp(-i pi c t^2) for a grid of chirp rates c before. Under white noise each cell is
    exponential with mean one. Where its surroundings hold more than that, the noise is not quite white, and a line has
    to stand out of them. `p_value` counts the cells searched.
    """
    label = np.asarray(state.record)
    pieces = []
    for one in np.unique(label):
        index = np.flatnonzero(label == one)
        series = np.zeros(len(index))
        chosen = rows[(rows >= index[0]) & (rows <= index[-1])]
        if len(chosen) < FEWEST_OF_RECORD:
            continue
        series[chosen - index[0]] = residual[np.searchsorted(rows, chosen)]
        pieces.append((int(one), series, len(chosen)))
    best: Line | None = None
    cells = 0
    together: dict[int, tuple[np.ndarray, int]] = {}
    lengths = Counter(len(series) for _, series, _ in pieces)
    swept: dict[int, tuple[np.ndarray, np.ndarray, np.ndarray]] = {}
    for one, series, filled in pieces:
        for frequency, chirp, power in (_lines(series, rate, filled), _chirps(series, rate, filled)):
            cells += power.size // 2
            row, cell, value = _largest(power)
            if best is None or value > best.power:
                best = Line(value, 1.0, float(frequency[cell]), float(chirp[row]), one)
            if len(chirp) == 1:
                old, count = together.get(len(frequency), (0.0, 0))
                together[len(frequency)] = (old + power[0] / _level(power)[0], count + 1)
            elif lengths[len(series)] > 1:
                before = swept[len(series)][2] if len(series) in swept else 0.0
                swept[len(series)] = frequency, chirp, before + power
    if best is None:
        return None
    p = min(1.0, cells * float(np.exp(-best.power)))
    for size, (power, count) in together.items():
        where = int(np.argmax(power))
        joint = min(1.0, len(power) * float(gammaincc(count, power[where])))
        if joint < p:
            p = joint
            best = Line(float(power[where]), joint, float(0.5 * where * rate / size), 0.0, -1)
    for length, (frequency, chirp, power) in swept.items():
        count = lengths[length]
        row, cell, value = _largest(power / count, count)
        joint = min(1.0, 0.5 * power.size * float(gammaincc(count, count * value)))
        if joint < p:
            p = joint
            best = Line(count * value, joint, float(frequency[cell]), float(chirp[row]), -1)
    return Line(best.power, p, best.frequency, best.rate, best.record)


def _turned(
    line: Line, residual: np.ndarray, rows: np.ndarray, state: State, rate: float
) -> list[tuple[np.ndarray, np.ndarray]]:
    """Return, of each record that a line was found in, which samples (k,) lie in it and their whitened residual turned
    back by the line."""
    label, pieces = np.asarray(state.record), []
    for one in np.unique(label) if line.record < 0 else [line.record]:
        inside = label[rows] == one
        time = (rows[inside] - np.flatnonzero(label == one)[0]) / rate
        back = np.exp(-2j * np.pi * (line.frequency * time + 0.5 * line.rate * time**2))
        pieces.append((inside, residual[inside] * back))
    return pieces


def where_strongest(line: Line, residual: np.ndarray, rows: np.ndarray, state: State, rate: float) -> np.ndarray:
    """Return which samples (m,) of a whitened residual lie in the bin of time in which a line is strongest."""
    turned = np.zeros(len(rows), complex)
    for inside, piece in _turned(line, residual, rows, state, rate):
        turned[inside] = piece
    bins = time_bins(state, TIME_BIN)[rows]
    power = np.abs(turned @ bins) ** 2 / np.maximum(bins.sum(axis=0), 1.0)
    return bins[:, int(np.argmax(power))] > 0


def chance_of(line: Line, residual: np.ndarray, rows: np.ndarray, state: State, rate: float) -> float:
    """Return how likely noise alone holds as much of one line as the samples `rows` (m,) do.

    As for :func:`strongest_line` the line has to stand out of what is around it.
    """
    pieces = [piece for _, piece in _turned(line, residual, rows, state, rate) if len(piece)]
    total = 0.0
    for piece in pieces:
        near = np.abs(np.fft.fft(piece)) ** 2 / len(piece)
        around = np.concatenate([near[1 : SURROUNDINGS // 2 + 1], near[-(SURROUNDINGS // 2) :]])
        total += float(near[0]) / max(float(np.median(around)) / np.log(2.0), 1.0)
    return float(gammaincc(max(len(pieces), 1), total))
