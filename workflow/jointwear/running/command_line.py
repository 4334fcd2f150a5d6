"""Check what the command line hands to Snakemake before Snakemake itself reads it.

Snakemake loads and merges the files of ``--configfile`` before it reads the Snakefile. It evaluates templates in them
(YTE: any Python), expands aliases without a limit, waits for a named pipe, and answers what PyYAML cannot build with a
traceback. The default profile is read earlier still, and calls this. So does the Snakefile, for who goes without.

Nothing heavy is imported here.
"""

from __future__ import annotations

import re
import sys
from collections.abc import Iterator, Sequence
from pathlib import Path

from jointwear.files.documents import check_tabs, check_written_out, read_yaml
from jointwear.files.errors import InputError, shown
from jointwear.running.script import message_of

# The parser of Snakemake takes any unambiguous beginning of an option.
_FILES = re.compile(r"--configf(?:i(?:l(?:es?)?)?)?(?:=(?P<value>.*))?", re.DOTALL)
_VALUES = re.compile(r"--config(?:=(?P<value>.*))?|-C(?P<joined>.+)?", re.DOTALL)
_CORES = re.compile(r"--co(?:r(?:es?)?)?(?:=(?P<value>.*))?|-c(?P<joined>.+)?", re.DOTALL)
#: A value of the command line, as Snakemake takes it.
_ENTRY = re.compile(r"(?P<key>[a-zA-Z_][\w-]*\w)=(?P<text>.*)", re.DOTALL)
#: Why a target stands among the values of an option, and where it belongs.
_TAKES_ALL = "{option} takes every word up to the next option: write a target before it"
#: Key that turns a configuration file into a template.
TEMPLATE = "__use_yte__"


def check_command_line(arguments: Sequence[str], files: Sequence[str | Path] | None = None) -> None:
    """Check the files of ``--configfile``, the values of ``--config`` and the cores; end with one line if one is bad.

    Parameters
    ----------
    arguments : what follows the name of the program.
    files : where Snakemake has found the files by now; default as the arguments name them, seen from here.

    Raises
    ------
    SystemExit : with the line that says which file, and what is wrong with it.
    """
    try:
        for path in _given(arguments, _FILES) if files is None else files:
            if files is None and _is_word(path):
                raise InputError(f"{path}: no such file; {_TAKES_ALL.format(option='--configfile')}")
            values = read_yaml(path)
            check_tabs(path)
            if TEMPLATE in values:
                raise InputError(f"{path}: '{TEMPLATE}' makes a template of it, which runs code; only values are read")
        for text in _given(arguments, _VALUES):
            _check_entry(text)
        for text in _given(arguments, _CORES):
            # With none Snakemake starts no job and waits for ever.
            if text.strip("0") == "" and text:
                raise InputError(f"--cores {shown(text)}: no job can start (allowed: 1 or more, or all)")
    except (InputError, OSError, MemoryError) as error:
        sys.exit(message_of(error) or f"jointwear: {error}")


def _check_entry(text: str) -> None:
    """Check one value of ``--config``."""
    entry = _ENTRY.fullmatch(text)
    if entry is None:
        hint = _nested(text)
        if _is_word(text):
            hint = f"; {_TAKES_ALL.format(option='--config')}"
        raise InputError(f"--config {shown(text)}: must be key=value{hint}")
    text = entry["text"]
    if ("_" in text or not text.isascii()) and _counts_as_number(text):
        raise InputError(f"--config {entry['key']}: {shown(text)} must be written in digits 0 to 9")
    if text:
        check_written_out(text, f"--config {entry['key']}")


def _nested(text: str) -> str:
    """Return how a key inside others, as ``a.b.c=2``, is given, in words; empty for all other texts."""
    dotted = re.fullmatch(r"(\w+(?:\.\w+)+)=(.*)", text, re.DOTALL)
    if dotted is None:
        return ""
    first, *inner = dotted[1].split(".")
    value = dotted[2]
    for key in reversed(inner):
        value = f"{{{key}: {value}}}"
    return f", with a key inside another as {shown(f'{first}={value}')}"


def _is_word(text: str) -> bool:
    """Whether a value is a bare word, as a target is, and no file."""
    return re.fullmatch(r"[a-z_]+", text) is not None and not Path(text).exists()


def _counts_as_number(text: str) -> bool:
    """Whether Python, and so Snakemake, takes a text for a number."""
    try:
        float(text)
    except ValueError:
        return False
    return True


def _given(arguments: Sequence[str], option: re.Pattern[str]) -> Iterator[str]:
    """Yield every value of an option: the one joined to it, else all that follow up to the next option."""
    inside = False
    for argument in arguments:
        found = option.fullmatch(argument)
        if found:
            joined = [value for value in found.groups() if value is not None]
            inside = not joined
            yield from joined
        elif argument.startswith("-"):
            inside = False
        elif inside:
            yield argument
