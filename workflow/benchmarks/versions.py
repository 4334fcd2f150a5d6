"""Are the results the same elsewhere? Cores, runs, Python 3.11 to 3.14, the lower bounds of pyproject.toml.

Builds an environment for each, runs the tiny experiment in it and compares every result with that of the environment
that runs this program. Prints a table; exits 1 if a result differs by more than the tolerance of `verify`. A Python
that is not there, or on which a locked package cannot be installed, is told and does not count.

    PYTHONPATH=workflow python workflow/benchmarks/versions.py [--pythons PATH...] [--keep FOLDER]
"""

from __future__ import annotations

import argparse
import json
import os
import re
import shutil
import subprocess
import sys
import tempfile
import tomllib
from collections import Counter
from pathlib import Path

from jointwear.publishing.verification.comparison import compare_files
from workflow import copy_project

ROOT = Path(__file__).resolve().parents[2]
#: Versions of Python that pyproject.toml allows and that are maintained.
VERSIONS = ("3.11", "3.12", "3.13", "3.14")
TINY = "config/examples/tiny.yaml"


def lower_bounds() -> list[str]:
    """Return the dependencies of pyproject.toml, each at its lower bound."""
    with (ROOT / "pyproject.toml").open("rb") as file:
        given = tomllib.load(file)["project"]["dependencies"]
    return [re.sub(r"\s*>=\s*", "==", entry) for entry in given]


def interpreters(given: list[str] | None) -> dict[str, str | None]:
    """Return the Pythons to try, by version: those given, else of every known version the first that is found."""
    if given is not None:
        return {Path(path).resolve().parents[1].name: path for path in given}
    found: dict[str, str | None] = {}
    for version in VERSIONS:
        managed = sorted(Path.home().glob(f".pyenv/versions/{version}.*/bin/python"))
        found[version] = str(managed[-1]) if managed else shutil.which(f"python{version}")
    return found


def environment(python: str, folder: Path, requirements: list[str]) -> Path | str:
    """Build an environment and return its Python, or the reason why it cannot be built."""
    subprocess.run([python, "-m", "venv", str(folder)], check=True)
    own = folder / "bin/python"
    done = subprocess.run(
        [
            str(own),
            "-m",
            "pip",
            "install",
            "--quiet",
            "--disable-pip-version-check",
            "--prefer-binary",
            *requirements,
        ],
        capture_output=True,
        text=True,
        check=False,
    )
    errors = [line for line in done.stderr.splitlines() if line.startswith("ERROR")]
    return own if done.returncode == 0 else (errors or ["pip failed"])[0]


def run(python: str | Path, folder: Path, cores: int) -> str:
    """Run the tiny experiment in a copy of the project; return the reason of a failure, or nothing."""
    folder.mkdir()
    copy_project(folder)
    kept = {k: v for k, v in os.environ.items() if k != "PYTHONPATH"}
    kept["PATH"] = f"{Path(python).parent}{os.pathsep}{kept['PATH']}"
    done = subprocess.run(
        [str(python), "-m", "snakemake", "--cores", str(cores), "--configfile", TINY],
        cwd=folder,
        env=kept,
        capture_output=True,
        text=True,
        check=False,
    )
    return "" if done.returncode == 0 else (done.stdout + done.stderr)[-1500:]


def compare(base: Path, other: Path) -> tuple[Counter, list[str]]:
    """Return how many netCDF and CSV results have each verdict, and what was seen in those that are not equal."""
    verdicts, seen = Counter(), []
    for path in sorted(p for kind in ("nc", "csv") for p in (base / "results").rglob(f"*.{kind}")):
        name = path.relative_to(base)
        found = compare_files(other / name, path)
        verdicts[found.verdict] += 1
        if found.verdict != "equal":
            seen.append(f"{name}: {found.verdict} {found.detail}")
    return verdicts, seen


def main() -> None:
    """Build, run, compare, print."""
    parser = argparse.ArgumentParser()
    parser.add_argument("--pythons", nargs="*", help="Pythons to try; by default 3.11 to 3.14 as far as they are there")
    parser.add_argument("--keep", type=Path, help="folder for the environments and runs, kept afterwards")
    given = parser.parse_args()
    failed, rows = False, []
    with tempfile.TemporaryDirectory() as name:
        folder = given.keep or Path(name)
        folder.mkdir(parents=True, exist_ok=True)
        if problem := run(sys.executable, folder / "base", 2):
            sys.exit(problem)
        cases = {"second run": (sys.executable, 2), "one core": (sys.executable, 1)}
        locked = ["--require-hashes", "-r", str(ROOT / "requirements/run.txt")]
        for version, path in interpreters(given.pythons).items():
            title = f"Python {version}, locked packages"
            python = environment(path, folder / f"env{version}", locked) if path else "no such Python here"
            if Path(python).exists():
                cases[title] = (python, 2)
            else:
                rows.append((title, f"not tried: {python}", []))
        cases["lower bounds of pyproject.toml"] = (environment(sys.executable, folder / "envlow", lower_bounds()), 2)
        for number, (title, (python, cores)) in enumerate(cases.items()):
            if isinstance(python, str) and not Path(python).exists():
                failed = True
                rows.append((title, f"no environment: {python}", []))
                continue
            other = folder / f"run{number}"
            if problem := run(python, other, cores):
                failed = True
                rows.append((title, "the run failed", [problem]))
                continue
            verdicts, seen = compare(folder / "base", other)
            failed |= any(verdict not in ("equal", "equal within tolerance") for verdict in verdicts)
            rows.append((title, ", ".join(f"{count} {verdict}" for verdict, count in verdicts.items()), seen))
    for title, words, seen in rows:
        print(f"{title:34s} {words}", *(f"    {line}" for line in seen), sep="\n")
    print(json.dumps({"versions": [{"case": title, "result": words} for title, words, _ in rows]}))
    sys.exit(failed)


if __name__ == "__main__":
    main()
