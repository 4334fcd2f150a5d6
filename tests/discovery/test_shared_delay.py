"""A log whose torque is late or early on all joints alike is read at the right time; one joint that is late is not."""

import copy
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
from discovery_cases import make_case

from jointwear.discovery import Settings, discover, pipeline
from jointwear.discovery.estimates.outcome import Named
from jointwear.discovery.linear import Term
from jointwear.discovery.problem.candidates import Candidate, raw_blocks
from jointwear.discovery.problem.setting_up import build_problem
from jointwear.discovery.search import shared_delay as module
from jointwear.discovery.search.recorded_in_time import Steps, coulomb_steps
from jointwear.discovery.search.searches import whitened
from jointwear.discovery.search.shared_delay import (
    delay_in_words,
    lasting_terms,
    sampling_period,
    shared_delay,
    without_delay,
)
from jointwear.effects import get_effect
from jointwear.measurement.recording import Recording, split
from jointwear.robots.robot import robot_from_data
from jointwear.robots.robot_file import read_robot_file


@pytest.fixture(scope="module")
def recording(robot):
    return split(make_case(robot, 29, lambda q, v, *_: np.zeros_like(q)))


_SEEN = {}


def _white(recording, robot):
    """What the search sees of a log; of the same samples it is worked out once."""
    key = (recording.time.tobytes(), recording.position.tobytes(), recording.torque.tobytes())
    if key not in _SEEN:
        _SEEN[key] = whitened(build_problem(recording, robot, Settings()))
    return _SEEN[key]


def _steps(recording, robot, delay):
    white = _white(recording, robot)
    return coulomb_steps(white, white.fit(), delay)


def _made_late(recording, robot, share):
    """The recording with its torque late by a share of a sampling period, friction turning between two samples."""
    late = share * sampling_period(recording)
    steps = _steps(recording, robot, late)
    return without_delay(recording, -late, Steps(steps.now, steps.late, steps.used))


def _found(recording, robot):
    period = sampling_period(recording)
    return shared_delay(_white(recording, robot), period) / period


def _whole(white, load):
    columns = get_effect(load.effect).columns(white.problem.train_state, 0, None, {})
    return {a: columns[:, a] for a in white.problem.judged}


@pytest.mark.long
@pytest.mark.parametrize("share", [-0.5, 0.0, 0.3])
def test_a_delay_of_all_joints_is_found(recording, robot, share):
    late = _made_late(recording, robot, share)
    assert _found(late, robot) == pytest.approx(share, abs=0.1)


def test_the_delay_of_one_joint_is_its_own(recording, robot):
    late = without_delay(recording, -0.5 * sampling_period(recording))
    torque = recording.torque.copy()
    torque[:, 1] = late.torque[:, 1]
    assert _found(replace(recording, torque=torque), robot) == 0.0
    later = without_delay(recording, -3.0 * sampling_period(recording))
    assert _found(later, robot) == 0.0


@pytest.mark.long
def test_torque_that_is_held_for_a_period_names_nothing(recording, robot):
    held = _made_late(recording, robot, -0.5)
    found = discover(held, robot)
    assert found.effects == []
    assert any("all joints is recorded" in told and "early" in told for told in found.data["restrictions"])


def _load(white):
    """What a payload adds, as a name."""
    load = Candidate("payload", None, None)
    blocks = raw_blocks(white, load)
    term = Term("payload", {a: white.columns(a, x) for a, x in _whole(white, load).items()}, np.ones(10), blocks)
    return Named(load, term, None, 99.0)


@pytest.mark.long
@pytest.mark.parametrize("late", [0.0, -0.5])
@pytest.mark.parametrize("read", [0.3, 0.0])
def test_a_delay_is_asked_again_beside_a_load(recording, robot, late, read):
    """Read 0.3 periods later than it was, or not, the torque is as late beside what was found as it was at first."""
    period = sampling_period(recording)
    came = _made_late(recording, robot, late)
    put_right = without_delay(came, read * period, _steps(came, robot, read * period))
    white = _white(put_right, robot)
    asked = shared_delay(white, period, lasting_terms([_load(white)]), read * period) / period
    assert asked == pytest.approx(late, abs=0.07)


def test_a_log_that_is_read_right_stays_so(recording, robot):
    period = sampling_period(recording)
    came = _made_late(recording, robot, -0.5)
    read = -0.48 * period
    white = _white(without_delay(came, read, _steps(came, robot, read)), robot)
    assert shared_delay(white, period, (), read) == read


@pytest.mark.parametrize(("undo", "stays"), [(2, True), (3, False)])
def test_nothing_is_read_that_the_names_of_three_joints_undo(recording, robot, undo, stays):
    period = sampling_period(recording)
    white = _white(recording, robot)
    read = 0.3 * period
    named = {axis: -read if axis < undo else read for axis in range(3)}
    assert shared_delay(white, period, read=read, named=named) == (read if stays else 0.0)


