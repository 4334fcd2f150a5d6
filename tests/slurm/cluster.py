"""A Slurm cluster of one node, bound to loopback, in a temporary folder; Debian's slurm-wlm and munge, no service.

The workflow's own configuration of Slurm, if the machine has one, is not touched: programs find ours through small
wrappers that stand first on the PATH, because Snakemake's executor clears SLURM_CONF from the environment.
"""

from __future__ import annotations

import contextlib
import getpass
import os
import shutil
import signal
import socket
import subprocess
import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from pathlib import Path

PROGRAMS = ("munged", "slurmctld", "slurmd")
COMMANDS = ("sbatch", "srun", "squeue", "scancel", "scontrol", "sinfo", "sacct", "sacctmgr")
APT = "apt-get install --no-install-recommends slurm-wlm munge"
FOLDERS = ("/usr/local/sbin", "/usr/sbin", "/sbin", "/usr/local/bin", "/usr/bin", "/bin")


def find(program: str) -> str | None:
    """Return the path of a program, in /usr/sbin too, which is not on every user's PATH."""
    return shutil.which(program, path=os.pathsep.join([os.environ.get("PATH", ""), *FOLDERS]))


def missing() -> list[str]:
    """Return the programs that the cluster needs and that are not installed."""
    return [name for name in (*PROGRAMS, "sbatch", "srun", "squeue", "scancel", "scontrol") if find(name) is None]


def free_ports(count: int) -> list[int]:
    """Return ports of the loopback interface that nobody listens on now."""
    with contextlib.ExitStack() as stack:
        sockets = [stack.enter_context(socket.socket()) for _ in range(count)]
        for each in sockets:
            each.bind(("127.0.0.1", 0))
        return [each.getsockname()[1] for each in sockets]


def wait_for(condition: Callable[[], object], seconds: float, words: str) -> object:
    """Wait until a condition holds and return its value; fail with the words after so many seconds."""
    end = time.monotonic() + seconds
    while time.monotonic() < end:
        if value := condition():
            return value
        time.sleep(0.2)
    raise TimeoutError(f"{words}: not within {seconds:g} s")


