"""What of a growth is viscous, named for an episode; which limit comes first; what is back to normal."""

from __future__ import annotations

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from jointwear.monitor.events import Event
from jointwear.monitor.findings.findings import _returned, _services, _shared
from jointwear.monitor.watching.limits import COULOMB as COULOMB_FRICTION
from jointwear.monitor.watching.limits import VISCOUS as VISCOUS_FRICTION
from jointwear.monitor.watching.limits import Limits
from jointwear.monitor.watching.parts import viscous_growth, viscous_part
from jointwear.monitor.watching.present import back_to_normal, coulomb_growth
from jointwear.monitor.watching.records import Teller
from jointwear.monitor.watching.watched_axis import Start


def watched(residual, source="friction", alarm_from=None, std=0.005):
    """What a watch says of one axis: residuals (s, per) of shifts, alarms from shift `alarm_from` on, no start."""
    residual = np.array(residual, dtype=float)  # a copy: a test may take values out
    w = residual.size
    column = residual.reshape(w, 1)
    alarm = np.arange(w) >= (w if alarm_from is None else alarm_from * residual.shape[1])
    normal = SimpleNamespace(
        source=source, to_coulomb=1.5, of_viscous=1.0, dispersion=SimpleNamespace(between=0.005, memory=0.0),
        fit=SimpleNamespace(left_out_variance=np.full(w, 0.002**2)),
    )  # fmt: skip
    return SimpleNamespace(
        axes=[normal], residual=column, std=np.full((w, 1), std), noise=np.full((w, 1), std**2), starts=[[]],
        alarm=alarm[:, None], shifts=np.full((w, 1), 2), baseline=np.zeros(w, dtype=bool),
    )  # fmt: skip


#: Growth of an axis in 16 shifts of 4 windows: none in six, then more with every shift.
GROWN = np.repeat(0.03 * np.maximum(np.arange(16) - 5, 0), 4).reshape(16, 4)
SHIFT = np.repeat(np.arange(16), 4)


def noise_of(seed, size=0.004):
    return size * np.random.default_rng(seed).standard_normal(GROWN.shape)


def part_of(level, viscous, share=0.5):
    return viscous_part(level, viscous, 0, SHIFT, viscous_growth(level, viscous, 0, SHIFT, share))


def test_while_viscous_friction_grows_coulomb_friction_does_not():
    level = watched(np.log1p(GROWN) + noise_of(0), alarm_from=8)
    viscous = watched(GROWN + noise_of(1))
    part, spread = part_of(level, viscous)
    left = np.expm1(level.residual[:, 0]) - part
    # From the first shift that the first alarm rests on; the shifts before it are as they were.
    assert np.abs(left[28:]).max() < 0.03
    assert np.abs([left[4 * k : 4 * k + 4].mean() for k in range(7, 16)]).max() < 0.01
    assert not part[:28].any()
    assert (spread[28:] > 0).all()


def test_windows_that_do_not_show_viscous_friction_take_it_from_their_shift():
    level, viscous = (watched(x, alarm_from=8) for x in (np.log1p(GROWN), GROWN))
    viscous.residual[40:42] = viscous.residual[44:48] = np.nan
    part, _ = part_of(level, viscous)
    assert part[40:48] == pytest.approx(0.03 * 5)


def test_one_shift_that_looks_viscous_does_not_take_the_name_of_an_episode():
    """Two parts, not told apart: in some shifts the viscous part is off, before the wear as well as in it."""
    level = watched(np.log1p(GROWN) + noise_of(2), alarm_from=8)
    odd = np.zeros_like(GROWN)
    odd[[2, 8, 12]] = 0.2
    viscous = watched(odd + noise_of(3))
    assert not viscous_growth(level, viscous, 0, SHIFT, 0.5).named.any()
    assert not part_of(level, viscous)[0].any()


@pytest.mark.parametrize(
    ("later", "words"),
    [
        ([], "came back to its normal state: was it serviced? Its alarm"),
        ([0.0, 0.3], "came back to its normal state: was it serviced? Its alarm"),
        ([0.01, 0.02], "came back to its normal state: was it serviced? Its alarm"),
        ([0.2, 0.3], "came back to its normal state, and has grown again since: was it serviced then? Its alarm"),
    ],
)
def test_an_axis_that_came_back_and_has_grown_again_is_told_as_that(later, words):
    means = np.array([0.3, 0.3, 0.0, 0.0, *later])
    level = watched(np.repeat(means, 4).reshape(-1, 4))
    shift = np.repeat(np.arange(len(means)), 4)
    statistics = SimpleNamespace(start=3600.0 * np.arange(len(shift)))
    (found,) = _returned(statistics, shift, level, np.ones((len(shift), 1), dtype=bool))
    assert words in found["words"]
    assert found["time"] == 8 * 3600.0


