"""Read YAML documents strictly, with one-line errors.

Imported by the Snakefile at every call of Snakemake, so nothing heavy is imported here.
"""

from __future__ import annotations

import re
from copy import deepcopy
from datetime import date
from functools import lru_cache
from pathlib import Path
from typing import Any

import yaml

from jointwear.files.errors import InputError, quoted, shown
from jointwear.files.numbers import check_numbers
from jointwear.files.regular_files import read_text

#: Largest YAML file. Bytes; a robot file has a thousandth of it.
LARGEST_YAML = 4 << 20
#: Most values of a YAML file, aliases counted as often as they stand for something: a fleet of ten thousand robots.
MOST_VALUES = 200_000
#: Deepest nesting of a YAML file; the configuration has five levels.
DEEPEST = 50
#: What the parser says at the line after one whose colon has no space behind it, and such a line.
_NO_KEY = ("could not find expected ':'", "mapping values are not allowed in this context")
_INDENT, _BARE = re.compile(r" *"), re.compile(r"[\w.-]+(?![^#]*:(?:\s|$))\s+[^\s#]")
_GLUED = re.compile(r"\s*(?:- )?[\w.-]+:[^\s:]")


class _StrictLoader(getattr(yaml, "CSafeLoader", yaml.SafeLoader)):
    """A safe loader that refuses duplicate keys and reads 1e-4 as a number, as YAML 1.2 does."""


def _mapping(loader: _StrictLoader, node: yaml.MappingNode, deep: bool = False) -> dict:
    seen: set = set()
    for key_node, _ in node.value:
        if key_node.tag == "tag:yaml.org,2002:merge":  # <<: *anchor, laid under the mapping's own keys below
            continue
        line = key_node.start_mark.line + 1
        key = loader.construct_object(key_node, deep=True)
        if not isinstance(key, (str, int, float, date, type(None))):
            raise InputError(f"line {line}: a key must be text, not a list or a mapping")
        if key is None or isinstance(key, bool):
            said = quoted(key_node.value) if key_node.value else "an empty key"
            meaning = "nothing" if key is None else str(key).lower()
            raise InputError(f"line {line}: YAML reads {said} as {meaning}; put a name between quotation marks")
        if key in seen:
            raise InputError(f"line {line}: key {quoted(key)} is given twice")
        seen.add(key)
    loader.flatten_mapping(node)
    return {loader.construct_object(k, deep=True): loader.construct_object(v, deep=True) for k, v in node.value}


_StrictLoader.add_constructor(yaml.resolver.BaseResolver.DEFAULT_MAPPING_TAG, _mapping)
_StrictLoader.add_implicit_resolver(
    "tag:yaml.org,2002:float", re.compile(r"^[-+]?[0-9][0-9_]*(\.[0-9_]*)?[eE][-+]?[0-9]+$"), list("-+0123456789")
)

# YAML 1.1 reads 010 as 8, 1:30 as 90, 1_0 as 10 and 0x1F as 31; YAML 1.2, and people, read most of them otherwise.
_PLAIN = {
    "tag:yaml.org,2002:int": re.compile(r"[-+]?(0|[1-9][0-9]*)"),
    "tag:yaml.org,2002:float": re.compile(
        r"[-+]?([0-9]+(\.[0-9]*)?|\.[0-9]+)([eE][-+]?[0-9]+)?|[-+]?\.(inf|Inf|INF)|\.(nan|NaN|NAN)"
    ),
}


def _number(loader: _StrictLoader, node: yaml.ScalarNode) -> float:
    if not _PLAIN[node.tag].fullmatch(loader.construct_scalar(node)):
        raise InputError(
            f"line {node.start_mark.line + 1}: {shown(node.value)} is not read as the same number by all readers of "
            "YAML; write decimal digits without colon, underscore or leading zero, or put text between quotation marks"
        )
    whole = node.tag.endswith("int")
    return loader.construct_yaml_int(node) if whole else loader.construct_yaml_float(node)


for _tag in _PLAIN:
    _StrictLoader.add_constructor(_tag, _number)


def _check_size(node: yaml.Node, seen: dict[int, tuple[int, int] | None]) -> tuple[int, int]:
    """Return how many values and levels a node stands for when every alias is written out; `seen` remembers nodes.

    Raises
    ------
    InputError : if an anchor holds itself, or there are too many values or levels.
    """
    line = node.start_mark.line + 1
    if id(node) in seen:
        if seen[id(node)] is None:
            raise InputError(f"line {line}: an anchor holds itself")
        return seen[id(node)]
    seen[id(node)] = None
    total, levels = 1, 0
    if isinstance(node, yaml.CollectionNode):
        pairs = isinstance(node, yaml.MappingNode)
        for entry in node.value:
            for inner in entry if pairs else (entry,):
                count, below = _check_size(inner, seen)
                total, levels = total + count, max(levels, below + 1)
            if total > MOST_VALUES:
                raise InputError(f"line {line}: stands for more than {MOST_VALUES} values, aliases written out")
            if levels > DEEPEST:
                raise InputError(f"line {line}: is nested more than {DEEPEST} levels deep, aliases written out")
    seen[id(node)] = total, levels
    return seen[id(node)]


