"""Check the entries of ``discover.datasets`` before any job starts.

Read by the Snakefile at every call: nothing heavy is imported here.
"""

from __future__ import annotations

import os
import re
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from jointwear.files.errors import InputError, nearest
from jointwear.files.registered import will_be_fetched
from jointwear.files.regular_files import check_regular
from jointwear.measurement.log_entries import check_log_entry
from jointwear.measurement.log_kinds import log_format
from jointwear.robots.robot_file import read_robot_file, robot_sources

_WRITTEN = re.compile(r"^(?:\./)?results/discover/([A-Za-z][A-Za-z0-9_]*)/robot\.yaml$")


def written_for(robot: str | Path) -> str | None:
    """Return the data set whose augmented robot a path stands for, None for any other robot file."""
    found = _WRITTEN.match(str(robot))
    return found.group(1) if found else None


def check_datasets(config: Mapping[str, Any]) -> None:
    """Check that the files named by every data set exist, or are made by another data set of the config.

    Raises
    ------
    InputError : one line naming the data set, the key and what is allowed or the nearest file.
    """
    datasets = config["discover"]["datasets"]
    for name, entry in datasets.items():
        both = [label for label in entry.get("test") or () if label in (entry.get("train") or ())]
        if both:
            raise InputError(
                f"config: 'discover.datasets.{name}.test' holds trajectory {both[0]}, and so does 'train'; allowed: in "
                "one of them, as what tests a model takes no part in its fit"
            )
        _check_groups(name, entry.get("group") or {})
        for key in ("measured", "robot"):
            made_for = written_for(entry[key]) if key == "robot" else None
            if made_for in datasets:
                _check_order(name, datasets)
                continue
            if will_be_fetched(entry[key]):
                continue
            if made_for is not None and not os.path.isfile(entry[key]):
                raise InputError(
                    f"config: 'discover.datasets.{name}.robot' is {entry[key]}, which does not exist, and the config "
                    f"has no data set '{made_for}' that would make it{nearest(made_for, datasets)}"
                )
            try:
                if key == "measured" and os.path.isdir(entry[key]):
                    _check_bag(entry[key])
                    continue
                check_regular(entry[key])
            except InputError as error:
                path, told = Path(entry[key]), str(error)
                if path.parent.is_dir() and not os.path.lexists(path) and "did you mean" not in told:
                    told += nearest(path.name, [p.name for p in path.parent.glob("*")])
                raise InputError(f"config: 'discover.datasets.{name}.{key}' is {told}") from None
        if written_for(entry["robot"]) in datasets:
            continue
        for path in robot_sources(entry["robot"])[1:]:
            if not os.path.exists(path) and not will_be_fetched(path):
                raise InputError(f"{entry['robot']}: 'urdf' names {path}, which does not exist")
        if not any(will_be_fetched(path) for path in robot_sources(entry["robot"])):
            check_log_entry(entry, f"discover.datasets.{name}", read_robot_file(entry["robot"]))


def _check_bag(folder: str) -> None:
    """Check that a folder is a bag.

    Raises
    ------
    InputError : with a log that is in it.
    """
    if log_format(folder) is None:
        there = next((p.as_posix() for p in sorted(Path(folder).glob("*")) if log_format(p)), "")
        name = f", as '{there}'" if there else ""
        raise InputError(f"{folder}: is a folder without metadata.yaml, and so no ROS 2 bag; name a file{name}")


def _check_groups(name: str, groups: Mapping[str, Any]) -> None:
    """Check that no trajectory is in two groups; whether there are such trajectories the data tell."""
    seen: dict[int, str] = {}
    for group, labels in groups.items():
        for label in labels:
            if label in seen:
                raise InputError(
                    f"config: 'discover.datasets.{name}.group.{group}' holds trajectory {label}, and so does "
                    f"'{seen[label]}'; allowed: in one of them"
                )
            seen[label] = group


def _check_order(name: str, datasets: Mapping[str, Any]) -> None:
    """Refuse data sets whose robots wait for each other."""
    seen = [name]
    while (source := written_for(datasets[seen[-1]]["robot"])) in datasets:
        if source in seen:
            first, waited = written_for(datasets[name]["robot"]), [*seen[2:], source]
            those = "itself" if waited == [first] else f"that of {' and '.join(map(repr, waited))}"
            raise InputError(
                f"config: 'discover.datasets.{name}.robot' is the robot that data set '{first}' makes, which waits for "
                f"{those}; one of them needs a robot file of its own"
            )
        seen.append(source)
