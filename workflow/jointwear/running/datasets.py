"""Check the entries of ``discover.datasets`` before any job starts.

Read by the Snakefile at every call: nothing heavy is imported here.
"""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from jointwear.files.errors import InputError, nearest
from jointwear.files.registered import will_be_fetched
from jointwear.robots.robot_file import robot_sources


def check_datasets(config: Mapping[str, Any]) -> None:
    """Check that the files named by every data set exist.

    Raises
    ------
    InputError : one line naming the data set, the key and the nearest file.
    """
    for name, entry in config["discover"]["datasets"].items():
        for key in ("measured", "robot"):
            path = Path(entry[key])
            if not path.is_file() and not will_be_fetched(path):
                there = [p.name for p in path.parent.glob("*")] if path.parent.is_dir() else []
                raise InputError(
                    f"config: 'discover.datasets.{name}.{key}' is {path}: no such file{nearest(path.name, there)}"
                )
        for path in robot_sources(entry["robot"])[1:]:
            if not Path(path).is_file() and not will_be_fetched(path):
                raise InputError(f"{entry['robot']}: 'urdf' names {path}, which does not exist")
