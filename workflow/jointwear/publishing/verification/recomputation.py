"""Compute the run of a crate again in a folder of its own and compare every file."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
import tempfile
from collections import Counter
from pathlib import Path

from jointwear.files.documents import read_yaml
from jointwear.files.errors import InputError, printable
from jointwear.files.regular_files import ROOT
from jointwear.files.wording import count
from jointwear.publishing.crate.layout import COMMIT, CONFIG, PROJECT, PROJECT_FILES, STAMP
from jointwear.publishing.crate.software import software
from jointwear.publishing.verification.comparison import CLOSE, EQUAL, Outcome, compare_files
from jointwear.publishing.verification.packed_run import check_contents, foreign_code, listing, unpacked
from jointwear.running.configuration import prepare

#: What a run leaves below results beside its results.
NOT_RESULTS = ("results/logs/", "results/benchmarks/")


def recompute(crate: Path, folder: Path, cores: int) -> None:
    """Run the workflow of a checked crate in an empty folder, with the Python that runs now.

    Nothing but what a run is made from is copied: neither results nor files that Python or Snakemake would pick up.

    Raises
    ------
    InputError : if the run fails; its last lines are in the message.
    """
    for part in (*PROJECT, *PROJECT_FILES, COMMIT, CONFIG):
        source, target = crate / part, folder / part
        if source.is_dir():
            shutil.copytree(source, target, ignore=shutil.ignore_patterns("__pycache__"))
        elif source.is_file():
            target.parent.mkdir(parents=True, exist_ok=True)
            shutil.copyfile(source, target)
    # The crate brings a library of its own; that of this process must not shadow it.
    environment = {k: v for k, v in os.environ.items() if k != "PYTHONPATH"}
    command = [sys.executable, "-m", "snakemake", "--cores", str(cores), "--configfile", CONFIG]
    # Behind the dashes a name is a file, whatever it looks like.
    command += ["--", *listing(crate)["wanted"]]
    try:
        done = subprocess.run(command, cwd=folder, env=environment, capture_output=True, text=True, check=False)
    except OSError as error:  # more names than a command line takes
        raise InputError(f"crate {crate}: the run cannot be started ({error.strerror})") from None
    if done.returncode:
        last = " | ".join((done.stdout + done.stderr).splitlines()[-12:])
        raise InputError(f"crate {crate}: the run failed: {last[-1500:]}")


def compare_runs(crate: Path, folder: Path) -> dict[str, Outcome]:
    """Compare every result that the crate lists or that was made under `folder` with the file of the same name."""
    made = {p.relative_to(folder).as_posix() for p in (folder / "results").rglob("*") if p.is_file()}
    made = {name for name in made if not name.startswith(NOT_RESULTS) and not name.endswith(STAMP)}
    names = sorted(made | listing(crate)["results"].keys())
    return {name: compare_files(folder / name, crate / name) for name in names}


def describe(outcomes: dict[str, Outcome]) -> str:
    """Return the comparison as text: a line a file, then the count of each verdict."""
    lines = [
        f"{o.verdict:23s} {printable(name)}{f'  ({printable(o.detail)})' if o.detail else ''}"
        for name, o in outcomes.items()
    ]
    counts = Counter(o.verdict for o in outcomes.values())
    summary = ", ".join(f"{many} {verdict}" for verdict, many in sorted(counts.items()))
    return "\n".join([*lines, f"verify: {count(len(outcomes), 'file')}: {summary}"])


def changed_versions(crate: Path, now: dict[str, str]) -> list[str]:
    """Return one line for every package whose version differs from that of the crate's run."""
    then = listing(crate)["software"]
    return [f"{k}: {now.get(k, 'none')}, in the crate {then[k]}" for k in sorted(then) if now.get(k) != then[k]]


def check_trust(crate: Path, own: Path) -> None:
    """Check that the workflow of a crate is this one, file by file, and that its configuration is one for it.

    Raises
    ------
    InputError : naming the files that differ; a workflow is a program, and it would run with the user's rights.
    """
    differing = foreign_code(crate, own)
    if differing:
        raise InputError(
            f"crate {crate}: its workflow is not this one: {count(len(differing), 'file')} "
            f"{'differs' if len(differing) == 1 else 'differ'}, as {differing[0]}. It would "
            "run with your rights: look at it, then add --config trust=true, or verify with the version of jointwear "
            "that wrote it"
        )
    prepare(read_yaml(crate / CONFIG))


def verify(crate: str | Path, cores: int, trust: bool = False, own: Path = ROOT) -> bool:
    """Compute a crate again, print the comparison file by file, and return whether nothing differs.

    Parameters
    ----------
    crate : folder or zip file.
    cores : of the run.
    trust : whether a workflow other than that in `own` may run.
    own : top folder of the project.

    Raises
    ------
    InputError : if there is no crate at the path, it is not what it lists, its workflow is not trusted or fails.
    """
    with unpacked(crate) as source, tempfile.TemporaryDirectory(prefix="jointwear-verify-") as name:
        folder = Path(name)
        check_contents(source)
        print(f"checksums: all of {len(listing(source)['results'])} results and of the workflow are as listed")
        if trust:
            # Snakemake would evaluate what a configuration may ask it to; ours asks for nothing.
            read_yaml(source / CONFIG)
        else:
            check_trust(source, own)
        for line in changed_versions(source, software()):
            print(f"software: {printable(line)}")
        recompute(source, folder, cores)
        outcomes = compare_runs(source, folder)
    print(describe(outcomes), flush=True)
    return all(o.verdict in (EQUAL, CLOSE) for o in outcomes.values())
