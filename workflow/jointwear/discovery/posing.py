"""From a recording and a robot to the problem that discovery works on: what is read, what is felt, what was checked."""

from __future__ import annotations

from dataclasses import dataclass

from jointwear.discovery.problem.problem import Problem
from jointwear.discovery.problem.restrictions import motion_restrictions
from jointwear.discovery.problem.unknown_inertia import build_with_motors
from jointwear.discovery.search.repeatability import check_groups
from jointwear.discovery.settings import Settings
from jointwear.measurement.behind_gears import felt_robot
from jointwear.measurement.checks.checked import Checked, checked
from jointwear.measurement.recording import Recording
from jointwear.measurement.refused import telling
from jointwear.measurement.shortened import shortened
from jointwear.robots.robot import Robot


@dataclass(frozen=True)
class Posed:
    """What is read of a recording, the problem that it poses, what was checked, and in words what it cannot show."""

    recording: Recording
    problem: Problem
    checked: Checked
    restrictions: list[str]


def pose_problem(recording: Recording, robot: Robot, settings: Settings) -> Posed:
    """Return the problem that a recording poses.

    Parameters
    ----------
    recording : with `train` and `test` filled in. robot : the nominal model, as given.

    Raises
    ------
    Refused : an InputError with a suggestion, where the recording cannot belong to the robot as it stands; it tells
        what was left out of the file as well.
    """
    with telling(recording.unread):
        return _posed(recording, robot, settings)


def _posed(recording: Recording, robot: Robot, settings: Settings) -> Posed:
    check_groups(recording, settings.groups)
    recording, left_out = shortened(recording, keep_all=bool(settings.groups))
    robot, set_aside = felt_robot(recording, robot)
    read = checked(recording, robot)
    problem = build_with_motors(recording, robot, settings, read.measured)
    of_motion = motion_restrictions(problem, f"data set '{recording.name}'", recording.units.get("time", "s"))
    return Posed(recording, problem, read, [*read.restrictions, *set_aside, *left_out, *of_motion])
