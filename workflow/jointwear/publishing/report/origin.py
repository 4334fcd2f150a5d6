"""Where a report comes from: commit, packages, run time of every rule."""

from __future__ import annotations

import platform
import subprocess
from collections import defaultdict
from importlib import metadata
from pathlib import Path
from typing import Any

from jointwear.files.json_documents import read_json

PACKAGES = ("jinja2", "matplotlib", "netCDF4", "numpy", "pin", "scikit-learn", "scipy", "snakemake", "xarray")


def commit(root: str | Path) -> dict[str, Any] | None:
    """Return the commit of the working tree at `root` and whether files differ from it; None outside git.

    A crate of a run is no git checkout: its file commit.json says what the run knew.
    """
    packed = Path(root) / "commit.json"
    if packed.is_file():
        return read_json(packed, object)

    def git(*arguments: str) -> str:
        call = ["git", "-C", str(root), *arguments]
        return subprocess.run(call, capture_output=True, text=True, check=True, timeout=10).stdout.strip()

    try:
        if Path(git("rev-parse", "--show-toplevel")).resolve() != Path(root).resolve():
            return None
        changed = bool(git("status", "--porcelain", "--untracked-files=no"))
        return {"identifier": git("rev-parse", "HEAD"), "changed": changed}
    except (OSError, subprocess.SubprocessError):
        return None


def versions() -> dict[str, str]:
    """Return the versions of Python and of the packages that the results depend on."""
    found = {"Python": platform.python_version()}
    for name in PACKAGES:
        try:
            found[name] = metadata.version(name)
        except metadata.PackageNotFoundError:
            found[name] = "not installed"
    return found


def rule_times(records: str | Path) -> list[dict[str, Any]]:
    """Return the run time of every rule [s] from Snakemake's records (.snakemake/metadata); empty without them.

    A job leaves a record for each of its outputs and counts once, by its log. Returns `rule`, `jobs`, `total` and
    `longest`.
    """
    seconds: dict[str, dict[tuple, float]] = defaultdict(dict)
    for path in Path(records).rglob("*") if Path(records).is_dir() else ():
        try:
            record = read_json(path) if path.is_file() else {}
            begin, end, rule = float(record["starttime"]), float(record["endtime"]), record["rule"]
            job = tuple(record.get("log") or [path.name])
            seconds[rule][job] = max(end - begin, seconds[rule].get(job, 0.0))
        except (OSError, ValueError, KeyError, TypeError):
            continue
    return [
        {"rule": rule, "jobs": len(jobs), "total": sum(jobs.values()), "longest": max(jobs.values())}
        for rule, jobs in sorted(seconds.items())
    ]
