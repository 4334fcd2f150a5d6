"""What every rule needs: longest run time and largest memory over its jobs, from `benchmark:` of a whole run.

Adds a benchmark to every rule of a scratch copy of the project, runs the targets there and prints JSON: one entry a
rule. The profiles under workflow/profiles hold what this measured, with room to spare.

    PYTHONPATH=workflow python workflow/benchmarks/resources.py [target ...]
"""

from __future__ import annotations

import csv
import json
import re
import sys
import tempfile
from pathlib import Path

from workflow import copy_project, seconds

_LOG = re.compile(r'    log:\n        "results/logs/(?P<name>[^"]+)\.log",\n')


def add_benchmarks(rules: Path) -> None:
    """Give every rule of a folder that has a log a benchmark of the same name."""
    for path in rules.glob("*.smk"):
        text = path.read_text(encoding="utf-8")
        found = r'\g<0>    benchmark:\n        "results/benchmarks/\g<name>.tsv"\n'
        path.write_text(_LOG.sub(found, text), encoding="utf-8")


def table(folder: Path) -> dict[str, dict[str, float]]:
    """Return for every rule its jobs, longest time [s], total time [s] and largest resident memory [MiB]."""
    found: dict[str, dict[str, float]] = {}
    for path in sorted(folder.rglob("*.tsv")):
        rule = path.relative_to(folder).parts[0].removesuffix(".tsv")
        with path.open(encoding="utf-8") as file:
            row = next(csv.DictReader(file, delimiter="\t"))
        # A job shorter than the sampling of memory has none.
        memory = float(row["max_rss"]) if row["max_rss"] not in ("-", "NA") else 0.0
        entry = found.setdefault(rule, {"jobs": 0, "longest_seconds": 0.0, "total_seconds": 0.0, "largest_mib": 0.0})
        entry["jobs"] += 1
        entry["longest_seconds"] = round(max(entry["longest_seconds"], float(row["s"])), 1)
        entry["total_seconds"] = round(entry["total_seconds"] + float(row["s"]), 1)
        entry["largest_mib"] = round(max(entry["largest_mib"], memory))
    return found


def main() -> None:
    """Measure and print."""
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        copy_project(folder)
        add_benchmarks(folder / "workflow/rules")
        seconds(["--cores", "1", *sys.argv[1:]], folder)
        print(json.dumps(table(folder / "results/benchmarks")))


if __name__ == "__main__":
    main()
