"""The engine of the plants, and what to say where it is missing."""

from __future__ import annotations

from functools import cache

from jointwear.files.errors import InputError


@cache
def mujoco():
    """Return the module `mujoco`.

    Raises
    ------
    InputError : if it is not installed.
    """
    try:
        import mujoco
    except ImportError:
        raise InputError(
            "challenge: the tier 'world' needs the package mujoco, which is not installed (make plants installs it)"
        ) from None
    return mujoco