@dataclass
class Cluster:
    """A running cluster: `environment` lets a process use it."""

    folder: Path
    cpus: int = 2
    memory: int = 8000
    node: str = field(default_factory=lambda: socket.gethostname().split(".")[0])
    _daemons: list[subprocess.Popen] = field(default_factory=list)

    @property
    def environment(self) -> dict[str, str]:
        """Environment in which sbatch and its friends talk to this cluster."""
        kept = {k: v for k, v in os.environ.items() if not k.startswith("SLURM_")}
        return {**kept, "PATH": f"{self.folder / 'bin'}{os.pathsep}{kept.get('PATH', '')}"}

    def call(self, *command: str) -> str:
        """Run a command of Slurm and return what it prints."""
        done = subprocess.run(command, env=self.environment, capture_output=True, text=True, timeout=60, check=False)
        if done.returncode:
            raise RuntimeError(f"{' '.join(command)}: {done.stderr.strip()}")
        return done.stdout

    def jobs(self) -> dict[str, str]:
        """Return id -> state of the jobs that the controller knows."""
        rows = self.call("squeue", "--all", "--states=all", "--noheader", "--format=%i %T").splitlines()
        return dict(row.split() for row in rows)

    def finished(self) -> list[dict[str, str]]:
        """Return one record for every finished job, from the file that slurmctld itself writes."""
        path = self.folder / "jobcomp.txt"
        text = path.read_text(encoding="utf-8") if path.exists() else ""
        return [dict(part.split("=", 1) for part in line.split() if "=" in part) for line in text.splitlines()]

    def start(self) -> None:
        """Start munged, slurmctld and slurmd and wait until the node is idle."""
        self._configure()
        self._start("munged", "--foreground", "--force", *self._munge_options(), log="munged.log")
        wait_for((self.folder / "munge/socket").exists, 20, "munged")
        conf = str(self.folder / "slurm.conf")
        self._start("slurmctld", "-D", "-f", conf, log="slurmctld.out")
        self._start("slurmd", "-D", "-f", conf, log="slurmd.out")
        wait_for(lambda: "idle" in self._state(), 60, f"the node is not idle; {self.logs()}")

    def stop(self) -> None:
        """Stop the daemons by their process ids, and wait until they are gone."""
        for process in reversed(self._daemons):
            if process.poll() is None:
                process.send_signal(signal.SIGTERM)
            try:
                process.wait(20)
            except subprocess.TimeoutExpired:
                process.kill()
                process.wait()
        self._daemons.clear()

    @property
    def pids(self) -> list[int]:
        """Process ids of the daemons."""
        return [process.pid for process in self._daemons]

    def logs(self) -> str:
        """Return the last lines of what the daemons wrote."""
        return "\n".join(p.read_text(errors="replace")[-800:] for p in sorted(self.folder.glob("*.out")))

    def _state(self) -> str:
        try:
            return self.call("sinfo", "--noheader", "--format=%T")
        except RuntimeError:
            return ""

    def _start(self, program: str, *arguments: str, log: str) -> None:
        with (self.folder / log).open("w") as file:
            self._daemons.append(
                subprocess.Popen(
                    [find(program), *arguments],
                    stdout=file,
                    stderr=subprocess.STDOUT,
                    env=self.environment,
                    start_new_session=True,
                )
            )

    def _munge_options(self) -> list[str]:
        munge = self.folder / "munge"
        return [
            f"--key-file={munge / 'key'}",
            f"--socket={munge / 'socket'}",
            f"--pid-file={munge / 'pid'}",
            f"--log-file={munge / 'log'}",
            f"--seed-file={munge / 'seed'}",
        ]

    def _configure(self) -> None:
        for name in ("munge", "state", "spool", "bin"):
            (self.folder / name).mkdir(parents=True, exist_ok=True)
        # Everyone may use the socket, nobody but us reads the key.
        self.folder.chmod(0o755)
        (self.folder / "munge").chmod(0o755)
        key = self.folder / "munge/key"
        key.write_bytes(os.urandom(1024))
        key.chmod(0o400)
        controller, daemon = free_ports(2)
        conf = self.folder / "slurm.conf"
        user = getpass.getuser()
        lines = {
            "ClusterName": "jointwear",
            "SlurmctldHost": f"{self.node}(127.0.0.1)",
            "SlurmUser": user,
            "SlurmdUser": user,
            "SlurmctldPort": controller,
            "SlurmdPort": daemon,
            "CommunicationParameters": "NoInAddrAny,NoCtldInAddrAny",
            "AuthType": "auth/munge",
            "AuthInfo": f"socket={self.folder / 'munge/socket'}",
            "CredType": "cred/munge",
            "StateSaveLocation": self.folder / "state",
            "SlurmdSpoolDir": self.folder / "spool",
            "SlurmctldPidFile": self.folder / "slurmctld.pid",
            "SlurmdPidFile": self.folder / "slurmd.pid",
            "ProctrackType": "proctrack/linuxproc",
            "TaskPlugin": "task/none",
            "JobAcctGatherType": "jobacct_gather/none",
            "AccountingStorageType": "accounting_storage/none",
            "JobCompType": "jobcomp/filetxt",
            "JobCompLoc": self.folder / "jobcomp.txt",
            "SelectType": "select/cons_tres",
            "SelectTypeParameters": "CR_CPU",
            "SchedulerType": "sched/backfill",
            "SchedulerParameters": "batch_sched_delay=0,sched_min_interval=100000",
            "MpiDefault": "none",
            "PluginDir": "",
            "MinJobAge": 600,
            "KillWait": 2,
            "ReturnToService": 2,
        }
        text = "".join(f"{k}={v}\n" for k, v in lines.items() if v != "")
        text += (
            f"NodeName={self.node} NodeAddr=127.0.0.1 CPUs={self.cpus} RealMemory={self.memory} State=UNKNOWN\n"
            f"PartitionName=main Nodes={self.node} Default=YES MaxTime=INFINITE State=UP\n"
        )
        conf.write_text(text, encoding="utf-8")
        # Slurm looks for plug-ins to its command line beside its configuration; there are none.
        (self.folder / "plugstack.conf").write_text("", encoding="utf-8")
        for name in COMMANDS:
            if real := find(name):
                wrapper = self.folder / "bin" / name
                wrapper.write_text(f'#!/bin/sh\nSLURM_CONF="{conf}" exec {real} "$@"\n', encoding="utf-8")
                wrapper.chmod(0o755)


@contextlib.contextmanager
def cluster(folder: Path, **how: int) -> Iterator[Cluster]:
    """Run a cluster in a folder for the length of a block; its daemons are stopped however the block ends."""
    running = Cluster(folder, **how)
    try:
        running.start()
        yield running
    finally:
        running.stop()
