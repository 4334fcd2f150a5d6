"""Find where a model and a measurement disagree, name the missing effect, and say when that cannot be said.

:func:`discover` is the pure entry point; :mod:`jointwear.measurement.recording_files` reads and writes the files
of the workflow. The names below are loaded when they are asked for: a page needs none of the search.
"""

from __future__ import annotations

import importlib
from typing import Any

_HOME = {
    "Discovery": "jointwear.discovery.pipeline",
    "Recording": "jointwear.measurement.recording",
    "Settings": "jointwear.discovery.settings",
    "discover": "jointwear.discovery.pipeline",
    "load_recording": "jointwear.measurement.recording_files",
}

__all__ = ["Discovery", "Recording", "Settings", "discover", "load_recording"]


def __getattr__(name: str) -> Any:
    if name not in _HOME:
        raise AttributeError(f"module 'jointwear.discovery' has no attribute '{name}'")
    return getattr(importlib.import_module(_HOME[name]), name)
