"""Kinova Gen3: eleven recordings at 1 kHz, one file of comma-separated values each, laid end to end.

The column `Time` counts samples. `TorqueCur` is the motor current times the maker's constant [N m].
"""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

import numpy as np

from jointwear.files import provenance
from jointwear.files.storage import Variable, write_dataset
from jointwear.measurement.published.urdf import without_meshes

JOINTS = 7
PERIOD = 1e-3  # s
#: Time between one recording and the next in the joined file [s]; nothing may be differentiated across it.
GAP = 1.0
#: Column of the source, name, long name and unit of each variable.
COLUMNS = (
    ("Position", "q", "measured joint position", "rad"),
    ("Velocity", "qd", "measured joint velocity", "rad/s"),
    ("TorqueCur", "tau", "joint torque from motor current", "N m"),
    ("Temp", "temperature", "motor temperature", "degC"),
)


def convert(sources: Mapping[str, Path], folder: Path) -> None:
    """Write ``measured.nc`` and ``robot.urdf`` into `folder`; the recordings keep the order of the registry."""
    times, labels = [], []
    values: dict[str, list[np.ndarray]] = {name: [] for _, name, _, _ in COLUMNS}
    start = 0.0
    for label, path in enumerate(path for name, path in sources.items() if name.endswith(".csv")):
        table = np.genfromtxt(path, delimiter=",", names=True)
        time = start + PERIOD * np.arange(len(table))
        for column, name, _, _ in COLUMNS:
            stacked = np.stack([table[f"{column}{j}"] for j in range(1, JOINTS + 1)], axis=1)
            values[name].append(np.unwrap(stacked, axis=0) if name == "q" else stacked)
        times.append(time)
        labels.append(np.full(len(table), label))
        start = time[-1] + GAP
    by_sample = ("instant", "joint")
    variables = {
        "joint": Variable(("joint",), np.arange(1, JOINTS + 1), "number of the joint", "1"),
        "time": Variable(("instant",), np.concatenate(times), "time, recordings end to end", "s"),
        "segment": Variable(("instant",), np.concatenate(labels), "label of the recording", "1"),
    } | {
        name: Variable(by_sample, np.concatenate(values[name]), long_name, unit) for _, name, long_name, unit in COLUMNS
    }
    attributes = provenance.attributes("Kinova Gen3, eleven recordings, measured", {"period": PERIOD, "gap": GAP})
    write_dataset(folder / "measured.nc", variables, attributes)
    urdf = next(path for name, path in sources.items() if name.endswith(".urdf"))
    without_meshes(urdf, folder / "robot.urdf")
