"""Files by pattern. Read by the Snakefile at every call: nothing heavy is imported here."""

from __future__ import annotations

import os
from glob import escape, glob
from pathlib import Path

from jointwear.files.errors import InputError

#: Most files and folders that ``**`` looks at: a plant's logs of a year, looked through in some seconds.
MOST_ENTRIES = 500_000


def matches(pattern: str) -> list[str]:
    """Return the paths that a pattern matches, in no order; ``**`` stands for any number of folders.

    Hidden files are left out unless named. Links to folders are not followed below ``**``: they may lead in circles.

    Raises
    ------
    InputError : if ``**`` would look at more than :data:`MOST_ENTRIES` files and folders.
    """
    try:
        return list(dict.fromkeys(_found(Path(pattern).parts)))
    except ValueError as error:
        raise InputError(f"{pattern}: is no path ({error})") from None


def _found(parts: tuple[str, ...]) -> list[str]:
    if "**" not in parts:
        return glob(str(Path(*parts)))
    place = parts.index("**")
    rest = parts[place + 1 :]
    found: list[str] = []
    count = 0
    for base in _found(parts[:place]) if place else ["."]:
        for folder, folders, files in os.walk(base):
            folders[:] = [name for name in folders if not name.startswith(".")]
            count += 1 + len(files)
            if count > MOST_ENTRIES:
                raise InputError(f"{Path(*parts)}: ** looks at more than {MOST_ENTRIES} files; name the folder closer")
            if rest:
                found += _found((*Path(escape(folder)).parts, *rest))
            else:
                found += [folder, *(str(Path(folder) / name) for name in files if not name.startswith("."))]
    return [str(Path(path)) for path in found]
