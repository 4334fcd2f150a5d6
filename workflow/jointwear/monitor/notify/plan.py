"""Check ``monitor.notify`` before any job starts. Read by the Snakefile at every call: nothing heavy here."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from jointwear.files.errors import InputError, nearest


def check_channels(monitor: Mapping[str, Any]) -> None:
    """Check the channels of the section `monitor` of a config; their addresses are looked up when they are used.

    Raises
    ------
    InputError : one line naming the channel, the key and what is allowed.
    """
    names: set[str] = set()
    for channel in monitor["notify"]:
        where = f"monitor.notify: {channel['name']}"
        if channel["name"] in names:
            raise InputError(f"config: '{where}' is given twice")
        names.add(channel["name"])
        if ("env" in channel) == ("file" in channel):
            raise InputError(
                f"config: '{where}' must name its address either by 'env' (an environment variable) or by 'file'; the "
                "address itself is a secret and has no place in a config"
            )
        if "://" in channel.get("file", ""):
            raise InputError(
                f"config: '{where}.file' holds an address, which is a secret and is not repeated here; allowed: the "
                "path of a file that holds it"
            )
        for robot in channel.get("robots", ()):
            if robot not in monitor["robots"]:
                hint = nearest(robot, monitor["robots"])
                raise InputError(f"config: '{where}.robots' names '{robot}', which is no robot{hint}")
