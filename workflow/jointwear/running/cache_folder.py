"""A cache folder for Snakemake and Matplotlib where the user has none that can be written."""

from __future__ import annotations

import os
from pathlib import Path

#: What tells Snakemake where its cache is, and Matplotlib.
VARIABLE, OF_FIGURES = "XDG_CACHE_HOME", "MPLCONFIGDIR"


def lend_cache_folder() -> None:
    """Let Snakemake keep its copies of sources in the working directory, if it cannot below the user's home.

    A service account and a container may have no home, or one that is read-only: Snakemake ends with a traceback there,
    and Matplotlib prints two lines for each figure.
    """
    given = os.environ.get(VARIABLE)
    folder = Path(given) if given else Path(os.path.expanduser("~")) / ".cache"
    # Of a user without a home "~" stays as it is, and would become a folder of that name.
    if not (folder.is_absolute() and _can_be_made(folder / "snakemake")):
        lent = Path.cwd() / ".snakemake" / "cache"
        os.environ[VARIABLE] = str(lent)
        os.environ.setdefault(OF_FIGURES, str(lent / "matplotlib"))


def _can_be_made(folder: Path) -> bool:
    # What may not even be looked into counts as not there, where Path.exists fails.
    there = next(f for f in (folder, *folder.parents) if os.path.exists(f))
    return there.is_dir() and os.access(there, os.W_OK | os.X_OK)
