"""Write text files whole or not at all."""

from __future__ import annotations

import os
import shutil
from pathlib import Path

from jointwear.files.errors import InputError


def replace_text(path: str | Path, text: str) -> None:
    """Write `text` to `path` in one step; an earlier file stays until the new one is complete.

    Raises
    ------
    InputError : if it cannot be written.
    """
    path = Path(path)
    part = path.with_name(path.name + ".part")
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        part.write_text(text, encoding="utf-8")
        os.replace(part, path)
    except OSError as error:
        raise unwritable(path, error) from None
    finally:
        remove(part)


def remove(part: Path) -> None:
    """Remove what is left of a file that was not written to its end; a folder that cannot be written has none."""
    try:
        part.unlink(missing_ok=True)
    except OSError:
        return


def unwritable(path: Path, error: Exception) -> InputError:
    """Return the error that says why `path` cannot be written; the libraries below do not say that a disk is full."""
    reason = getattr(error, "strerror", None) or str(error)
    there = next((p for p in path.parents if p.is_dir()), Path("."))
    if shutil.disk_usage(there).free < 1 << 20:
        reason += "; the disk is full"
    return InputError(f"{path}: cannot be written ({reason})")
