"""An axis whose torque grows uneven alone is told, since its hours are not judged."""

import numpy as np
import pytest
from monitor_windows import NOISE, residuals, statistics_of

from jointwear.monitor.findings.loud import LOUD, LOUD_PROGRAM, SMOOTH, UNEVEN, loud_findings

#: Windows, and those of a shift; the first three shifts are the baseline.
WINDOWS, SHIFT = 64, 8


def _findings(loud, events=((), (), ()), **more):
    """Findings where `loud` (w, 3) multiplies the noise."""
    extra = (loud - 1)[:, None] * NOISE * np.random.default_rng(3).standard_normal((WINDOWS, 80, 3))
    statistics = statistics_of(residuals(WINDOWS, np.zeros((WINDOWS, 3)), 1, extra))
    shift = np.arange(WINDOWS) // SHIFT
    return loud_findings(statistics, shift, shift < 3, events, **more)


def _loud(axes, shifts):
    loud = np.ones((WINDOWS, 3))
    for s in shifts:
        loud[s * SHIFT : (s + 1) * SHIFT, axes] = 8.0
    return loud


def test_one_axis_that_is_loud_shift_after_shift_is_told():
    (found,) = _findings(_loud([1], [5, 6, 7]))
    assert found["kind"] == LOUD
    assert found["axes"] == [2]
    assert found["time"] == 5 * SHIFT * 3600.0
    assert "of axis 2" in found["words"]
    assert "answered" not in found


def test_how_large_it_is_says_what_its_loud_hours_are():
    """The median of all hours since was told, which may be as quiet as before: "1 times as large"."""
    (found,) = _findings(_loud([1], [4, 5]))
    assert float(found["words"].split(" is ")[1].split(" times")[0]) > 5


@pytest.mark.parametrize(("shifts", "ended"), [([3, 4], True), ([4, 5], False), ([3, 4, 6], False)])
def test_an_axis_that_is_as_before_for_three_shifts_is_done(shifts, ended):
    """One day on which two columns were exchanged left the axis unjudged until somebody entered an event."""
    (found,) = _findings(_loud([1], shifts))
    assert ("end" in found, "answered" in found) == (ended, ended)
    assert ("as before again" in found["words"]) == ended
    if ended:
        assert (found["time"], found["end"]) == (3 * SHIFT * 3600.0, 5 * SHIFT * 3600.0)


def test_logs_that_were_refused_in_part_tell_nothing_of_an_axis():
    loud = _loud([1], [4, 5])
    doubtful = loud[:, 1] > 1
    assert _findings(loud, doubtful=doubtful) == []
    # In one of two shifts it leaves one, which is not shift after shift.
    assert _findings(loud, doubtful=doubtful & (np.arange(WINDOWS) < 40)) == []
    assert _findings(loud, doubtful=np.arange(WINDOWS) < 32)


@pytest.mark.parametrize(
    ("case", "kinds"),
    [
        ("only there, from its first window on", [LOUD_PROGRAM]),
        ("the other program too", [LOUD]),
        ("quiet there at first", [LOUD]),
        ("nothing else runs since", [LOUD]),
    ],
)
def test_a_noise_of_a_new_program_alone_is_no_damage(case, kinds):
    program = np.zeros(WINDOWS, dtype=int)
    program[(np.arange(WINDOWS) >= 32) & (np.arange(WINDOWS) % SHIFT >= 2)] = 1
    loud = np.ones((WINDOWS, 3))
    loud[program == 1, 1] = 8.0
    if case == "the other program too":
        loud[40:, 1] = 8.0
    elif case == "quiet there at first":
        loud[:40, 1] = 1.0
    elif case == "nothing else runs since":
        program[32:], loud[32:, 1] = 1, 8.0
    found = _findings(loud, program=program)
    assert [f["kind"] for f in found] == kinds
    assert all(f["axes"] == [2] for f in found)


