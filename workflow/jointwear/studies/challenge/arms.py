"""The arms of the tiers clean, dirty and factory: six robot files, and which of them a case has."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from jointwear.files.regular_files import ROOT
from jointwear.robots.robot import Robot, load_robot
from jointwear.statistics.randomness import generator
from jointwear.studies.challenge.plan import Case

#: Robot file of every arm, relative to the workflow, and the load [kg] that it is rated for.
ARMS = {
    "puma560": ("config/robots/puma560.yaml", 2.5),
    "ur5": ("data/arms/ur5.yaml", 5.0),
    "ur10": ("data/arms/ur10.yaml", 10.0),
    "panda": ("data/arms/panda.yaml", 3.0),
    "seven_axis": ("data/arms/seven_axis.yaml", 14.0),
    "heavy_210": ("data/arms/heavy_210.yaml", 150.0),
}


def arm_of(case: Case, seed: int) -> str:
    """Return the name of the arm of a case, each as often."""
    return str(generator(seed, *case.key, "arm", replicate=case.index).choice(list(ARMS)))


def arm_path(name: str) -> Path:
    """Return the robot file of an arm."""
    return ROOT / ARMS[name][0]


def rated_load(name: str) -> float:
    """Return the load [kg] that an arm is rated for; that of the PUMA for any other robot."""
    return ARMS.get(name, ARMS["puma560"])[1]


def given_robot(case: Mapping[str, Any]) -> Robot:
    """Return the robot of a listed case as its user would give it."""
    robot = load_robot(ROOT / case["robot"])
    return robot.without_drives() if case["told"]["torque_kind"] == "link_sensor" else robot
