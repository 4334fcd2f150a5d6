"""Clear the lock that a killed Snakemake leaves behind, but never that of a live one."""

from __future__ import annotations

import os
import shutil
import socket
import time
from pathlib import Path

PATIENCE = 120.0  # s; the longest job of the default workflow takes a few seconds


def _is_snakemake(command: list[str]) -> bool:
    """Whether a command line is Snakemake itself or a script that it started."""
    if any(".snakemake/scripts/" in part for part in command):
        return True
    names = [Path(part).name for part in command[:3]]
    return bool(names) and names[0].startswith(("python", "snakemake")) and "snakemake" in names


def live_processes(root: Path) -> list[int]:
    """Return process ids of other Snakemake runs, or jobs of such, whose working directory is `root`."""
    import psutil

    own = psutil.Process()
    family = {own.pid, *(p.pid for p in own.parents())}
    found = []
    for process in psutil.process_iter():
        try:
            if process.pid in family or Path(process.cwd()) != root.resolve():
                continue
            if process.status() != psutil.STATUS_ZOMBIE and _is_snakemake(process.cmdline()):
                found.append(process.pid)
        except (psutil.Error, OSError):
            continue
    return found


def note_run(root: Path) -> None:
    """Remember which host holds the lock, so that no other host sharing the folder takes it for stale."""
    marker = root / ".snakemake" / "jointwear_host"
    marker.parent.mkdir(exist_ok=True)
    marker.write_text(f"{socket.gethostname()} {os.getpid()}\n", encoding="utf-8")


def _holder(root: Path) -> tuple[str, int | None]:
    """Return the host of the run that noted itself last under `root`, empty where none has, and its process id."""
    marker = root / ".snakemake" / "jointwear_host"
    if not marker.is_file():
        return "", None
    host, _, pid = marker.read_text(encoding="utf-8").partition(" ")
    return host, int(pid) if pid.strip().isdigit() else None


def _locked(root: Path) -> bool:
    locks = root / ".snakemake" / "locks"
    return locks.is_dir() and any(locks.iterdir())


def call_at_work(root: Path) -> int | None:
    """Return the process id of another run that holds the lock under `root`, on this host; None where none does."""
    host, pid = _holder(root)
    if pid is None or not _locked(root) or host != socket.gethostname():
        return None
    return pid if pid in live_processes(root) else None


def clear_stale_lock(root: Path, patience: float = PATIENCE) -> bool:
    """Remove Snakemake's lock under `root` if the run that set it is dead; return whether it was removed.

    Scripts that outlived their killed Snakemake may still be writing; they are waited for up to `patience` [s].
    """
    if not _locked(root):
        return False
    host, pid = _holder(root)
    if host and (host != socket.gethostname() or (pid is not None and pid in live_processes(root))):
        return False
    end = time.monotonic() + patience
    while live_processes(root):
        if not host or time.monotonic() > end:
            return False
        time.sleep(0.2)
    shutil.rmtree(root / ".snakemake" / "locks", ignore_errors=True)
    return True
