"""The rooms of the library, and those of its large rooms, import one way."""

import ast
import re
from collections import defaultdict
from functools import cache
from graphlib import TopologicalSorter

import pytest
from scratch_project import ROOT

from jointwear.running.modules import LIBRARY

#: The record that tells the rooms of the large rooms.
RECORD = ROOT / "docs/decisions/rooms_of_the_large_rooms.md"


@cache
def imported(path):
    """The modules of the library that a file names in its imports, as parts of their dotted names."""
    found = []
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if isinstance(node, ast.ImportFrom) and node.module:
            found += [f"{node.module}.{name.name}".split(".") for name in node.names]
        elif isinstance(node, ast.Import):
            found += [name.name.split(".") for name in node.names]
    return found


def arrows(room):
    """Of each room and module that lies in a folder, those beside it that it imports."""
    found = defaultdict(set)
    depth = len(room.relative_to(LIBRARY.parent).parts)
    for path in room.rglob("*.py"):
        own = path.relative_to(LIBRARY.parent).with_suffix("").parts
        if own[depth] == "__init__":
            continue
        for name in imported(path):
            there = room / name[depth] if len(name) > depth else None
            if tuple(name[:depth]) == own[:depth] and there and (there.is_dir() or there.with_suffix(".py").is_file()):
                found[own[depth]].add(name[depth])
        found[own[depth]].discard(own[depth])
    return found


def rooms():
    return {p.name for p in LIBRARY.iterdir() if (p / "__init__.py").is_file()}


@pytest.mark.parametrize("room", ["", *sorted(rooms())])
def test_what_a_room_holds_imports_one_way(room):
    order = set(TopologicalSorter(arrows(LIBRARY / room)).static_order())
    assert room or order == rooms()


@pytest.mark.parametrize("room", ["discovery", "monitor", "measurement"])
def test_the_record_tells_the_rooms_in_the_order_in_which_they_import(room):
    table = RECORD.read_text(encoding="utf-8").split(f"| room of `{room}` |")[1].split("\n\n")[0]
    rows = re.findall(r"^\| `(\w+)` \| (\d+) \| (.*) \|$", table, re.MULTILINE)
    seen, asked = set(), arrows(LIBRARY / room)
    for name, modules, what in rows:
        assert asked[name] & {other for other, *_ in rows} <= seen
        folder = LIBRARY / room / name
        assert len(list(folder.glob("*.py"))) - 1 == int(modules)
        assert ast.get_docstring(ast.parse((folder / "__init__.py").read_text(encoding="utf-8"))) == f"{what}."
        seen.add(name)


def test_two_rooms_that_import_each_other_are_found(tmp_path, monkeypatch):
    monkeypatch.setattr(f"{__name__}.LIBRARY", tmp_path / "jointwear")
    for name, other in (("one", "two"), ("two", "one")):
        folder = tmp_path / "jointwear/shop" / name
        folder.mkdir(parents=True)
        (folder / "part.py").write_text(f"from jointwear.shop.{other} import part\n")
    assert arrows(tmp_path / "jointwear/shop") == {"one": {"two"}, "two": {"one"}}
