"""What Snakemake would read before this workflow is checked first: files and values of the command line."""

import os
import shutil
import subprocess
import sys

import pytest
from scratch_project import ROOT

from jointwear.running.cache_folder import OF_FIGURES, VARIABLE, lend_cache_folder
from jointwear.running.command_line import check_command_line


def said(*arguments):
    with pytest.raises(SystemExit) as ended:
        check_command_line(arguments)
    line = str(ended.value.code)
    assert line.startswith("jointwear: ")
    assert line.isprintable()
    return line


def mappings(levels=9):
    """A mapping that stands for 9^levels values: to merge it takes for ever, to load it no time."""
    lines = ["a0: &a0 {" + ", ".join(f"x{k}: 1" for k in range(9)) + "}"]
    for i in range(1, levels):
        lines.append(f"a{i}: &a{i} {{" + ", ".join(f"x{k}: *a{i - 1}" for k in range(9)) + "}")
    return "\n".join(lines)


@pytest.mark.parametrize(
    "arguments", [("--cores", "0"), ("--cores=0",), ("-c0",), ("-c", "0"), ("all", "--core", "00")]
)
def test_no_cores_start_no_job(arguments):
    assert "no job can start (allowed: 1 or more, or all)" in said(*arguments)


@pytest.mark.parametrize("arguments", [("--cores", "10"), ("-c2",), ("--cores", "all"), ("--cores",), ("-c", "report")])
def test_some_cores_start_some(arguments):
    check_command_line(arguments)


FILES = {
    "bomb": (mappings(), "stands for more than 200000 values"),
    "loop": ("wear: &w {shape: *w}\n", "an anchor holds itself"),
    "digits": ("seed: " + "9" * 5000, "not valid YAML"),
    "json": ('{"seed": ' + "9" * 5000 + "}", "not valid YAML"),
    "deep": ("a: " + "[" * 100_000, "levels deep"),
    "date": ("seed: 2026-13-45\n", "not valid YAML"),
    "template": ("__use_yte__: true\nseed: ?__import__('os').system('touch executed')\n", "runs code"),
    "empty": ("# nothing yet\n", "is empty; a mapping of keys to values is expected"),
    "tab": ("wear:\n  shape:\tlinear\n", "line 2: holds a tab that YAML does not take there; write spaces"),
    "bytes": ("seed: 7", "UTF-8"),
}


@pytest.mark.parametrize(("option", "value"), [("--configfile", "my.yaml"), ("--config", "seed=7")])
def test_a_target_after_the_values_of_an_option_is_told_where_it_belongs(tmp_path, monkeypatch, option, value):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "my.yaml").write_text("seed: 7\n")
    check_command_line(("discover", option, value))
    assert f"{option} takes every word up to the next option: write a target before it" in said(
        option, value, "discover"
    )


@pytest.mark.parametrize("name", FILES)
@pytest.mark.parametrize("option", ["--configfile", "--configfiles", "--configf"])
def test_a_file_that_snakemake_cannot_take_is_named(tmp_path, name, option):
    text, words = FILES[name]
    path, sound = tmp_path / "x.yaml", tmp_path / "sound.yaml"
    path.write_bytes(text.encode("utf-16" if name == "bytes" else "utf-8"))
    sound.write_text("seed: 7\n")
    assert words in said("-n", option, str(sound), str(path), "--cores", "1")
    assert str(path) in said(f"{option}={path}", "all")


def test_what_is_no_file_is_named(tmp_path):
    os.mkfifo(tmp_path / "pipe.yaml")
    (tmp_path / "folder.yaml").mkdir()
    assert "named pipe" in said("--configfile", str(tmp_path / "pipe.yaml"))
    assert "is a folder" in said("--configfile", str(tmp_path / "folder.yaml"))
    assert "no such file" in said("--configfile", str(tmp_path / "none.yaml"))


@pytest.mark.parametrize(
    ("value", "words"),
    [
        ("seed", "must be key=value"),
        ("1=2", "must be key=value"),
        ("wear.axes=[1]", "must be key=value, with a key inside another as 'wear={axes: [1]}'"),
        ("monitor.robots.press.window=2h", "inside another as 'monitor={robots: {press: {window: 2h}}}'"),
        ("seed=#", "holds no value"),
        ("wear={shape: &x {a: *x}}", "an anchor holds itself"),
        ("seed=" + "[" * 500, "levels deep"),
        ("seed=\u0663", "digits 0 to 9"),
        ("seed=1_000", "digits 0 to 9"),
        ("wear={" + ", ".join(mappings().splitlines()) + "}", "200000 values"),
    ],
)
def test_a_value_that_snakemake_cannot_take_is_named(value, words):
    assert words in said("--config", "replicates=3", value, "-n")
    assert words in said("-C" + value)


