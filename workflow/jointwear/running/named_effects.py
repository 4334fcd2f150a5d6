"""Check the effects that robot files name before any job starts.

Apart from the check of everything else in a robot file, because the library of effects takes a second to load: only a
call with a robot file that names effects pays for it. Imported by the Snakefile at every call.
"""

from __future__ import annotations

import os
from collections.abc import Iterable, Mapping
from typing import Any

from jointwear.files.documents import LARGEST_YAML, read_yaml
from jointwear.files.registered import will_be_fetched
from jointwear.files.regular_files import read_text
from jointwear.robots.robot_file import read_robot_file, robot_sources


def robot_files(config: Mapping[str, Any]) -> list[str]:
    """Return the robot files that a configuration names and that are there, each once."""
    entries = [config, *config["monitor"]["robots"].values(), *config["discover"]["datasets"].values()]
    return [path for path in dict.fromkeys(str(entry["robot"]) for entry in entries) if os.path.isfile(path)]


def check_named_effects(paths: Iterable[str]) -> None:
    """Check the `effects` of robot files against the library.

    Raises
    ------
    InputError : one line naming the file, the entry and what is allowed.
    """
    for path in paths:
        # A fleet may have a file for each robot: most need not be built up again.
        if "effects" not in read_text(path, LARGEST_YAML) or not read_yaml(path).get("effects"):
            continue
        if any(will_be_fetched(source) for source in robot_sources(path)):
            continue
        from jointwear.effects import check_entries

        robot = read_robot_file(path)
        check_entries(robot["effects"], len(robot["joints"]), path)
