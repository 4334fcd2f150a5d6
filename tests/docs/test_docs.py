"""Every block of the documentation in order, page by page, in a scratch copy of the project with small settings."""

import contextlib
import hashlib
import os
import re
import shutil
import subprocess
import sys
import tempfile
from dataclasses import replace
from pathlib import Path

import pytest
from pages import Step, steps
from scratch_project import ROOT, copy_project

pytestmark = pytest.mark.docs
PAGES = sorted(p.relative_to(ROOT / "docs") for p in [ROOT / "docs/tutorial.md", *(ROOT / "docs/howto").glob("*.md")])
FURTHER = ("Makefile", "requirements", "pyproject.toml", "README.md", "LICENSE", "CITATION.cff", "docs")
# What the executors say they need; pages that name them run inside.
CLUSTER_PAGE = Path("howto/cluster.md")
# The page whose commands are called in a folder of the reader's own, and what it has in place of that of the checkout.
OWN_FOLDER_PAGE, CHECKOUT = Path("howto/own_folder.md"), "/path/to/jointwear"


def lend_environment(folder: Path) -> None:
    """Give a scratch copy the environment of this run as its .venv, so that make builds none."""
    venv = folder / ".venv"
    venv.mkdir()
    for item in Path(sys.prefix).iterdir():
        (venv / item.name).symlink_to(item)
    locks = {name: (ROOT / f"requirements/{name}.txt").read_bytes() for name in ("run", "test", "publish", "cluster")}
    for stamp in locks:
        text = locks["run"] if stamp == "run" else locks["run"] + locks[stamp]
        mark = venv / f".{stamp}-{hashlib.sha256(text).hexdigest()[:16]}"
        if not mark.exists():
            mark.touch()


def run(step: Step, folder: Path, environment: dict[str, str]) -> None:
    """Carry out one step; fail with its output."""
    if step.kind == "file":
        path = folder / step.path
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(step.text)
        return
    command = ["bash", "-eu", "-c", step.text] if step.kind == "sh" else [sys.executable, "-c", step.text]
    done = subprocess.run(
        command, cwd=folder, env=environment, capture_output=True, text=True, timeout=900, check=False
    )
    assert done.returncode == 0, f"{step.text}\n{done.stdout[-3000:]}{done.stderr[-3000:]}"


@pytest.fixture(scope="module")
def built(tmp_path_factory):
    """A project that has run once, as a reader of a how-to has it."""
    project = copy_project(tmp_path_factory.mktemp("docs"))
    for name in FURTHER:
        source = ROOT / name
        (shutil.copytree if source.is_dir() else shutil.copy2)(source, project.folder / name)
    lend_environment(project.folder)
    project.snakemake("--cores", "2")
    return project.folder


@contextlib.contextmanager
def surroundings(page: Path, folder: Path):
    """Give the environment of a page; that of the cluster page has a Slurm and a Kubernetes API on loopback."""
    base = {name: value for name, value in os.environ.items() if name != "PYTHONPATH"}  # as a reader has it
    base["PATH"] = f"{folder / '.venv/bin'}{os.pathsep}{base['PATH']}"
    if page != CLUSTER_PAGE:
        yield base
        return
    sys.path[:0] = [str(ROOT / "tests/slurm"), str(ROOT / "tests/publish")]
    from cluster import APT, cluster, missing
    from kubernetes_api import kubernetes_api

    if gone := missing():
        pytest.fail(f"{', '.join(gone)} not found; on Debian: {APT}")
    # Something to do for the cluster, and a profile that asks it often: it is small and near.
    for part in ("tables", "report"):
        shutil.rmtree(folder / "results" / part)
    with (folder / "workflow/profiles/slurm/config.yaml").open("a") as profile:
        profile.write("slurm-status-command: squeue\nslurm-init-seconds-before-status-checks: 1\n")
        profile.write("seconds-between-status-checks: 1\n")
    for command in (["git", "init", "--quiet"], ["git", "add", "Snakefile", "workflow", "config", "report"]):
        subprocess.run(command, cwd=folder, check=True)
    with tempfile.TemporaryDirectory(prefix="slurm-") as name, cluster(Path(name)) as slurm, kubernetes_api() as api:
        own = api.write_kubeconfig(Path(name) / "kubeconfig")
        path = f"{Path(name) / 'bin'}{os.pathsep}{base['PATH']}"
        kept = {k: v for k, v in base.items() if not k.startswith("SLURM_")}
        yield {**kept, "PATH": path, "KUBECONFIG": str(own)}
        assert slurm.finished()


@pytest.mark.parametrize("page", PAGES, ids=str)
def test_every_step_of_a_page_works(built, tmp_path, page):
    folder = tmp_path / "project"
    shutil.copytree(built, folder, symlinks=True)
    found = steps(ROOT / "docs" / page)
    assert found
    with surroundings(page, folder) as environment:
        for number, step in enumerate(found):
            if page == OWN_FOLDER_PAGE:
                own = tmp_path / f"own_{number}"
                own.mkdir()
                assert CHECKOUT in step.text
                run(replace(step, text=step.text.replace(CHECKOUT, str(folder))), own, environment)
            else:
                run(step, folder, environment)


def test_files_of_the_project_that_documents_name_are_there():
    pages = [*(ROOT / "docs").rglob("*.md"), *(ROOT / "data").rglob("README.md"), ROOT / "config/README.md"]
    for page in pages:
        text = page.read_text()
        for path in re.findall(r"\bworkflow/\w+/[\w/]+\.\w+", text):
            # A reader writes some of them.
            assert (ROOT / path).exists() or f"# file: {path}" in text, f"{page.relative_to(ROOT)}: {path}"


def test_links_between_pages_lead_somewhere():
    for page in [*(ROOT / "docs").rglob("*.md"), ROOT / "README.md", ROOT / "config/README.md"]:
        for target in re.findall(r"\]\(([^)#]+)", page.read_text()):
            if not target.startswith(("http:", "https:")):
                assert (page.parent / target).exists(), f"{page.name}: {target}"