def test_an_axis_that_fell_since_its_alarm_is_as_what_it_was_learnt_anew_from():
    """One greasing was three entries: an alarm, a fall two days later, and a return to normal five days after that."""
    means = np.array([0.3, 0.3, 0.3, 0.0, 0.0])
    level = watched(np.repeat(means, 4).reshape(-1, 4))
    shift, changed = np.repeat(np.arange(5), 4), np.ones((20, 1), dtype=bool)
    statistics = SimpleNamespace(start=3600.0 * np.arange(20))
    for starts, count in (([], 1), ([Start(12, True)], 0), ([Start(12, False)], 1)):
        level.starts = [starts]
        assert len(_returned(statistics, shift, level, changed)) == count


def test_falls_within_a_fortnight_are_one_question_and_after_a_service_none():
    day = 86400.0
    statistics = SimpleNamespace(start=day * np.arange(60), dated=False)
    level = SimpleNamespace(starts=[[Start(k, True, doubtful=k == 50) for k in (20, 25, 50)]])
    service = Event(19.5 * day, (0,), "service")
    once, later = _services(statistics, level, set())
    assert (once["time"], later["time"]) == (20 * day, 50 * day)
    assert once["words"].startswith("Friction of axis 1 fell, and again 600 h: was it serviced")
    assert ("fell" in once, "fell" in later) == (False, True)
    wanders = "until then growth alarms only beyond what was normal before the fall"
    assert (wanders in once["words"], wanders in later["words"]) == (False, True)
    told, later = _services(statistics, level, set(), [service])
    assert told["answered"]
    assert told["words"].startswith("Friction of axis 1 fell further after the service of 468 h, the last time 600 h")
    assert "answered" not in later
    # Somebody who looked at an alarm has worked no grease in, and a service of another axis none here.
    for other in (replace(service, kind="acknowledged"), replace(service, axes=(1,))):
        assert not any("answered" in found for found in _services(statistics, level, set(), [other]))


def test_the_share_of_a_level_without_viscous_friction_is_not_known():
    level = watched(np.log1p(GROWN), "coulomb", alarm_from=8)
    part, spread = part_of(level, watched(GROWN))
    assert np.isnan(part[28:]).all()
    assert not part[:28].any()
    assert not spread.any()


@pytest.mark.parametrize(("source", "of_viscous", "share"), [("friction", 1.0, 1.0), ("coulomb", 1.6, 0.5)])
def test_viscous_growth_beside_more_of_coulomb_friction_is_taken_off_it(source, of_viscous, share):
    """Most of the growth is of Coulomb friction, whether the level holds viscous friction or takes of it."""
    level = watched(np.log1p((0.7 + 0.2 * of_viscous) * GROWN) + noise_of(7), source, alarm_from=8)
    level.axes[0].of_viscous = of_viscous
    viscous = watched(0.2 * GROWN + noise_of(8))
    grown = viscous_growth(level, viscous, 0, SHIFT, share)
    assert not grown.named.any()
    part, spread = part_of(level, viscous, share)
    left = np.expm1(level.residual[28:, 0]) - part[28:]
    assert left == pytest.approx(0.7 * GROWN.ravel()[28:], abs=0.03)
    assert not part[:28].any()
    assert (spread[36:] > 0).all()
    # The limit of Coulomb friction comes as late as without what is viscous.
    hours = 3600.0 * np.arange(64)
    plain = watched(np.log1p(0.7 * GROWN) + noise_of(7), source, alarm_from=8)
    of_both, of_one = (
        Limits(seen, too, np.array([share]), SHIFT, hours, 0.6).forecast(0, COULOMB_FRICTION).hours_from(hours[-1])[0]
        for seen, too in ((level, viscous), (plain, watched(noise_of(9))))
    )
    assert of_both == pytest.approx(of_one, rel=0.15)


@pytest.mark.parametrize(("coulomb", "viscous", "first"), [(1.0, 0.1, COULOMB_FRICTION), (0.2, 0.8, VISCOUS_FRICTION)])
def test_the_limit_that_is_reached_first_is_told(coulomb, viscous, first):
    """Half of the friction is viscous: it reaches a fifth more sooner where most of the growth is its own."""
    level = watched(np.log1p(0.3 * (coulomb + viscous) * GROWN), alarm_from=8)
    part = watched(0.3 * viscous * GROWN)
    level.axes[0].to_coulomb = 2.0
    limits = Limits(level, part, np.array([0.5]), SHIFT, 3600.0 * np.arange(64), 0.2)
    for name in (COULOMB_FRICTION, VISCOUS_FRICTION):
        assert limits.forecast(0, name).quantity == first


