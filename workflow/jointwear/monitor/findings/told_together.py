"""What was found, for people: what is alike in one sentence."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import Any

from jointwear.files.wording import count, listed, name_axes
from jointwear.monitor.findings.findings import FELL, PROGRAM, fell_words
from jointwear.monitor.findings.read_findings import DRIVES, drives_words
from jointwear.monitor.findings.seen_growth import COARSE
from jointwear.monitor.normal.products import log_words

#: What findings on products have in common.
PRODUCTS = "products"
#: A finding as it is stored.
Finding = Mapping[str, Any]


def told_together(findings: Sequence[Finding]) -> list[dict[str, Any]]:
    """Return findings for a page, what is alike in one sentence where the first of it stands.

    Alike are axes whose limit cannot be seen, axes whose friction fell or was none at one time, and programs that the
    motion shows, or products that the torque shows, and the baseline did not have, which are told with the time of the
    newest.
    """
    groups: dict[tuple, list[Finding]] = {}
    for k, found in enumerate(findings):
        groups.setdefault(_alike(found) or (k,), []).append(found)
    return [dict(g[0]) if len(g) == 1 else {**g[0], **_TOGETHER[key[0]](g)} for key, g in groups.items()]


def before_words(count: int) -> str:
    """Return in words that what was found has been so `count` times before; empty for none."""
    if not count:
        return ""
    return " It was so once before." if count == 1 else f" It was so {count} times before."


def _alike(found: Finding) -> tuple:
    """Return what findings that are told together have in common, empty where a finding stands alone."""
    kind = found["kind"]
    if kind == COARSE:
        return (kind,)
    # One that came back to normal is another story, and so is a program that has a name.
    if kind == FELL and found.get("fell"):
        return kind, found["time"], bool(found.get("answered")), bool(found.get("doubtful"))
    if kind == DRIVES:
        return kind, found["time"], found.get("end")
    if kind == PROGRAM and "ran" in found:
        return (kind,)
    if kind == PROGRAM and "moved" in found:
        return (PRODUCTS,)
    return ()


def _coarse(found: Sequence[Finding]) -> dict[str, Any]:
    axes, least = _axes(found), sorted(f["least"] for f in found)
    words = (
        f"Of {name_axes(axes)} only changes above {_percents(least)} can be seen, more than their limits: their "
        "friction differs too much from shift to shift, or is too small against the noise. That there is no alarm says "
        "nothing of smaller changes."
    )
    return {"axes": axes, "least": least[0], "words": words}


def _fell(found: Sequence[Finding]) -> dict[str, Any]:
    axes = _axes(found)
    return {"axes": axes, "words": fell_words(axes, doubtful=bool(found[0].get("doubtful")))}


def _drive(found: Sequence[Finding]) -> dict[str, Any]:
    axes = _axes(found)
    return {"axes": axes, "words": drives_words(axes)}


def _programs(found: Sequence[Finding]) -> dict[str, Any]:
    blind = sum(f["judged_after"] is None for f in found)
    ran = sum(f["ran"] for f in found)
    judged = f"; in {blind} of them most axes could not be judged so far" if blind else ""
    words = (
        f"The motion shows {len(found)} programs that the baseline did not have, {ran:.3g} h in all{judged}. What they "
        "change is learnt from their differences to other programs of the same shift, never from the level of a shift. "
        "If nothing new was started, a window holds less than a whole cycle: log whole cycles, or name the programs "
        "under 'program'."
    )
    return {"time": max(f["time"] for f in found), "words": words}


def _products(found: Sequence[Finding]) -> dict[str, Any]:
    blind = sum(not f["judged"] for f in found)
    moved = "; ".join(sorted({name_axes(f["moved"]) for f in found}))
    judged = f"; with {blind} of them most axes cannot be judged yet" if blind else ""
    times = [f["time"] for f in found]
    days = round((max(times) - min(times)) / 86400)
    # The date beside it is that of the newest.
    apart = f", the first {count(days, 'day')} before the last" if days else ""
    words = (
        f"The torque changed at once {len(found)} times, as with parts that their programs did not have before and "
        f"that no load of the robot file stands for ({moved}){apart}: the normal of each is learnt from its first "
        f"shifts{judged}."
    )
    if logs := list(dict.fromkeys(name for f in found for name in f.get("logs", ()))):
        words += f" {log_words(logs)}" if all(f.get("logs") for f in found) else f" Look at {listed(logs)} first."
    return {"time": max(f["time"] for f in found), "words": words}


_TOGETHER: dict[str, Callable[[Sequence[Finding]], dict[str, Any]]] = {
    COARSE: _coarse, FELL: _fell, DRIVES: _drive, PROGRAM: _programs, PRODUCTS: _products,
}  # fmt: skip


def _axes(found: Sequence[Finding]) -> list[int]:
    return sorted(axis for f in found for axis in f["axes"])


def _percents(shares: Sequence[float]) -> str:
    """Return the span of sorted shares in percent, one number where they round to the same."""
    low, high = (f"{100 * share:.0f}" for share in (shares[0], shares[-1]))
    return f"{low} %" if low == high else f"{low} to {high} %"
