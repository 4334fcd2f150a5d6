"""Snakemake as `python -m snakemake` runs it, in a fork of a process that has loaded its libraries before.

Two thirds of the time of a plan go into loading Snakemake, which is the same for every test. The process is a fresh
interpreter of its own: of the project it has loaded nothing, so that each fork loads the copy in its own folder. Every
fork has its own folder, command line, output and exit status, as a command has.
"""

import atexit
import json
import os
import subprocess
import sys
from functools import cache
from pathlib import Path
from tempfile import TemporaryDirectory

#: What a plan loads that is not of the project.
LIBRARIES = (
    "snakemake.cli",
    "snakemake.report.html_reporter",
    "snakemake_logger_plugin_rich",
    "yte",
    "jsonschema",
    "netCDF4",
)


def warm_snakemake(arguments: list[str], folder: Path, timeout: float) -> subprocess.CompletedProcess:
    """Run `snakemake` with `arguments` in `folder`, as subprocess.run does with captured text.

    Raises
    ------
    subprocess.TimeoutExpired : if it takes longer than `timeout` seconds.
    """
    with TemporaryDirectory() as kept:
        out, err = Path(kept) / "stdout", Path(kept) / "stderr"
        process = _process()
        request = {"arguments": arguments, "folder": str(folder), "out": str(out), "err": str(err), "timeout": timeout}
        process.stdin.write(json.dumps(request) + "\n")
        process.stdin.flush()
        status = json.loads(process.stdout.readline())
        if status is None:
            raise subprocess.TimeoutExpired(["snakemake", *arguments], timeout)
        return subprocess.CompletedProcess(["snakemake", *arguments], status, out.read_text(), err.read_text())


@cache
def _process() -> subprocess.Popen:
    process = subprocess.Popen(
        [sys.executable, __file__], stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True, cwd="/"
    )

    def end() -> None:
        process.stdin.close()
        process.wait()

    atexit.register(end)
    return process


def _serve() -> None:
    """Answer each request with the exit status of its fork."""
    import gc
    import importlib
    import signal

    answers = os.fdopen(os.dup(1), "w")
    os.dup2(2, 1)  # what libraries print while they are loaded is no answer
    for name in LIBRARIES:
        importlib.import_module(name)
    assert not any(name.split(".")[0] == "jointwear" for name in sys.modules)
    gc.freeze()
    for line in sys.stdin:
        request = json.loads(line)
        fork = os.fork()
        if fork == 0:
            _become_snakemake(request)
        signal.signal(signal.SIGALRM, lambda *_, fork=fork: os.kill(fork, signal.SIGKILL))
        signal.setitimer(signal.ITIMER_REAL, request["timeout"])
        _, status = os.waitpid(fork, 0)
        signal.setitimer(signal.ITIMER_REAL, 0)
        code = os.waitstatus_to_exitcode(status)
        answers.write(json.dumps(None if code == -signal.SIGKILL else code) + "\n")
        answers.flush()


def _become_snakemake(request: dict) -> None:
    """Go on as `python -m snakemake` in the folder of the request."""
    import runpy

    os.chdir(request["folder"])
    for number, flags, name in ((0, os.O_RDONLY, os.devnull), (1, os.O_WRONLY, "out"), (2, os.O_WRONLY, "err")):
        file = os.open(request.get(name, name), flags | os.O_CREAT, 0o600)
        os.dup2(file, number)
        os.close(file)
    sys.path[0] = request["folder"]
    sys.argv = ["snakemake", *request["arguments"]]
    runpy.run_module("snakemake", run_name="__main__", alter_sys=True)
    sys.exit()


if __name__ == "__main__":
    _serve()
