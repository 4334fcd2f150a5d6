"""A script tells what a user can mend in one line, in its log too; a defect of its own keeps its traceback."""

import errno
import subprocess
import sys
from pathlib import Path

import pytest

import jointwear
from jointwear.files.errors import InputError
from jointwear.measurement.refused import Refused
from jointwear.running.script import INTERRUPTED, reported


@pytest.mark.parametrize(
    ("error", "words"),
    [
        (InputError("a.yaml: wrong"), "jointwear: a.yaml: wrong"),
        (OSError(errno.EROFS, "Read-only file system", "results/a"), "jointwear: results/a: Read-only file system"),
        (PermissionError(errno.EACCES, "Permission denied", "b"), "jointwear: b: Permission denied"),
        (OSError(errno.ENOSPC, "No space left on device"), "No space left"),
        (MemoryError(), "not enough memory"),
    ],
)
def test_what_the_surroundings_refuse_is_one_line(tmp_path, capsys, error, words):
    with pytest.raises(SystemExit), reported(str(tmp_path / "log")):
        raise error
    said = capsys.readouterr().err
    assert words in said
    assert said.count("\n") == 1
    assert (tmp_path / "log").read_text() == said


def test_a_refusal_comes_with_its_remedy(capsys):
    with pytest.raises(SystemExit), reported(None):
        raise Refused("log.csv: looks like degrees", "state units: {position: deg}")
    assert capsys.readouterr().err == "jointwear: log.csv: looks like degrees; state units: {position: deg}\n"


def test_a_log_that_cannot_be_written_hides_nothing(tmp_path, capsys):
    with pytest.raises(SystemExit), reported(str(tmp_path / "none" / "log")):
        raise InputError("a.yaml: wrong")
    assert "a.yaml: wrong" in capsys.readouterr().err


def test_a_defect_keeps_its_traceback(tmp_path):
    with pytest.raises(KeyError), reported(None):
        raise KeyError("x")
    # In the log of the rule too, which a failed job is expected to have.
    with pytest.raises(KeyError), reported(str(tmp_path / "log")):
        raise KeyError("of a defect")
    assert "KeyError: 'of a defect'" in (tmp_path / "log").read_text(encoding="utf-8")
    with pytest.raises(OSError, match="x"), reported(None):
        raise OSError(errno.EPIPE, "x")


def test_a_module_that_counts_as_absent_is_there_again_afterwards():
    code = """
import sys
from jointwear.running.script import reported
import pyarrow
with reported(None, ['pandas']):
    pyarrow.array([1.0]).to_numpy(zero_copy_only=False)
    assert "pandas" not in sys.modules
import pandas
with reported(None, ['pandas']):
    assert sys.modules["pandas"] is pandas
"""
    library = Path(jointwear.__file__).parents[1]
    subprocess.run([sys.executable, "-c", code], cwd=library, check=True, timeout=120)


def test_an_interrupted_job_leaves_a_log_and_no_traceback(tmp_path, capsys):
    """Without the log the logger plugin fails beside the job."""
    with pytest.raises(SystemExit) as ended, reported(str(tmp_path / "log")):
        raise KeyboardInterrupt
    assert ended.value.code == INTERRUPTED
    assert (tmp_path / "log").read_text() == "jointwear: interrupted\n"
    assert capsys.readouterr().err == ""