@pytest.mark.parametrize(
    ("returns", "ended", "told"), [(None, False, True), ("loud", False, False), ("calm", True, False)]
)
def test_programs_in_which_it_was_not_loud_do_not_say_that_it_is_as_before(returns, ended, told):
    """Play of a base showed in one program; three shifts of another one called it mended."""
    program = np.repeat([0, 1, 0, 0, 1, 0, 0, 0], SHIFT)
    loud = _loud([1], [])
    loud[np.repeat([0, 0, 0, 0, 1, 1, 0, 0], SHIFT) == 1, 1] = 8.0
    program[40:48] = 1
    if returns:
        program, loud = np.repeat([0, 1, 0, 1, 1, 1, 1, 1], SHIFT), _loud([1], [3, 4])
        if returns == "loud":
            loud[56:, 1] = 8.0
    (found,) = _findings(loud, program=program)
    assert ("end" in found, "have not run since" in found["words"]) == (ended, told)


def test_an_event_answers_it():
    (found,) = _findings(_loud([1], [5, 6, 7]), ((), (50,), ()))
    assert found["answered"]


@pytest.mark.parametrize(("axes", "shifts"), [([1], [5]), ([1], [5, 7]), ([0, 1, 2], [5, 7]), ([1], [0, 1, 2])])
def test_one_shift_or_the_baseline_tells_nothing(axes, shifts):
    assert _findings(_loud(axes, shifts)) == []


@pytest.mark.parametrize(("times", "told"), [(1.0, False), (2.0, True)])
def test_a_noise_that_windows_of_the_baseline_show_as_well_is_no_news(times, told):
    """A part that two of 24 windows of the baseline carry, and all of later shifts; and what is louder than it."""
    for axes in ([1], [0, 1, 2]):
        loud = _loud(axes, [5, 6, 7])
        loud[40:, axes] *= times
        loud[np.ix_([3, 12], axes)] = 8.0
        assert bool(_findings(loud)) == told


@pytest.mark.parametrize("axes", [[0, 1, 2], [0, 2]])
def test_most_axes_that_are_loud_together_are_told_as_one_while_it_lasts(axes):
    (found,) = _findings(_loud(axes, [4, 5]))
    assert found["kind"] == UNEVEN
    assert found["axes"] == [a + 1 for a in axes]
    assert (found["time"], found["end"]) == (4 * SHIFT * 3600.0, 6 * SHIFT * 3600.0)
    (answered,) = _findings(_loud(axes, [4, 5]), ((40,), (40,), (40,)))
    assert answered["answered"]


def _smooth(factor, axes, shifts):
    """Noise of `axes` divided by `factor` in `shifts`."""
    less = np.ones((WINDOWS, 3))
    for s in shifts:
        less[s * SHIFT : (s + 1) * SHIFT, axes] = 1 / factor
    statistics = statistics_of(residuals(WINDOWS, np.zeros((WINDOWS, 3)), 1))
    statistics.residual_square[:] *= less**2
    return loud_findings(statistics, np.arange(WINDOWS) // SHIFT, np.arange(WINDOWS) // SHIFT < 3, ((), (), ()))


@pytest.mark.parametrize("axes", [[0, 1, 2], [0, 2]])
def test_torques_of_most_axes_that_grow_smooth_are_told(axes):
    (found,) = _smooth(4.0, axes, [4, 5])
    assert found["kind"] == SMOOTH
    assert found["axes"] == [a + 1 for a in axes]
    assert (found["time"], found["end"]) == (4 * SHIFT * 3600.0, 6 * SHIFT * 3600.0)


@pytest.mark.parametrize(
    ("factor", "axes", "shifts"), [(1.5, [0, 1, 2], [4, 5]), (8.0, [1], [4, 5]), (8.0, [0, 1, 2], [4, 6])]
)
def test_a_little_less_noise_one_axis_or_one_shift_is_not_smooth(factor, axes, shifts):
    assert _smooth(factor, axes, shifts) == []
