"""Compute the run of a crate again in a folder of its own and compare every file."""

from __future__ import annotations

import json
import os
import shutil
import subprocess
import sys
import tempfile
import zipfile
from collections import Counter
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from jointwear.files.errors import InputError
from jointwear.publishing.crate.layout import CONFIG, FILES, METADATA
from jointwear.publishing.crate.software import software
from jointwear.publishing.verification.comparison import CLOSE, EQUAL, TOLERANCE, Outcome, compare_files


@contextmanager
def unpacked(crate: str | Path) -> Iterator[Path]:
    """Give the folder of a crate, which may be a folder or a zip file.

    Raises
    ------
    InputError : if there is no crate of this project at the path.
    """
    path = Path(crate)
    if not path.exists():
        raise InputError(f"config: 'crate' is {crate}: no such file or folder; `make crate` writes one to crate")
    if path.is_dir():
        yield _checked(path, crate)
        return
    with tempfile.TemporaryDirectory() as folder:
        try:
            with zipfile.ZipFile(path) as file:
                file.extractall(folder)
        except zipfile.BadZipFile as error:
            raise InputError(f"config: 'crate' is {crate}: neither a folder nor a zip file ({error})") from None
        yield _checked(Path(folder), crate)


def _checked(folder: Path, crate: str | Path) -> Path:
    found = sorted([*folder.glob(METADATA), *folder.glob(f"*/{METADATA}")])
    if not found or not (found[0].parent / FILES).is_file():
        raise InputError(f"config: 'crate' is {crate}: holds no {METADATA} with {FILES}; it is no crate of jointwear")
    return found[0].parent


def listing(crate: Path) -> dict[str, Any]:
    """Return what the crate lists: results with checksums, wanted files, software, seed."""
    return json.loads((crate / FILES).read_text(encoding="utf-8"))


def recompute(crate: Path, folder: Path, cores: int) -> None:
    """Run the workflow of an unpacked crate in an empty folder, with the Python that runs now.

    Raises
    ------
    InputError : if the run fails; its last lines are in the message.
    """
    shutil.copytree(crate, folder, dirs_exist_ok=True, ignore=_results_of(crate))
    # The crate brings a library of its own; that of this process must not shadow it.
    environment = {k: v for k, v in os.environ.items() if k != "PYTHONPATH"}
    command = [sys.executable, "-m", "snakemake", "--cores", str(cores), *listing(crate)["wanted"]]
    done = subprocess.run(
        [*command, "--configfile", CONFIG], cwd=folder, env=environment, capture_output=True, text=True, check=False
    )
    if done.returncode:
        raise InputError(f"crate {crate}: the run failed: {(done.stdout + done.stderr)[-2000:]}")


def _results_of(crate: Path) -> Callable[[str, list[str]], list[str]]:
    def ignored(folder: str, names: list[str]) -> list[str]:
        return [n for n in names if (Path(folder) == crate and n == "results") or n == "__pycache__"]

    return ignored


def compare_runs(crate: Path, folder: Path, tolerance: float = TOLERANCE) -> dict[str, Outcome]:
    """Compare every result that the crate lists with the file of the same name under `folder`."""
    return {name: compare_files(folder / name, crate / name, tolerance) for name in sorted(listing(crate)["results"])}


def describe(outcomes: dict[str, Outcome]) -> str:
    """Return the comparison as text: a line a file, then the count of each verdict."""
    lines = [f"{o.verdict:23s} {name}{f'  ({o.detail})' if o.detail else ''}" for name, o in outcomes.items()]
    counts = Counter(o.verdict for o in outcomes.values())
    summary = ", ".join(f"{count} {verdict}" for verdict, count in sorted(counts.items()))
    return "\n".join([*lines, f"verify: {len(outcomes)} files: {summary}"])


def changed_versions(crate: Path, now: dict[str, str]) -> list[str]:
    """Return one line for every package whose version differs from that of the crate's run."""
    then = listing(crate)["software"]
    return [f"{k}: {now.get(k, 'none')}, in the crate {then[k]}" for k in sorted(then) if now.get(k) != then[k]]


def verify(crate: str | Path, cores: int) -> bool:
    """Compute a crate again, print the comparison file by file, and return whether nothing differs.

    Raises
    ------
    InputError : if there is no crate at the path or its workflow fails.
    """
    with unpacked(crate) as source, tempfile.TemporaryDirectory(prefix="jointwear-verify-") as name:
        folder = Path(name)
        for line in changed_versions(source, software()):
            print(f"software: {line}")
        recompute(source, folder, cores)
        outcomes = compare_runs(source, folder)
    print(describe(outcomes), flush=True)
    return all(o.verdict in (EQUAL, CLOSE) for o in outcomes.values())
