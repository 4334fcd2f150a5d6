"""Are two files of the same name equal, equal within a tolerance, or different?

Dates and run times are exempt: in pages they stand inside elements marked `data-varies`, of which both pages must have
the same in the same places, in `summary.json` under `source`, where versions of software stand as well.
"""

from __future__ import annotations

import math
import re
from collections.abc import Iterator
from dataclasses import dataclass
from html.parser import HTMLParser
from pathlib import Path
from typing import Any

import numpy as np

from jointwear.files.errors import InputError, shown
from jointwear.files.json_documents import read_json
from jointwear.files.storage import CHECKSUM, open_dataset, read_variable
from jointwear.publishing.figures.seal import unsealed

#: Largest difference of a number allowed, as a share of the number itself; single precision holds 6e-8.
TOLERANCE = 1e-6
#: Numbers below this share of the largest of their variable count as if they were that large: what is left where large
#: numbers cancel is round-off, allowed up to 1e-12 of the largest.
CANCELLED = 1e-6
EQUAL, CLOSE, DIFFERENT, MISSING = "equal", "equal within tolerance", "different", "missing"
_NUMBER = re.compile(r"[-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?", re.ASCII)
_VARYING_KEYS = ("source",)
#: Attributes of a file that say when and by what it was written, not what it holds.
_VARYING_ATTRIBUTES = ("history", "source", "workflow_version", CHECKSUM)
#: Elements that may stand inside a varying one: words, links and tables, but no pictures or scripts.
_PLAIN_TAGS = frozenset(
    ["a", "b", "caption", "code", "div", "h3", "p", "small", "span", "table", "tbody", "td", "th", "thead", "tr"]
)
#: What Python's parser of HTML looks for the end of, again and again where there is none: ten seconds for a megabyte.
#: So does it within an element with a `<` or many quotation marks; elements up to this length [characters] do no harm.
_OPENERS, _LONG = ("<!--", "<![", "<script", "<style", "<textarea", "<title"), 1000
_VOID = ("area", "base", "br", "col", "embed", "hr", "img", "input", "link", "meta", "source", "track", "wbr")


@dataclass(frozen=True)
class Outcome:
    """Verdict on one file, and what was seen where it is not plain equality."""

    verdict: str
    detail: str = ""


def compare_files(ours: str | Path, theirs: str | Path) -> Outcome:
    """Compare two files of the same kind.

    Parameters
    ----------
    ours, theirs : recomputed file and the one of the crate.
    """
    ours, theirs = Path(ours), Path(theirs)
    if not ours.is_file():
        return Outcome(MISSING, "was not made")
    if not theirs.is_file():
        return Outcome(MISSING, "is not in the crate")
    if _same_bytes(ours, theirs):
        return Outcome(EQUAL)
    try:
        if ours.suffix == ".nc":
            return _compare_netcdf(ours, theirs)
        if ours.suffix == ".json":
            return _compare_values(read_json(ours, object), read_json(theirs, object))
        if ours.suffix == ".html" and _outline(ours) != _outline(theirs):
            return Outcome(DIFFERENT, "its comments, scripts or long elements are not those of the recomputed page")
        return _compare_text(_text(ours), _text(theirs))
    except InputError as error:
        return Outcome(DIFFERENT, str(error))
    except UnicodeDecodeError:
        return Outcome(DIFFERENT, "is not text in UTF-8")


def _same_bytes(a: Path, b: Path) -> bool:
    if a.stat().st_size != b.stat().st_size:
        return False
    with a.open("rb") as one, b.open("rb") as other:
        while block := one.read(1 << 20):
            if block != other.read(1 << 20):
                return False
    return True


def _compare_netcdf(a: Path, b: Path) -> Outcome:
    with open_dataset(a) as one, open_dataset(b) as other:
        if one.variables.keys() != other.variables.keys():
            changed = sorted(one.variables.keys() ^ other.variables.keys())
            return Outcome(DIFFERENT, f"variables in one file only: {', '.join(changed)}")
        largest, where = 0.0, ""
        for name in one.variables:
            x, y = read_variable(one, a, name), read_variable(other, b, name)
            if x.shape != y.shape or one[name].dimensions != other[name].dimensions:
                return Outcome(DIFFERENT, f"{name}: shape {x.shape}, in the crate {y.shape}")
            if _attributes(one[name]) != _attributes(other[name]):
                return Outcome(DIFFERENT, f"{name}: its units or other attributes differ")
            gap = relative_difference(x, y)
            if gap > largest:
                largest, where = gap, name
        if _attributes(one, _VARYING_ATTRIBUTES) != _attributes(other, _VARYING_ATTRIBUTES):
            return Outcome(DIFFERENT, "global attributes differ")
    if largest > TOLERANCE:
        return Outcome(DIFFERENT, f"{where}: a number differs by {largest:.2g} of its size")
    if largest > 0:
        return Outcome(CLOSE, f"{where}: a number differs by {largest:.2g} of its size")
    return Outcome(CLOSE, "same numbers, other software or layout")


def _attributes(holder: Any, left_out: tuple[str, ...] = ()) -> dict[str, str]:
    return {name: repr(holder.getncattr(name)) for name in holder.ncattrs() if name not in left_out}


