"""What Snakemake recorded about a run: which job made which file from which others, and when."""

from __future__ import annotations

import base64
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from pathlib import Path

from jointwear.files.errors import InputError
from jointwear.files.json_documents import read_json


@dataclass(frozen=True)
class Made:
    """How one file came about: rule, files it was made from, begin and end [s since 1970].

    `log` names the job, whose other outputs have the same; `checksums` are the SHA-256 of files that the job has read.
    """

    rule: str
    inputs: tuple[str, ...]
    begin: float
    end: float
    log: tuple[str, ...] = ()
    checksums: Mapping[str, str] = field(default_factory=dict)


@dataclass(frozen=True)
class Run:
    """Everything behind the wanted files: results with the job that made each, and files that no job made."""

    results: dict[str, Made]
    sources: tuple[str, ...]

    @property
    def checksums(self) -> dict[str, str]:
        """SHA-256 of files as the last job that Snakemake has noted it for has read them."""
        made = sorted(self.results.values(), key=lambda m: m.begin)
        return {name: value for m in made for name, value in m.checksums.items()}

    @property
    def begin(self) -> float:
        """Begin of the first job [s since 1970]."""
        return min(made.begin for made in self.results.values())

    @property
    def end(self) -> float:
        """End of the last job [s since 1970]."""
        return max(made.end for made in self.results.values())


def trace(wanted: Iterable[str], root: str | Path = ".") -> Run:
    """Follow Snakemake's records (.snakemake/metadata) from the wanted files back to files that no job made.

    Parameters
    ----------
    wanted : result files, relative to `root`.
    root : folder of the project.

    Raises
    ------
    InputError : if a wanted file, or a file behind it, is neither there nor recorded, or is a result without record.
    """
    records = _records(Path(root) / ".snakemake" / "metadata")
    results: dict[str, Made] = {}
    sources: set[str] = set()
    waiting, seen = list(wanted), set()
    while waiting:
        name = waiting.pop()
        if name in seen:
            continue
        seen.add(name)
        if name not in records:
            if not (Path(root) / name).is_file():
                raise InputError(f"{name}: neither a file nor recorded as a result; run `make reproduce` first")
            if name.startswith("results/"):
                # It would pass for a file that the run was given, and what it rests on would be left out.
                raise InputError(f"{name}: there is no sound record of how it was made; delete it and run again")
            sources.add(name)
            continue
        results[name] = records[name]
        waiting.extend(records[name].inputs)
    # A job's other outputs belong to the run as well: a table is written as netCDF and as CSV.
    jobs = {(made.rule, made.inputs, made.log) for made in results.values()}
    results.update({n: made for n, made in records.items() if (made.rule, made.inputs, made.log) in jobs})
    missing = sorted(name for name in results if not (Path(root) / name).exists())
    if missing:
        raise InputError(
            f"{missing[0]}: is not there{f', nor are {len(missing) - 1} further results' if missing[1:] else ''}; "
            "run `make reproduce` first"
        )
    return Run(dict(sorted(results.items())), tuple(sorted(sources)))


def _records(folder: Path) -> dict[str, Made]:
    """Return Snakemake's records by the name of the file that they describe."""
    found: dict[str, Made] = {}
    for path in folder.rglob("*") if folder.is_dir() else ():
        if not path.is_file():
            continue
        try:
            # A long name is split over folders that start with @.
            coded = "".join(part.removeprefix("@") for part in path.relative_to(folder).parts)
            name = base64.b64decode(coded).decode()
            entry = read_json(path)
            times = float(entry["starttime"]), float(entry["endtime"])
            read = {n: c.removeprefix("sha256:") for n, c in (entry.get("input_checksums") or {}).items()}
            made = Made(entry["rule"], tuple(entry["input"]), *times, tuple(entry.get("log") or ()), read)
        except (OSError, ValueError, KeyError, TypeError, AttributeError):
            continue
        found[name] = made
    return found
