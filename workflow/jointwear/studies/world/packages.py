"""The packages that the plants need, and what to say where they are missing."""

from __future__ import annotations

import importlib.metadata
from pathlib import Path

from jointwear.files.errors import InputError

_ROBOTS = "cmeel.prefix/share/example-robot-data/robots"
_MISSING = (
    "challenge: tier 'world' needs the package '{}', which is not installed; 'make plants' installs it "
    "(requirements/plants.txt)"
)


def mujoco():
    """Return the module `mujoco`.

    Raises
    ------
    InputError : if it is not installed.
    """
    try:
        import mujoco
    except ImportError:
        raise InputError(_MISSING.format("mujoco")) from None
    return mujoco


def robots_folder() -> Path:
    """Return the folder of the robot descriptions of `example-robot-data`.

    Raises
    ------
    InputError : if it is not installed.
    """
    try:
        distribution = importlib.metadata.distribution("example-robot-data")
    except importlib.metadata.PackageNotFoundError:
        raise InputError(_MISSING.format("example-robot-data")) from None
    return Path(str(distribution.locate_file(_ROBOTS)))