def test_names_of_timing_are_nothing_that_lasts(recording, robot):
    white = _white(recording, robot)
    load = _load(white)
    late = Named(Candidate("actuation_delay", 1, None, {"delay": 0.003, "lag": 0}), load.term, None, 99.0)
    assert lasting_terms([load, late]) == lasting_terms([load]) == [load.term]


@pytest.mark.long
def test_a_delay_that_a_tilt_hides_is_taken_out_beside_it(recording, robot):
    """A torque held for a period on a base that is not level: the tilt is named, and no joint gets a delay."""
    content = copy.deepcopy(read_robot_file("config/robots/puma560.yaml"))
    content["gravity"] = [0.35, 0.0, -9.8]
    held = without_delay(make_case(robot_from_data(content), 29), 0.5 * sampling_period(recording))
    found = discover(held, robot)
    assert [e["effect"] for e in found.effects] == ["mounting_tilt"]
    assert any("all joints is recorded" in told and "early" in told for told in found.data["restrictions"])


def test_torque_is_read_later_within_each_trajectory():
    time, trajectory = np.array([0.0, 0.1, 0.2, 5.0, 5.1, 5.2]), np.array([0, 0, 0, 1, 1, 1])
    torque = np.array([0.0, 1.0, 2.0, 10.0, 12.0, 14.0])[:, None]
    recording = Recording(time, trajectory, np.zeros((6, 1)), torque)
    assert sampling_period(recording) == pytest.approx(0.1)
    np.testing.assert_allclose(without_delay(recording, 0.05).torque[:, 0], [0.5, 1.5, 2.5, 11.0, 13.0, 15.0])
    np.testing.assert_allclose(without_delay(recording, -0.05).torque[:, 0], [-0.5, 0.5, 1.5, 9.0, 11.0, 13.0])
    holed = replace(recording, torque=np.where(np.arange(6)[:, None] == 1, np.nan, torque))
    np.testing.assert_allclose(without_delay(holed, 0.05).torque[3:, 0], [11.0, 13.0, 15.0])
    uneven = replace(recording, time=np.array([0.0, 0.1, 0.3, 5.0, 5.1, 5.3]))
    np.testing.assert_allclose(without_delay(uneven, 0.05).torque[:3, 0], [0.5, 1.25, 2.0])
    assert "2 ms early (0.50 of a sampling period)" in delay_in_words(-0.002, 0.004)
    assert "late" in delay_in_words(0.002, 0.004)
    unsure = delay_in_words(-0.002, 0.004, unexplained=True)
    assert "2 ms early (0.50 of a sampling period)" in unsure
    assert "unexplained" in unsure
    assert "that is how the log is sampled" not in unsure
    beside = delay_in_words(-0.002, 0.004, named=True)
    assert "recorded about 2 ms early (0.50 of a sampling period), as far as that can be told" in beside
    assert "that is how the log is sampled" not in beside


def _curves(monkeypatch, model, recorded):
    """Let every joint tell a parabola of nats: (delay in periods, nats that a period costs) by model and torque."""

    def told(white, fit, period, shares, recorded_torque=False, **more):
        chosen = recorded if more.get("recorded", recorded_torque) else model
        return {axis: size * (shares - place) ** 2 for axis, (place, size) in chosen.items()}

    monkeypatch.setattr(module, "_of_joints", told)


def test_the_recorded_torque_tells_among_all_that_the_model_leaves_open(recording, robot, monkeypatch):
    """Three joints say "early", none how much: the best of the model is the largest that is asked."""
    flat, sharp = dict.fromkeys(range(3), (-0.8, 30.0)), dict.fromkeys(range(6), (-0.44, 3000.0))
    _curves(monkeypatch, {**flat, **dict.fromkeys(range(3, 6), (0.0, 0.1))}, sharp)
    assert _found(recording, robot) == pytest.approx(-0.44, abs=0.01)


@pytest.mark.parametrize(
    ("others", "by_model", "expected"),
    [
        ((-0.43, -0.45, -0.44, -0.42, 0.0), 0.0, -0.44),
        ((-0.43, -0.45, 0.0, 0.1, 0.0), 0.0, 0.0),  # two agree
        ((0.0, 0.0, 0.0, 0.0, 0.0), 0.0, 0.0),  # a delay of one joint
        ((-0.43, -0.45, -0.44, -0.42, 0.0), 3.0, 0.0),  # the model speaks against it
    ],
)
def test_joints_agree_by_their_torque_with_one_that_has_a_name(
    recording, robot, monkeypatch, others, by_model, expected
):
    model = {0: (-0.4, 50.0), **dict.fromkeys(range(1, 6), (0.0 if by_model else -0.3, by_model or 0.5))}
    _curves(monkeypatch, model, {0: (-0.44, 3000.0), **{a: (x, 3000.0) for a, x in enumerate(others, start=1)}})
    period = sampling_period(recording)
    white = _white(recording, robot)
    assert shared_delay(white, period) == 0.0
    asked = shared_delay(white, period, named={0: -0.4 * period}) / period
    assert asked == pytest.approx(expected, abs=0.03)


