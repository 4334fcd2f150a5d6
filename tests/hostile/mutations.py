"""Ways in which a document, a file or its bytes are broken, as strategies of hypothesis."""

from __future__ import annotations

import copy
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from hypothesis import HealthCheck, settings
from hypothesis import strategies as st


def seeds(count: int) -> settings:
    """Settings of a fuzz test: `count` inputs, the same at every run (the seed is that of the test itself)."""
    return settings(
        max_examples=count,
        derandomize=True,
        database=None,
        deadline=None,
        suppress_health_check=list(HealthCheck),
    )


NUMBERS = (
    *(float("nan"), float("inf"), -float("inf"), 1e308, -1e308, 1e-320, 10**400, -(10**400), 10**30, 2**63, -0.0),
    *(0, -1, 1e9, -1e9, 0.5, 1e-12),
)
WORDS = (
    *("", " ", "nan", "1e999", "1,37", "1.37kg", "../../x", "/etc/passwd", "--help", "a\x00b", "a\nb", "\x1b[31m"),
    *(
        "x" * 5000,
        "null",
        "~",
        "{{ 7 * 7 }}",
        "$(touch executed)",
        "__import__('os').system('touch executed')",
        "é" * 90,
    ),
)
#: Values that no key expects, in any place.
hostile_values = st.one_of(
    st.sampled_from(NUMBERS),
    st.sampled_from(WORDS),
    st.sampled_from([None, True, [], {}, [None], {"x": 1}, [[]] * 3, [[[[[[1]]]]]], {"": None}, [1] * 500]),
    st.floats(),
    st.integers(),
    st.text(max_size=20),
)


def places(value: Any, path: tuple = ()) -> Iterator[tuple]:
    """Yield the path of every value in nested mappings and lists."""
    for key, inner in value.items() if isinstance(value, dict) else enumerate(value) if isinstance(value, list) else ():
        yield (*path, key)
        yield from places(inner, (*path, key))


@st.composite
def broken_documents(draw: st.DrawFn, whole: Any) -> Any:
    """A document in which one to three values are replaced, removed, doubled or renamed."""
    data = copy.deepcopy(whole)
    for _ in range(draw(st.integers(1, 3))):
        there = list(places(data))
        if not there:
            return data
        *parents, last = draw(st.sampled_from(there))
        inner = data
        for key in parents:
            inner = inner[key]
        what = draw(
            st.sampled_from(["replace", "replace", "replace", "replace", "remove", "double", "rename", "scale"])
        )
        if what == "replace":
            inner[last] = copy.deepcopy(draw(hostile_values))
        elif what == "scale" and isinstance(inner[last], (int, float)):
            inner[last] = inner[last] * draw(st.sampled_from([-1, 0, 1e3, 1e10, 1e300]))
        elif what == "remove":
            del inner[last]
        elif isinstance(inner, list):
            inner.insert(last, copy.deepcopy(inner[last]))
        else:
            inner[str(draw(st.sampled_from(WORDS)))] = inner.pop(last)
    return data


@st.composite
def broken_bytes(draw: st.DrawFn, whole: bytes) -> bytes:
    """Bytes of a file: cut, flipped, overwritten, repeated, or with something put in."""
    data = bytearray(whole)
    for _ in range(draw(st.integers(1, 4))):
        place = draw(st.integers(0, max(0, len(data) - 1)))
        length = draw(st.sampled_from([1, 1, 2, 8, 64, 1000]))
        what = draw(st.sampled_from(["flip", "flip", "flip", "cut", "drop", "repeat", "insert", "zero", "ones"]))
        if what == "flip" and data:
            data[place] ^= 1 << draw(st.integers(0, 7))
        elif what == "cut":
            del data[place:]
        elif what == "drop":
            del data[place : place + length]
        elif what == "repeat":
            data[place:place] = data[place : place + length] * draw(st.sampled_from([1, 3, 50]))
        elif what == "insert":
            data[place:place] = draw(st.one_of(st.binary(max_size=20), st.sampled_from(WORDS).map(str.encode)))
        elif what in ("zero", "ones"):
            part = data[place : place + length]
            data[place : place + length] = (b"\x00" if what == "zero" else b"\xff") * len(part)
    return bytes(data)


def finite_numbers(value: Any, largest: float = 1e18) -> bool:
    """Whether all numbers in nested mappings and lists are finite and at most `largest` in size."""
    if isinstance(value, dict):
        return all(finite_numbers(v, largest) for v in value.values())
    if isinstance(value, (list, tuple)):
        return all(finite_numbers(v, largest) for v in value)
    return not isinstance(value, (int, float)) or abs(value) <= largest


def tree(folder: Path) -> dict[str, bytes | str]:
    """Return every file below a folder with its bytes, every link with its target."""
    found: dict[str, bytes | str] = {}
    for path in sorted(folder.rglob("*")):
        if path.is_symlink():
            found[path.relative_to(folder).as_posix()] = str(path.readlink())
        elif path.is_file():
            found[path.relative_to(folder).as_posix()] = path.read_bytes()
    return found