def relative_difference(x: np.ndarray, y: np.ndarray) -> float:
    """Return the largest difference of two numbers as a share of the larger; infinite for text that differs.

    Numbers below :data:`CANCELLED` of the largest count as if they were that large. NaN equals NaN; NaN against a
    number is an infinite difference.
    """
    if x.dtype.kind not in "iufb" or y.dtype.kind not in "iufb":
        return 0.0 if np.array_equal(x, y) else math.inf
    if x.size == 0 or np.array_equal(x, y, equal_nan=x.dtype.kind == "f" and y.dtype.kind == "f"):
        return 0.0
    if not np.array_equal(np.isfinite(x), np.isfinite(y)):
        return math.inf
    finite = np.isfinite(x)
    if not np.array_equal(x[~finite], y[~finite], equal_nan=True):
        return math.inf
    x, y = x[finite].astype(float), y[finite].astype(float)
    size = np.maximum(np.abs(x), np.abs(y))
    floor = CANCELLED * size.max(initial=0.0)
    if not floor:
        return float(np.inf) if size.any() else 0.0
    return float((np.abs(x - y) / np.maximum(size, floor)).max())


def _without_varying(value: Any) -> Any:
    return {k: v for k, v in value.items() if k not in _VARYING_KEYS} if isinstance(value, dict) else value


def _compare_values(a: Any, b: Any) -> Outcome:
    largest = 0.0
    for place, x, y in _pairs(_without_varying(a), _without_varying(b), ""):
        gap = _number_gap(x, y)
        if gap > TOLERANCE:
            return Outcome(DIFFERENT, f"{place.lstrip('.')}: {shown(x)}, in the crate {shown(y)}")
        largest = max(largest, gap)
    if largest == 0:
        return Outcome(EQUAL, "but for dates, run times and versions")
    return Outcome(CLOSE, f"numbers differ by up to {largest:.2g}")


def _pairs(a: Any, b: Any, place: str) -> Iterator[tuple[str, Any, Any]]:
    if isinstance(a, dict) and isinstance(b, dict) and a.keys() == b.keys():
        for key in a:
            yield from _pairs(a[key], b[key], f"{place}.{key}")
    elif isinstance(a, list) and isinstance(b, list) and len(a) == len(b):
        for index, (x, y) in enumerate(zip(a, b, strict=True)):
            yield from _pairs(x, y, f"{place}[{index}]")
    else:
        yield place, a, b


def _number_gap(x: Any, y: Any) -> float:
    """Return the difference of two values as a share of the larger; infinite for all that is no pair of numbers."""
    if isinstance(x, bool) != isinstance(y, bool):
        return math.inf
    if x == y:
        return 0.0
    if isinstance(x, bool) or not isinstance(x, (int, float)) or not isinstance(y, (int, float)):
        return math.inf
    try:
        gap = abs(x - y) / max(abs(x), abs(y))
    except OverflowError:  # a whole number beyond double precision
        return math.inf
    # Against infinity, as 1e999 is read, the share is NaN, which no tolerance holds.
    return gap if math.isfinite(gap) else math.inf


class _Plain(HTMLParser):
    """Collects a page but for elements marked `data-varies`."""

    def __init__(self) -> None:
        super().__init__(convert_charrefs=False)
        self.kept: list[str] = []
        self._depth = 0

    def _keep(self, text: str) -> None:
        if not self._depth:
            self.kept.append(text)

    def handle_starttag(self, tag: str, attrs: list) -> None:
        kind = dict(attrs).get("data-varies")
        if self._depth or kind is not None:
            # The element itself counts, and what may not stand in one; its words and numbers do not.
            if kind is not None or tag not in _PLAIN_TAGS:
                self.kept.append(f"<{tag} data-varies={kind!r}>")
            self._depth += tag not in _VOID
        else:
            self._keep(self.get_starttag_text() or "")

    def handle_startendtag(self, tag: str, attrs: list) -> None:
        if tag not in _PLAIN_TAGS or not self._depth:
            self.kept.append(self.get_starttag_text() or "")

    def handle_endtag(self, tag: str) -> None:
        if self._depth:
            self._depth -= 1
        else:
            self._keep(f"</{tag}>")

    def handle_data(self, data: str) -> None:
        self._keep(data)

    def handle_entityref(self, name: str) -> None:
        self._keep(f"&{name};")

    def handle_charref(self, name: str) -> None:
        self._keep(f"&#{name};")


def _text(path: Path) -> str:
    text = path.read_text(encoding="utf-8")
    if path.suffix == ".svg":
        return unsealed(text, path)
    if path.suffix != ".html":
        return text
    page = _Plain()
    page.feed(text)
    page.close()
    return "".join(page.kept)


def _outline(path: Path) -> tuple[list[int], int, list[str]]:
    """Return what two pages that differ in varying elements alone have in common, found in linear time."""
    text = path.read_text(encoding="utf-8")
    elements = re.findall("<[^>]*", text)
    within = text.count("<") - len(elements)
    long = [_NUMBER.sub("#", element) for element in elements if len(element) > _LONG]
    return [text.lower().count(opener) for opener in _OPENERS], within, long


def _compare_text(a: str, b: str) -> Outcome:
    if a == b:
        return Outcome(EQUAL, "but for dates, run times and versions")
    if _NUMBER.sub("#", a) != _NUMBER.sub("#", b):
        line = next((i for i, (x, y) in enumerate(zip(a.splitlines(), b.splitlines(), strict=False), 1) if x != y), 0)
        return Outcome(DIFFERENT, f"text differs at line {line}" if line else "one text is longer")
    gaps = [
        _number_gap(float(x), float(y)) for x, y in zip(_NUMBER.findall(a), _NUMBER.findall(b), strict=True) if x != y
    ]
    worst = max(gaps, default=0.0)
    if worst > TOLERANCE:
        return Outcome(DIFFERENT, f"{sum(g > TOLERANCE for g in gaps)} numbers differ, by up to {worst:.2g}")
    return Outcome(CLOSE, f"numbers differ by up to {worst:.2g}")
