"""Check the entries of ``discover.datasets`` before any job starts.

Read by the Snakefile at every call: nothing heavy is imported here.
"""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from jointwear.files.errors import InputError
from jointwear.files.registered import will_be_fetched
from jointwear.files.regular_files import check_regular
from jointwear.robots.robot_file import robot_sources


def check_datasets(config: Mapping[str, Any]) -> None:
    """Check that the files named by every data set exist.

    Raises
    ------
    InputError : one line naming the data set, the key and the nearest file.
    """
    for name, entry in config["discover"]["datasets"].items():
        for key in ("measured", "robot"):
            if will_be_fetched(entry[key]):
                continue
            try:
                if key == "measured" and Path(entry[key]).is_dir():
                    continue  # a bag
                check_regular(entry[key])
            except InputError as error:
                raise InputError(f"config: 'discover.datasets.{name}.{key}' is {error}") from None
        for path in robot_sources(entry["robot"])[1:]:
            if not Path(path).exists() and not will_be_fetched(path):
                raise InputError(f"{entry['robot']}: 'urdf' names {path}, which does not exist")
