"""Staubli TX40: motor positions and torques of one run, as comma-separated values with one header line.

Motor 6 is driven by joints 5 and 6 together, so that the ratio matrix has an entry beside its diagonal; its
transpose turns motor torques into joint torques. Joints 2 and 3 are counted from poses a quarter turn off.
"""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

import numpy as np

from jointwear.files import provenance
from jointwear.files.storage import Variable, write_dataset
from jointwear.measurement.published.urdf import without_meshes

RATIO = np.diag([32.0, 32.0, 45.0, -48.0, 45.0, 32.0])
RATIO[5, 4] = 32.0
#: Offset of the joint positions [rad].
OFFSET = np.array([0.0, -np.pi / 2, np.pi / 2, 0.0, 0.0, 0.0])
RATE = 5000.0  # Hz


def convert(sources: Mapping[str, Path], folder: Path) -> None:
    """Write ``measured.nc`` (joint positions [rad] and torques [N m]) and ``robot.urdf`` into `folder`."""
    by_name = {Path(name).name: path for name, path in sources.items()}
    motor, torque = (
        np.loadtxt(by_name[name], delimiter=",", skiprows=1) for name in ("pos_read_data.csv", "curr_data.csv")
    )
    position = motor @ np.linalg.inv(RATIO).T + OFFSET
    by_sample = ("instant", "joint")
    write_dataset(
        folder / "measured.nc",
        {
            "joint": Variable(("joint",), np.arange(1, 7), "number of the joint", "1"),
            "time": Variable(("instant",), np.arange(len(motor)) / RATE, "time", "s"),
            "q": Variable(by_sample, position, "joint position, from motor encoders", "rad"),
            "tau": Variable(by_sample, torque @ RATIO, "joint torque, from motor torques", "N m"),
        },
        provenance.attributes("Staubli TX40, one excitation run, measured", {"rate": RATE}),
    )
    without_meshes(by_name["tx40_mdh_modified.urdf"], folder / "robot.urdf")