def test_what_is_sound_passes(tmp_path):
    (tmp_path / "x.yaml").write_text("seed: 7\n")
    check_command_line(["all", "--cores", "1"])
    check_command_line(["--configfile", str(tmp_path / "x.yaml"), "--config", "seed=7", "wear={shape: 1e-4}", "robot="])
    # A target or the value of another option is none of these.
    check_command_line(["--configfile=" + str(tmp_path / "x.yaml"), "nothing.yaml", "--directory", "none.yaml"])


@pytest.mark.long
def test_the_default_profile_asks_first(tmp_path):
    """Snakemake itself, in the checkout and from elsewhere: no traceback, nothing run, no hang."""
    for name in ("loop", "template"):
        (tmp_path / "x.yaml").write_text(FILES[name][0])
        command = [sys.executable, "-m", "snakemake", "-n", "-s", str(ROOT / "Snakefile"), "--configfile", "x.yaml"]
        done = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True, timeout=60, check=False)
        assert done.returncode == 1
        assert done.stderr.splitlines()[-1].startswith("jointwear: x.yaml: ")
        assert FILES[name][1] in done.stderr
    assert os.listdir(tmp_path) == ["x.yaml"]


@pytest.mark.long
def test_a_home_that_cannot_be_written_is_none_of_snakemakes_concern(tmp_path):
    """A file in its place: root, as which tests may run, can write to any folder."""
    (tmp_path / "home").touch()
    (tmp_path / "mine").mkdir()
    kept = {k: v for k, v in os.environ.items() if k != "XDG_CACHE_HOME"} | {"HOME": str(tmp_path / "home")}
    command = [sys.executable, "-m", "snakemake", "-n", "-s", str(ROOT / "Snakefile")]
    done = subprocess.run(command, cwd=tmp_path / "mine", env=kept, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    assert (tmp_path / "mine/.snakemake/cache").is_dir()


@pytest.mark.parametrize("home", ["~", "/closed/home"])
def test_a_home_that_is_none_or_may_not_be_looked_into_is_not_used(tmp_path, monkeypatch, home):
    """A user of no name has none, and a call by sudo may keep that of another user."""
    stat = os.stat

    def closed(path, *args, **how):
        if os.fspath(path) != "/closed" and str(path).startswith("/closed"):
            raise PermissionError(13, "Permission denied", str(path))
        return stat(tmp_path if str(path) == "/closed" else path, *args, **how)

    monkeypatch.chdir(tmp_path)
    for name in (VARIABLE, OF_FIGURES):
        monkeypatch.setenv(name, "")  # so that what is lent goes with the test
        monkeypatch.delenv(name)
    monkeypatch.setattr(os.path, "expanduser", lambda _: home)
    monkeypatch.setattr(os, "stat", closed)
    monkeypatch.setattr(os, "access", lambda path, _: str(path) != "/closed")
    lend_cache_folder()
    assert os.environ[VARIABLE] == str(tmp_path / ".snakemake/cache")


def test_a_profile_that_was_copied_finds_the_library(tmp_path):
    """`profiles` is a link; a copy that follows links has a folder instead."""
    for name in ("workflow/jointwear", "profiles", "config", "workflow/schemas"):
        shutil.copytree(ROOT / name, tmp_path / name)
    (tmp_path / "Snakefile").write_text("rule all:\n")
    (tmp_path / "x.yaml").write_text(FILES["loop"][0])
    command = [sys.executable, "-m", "snakemake", "-n", "--configfile", "x.yaml"]
    done = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True, timeout=60, check=False)
    assert "jointwear: x.yaml: line 1: an anchor holds itself" in done.stderr


def test_files_count_where_snakemake_has_found_them(tmp_path):
    """After --directory a name of the command line is not where it was."""
    path = tmp_path / "mine.yaml"
    path.write_text("__use_yte__: true\n")
    with pytest.raises(SystemExit) as ended:
        check_command_line(["--configfile", "mine.yaml"], [path])
    assert f"{path}: '__use_yte__'" in str(ended.value.code)
    check_command_line(["--configfile", "nowhere.yaml"], [])


def test_tabs_that_every_reader_takes_pass(tmp_path):
    (tmp_path / "x.yaml").write_text('seed: 7 # a\tcomment\nnote: "a\tb"\n')
    check_command_line(["--configfile", str(tmp_path / "x.yaml")])
