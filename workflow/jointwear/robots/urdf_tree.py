"""Joints of a URDF as a chain from the base to the tip: only serial arms with a drive in each are known."""

from __future__ import annotations

import xml.etree.ElementTree as ElementTree
from collections.abc import Container, Iterable, Iterator
from dataclasses import dataclass
from pathlib import Path

from jointwear.files.errors import InputError, shown

MOVING = ("revolute", "continuous")


@dataclass(frozen=True)
class Joint:
    """A joint: name, type, the links that it ties together, and its element."""

    name: str
    kind: str
    parent: str
    child: str
    element: ElementTree.Element


def name_of(path: Path, element: ElementTree.Element) -> str:
    """Return the name of a link or joint.

    Raises
    ------
    InputError : if it has none.
    """
    name = element.get("name")
    if not name or not name.strip():
        raise InputError(f"{path}: a <{element.tag}> has no name")
    return name


def welded(link: str, joints: Iterable[Joint]) -> set[str]:
    """Return the links that are one body with `link`: those that fixed joints tie to it, in either direction."""
    tied: dict[str, list[str]] = {}
    for joint in joints:
        if joint.kind == "fixed":
            tied.setdefault(joint.parent, []).append(joint.child)
            tied.setdefault(joint.child, []).append(joint.parent)
    found, waiting = {link}, [link]
    while waiting:
        fresh = set(tied.get(waiting.pop(), [])) - found
        found |= fresh
        waiting.extend(fresh)
    return found


def read_joints(path: Path, root: ElementTree.Element, links: Container[str]) -> list[Joint]:
    """Return the joints of a URDF.

    Raises
    ------
    InputError : if two have one name, or one does not tie two of the links.
    """
    found: dict[str, Joint] = {}
    for element in root.findall("joint"):
        name = name_of(path, element)
        if name in found:
            raise InputError(f"{path}: two joints have the name '{name}'")
        ends = {}
        for role in ("parent", "child"):
            end = element.find(role)
            if end is None or not end.get("link"):
                raise InputError(f"{path}: joint '{name}' has no {role}: <{role} link=...> is missing")
            ends[role] = end.get("link")
            if ends[role] not in links:
                raise InputError(f"{path}: joint '{name}' names the {role} '{ends[role]}', which is no link")
        found[name] = Joint(name, element.get("type") or "", ends["parent"], ends["child"], element)
    return list(found.values())


def chain_of(path: Path, links: Iterable[str], joints: list[Joint]) -> list[Joint]:
    """Return the moving joints from the base to the tip.

    Raises
    ------
    InputError : if a link does not hang on the base by one path.
    """
    by_child: dict[str, Joint] = {}
    for joint in joints:
        other = by_child.setdefault(joint.child, joint)
        if other is not joint:
            raise InputError(
                f"{path}: link '{joint.child}' hangs on two joints, '{other.name}' and '{joint.name}'; remove one: "
                "only serial arms without closed loops are known"
            )
    bases = [name for name in links if name not in by_child]
    if len(bases) != 1:
        told = ", ".join(f"'{name}'" for name in bases[:5]) or "none: the joints run in a circle"
        raise InputError(f"{path}: must have one base link, found {len(bases)} ({told})")
    by_parent: dict[str, list[Joint]] = {}
    for joint in joints:
        by_parent.setdefault(joint.parent, []).append(joint)
    reached = {bases[0]}
    waiting = [bases[0]]
    while waiting:
        for joint in by_parent.get(waiting.pop(), []):
            reached.add(joint.child)
            waiting.append(joint.child)
    beside = next((joint for joint in joints if joint.child not in reached), None)
    if beside is not None:
        raise InputError(
            f"{path}: joint '{beside.name}' is not reached from the base '{bases[0]}': the joints behind it run in a "
            f"circle; correct the parent of one of them"
        )
    chain = list(_moving(path, bases[0], by_parent))
    if not chain:
        raise InputError(f"{path}: has no moving joint (allowed: {', '.join(MOVING)})")
    return chain


def _moving(path: Path, base: str, by_parent: dict[str, list[Joint]]) -> Iterator[Joint]:
    """Yield the moving joints in order; bodies that are welded together count as one."""
    link = base
    while True:
        welded, here = [link], []
        for name in welded:
            for joint in by_parent.get(name, []):
                if joint.kind == "fixed":
                    welded.append(joint.child)
                else:
                    here.append(joint)
        _check_kinds(path, here)
        if len(here) > 1:
            raise InputError(_branch(path, link, here, by_parent))
        if not here:
            return
        yield here[0]
        link = here[0].child


def _check_kinds(path: Path, here: list[Joint]) -> None:
    """Check the moving joints that one body carries; all that are not known are named at once."""
    strange = [joint for joint in here if joint.kind not in MOVING]
    if strange:
        told = ", ".join(f"'{joint.name}' ({shown(joint.kind)[1:-1] or 'of no type'})" for joint in strange[:5])
        raise InputError(f"{path}: joint {told}; only {' and '.join(MOVING)} joints are known; make others fixed")
    for joint in here:
        _check_drive(path, joint)


def _check_drive(path: Path, joint: Joint) -> None:
    mimic = joint.element.find("mimic")
    if mimic is not None:
        raise InputError(
            f"{path}: joint '{joint.name}' follows joint '{mimic.get('joint')}' (<mimic>); only joints with a drive "
            "of their own are known: make it fixed"
        )


def _branch(path: Path, link: str, here: list[Joint], by_parent: dict[str, list[Joint]]) -> str:
    """Return the message for a link that carries several moving joints: the longest branch is taken for the arm."""

    def behind(joint: Joint) -> int:
        count, waiting = 0, [joint.child]
        while waiting:
            for inner in by_parent.get(waiting.pop(), []):
                count += inner.kind != "fixed"
                waiting.append(inner.child)
        return count

    arm = max(here, key=behind)
    others = ", ".join(f"'{joint.name}'" for joint in here if joint is not arm)
    return (
        f"{path}: link '{link}' branches into the joints {', '.join(repr(j.name) for j in here)}; only serial arms are "
        f"known: make {others} fixed to keep the branch of '{arm.name}'"
    )
