"""Which format a log has, by its name. Read by the Snakefile at every call: nothing heavy is imported here."""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path

FORMATS = {
    ".nc": "netcdf", ".nc4": "netcdf", ".cdf": "netcdf", ".netcdf": "netcdf", ".csv": "csv", ".tsv": "csv",
    ".parquet": "parquet", ".mcap": "bag", ".db3": "bag",
}  # fmt: skip
#: Formats of which several logs may be read at a time by threads: the library of netCDF works for one alone.
IN_THREADS = frozenset({"csv", "parquet"})


def log_format(path: str | Path) -> str | None:
    """Return the format of a log by its name, or None; a folder with a metadata.yaml is a bag."""
    path = Path(path)
    if path.is_dir():
        return "bag" if (path / "metadata.yaml").is_file() else None
    return FORMATS.get(path.suffix.lower())


def readable_in_threads(paths: Iterable[str | Path]) -> bool:
    """Return whether threads may read several of these logs at a time."""
    return all(log_format(path) in IN_THREADS for path in paths)
