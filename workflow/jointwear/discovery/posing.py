"""From a recording and a robot to the problem that discovery works on: what is read, what is felt, what was checked."""

from __future__ import annotations

from jointwear.discovery.problem.problem import Problem
from jointwear.discovery.problem.restrictions import motion_restrictions
from jointwear.discovery.problem.unknown_inertia import build_with_motors
from jointwear.discovery.search.repeatability import check_groups
from jointwear.discovery.settings import Settings
from jointwear.measurement.behind_gears import felt_robot
from jointwear.measurement.checks.checked import checked
from jointwear.measurement.recording import Recording
from jointwear.measurement.shortened import shortened
from jointwear.robots.robot import Robot


def pose_problem(recording: Recording, robot: Robot, settings: Settings) -> tuple[Recording, Problem, list[str]]:
    """Return what is read of a recording, the problem that it poses, and in words what it cannot show.

    Parameters
    ----------
    recording : with `train` and `test` filled in. robot : the nominal model, as given.

    Raises
    ------
    Refused : an InputError with a suggestion, where the recording cannot belong to the robot as it stands.
    """
    check_groups(recording, settings.groups)
    recording, left_out = shortened(recording, keep_all=bool(settings.groups))
    robot, set_aside = felt_robot(recording, robot)
    measured, restrictions = checked(recording, robot)
    problem = build_with_motors(recording, robot, settings, measured)
    of_motion = motion_restrictions(problem, recording.units.get("time", "s"))
    return recording, problem, [*restrictions, *set_aside, *left_out, *of_motion]
