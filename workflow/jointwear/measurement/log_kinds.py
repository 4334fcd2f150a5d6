"""Which format a log has, by its name, and which files it is made of.

Read by the Snakefile at every call: nothing heavy is imported here.
"""

from __future__ import annotations

import os
from pathlib import Path

FORMATS = {
    ".nc": "netcdf", ".nc4": "netcdf", ".cdf": "netcdf", ".netcdf": "netcdf", ".csv": "csv", ".tsv": "csv",
    ".csv.gz": "csv", ".tsv.gz": "csv", ".parquet": "parquet", ".mcap": "bag", ".db3": "bag",
}  # fmt: skip

#: What a log may be, in words.
ALLOWED = f"{', '.join(FORMATS)}, or a bag's folder with metadata.yaml"

#: Endings of other files that samples come in -> what makes a log of one.
_OTHERWISE = {
    **dict.fromkeys((".txt", ".dat", ".asc", ".prn", ".log"), "a table of text is read if its name ends with .csv"),
    **dict.fromkeys((".mat", ".npz", ".h5", ".hdf5", ".xlsx", ".xls", ".json", ".pkl"), "export it as CSV or Parquet"),
    ".bag": "make a bag of ROS 2 of it, as rosbags-convert does",
}

#: Endings of what packers write behind the name of a log.
PACKED = (".gz", ".bz2", ".xz", ".zst", ".zip", ".7z")


def unpacked(path: str | Path) -> str:
    """Return the name that a packed log has once it is unpacked, as day_3.nc for day_3.nc.gz; empty for others and for
    those that are read as they are."""
    path = Path(path)
    if path.suffix.lower() not in PACKED or _kind_of(path.name) or path.with_suffix("").suffix.lower() not in FORMATS:
        return ""
    return path.with_suffix("").as_posix()


def is_folder_like_log(path: str | Path) -> bool:
    """Return whether a path is a folder with the name of a log, and no bag: a table that was written in parts, say."""
    path = Path(path)
    return os.path.isdir(path) and log_format(path) is None and _kind_of(path.name) is not None


def log_format(path: str | Path) -> str | None:
    """Return the format of a log by its name, or None; a folder with a metadata.yaml is a bag.

    Of a path that may not be looked at the name alone tells: whoever reads it says that it cannot be read.
    """
    path = Path(path)
    if os.path.isdir(path):
        return "bag" if os.path.isfile(path / "metadata.yaml") else None
    return _kind_of(path.name)


def _kind_of(name: str) -> str | None:
    return next((kind for ending, kind in FORMATS.items() if name.lower().endswith(ending)), None)


def no_kind_of_log(path: str | Path) -> str:
    """Return in words that a file is no log by its name, and what would make one of it."""
    mends = _OTHERWISE.get(Path(path).suffix.lower())
    return f"no kind of log; {mends}" if mends else "no kind of log"


def log_sources(path: str | Path) -> list[str]:
    """Return the files that one log is made of: itself, or the files of a bag's folder."""
    path = Path(path)
    if os.path.isdir(path) and os.access(path, os.R_OK | os.X_OK):
        return sorted(p.as_posix() for p in path.iterdir() if os.path.isfile(p))
    return [str(path)]
