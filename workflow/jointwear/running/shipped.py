"""Files that come with the workflow, found from any working directory.

A workflow may run in its own checkout, in a folder of the user's (``snakemake -s CLONE/Snakefile --directory MINE``) or
as a module of another workflow. A path such as ``config/robots/puma560.yaml`` then means the user's file where there
is one, else the file beside the workflow.
"""

from __future__ import annotations

import os
from pathlib import Path

from jointwear.files.registered import locate
from jointwear.files.regular_files import ROOT


def shipped(path: str | Path) -> str:
    """Return `path` where it exists from the working directory, else the file of that name beside the workflow.

    A reference to the registry of published data is followed (:func:`jointwear.files.registered.locate`). A path that
    exists in neither place is returned as it is, so that an error names what the user wrote.

    Raises
    ------
    InputError : if the registry has no such file.
    """
    path = locate(str(path))
    # os.path takes a name that no system allows for a file that is not there.
    if os.path.exists(path) or not os.path.exists(ROOT / path):
        return str(path)
    return str(ROOT / path)


def shipped_glob(pattern: str) -> list[Path]:
    """Return the files that match `pattern` in the working directory or beside the workflow, sorted by name.

    A file of the working directory hides the one of the same relative path beside the workflow.
    """
    beside = {path.relative_to(ROOT).as_posix(): path for path in ROOT.glob(pattern)}
    here = {path.as_posix(): path for path in Path(".").glob(pattern)}
    return [path for _, path in sorted({**beside, **here}.items())]