def test_viscous_friction_that_rose_on_all_axes_gives_the_limit_of_coulomb_friction_no_date():
    """In a cold spell viscous friction read +55 %, and the forecast was that its limit is reached."""
    cold = np.repeat(np.where(np.arange(16) >= 11, 0.3, 0.0), 4).reshape(16, 4)
    level, part = watched(np.log1p(0.3 * GROWN), alarm_from=8), watched(cold + noise_of(4))
    for together, first in ((None, VISCOUS_FRICTION), (cold.ravel() > 0, COULOMB_FRICTION)):
        limits = Limits(level, part, np.array([0.5]), SHIFT, 3600.0 * np.arange(64), 0.2, together)
        assert limits.forecast(0, COULOMB_FRICTION).quantity == first


def test_growth_that_is_gone_has_no_date_of_a_limit():
    gone = np.log1p(np.concatenate([GROWN[:12], np.zeros((4, 4))])) + noise_of(5)
    for shifts, dated in ((12, True), (16, False)):
        level, viscous = watched(gone[:shifts], alarm_from=8), watched(noise_of(6)[:shifts])
        w = 4 * shifts
        limits = Limits(level, viscous, np.array([0.5]), SHIFT[:w], 3600.0 * np.arange(w), 0.2)
        assert (limits.forecast(0, COULOMB_FRICTION, now=True) is not None) is dated


def test_what_came_back_is_told_from_what_lasts():
    gone = np.log1p(np.concatenate([GROWN[:12], np.zeros((4, 4))]))
    end = 6 * 3600.0 * np.arange(64)
    for residual, back in ((gone, True), (np.log1p(GROWN), False)):
        level = watched(residual + noise_of(5), alarm_from=8)
        level.mean = np.full((64, 1), 0.1)
        assert back_to_normal([(level, level.alarm)], SHIFT, end).tolist() == [back]
    # An axis without an alarm is not back from anything.
    assert not back_to_normal([(level, np.zeros((64, 1), dtype=bool))], SHIFT, end).any()
    level.starts = [[Start(60, False)]]
    assert not back_to_normal([(level, np.arange(64)[:, None] == 40)], SHIFT, end).any()


def test_axes_that_move_together_say_until_when():
    common = np.zeros(64)
    common[20:40] = np.repeat([0.05, 0.09, 0.06, 0.05, 0.04], 4)
    level = SimpleNamespace(shared=SimpleNamespace(common=common))
    hours = SimpleNamespace(start=3600.0 * np.arange(64), end=3600.0 * np.arange(1, 65))
    (told,) = _shared(hours, SHIFT, np.arange(64) < 8, level)
    assert (told["time"], told["end"]) == (20 * 3600.0, 40 * 3600.0)
    assert "together by up to +9 %, for 20 h, and no more since" in told["words"]
    common[40:] = 0.05
    (told,) = _shared(hours, SHIFT, np.arange(64) < 8, level)
    assert "end" not in told
    assert "to this day" in told["words"]


@pytest.mark.parametrize(
    ("mean", "name"),
    [
        (0.1, VISCOUS_FRICTION),
        (0.005, COULOMB_FRICTION),
        (-0.04, COULOMB_FRICTION),
        (np.nan, COULOMB_FRICTION),
    ],
)
def test_what_no_longer_shows_in_the_viscous_part_is_no_alarm_of_it(mean, name):
    """An alarm told that viscous friction had changed by -0.04 N m s/rad, with a probability of 0.99."""
    axis = SimpleNamespace(source="coulomb")
    level = SimpleNamespace(alarm=np.array([[True]]), mean=np.array([[0.2]]), mean_std=np.array([[0.01]]), axes=[axis])
    viscous = SimpleNamespace(mean=np.array([[mean]]), mean_std=np.array([[0.01]]))
    teller = SimpleNamespace(_level=level, _viscous=viscous)
    assert Teller._parts(teller, 0, 0, True)[:2] == (name, mean if name == VISCOUS_FRICTION else 0.2)


def test_an_error_of_a_logarithm_is_told_as_one_of_the_growth():
    """0.005 of a level that has tripled is 1.5 % of what it was."""
    end = 3600.0 * np.arange(SHIFT.size)
    still = watched(noise_of(1))
    for grown in (1.0, 3.0):
        level = watched(np.log(grown) + noise_of(0))
        growth, std, error = coulomb_growth(level, still, 0, SHIFT, end, viscous_growth(level, still, 0, SHIFT, 0.5))
        assert growth[-4:].mean() == pytest.approx(grown - 1.0, abs=0.02)
        assert std[-4:].mean() == pytest.approx(0.005 * grown, rel=0.02)
        plain = coulomb_growth(watched(noise_of(0)), still, 0, SHIFT, end, viscous_growth(level, still, 0, SHIFT, 0.5))
        assert error == pytest.approx(grown * plain[2], rel=0.02)
