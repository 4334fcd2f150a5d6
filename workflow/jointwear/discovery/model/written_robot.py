"""A robot file that discovery writes, and the torque of a robot along a measured motion."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, replace
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np
import yaml

from jointwear.discovery.model.augment import augmented_robot, augmented_urdf
from jointwear.discovery.model.final_model import Final
from jointwear.effects import effect_torque, make_state
from jointwear.files.text_files import replace_text
from jointwear.measurement.derived.motion import Measured
from jointwear.robots.dynamics import Dynamics
from jointwear.robots.inertia import wind_up_regressor
from jointwear.robots.robot import Robot, robot_from_data

#: libyaml writes a file of the size of a robot's twenty times as fast.
_Dumper = getattr(yaml, "CSafeDumper", yaml.SafeDumper)
#: Longest line of a robot file [characters].
WIDTH = 120


@dataclass(frozen=True)
class WrittenRobot:
    """Content of a robot file; `urdf` is the text of the URDF beside it, None for a robot given by DH parameters."""

    data: dict[str, Any]
    urdf: str | None

    def write(self, path: str | Path) -> None:
        """Write the robot file and, under the same stem, its URDF."""
        path = Path(path)
        data = self.data
        if self.urdf is not None:
            beside = path.with_suffix(".urdf")
            replace_text(beside, self.urdf + "\n")
            data = {key: beside.name if key == "urdf" else value for key, value in data.items()}
        replace_text(path, yaml.dump(data, Dumper=_Dumper, sort_keys=False, allow_unicode=True, width=WIDTH))

    @contextmanager
    def robot(self) -> Iterator[Robot]:
        """Give the robot that the file describes; a URDF exists for as long as the context does."""
        if self.urdf is None:
            yield robot_from_data(self.data)
            return
        with TemporaryDirectory(prefix="jointwear_") as folder:
            urdf = Path(folder) / "robot.urdf"
            urdf.write_text(self.urdf, encoding="utf-8")
            yield robot_from_data(self.data, urdf)


def written_robot(final: Final, with_effects: bool = True) -> WrittenRobot:
    """Return the augmented robot, or without effects the one that is only retuned."""
    return WrittenRobot(augmented_robot(final, None, with_effects), augmented_urdf(final, with_effects))


def simulate_robot(robot: Robot, measured: Measured) -> tuple[np.ndarray, np.ndarray]:
    """Return the torque of a robot, effects included, and its rigid-body part without motor inertia, (m, n) [N m]."""
    q, v, a = measured.position, measured.velocity, measured.acceleration
    dynamics = Dynamics(robot)
    rigid = np.array(dynamics.rigid_body_torque(q, v, a)) if len(q) else q
    state = make_state(
        robot,
        q,
        v,
        a,
        rigid,
        time=measured.time,
        temperature=measured.temperature,
        record=measured.trajectory,
        wind_up_regressor=wind_up_regressor(dynamics, q, v, a),
    )
    # The torque was filtered where a recording at a high rate was reduced: the prediction is compared with that.
    state = replace(state, passes=measured.passes, derives=measured.derives)
    return state.torque + effect_torque(robot, state), state.load