@pytest.mark.parametrize(
    ("shares", "by_model", "expected"),
    [
        ((0.25, 0.22, 0.26, 0.25, 0.28, 0.27), 0.5, 0.25),
        ((0.25, 0.22, 0.26, 0.25, 0.28, None), 0.5, 0.25),  # the last tells none
        ((0.25, 0.22, 0.26, 0.25, 0.28, -0.2), 0.5, 0.0),  # the last tells another
        ((0.25, 0.22, 0.26, None, None, None), 0.5, 0.0),  # half of the joints
        ((-0.25, -0.22, -0.26, -0.25, -0.28, -0.27), 0.5, 0.0),  # as an answer to the noise of an encoder seems
        ((0.25, 0.22, 0.26, 0.25, 0.28, 0.27), 60.0, 0.0),  # the model of all joints speaks against it
    ],
)
def test_torque_that_is_late_alike_by_what_was_recorded_is_that_of_the_log(
    recording, robot, monkeypatch, shares, by_model, expected
):
    told = {axis: (0.0, 0.1) if share is None else (share, 3000.0) for axis, share in enumerate(shares)}
    _curves(monkeypatch, dict.fromkeys(range(6), (0.0, by_model)), told)
    asked = shared_delay(_white(recording, robot), sampling_period(recording)) / sampling_period(recording)
    assert asked == pytest.approx(expected, abs=0.03)


def test_what_averages_two_samples_is_no_late_torque(recording, robot, monkeypatch):
    """As good early as late."""

    def told(white, fit, period, shares, recorded=False):
        nats = 300.0 * (np.abs(shares) - 0.5) ** 2 if recorded else 0.1 * shares**2
        return dict.fromkeys(range(6), nats - nats.min())

    monkeypatch.setattr(module, "_of_joints", told)
    assert shared_delay(_white(recording, robot), sampling_period(recording)) == 0.0


def test_joints_with_names_agree_with_each_other(recording, robot, monkeypatch):
    shares = (-0.42, -0.38, -0.4, -0.44, -0.37, -0.41)
    model = dict.fromkeys(range(6), (-0.3, 0.5))
    _curves(monkeypatch, model, {axis: (share, 3000.0) for axis, share in enumerate(shares)})
    period, white = sampling_period(recording), _white(recording, robot)
    for count in (1, 3, 6):
        named = {axis: share * period for axis, share in enumerate(shares[:count])}
        assert shared_delay(white, period, named=named) / period == pytest.approx(-0.4, abs=0.03)
    # Neither model nor torque need show what most have alike in their names.
    _curves(monkeypatch, dict.fromkeys(range(6), (0.0, 50.0)), dict.fromkeys(range(6), (0.0, 3000.0)))
    named = {axis: share * period for axis, share in enumerate(shares[:4])}
    assert shared_delay(white, period, named=named) / period != 0.0
    assert shared_delay(white, period, named=dict(list(named.items())[:3])) == 0.0
    # Names that do not agree are the delays of their joints.
    _curves(monkeypatch, model, {axis: (-0.1 * axis, 3000.0) for axis in range(6)})
    named = {axis: -0.1 * axis * period for axis in range(1, 6)}
    assert shared_delay(white, period, named=named) == 0.0


@pytest.mark.parametrize(("read", "stays"), [(0.57, False), (-0.3, True)])
def test_what_was_read_goes_where_the_delay_ends_beyond_the_other_side(recording, robot, monkeypatch, read, stays):
    """A tilt without a name said "late"; beside it the model says half a period early, the torque still earlier."""
    model, recorded = (dict.fromkeys(range(4), (place - read, 60.0)) for place in (-0.5, -0.9))
    _curves(monkeypatch, model, recorded)
    period = sampling_period(recording)
    asked = shared_delay(_white(recording, robot), period, read=read * period)
    assert asked == (read * period if stays else 0.0)


@pytest.mark.long
@pytest.mark.parametrize(
    ("asked", "read"), [((0.4, -0.5, 0.0), 0.0), ((0.4, -0.5, -0.5, -0.5), -0.5), ((0.4, 0.3, 0.3), 0.3)]
)
def test_between_late_and_early_the_log_is_read_as_it_came(recording, robot, monkeypatch, asked, read):
    """A delay that is found on the other side beside what has a name may be the first one, taken out too far."""
    period, answers = sampling_period(recording), list(asked)
    monkeypatch.setattr(pipeline, "shared_delay", lambda *_: answers.pop(0) * period)
    found = SimpleNamespace(named=[], unexplained=[])

    def search(white, _):
        found.white, found.named = white, [_load(white)]
        return found

    monkeypatch.setattr(pipeline, "beside_slow_noise", search)
    white = _white(recording, robot)
    log, outcome, told = pipeline.read_in_time(recording, white)
    assert not answers
    assert (outcome.white is white) == (log is recording) == (not told) == (read == 0.0)
    assert not told or f"({abs(read):.2f} of a sampling period)" in told[0]
