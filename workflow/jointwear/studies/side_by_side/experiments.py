"""The closest joint experiment as files that the workflow runs like any other experiment."""

from __future__ import annotations

import shutil
from collections.abc import Mapping, Sequence
from pathlib import Path

from jointwear.studies.joint_fit.confirmation import full_reading
from jointwear.studies.joint_fit.records import read_experiments
from jointwear.studies.recovery.export import write_yaml


def write_closest(
    checked: str | Path,
    robot: str | Path,
    tasks: Sequence[str | Path],
    base: Mapping[str, str],
    config: str | Path,
) -> None:
    """Write the working directory of the closest joint experiment: its config, and beside it robot and tasks.

    Parameters
    ----------
    checked : file that holds the closest experiment alone.
    robot, tasks : its robot file and task files.
    base : reading of the config, for the points that the joint fit leaves alone.
    config : `config/config.yaml` of the working directory.

    Raises
    ------
    InputError : if `checked` is missing or damaged.
    """
    (experiment,) = read_experiments(checked)
    folder = Path(config).parent
    for path, place in [(robot, "robots"), *((task, "tasks") for task in tasks)]:
        (folder / place).mkdir(parents=True, exist_ok=True)
        shutil.copyfile(path, folder / place / Path(path).name)
    reading = full_reading(experiment, base)
    shape, hours = reading.pop("wear_shape"), reading.pop("consecutive_hours")
    write_yaml(
        config,
        {
            "robot": f"config/robots/{Path(robot).name}",
            "wear": {"shape": round(float(shape), 4)},
            "reading": dict(reading),
            "detection": {"consecutive_hours": int(hours)},
        },
    )
