"""Find where a model and a measurement disagree, name the missing effect, and say when that cannot be said.

:func:`discover` is the pure entry point; :mod:`jointwear.measurement.recording_files` reads and writes the files
of the workflow.
"""

from __future__ import annotations

from functools import cache

from jointwear.discovery.decide import search
from jointwear.discovery.estimation import finalise
from jointwear.discovery.problem import build_problem
from jointwear.discovery.settings import Settings
from jointwear.discovery.verdict import Verdict, make_verdict
from jointwear.measurement.checks import check_recording
from jointwear.measurement.motion import measure
from jointwear.measurement.recording import Recording, split
from jointwear.measurement.recording_files import load_recording
from jointwear.robots.robot import Robot


def discover(recording: Recording, robot: Robot, settings: Settings | None = None) -> Verdict:
    """Compare a recording with the nominal model of `robot` and say what is missing.

    Parameters
    ----------
    recording : measured motion and torque; its `test` trajectories take no part in any choice.
    robot : the nominal model, its own effects included.
    settings : default :class:`Settings`.

    Raises
    ------
    Refused : an InputError with a suggestion, where the recording cannot belong to the robot as it stands.
    """
    settings = settings or Settings()
    recording = split(recording)
    measured = cache(lambda: measure(recording))
    restrictions = check_recording(recording, robot, measured)
    problem = build_problem(recording, robot, settings, measured())
    restrictions += problem_restrictions(problem)
    return make_verdict(recording.name, finalise(search(problem)), restrictions)


def problem_restrictions(problem) -> list[str]:
    """Return in words which axes and statements the data do not allow."""
    from jointwear.discovery.restrictions import motion_restrictions

    return motion_restrictions(problem)


__all__ = ["Recording", "Settings", "Verdict", "discover", "load_recording"]
