"""Discovery from a recording to everything that its files, its page and the studies need: one function, one order."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Any

import numpy as np

from jointwear.discovery.estimates.outcome import Outcome, Unexplained
from jointwear.discovery.experiment import Experiment, propose
from jointwear.discovery.findings import in_training, make_verdict
from jointwear.discovery.model.estimation import Final
from jointwear.discovery.model.kept_sizes import with_kept_sizes
from jointwear.discovery.model.sound_files import sound_files, unchanged_files, write_files
from jointwear.discovery.model.written_robot import WrittenRobot
from jointwear.discovery.posing import pose_problem
from jointwear.discovery.problem.base_parameters import free_identification
from jointwear.discovery.problem.identifiability import Visible, identifiability
from jointwear.discovery.problem.problem import Problem
from jointwear.discovery.problem.setting_up import build_problem
from jointwear.discovery.problem.whitening import White
from jointwear.discovery.search.carried import search_beside
from jointwear.discovery.search.driving_friction import driving_friction, driving_in_words
from jointwear.discovery.search.leftovers import lasting, unexplained
from jointwear.discovery.search.links_known_less import links_in_words
from jointwear.discovery.search.of_its_own import of_its_own
from jointwear.discovery.search.outside_force import force_in_words
from jointwear.discovery.search.recorded_in_time import coulomb_steps
from jointwear.discovery.search.repeatability import repeat
from jointwear.discovery.search.rocking import rocking, swing_in_words
from jointwear.discovery.search.searches import search, whitened
from jointwear.discovery.search.shared_delay import (
    delay_in_words,
    lasting_terms,
    named_delays,
    sampling_period,
    shared_delay,
    without_delay,
)
from jointwear.discovery.search.slow_noise import beside_slow_noise
from jointwear.discovery.settings import Settings
from jointwear.discovery.undecided import NUMERICAL, reason
from jointwear.discovery.verdict import NONE, UNKNOWN, Verdict
from jointwear.files.errors import InputError
from jointwear.measurement.checks.other_zero import zero_in_words
from jointwear.measurement.checks.silent_joints import moving_torques
from jointwear.measurement.recording import Recording, split
from jointwear.robots.robot import Robot

MODELS = ("nominal", "retuned", "augmented")
#: How often a log is read and searched at most, each time with the delay that its joints share beside what was found.
READINGS = 3


@dataclass
class Discovery:
    """What was found in one recording.

    Attributes
    ----------
    recording : split into training and test trajectories.
    content : the verdict. final : estimates, terms and the search behind it. map : what this motion can show.
    files : the robot files "retuned" and "augmented".
    torques : (m, n) torque [N m] of nominal, retuned and augmented model at the samples used, each as its robot file
        gives it. load : (m, n) rigid-body torque of the nominal model without motor inertia.
    """

    recording: Recording
    content: Verdict
    final: Final = field(repr=False)
    map: list[Visible] = field(repr=False)
    files: dict[str, WrittenRobot] = field(repr=False)
    torques: dict[str, np.ndarray] = field(repr=False)

    @property
    def problem(self) -> Problem:
        """The recording against the nominal model."""
        return self.final.outcome.problem

    @property
    def verdict(self) -> str:
        """none, retuned, effects or unknown."""
        return self.content.verdict

    @cached_property
    def data(self) -> dict[str, Any]:
        """The verdict as plain dicts and lists, in the layout of verdict.json."""
        return self.content.to_data()

    @property
    def effects(self) -> list[dict[str, Any]]:
        """The named effects, strongest evidence first."""
        return self.data["effects"]

    def to_json(self) -> str:
        """Return the text of verdict.json."""
        return self.content.to_json()

    @property
    def augmented_robot(self) -> dict[str, Any]:
        """Content of the robot file with what was found."""
        return self.files["augmented"].data

    @property
    def sample_time(self) -> np.ndarray:
        """(m,) time of the samples used [s]."""
        return self.problem.measured.time

    @property
    def sample_trajectory(self) -> np.ndarray:
        """(m,) trajectory of the samples used."""
        return self.problem.measured.trajectory

    @cached_property
    def where(self) -> list[Unexplained]:
        """Structure that retuning leaves, by axis and argument."""
        white = self.final.outcome.white
        if white is None:
            return []
        return unexplained(Outcome(self.problem, white, white.fit(), self.final.outcome.dictionary))[1]

    @cached_property
    def experiment(self) -> Experiment | None:
        """The motion that tells apart what this one cannot, None where no motion does."""
        return propose(self.final.outcome) if self.final.outcome.named else None

    @cached_property
    def free_identification(self) -> list[float | None]:
        """RMS error (n,) [N m] on held-out motion of a fit of all parameters without a prior."""
        return free_identification(self.problem)


def discover(recording: Recording, robot: Robot, settings: Settings | None = None) -> Discovery:
    """Compare a recording with the nominal model of `robot` and say what is missing.

    Parameters
    ----------
    recording : measured motion and torque. Its `test` trajectories choose no effect, no parameter and no robot file;
        where they contradict what the others say, the verdict is unknown.
    robot : the nominal model, its own effects included.
    settings : default :class:`Settings`.

    Raises
    ------
    Refused : an InputError with a suggestion, where the recording cannot belong to the robot as it stands.
    """
    posed = pose_problem(split(recording), robot, settings or Settings())
    recording, problem, restrictions = posed.recording, posed.problem, posed.restrictions
    try:
        log, outcome, told = read_in_time(recording, whitened(problem))
        return judge(log, outcome, [*restrictions, *told], posed.checked.zero_told)
    except InputError:
        raise
    except NUMERICAL as error:
        # A recording that was not refused gets a verdict: that nothing could be decided, and why.
        return _undecided(recording, problem, restrictions, reason(error))


def read_in_time(recording: Recording, white: White) -> tuple[Recording, Outcome, list[str]]:
    """Return a recording without the delay that all its joints share, what is found in it, and the delay in words.

    What a load or a tilt lacks can look like a delay of several joints, or hide one: the delay is asked again beside
    what was found, and the log is read and searched again for as long as that changes it.
    """
    problem, period = white.problem, sampling_period(recording)
    as_it_came, log, read = white, recording, 0.0
    delay, outcome = shared_delay(white, period), None
    for _ in range(READINGS):
        if delay != read:
            log, white, read = recording, as_it_came, delay
            if delay:
                log = without_delay(recording, delay, coulomb_steps(as_it_came, as_it_came.fit(), delay))
                in_time = build_problem(log, problem.robot, problem.settings, moving_torques(log))
                white = whitened(replace(in_time, motors=problem.motors))
        outcome = beside_slow_noise(white, search)
        beside = lasting_terms(outcome.named)
        late = named_delays(outcome.named)
        delay = shared_delay(outcome.white, period, beside, read, late) if beside or late else read
        if delay * read < 0:
            # The columns of a delay lack what lies above their band, which makes it too long. Between the two is none.
            delay = 0.0
        if delay == read:
            break
    words = delay_in_words(read, period, bool(outcome.unexplained), bool(outcome.named))
    return log, outcome, [words] if read else []


def judge(recording: Recording, found: Outcome, restrictions: list[str], zero_told: bool = False) -> Discovery:
    outcome = with_kept_sizes(repeat(search_beside(found), found.problem))
    problem = outcome.problem
    left = lasting(outcome)
    outcome.unexplained = left or rocking(outcome)
    own = of_its_own(outcome, left) or outcome.unexplained
    if outcome.force is not None and outcome.unexplained:
        restrictions = [*restrictions, force_in_words(outcome.force)]
    elif outcome.unexplained and not outcome.named and not zero_told:
        restrictions = [*restrictions, *zero_in_words(problem.measured, problem.robot)]
    restrictions = [*restrictions, *swing_in_words(outcome.unexplained), *links_in_words(outcome)]
    driving = driving_friction(outcome)
    outcome.unexplained, own = [*outcome.unexplained, *driving], [*own, *driving]
    restrictions = [*restrictions, *driving_in_words(driving)]
    final, files, torques = sound_files(problem, outcome)
    if in_training(final) == NONE:
        final, files, torques = unchanged_files(problem, final)
    # In the files a joint whose links others have bent counts as unexplained; told are those that lack something.
    final.outcome.unexplained = [u for u in final.outcome.unexplained if u in own]
    seen = identifiability(outcome.white, outcome.dictionary)
    content = make_verdict(recording.name, final, seen, torques, restrictions)
    return Discovery(recording, content, final, seen, files, torques)


def _undecided(recording: Recording, problem: Problem, restrictions: list[str], why: str) -> Discovery:
    """Return the verdict of a recording about which nothing can be said: unknown, with the given robot as it is."""
    n, drives = problem.robot.joints, problem.as_given
    nothing = drives, np.zeros((n, 4)), np.zeros(10 * n), drives, np.zeros(10 * n)
    final = Final(Outcome(problem, None, None, None), None, np.ones(n), None, (), *nothing, misfits=(why,))
    final, files, torques = write_files(problem, final)
    content = replace(make_verdict(recording.name, final, [], torques, restrictions), verdict=UNKNOWN, retuned=())
    return Discovery(recording, content, final, [], files, torques)