def _check_depth(text: str) -> None:
    """Check the nesting of a document event by event: to build one that is too deep would end the process."""
    depth = 0
    for event in yaml.parse(text, Loader=_StrictLoader):
        depth += isinstance(event, yaml.CollectionStartEvent)
        depth -= isinstance(event, yaml.CollectionEndEvent)
        if depth > DEEPEST:
            raise InputError(f"line {event.start_mark.line + 1}: is nested more than {DEEPEST} levels deep")


def check_tabs(path: str | Path) -> None:
    """Check a YAML file for tabs that readers written in Python refuse, Snakemake's among them, and others take.

    Raises
    ------
    InputError : naming the line.
    """
    text = read_text(path, LARGEST_YAML)
    if "\t" not in text:
        return
    try:
        for _ in yaml.scan(text, Loader=yaml.SafeLoader):
            pass
    except yaml.YAMLError as error:
        mark = getattr(error, "problem_mark", None)
        line = f" line {mark.line + 1}:" if mark else ""
        raise InputError(f"{path}:{line} holds a tab that YAML does not take there; write spaces") from None


def _load(text: str) -> Any:
    """Return what a text says; the caller may change it."""
    return deepcopy(_loaded(text))


@lru_cache(maxsize=16)
def _loaded(text: str) -> Any:
    """Return what a text says. The robots of a fleet share their robot file and its schema."""
    _check_depth(text)
    loader = _StrictLoader(text)
    try:
        node = loader.get_single_node()
        if node is None:
            return None
        _check_size(node, {})
        return loader.construct_document(node)
    finally:
        loader.dispose()


def check_written_out(text: str, name: str) -> None:
    """Check that a value given as YAML text is one, and that its aliases stand for no more than a document may hold.

    Text that is no YAML counts as a word.

    Raises
    ------
    InputError : one line naming the value.
    """
    try:
        _check_depth(text)
        node = yaml.compose(text, Loader=_StrictLoader)
        if node is None:
            raise InputError("holds no value")
        _check_size(node, {})
    except InputError as error:
        raise InputError(f"{name}: {error}") from None
    except (yaml.YAMLError, ValueError):
        return
    except RecursionError:
        raise InputError(f"{name}: is nested too deeply") from None


def read_yaml(path: str | Path, schema: dict[str, Any] | None = None) -> dict[str, Any]:
    """Read a YAML mapping; `schema` names the limits of numbers that no document may hold.

    Raises
    ------
    InputError : if the file is missing, no regular file, too large, is not valid YAML, holds a key twice or a number
        that is not finite, or is not a mapping.
    """
    path = Path(path)
    text = read_text(path, LARGEST_YAML)
    try:
        data = _load(text)
    except InputError as error:
        raise InputError(f"{path}: {error}") from None
    except yaml.YAMLError as error:
        mark = getattr(error, "problem_mark", None)
        what = getattr(error, "problem", None) or "not valid YAML"
        line = mark.line if mark else None
        if what in _NO_KEY and (glued := _glued_line(text, line)) is not None:
            line, what = glued, "is no 'key: value'; a space follows the colon"
        elif what in _NO_KEY and (bare := _bare_line(text, line)) is not None:
            line, what = bare, "is no 'key: value'; a colon and a space follow the key"
        if what == "but found another document":
            what = "begins another document; one file holds one: leave out the line '---', or what follows it"
        where = f" line {line + 1}:" if mark else ""
        if mark and re.match(r" *\t", "".join(text.splitlines()[mark.line : mark.line + 1])):
            what = "begins with a tab; YAML is indented with spaces"
        raise InputError(f"{path}:{where} {what}") from None
    except RecursionError:
        # Anchors within anchors within anchors.
        raise InputError(f"{path}: is nested too deeply") from None
    except (ValueError, TypeError, KeyError, AttributeError, OverflowError) as error:
        # Values whose tag says what they are not: 2026-13-45, !!int text.
        raise InputError(f"{path}: not valid YAML ({error})") from None
    if data is None:
        raise InputError(f"{path}: is empty; a mapping of keys to values is expected, as 'key: value' in a line")
    if not isinstance(data, dict):
        raise InputError(f"{path}: must be a mapping of keys to values")
    check_numbers(data, path, schema)
    return data


def _glued_line(text: str, line: int) -> int | None:
    """Return which line, up to two before the one at which a parser gave up, is a key whose colon has no space behind
    it, all counted from 0; None where none is."""
    lines = text.splitlines()
    return next((k for k in range(line, max(line - 3, -1), -1) if _GLUED.match("".join(lines[k : k + 1]))), None)


def _bare_line(text: str, line: int) -> int | None:
    """Return which line, one or two before the one at which a parser gave up, is a key without its colon, indented as
    that one is, all counted from 0; None where none is."""
    lines = text.splitlines()
    deep = _INDENT.match("".join(lines[line : line + 1]))[0]
    for k in range(line - 1, max(line - 3, -1), -1):
        if _INDENT.match(lines[k])[0] == deep and _BARE.match(lines[k].strip()):
            return k
    return None
