"""Which format a log has, by its name. Read by the Snakefile at every call: nothing heavy is imported here."""

from __future__ import annotations

from pathlib import Path

FORMATS = {
    ".nc": "netcdf", ".nc4": "netcdf", ".cdf": "netcdf", ".netcdf": "netcdf", ".csv": "csv", ".tsv": "csv",
    ".parquet": "parquet", ".mcap": "bag", ".db3": "bag",
}  # fmt: skip


def log_format(path: str | Path) -> str | None:
    """Return the format of a log by its name, or None; a folder with a metadata.yaml is a bag."""
    path = Path(path)
    if path.is_dir():
        return "bag" if (path / "metadata.yaml").is_file() else None
    return FORMATS.get(path.suffix.lower())
