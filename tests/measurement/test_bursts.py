"""Samples that are stamped when a packet of them arrives: bursts, and then a wait."""

import numpy as np
import pytest

from jointwear.measurement.checks.checked import checked
from jointwear.measurement.derived.motion import measure
from jointwear.measurement.formats.bursts import without_bursts
from jointwear.measurement.formats.chunk import Chunk
from jointwear.measurement.recording import Recording
from jointwear.measurement.refused import Refused
from jointwear.robots.robot import load_robot

RATE = 100.0
TIME = np.arange(0, 20, 1 / RATE)


def moved(time):
    return np.stack([0.6 * np.sin(2 * np.pi * f * time) for f in (0.3, 0.5)], axis=1)


def arrived(packet, delay=0.0, random=None, apart=2e-4):
    """Stamps of samples that are received in packets of so many, each `apart` [s] after the one before."""
    last = np.minimum((np.arange(len(TIME)) // packet + 1) * packet - 1, len(TIME) - 1)
    late = 0.0 if random is None else delay * random.random(len(TIME))[last]
    place = np.arange(len(TIME)) % packet
    return TIME[last] + 0.005 + late + apart * place


def log(stamps, keep=slice(None), label=None):
    q = moved(TIME)
    label = None if label is None else label[keep]
    return Chunk(stamps[keep], q[keep], 1.0 + q[keep], trajectory=label)


@pytest.mark.parametrize("packet", [2, 4, 9])
@pytest.mark.parametrize("apart", [0.0, 2e-4])
def test_samples_of_a_packet_are_spread_evenly(packet, apart):
    found = without_bursts(log(arrived(packet, apart=apart))).time
    assert np.all(np.diff(found) > 0)
    lag = found - TIME
    assert np.abs(lag - np.median(lag))[packet:].max() < 0.3 / RATE


def test_accelerations_are_those_of_even_samples():
    """Packets that are late by up to a fifth of a step, of which one in fifty is lost."""
    random = np.random.default_rng(np.random.SeedSequence(6))
    kept = (random.random(len(TIME)) > 0.02)[np.arange(len(TIME)) // 4]
    chunk = without_bursts(log(arrived(4, 0.002, random), kept))
    label = np.zeros(len(chunk.time), int)
    found = measure(Recording(chunk.time, label, np.round(chunk.position, 5), chunk.torque))
    true = -np.square(2 * np.pi * np.array([0.3, 0.5])) * moved(found.time - 0.0055)
    assert found.usable.all(axis=1).mean() > 0.8
    assert np.abs(found.acceleration - true)[found.usable.all(axis=1)].max() < 0.5


@pytest.mark.parametrize("uneven", [0.0, 0.9])
def test_other_stamps_are_left(uneven):
    """Even ones, ones that vary, and logs of a few samples on each event, which moved in between."""
    random = np.random.default_rng(np.random.SeedSequence(7))
    stamps = TIME + uneven * random.random(len(TIME)) / RATE
    assert np.array_equal(without_bursts(log(stamps)).time, stamps)
    events = np.concatenate([2.0 * k + np.arange(30) / RATE for k in range(40)])
    few = Chunk(events, moved(events), moved(events))
    assert np.array_equal(without_bursts(few).time, events)
    triples = np.concatenate([1.0 * k + np.arange(3) / RATE for k in range(40)])
    right = Chunk(triples, moved(triples), moved(triples))
    assert np.array_equal(without_bursts(right).time, triples)


def test_each_recording_is_spread_by_itself():
    stamps, label = arrived(4), (TIME >= 10.0).astype(int)
    stamps[label == 1] += 60.0
    found = without_bursts(log(stamps, label=label)).time
    lag = found - TIME - 60.0 * label
    assert np.abs(lag - np.median(lag)).max() < 0.5 / RATE


def test_stamps_that_leave_no_piece_are_refused():
    robot = load_robot("config/robots/puma560.yaml")
    triples = np.concatenate([1.0 * k + np.arange(3) / RATE for k in range(60)])
    q = np.repeat(moved(triples), 3, axis=1)
    with pytest.raises(Refused, match=r"no piece without a gap has 24 samples \(the longest has 3 of 180") as refused:
        checked(Recording(triples, np.zeros(180, int), q, 1.0 + q), robot)
    assert "at which it was taken" in refused.value.suggestion
