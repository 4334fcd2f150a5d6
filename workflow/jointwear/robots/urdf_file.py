"""Read and check a URDF: numbers, inertia, joints and their tree, before Pinocchio builds the model.

Pinocchio leaves out a link's inertia that it cannot read and takes any that it can; so everything that decides about
torques is checked here. Without numpy: the Snakefile reads robots at every call.
"""

from __future__ import annotations

import math
import re
import xml.etree.ElementTree as ElementTree
from functools import lru_cache
from pathlib import Path
from typing import Any

from jointwear.files.errors import InputError, shown
from jointwear.files.numbers import LARGEST
from jointwear.files.regular_files import check_regular
from jointwear.robots.rigid_body import fault_of_inertia
from jointwear.robots.urdf_tree import Joint, chain_of, name_of, read_joints, welded

#: Largest URDF; that of a humanoid with 80 joints has a hundredth of it. Bytes.
LARGEST_URDF = 16 << 20
#: Deepest nesting of elements; URDF itself has five levels, extensions for simulators a few more.
DEEPEST = 50
#: Most links, and most attributes of an element: the parser behind Pinocchio calls itself at each link behind another,
#: and compares each attribute with all others. A humanoid has a hundred links, an element six attributes.
MOST_LINKS, MOST_ATTRIBUTES = 1000, 100
#: Most moving joints, as many as a configuration can name axes; Pinocchio's memory grows with their cube.
MOST_JOINTS = 64
#: Encodings in which a digit is the byte that the parser behind Pinocchio takes it for, whatever the file declares.
ENCODINGS = ("utf-8", "us-ascii", "ascii", "iso-8859-1", "iso-8859-15", "windows-1252")
_DECLARED = re.compile(rb"""<\?xml[^>]*?encoding\s*=\s*["']([^"']*)""")
#: Size of the largest number of an axis, which URDF wants normalised: beyond, its length is lost in rounding.
AXIS_SIZES = (1e-6, 1e6)
#: Parts that a joint and an inertial have once at most: of two, one reader takes the first, another the last.
_ONCE = ("origin", "axis", "parent", "child", "limit", "dynamics", "mimic", "mass", "inertia")
#: White space of XML; more counts as such in Python.
_BLANKS = " \t\r\n"
#: Number as XML Schema has it (xs:double) without its NaN and INF, which is what URDF readers take.
_NUMBER = re.compile(r"[-+]?(\d+\.?\d*|\.\d+)([eE][-+]?\d+)?", re.ASCII)
#: Attributes that hold numbers, by element, each with how many.
_NUMBERS = {
    "origin": {"xyz": 3, "rpy": 3},
    "mass": {"value": 1},
    "inertia": dict.fromkeys(("ixx", "iyy", "izz", "ixy", "iyz", "ixz"), 1),
    "axis": {"xyz": 3},
    "limit": dict.fromkeys(("lower", "upper", "effort", "velocity"), 1),
    "dynamics": dict.fromkeys(("damping", "friction"), 1),
}
#: Largest size of them, as in the schema of the robot file; an effort or a limit may stand for "none".
_LARGEST = {"origin": 100.0, "mass": 1e5, "inertia": 1e7, "dynamics": 1e7}
#: Largest angle [rad] of an origin: one turn, with room for its rounding. Beyond, it is in degrees.
FULL_TURN = 2 * math.pi + 0.01
#: Largest distance [m] of a centre of mass from the frame of its link, as for a link by DH table
#: (`robot_file.FARTHEST_MASS`), and multiple of the summed lengths of the joints up to which a larger arm has one.
FARTHEST_MASS, TIMES_REACH = 20.0, 3.0
_INERTIA = ("ixx", "iyy", "izz", "ixy", "iyz", "ixz")


class _Builder(ElementTree.TreeBuilder):
    """Builds a tree of limited depth; a document type, which may define entities, is refused."""

    def __init__(self) -> None:
        super().__init__()
        self._depth = 0

    def doctype(self, name: str, pubid: str | None, system: str | None) -> None:
        raise InputError("holds a document type (<!DOCTYPE>), which a URDF has no use for; remove it")

    def start(self, tag: str, attrs: dict[str, str]) -> ElementTree.Element:
        self._depth += 1
        if self._depth > DEEPEST:
            raise InputError(f"is nested more than {DEEPEST} levels deep")
        if len(attrs) > MOST_ATTRIBUTES:
            raise InputError(f"has {len(attrs)} attributes in <{tag}> (allowed: at most {MOST_ATTRIBUTES})")
        return super().start(tag, attrs)

    def end(self, tag: str) -> ElementTree.Element:
        self._depth -= 1
        return super().end(tag)


def read_urdf_joints(path: Path, check_inertia: bool = True) -> list[dict[str, Any]]:
    """Return one entry for every moving joint of a serial arm, from the base on, in the layout of a robot file.

    Parameters
    ----------
    path : the URDF.
    check_inertia : whether to refuse inertia that no rigid body has.

    Raises
    ------
    InputError : one line naming the file, the link or joint, what is wrong and what is allowed.
    """
    root = _parse(path)
    _check_numbers(path, root)
    links = _links(path, root)
    for name, element in links.items():
        _check_mass(path, name, element)
    joints = read_joints(path, root, links)
    chain = chain_of(path, links, joints)
    _check_centres(path, links, chain)
    if len(chain) > MOST_JOINTS:
        raise InputError(f"{path}: has {len(chain)} moving joints (allowed: at most {MOST_JOINTS})")
    if check_inertia:
        # What does not move has no part in the torques.
        still = welded(chain[0].parent, joints)
        moving = {name: element for name, element in links.items() if name not in still}
        for name, element in moving.items():
            _check_inertia(path, name, element)
        if not any(e.find("inertial") is not None and _mass(e) for e in moving.values()):
            raise InputError(
                f"{path}: no link that moves has a mass, so that no torque follows from it; add <inertial>, or let the "
                "robot file say 'inertia_check: none'"
            )
    return [_entry(path, joint) for joint in chain]


def moving_mass(path: Path) -> float:
    """Return the mass [kg] of all links of a checked URDF that move, to hold the model built from it to.

    Raises
    ------
    InputError : if it cannot be read any more.
    """
    # A log may build dozens of models, each of which asks.
    return _moving_mass(path, _read(path))


@lru_cache(maxsize=16)
def _moving_mass(path: Path, data: bytes) -> float:
    """Return :func:`moving_mass` of a file that holds `data`."""
    root = _parsed(path, data)
    links = _links(path, root)
    joints = read_joints(path, root, links)
    still = welded(chain_of(path, links, joints)[0].parent, joints)
    return sum(_mass(e) for name, e in links.items() if name not in still and e.find("inertial") is not None)


def text_of(path: Path) -> str:
    """Return the text of a checked URDF, for a library that would not find its path.

    Pinocchio takes a path as UTF-8, whatever the locale names files in.
    """
    data = path.read_bytes()
    return data.decode(_declared(data) or "utf-8")


def _declared(data: bytes) -> str:
    """Return the encoding that the text of an XML file declares, empty where it declares none."""
    found = _DECLARED.match(data.lstrip())
    return found[1].decode("ascii", "replace") if found else ""


def _parse(path: Path) -> ElementTree.Element:
    return _parsed(path, _read(path))


def _read(path: Path) -> bytes:
    check_regular(path, LARGEST_URDF)
    try:
        return path.read_bytes()
    except OSError as error:
        raise InputError(f"{path}: cannot be read ({error.strerror})") from None


def _parsed(path: Path, data: bytes) -> ElementTree.Element:
    try:
        declared = _declared(data)
        if declared and declared.lower() not in ENCODINGS:
            raise InputError(f"declares the encoding {shown(declared)} (allowed: {', '.join(ENCODINGS)})")
        root = ElementTree.fromstring(data, ElementTree.XMLParser(target=_Builder()))
    except ElementTree.ParseError as error:
        raise InputError(f"{path}: is not valid XML ({error})") from None
    except InputError as error:
        raise InputError(f"{path}: {error}") from None
    except (ValueError, LookupError) as error:
        # An encoding that is not known, or not that of the text.
        raise InputError(f"{path}: is not valid XML ({error})") from None
    if root.tag != "robot":
        raise InputError(f"{path}: its top element is <{root.tag}>, must be <robot>")
    return root


def _number(path: Path, where: str, text: str, largest: float, may_trail: bool = True) -> None:
    if not _NUMBER.fullmatch(text.strip(_BLANKS) if may_trail else text.lstrip(_BLANKS)):
        raise InputError(f"{path}: {where} is {shown(text)}, must be a finite number with a decimal point and no unit")
    if abs(float(text)) > largest:
        raise InputError(f"{path}: {where} is {shown(text)}, out of range (allowed: at most {largest:g} in size)")


def _check_numbers(path: Path, root: ElementTree.Element) -> None:
    """Check every number that decides about torques: those of links and joints, not of shapes or extensions."""
    for owner in root:
        if owner.tag not in ("link", "joint"):
            continue
        inertial = [inner for part in owner.findall("inertial") for inner in part]
        parts = [*owner, *inertial]
        once = [part.tag for part in (inertial if owner.tag == "link" else owner) if part.tag in _ONCE]
        twice = next((tag for tag in once if once.count(tag) > 1), None)
        if twice and len(owner.findall("inertial")) < 2:
            name = owner.get("name")
            raise InputError(f"{path}: {owner.tag} '{name}' has {once.count(twice)} <{twice}>, must have one")
        for element in parts:
            for key, count in _NUMBERS.get(element.tag, {}).items():
                text = element.get(key)
                if text is None:
                    continue
                where = f"{owner.tag} '{owner.get('name')}': '{key}' of <{element.tag}>"
                words = text.split() if count > 1 else [text]
                if len(words) != count:
                    raise InputError(f"{path}: {where} is {shown(text)}, must hold {count} numbers")
                for word in words:
                    # Pinocchio leaves out an inertia of which a number has a blank behind it.
                    trailing = element.tag not in ("mass", "inertia")
                    _number(path, where, word, _LARGEST.get(element.tag, LARGEST), trailing)
                if key == "rpy" and max(abs(float(word)) for word in words) > FULL_TURN:
                    radians = " ".join(f"{math.radians(float(word)):.6g}" for word in words)
                    raise InputError(
                        f"{path}: {where} is {shown(text)}, in rad; this looks like degrees: '{radians}' (allowed: "
                        "up to 2 pi in size)"
                    )


def _links(path: Path, root: ElementTree.Element) -> dict[str, ElementTree.Element]:
    found: dict[str, ElementTree.Element] = {}
    for element in root.findall("link"):
        name = name_of(path, element)
        if name in found:
            raise InputError(f"{path}: two links have the name '{name}'")
        found[name] = element
    if not found:
        raise InputError(f"{path}: has no links")
    if len(found) > MOST_LINKS:
        raise InputError(f"{path}: has {len(found)} links (allowed: at most {MOST_LINKS})")
    return found


def _check_mass(path: Path, name: str, link: ElementTree.Element) -> None:
    """Check that the inertial part of a link is complete and its mass no less than nothing."""
    found = link.findall("inertial")
    if not found:
        return
    if len(found) > 1:
        raise InputError(f"{path}: link '{name}' has {len(found)} <inertial>, must have one at most")
    for tag, keys in (("mass", ("value",)), ("inertia", _INERTIA)):
        elements = found[0].findall(tag)
        if len(elements) != 1:
            raise InputError(f"{path}: link '{name}': <inertial> has {len(elements)} <{tag}>, must have one")
        missing = [key for key in keys if elements[0].get(key) is None]
        if missing:
            raise InputError(f"{path}: link '{name}': <{tag}> has no '{missing[0]}'")
    kilograms = _mass(link)
    if kilograms < 0:
        raise InputError(f"{path}: link '{name}' has a mass of {kilograms:g} kg (allowed: >= 0)")


def _check_centres(path: Path, links: dict[str, ElementTree.Element], chain: list[Joint]) -> None:
    """Check that no centre of mass lies farther from the frame of its link than an arm of such joints can have it."""
    reach = sum(_distance(joint.element) for joint in chain)
    farthest = max(TIMES_REACH * reach, FARTHEST_MASS)
    for name, link in links.items():
        inertial = link.find("inertial")
        distance = 0.0 if inertial is None else _distance(inertial)
        if distance > farthest:
            raise InputError(
                f"{path}: link '{name}': 'xyz' of <origin> of <inertial> lies {distance:.3g} m from the frame of the "
                f"link, farther than an arm of {reach:.3g} m can have it; this looks like mm (allowed: up to "
                f"{farthest:.3g} m)"
            )


def _distance(element: ElementTree.Element) -> float:
    """Return the length [m] of the origin of a joint or an inertial, 0 where it has none."""
    origin = element.find("origin")
    return 0.0 if origin is None else math.hypot(*(float(x) for x in origin.get("xyz", "0 0 0").split()))


def _mass(link: ElementTree.Element) -> float:
    return float(link.find("inertial/mass").get("value"))


def _check_inertia(path: Path, name: str, link: ElementTree.Element) -> None:
    found = link.find("inertial/inertia")
    if found is None:
        return
    six = [float(found.get(key)) for key in _INERTIA]
    fault = "there is no mass" if _mass(link) == 0 and any(six) else fault_of_inertia(six)
    if fault:
        raise InputError(
            f"{path}: link '{name}' has an inertia that no body has: {fault}; correct it, or let the robot file say "
            "'inertia_check: none' if the numbers are known to give the right torques"
        )


def _entry(path: Path, joint: Joint) -> dict[str, Any]:
    element = joint.element
    entry: dict[str, Any] = {"name": joint.name}
    axis = element.find("axis")
    if axis is not None:
        size = max(abs(float(x)) for x in axis.get("xyz", "1 0 0").split())
        if size == 0:
            raise InputError(f"{path}: joint '{joint.name}' has the axis 0 0 0; one number must differ from 0")
        if not AXIS_SIZES[0] <= size <= AXIS_SIZES[1]:
            raise InputError(
                f"{path}: joint '{joint.name}' has the axis {axis.get('xyz')}; its largest number must be "
                f"{AXIS_SIZES[0]:g} to {AXIS_SIZES[1]:g} in size, nearest 1"
            )
    limit, dynamics = element.find("limit"), element.find("dynamics")
    missing = [key for key in ("effort", "velocity") if limit is not None and limit.get(key) is None]
    if missing:
        raise InputError(f"{path}: joint '{joint.name}': <limit> has no '{missing[0]}', which URDF asks for")
    values = {key: float(limit.get(key, 0)) for key in _NUMBERS["limit"]} if limit is not None else {}
    if joint.kind == "continuous":
        entry["limits"] = [-2 * math.pi, 2 * math.pi]
    elif values:
        entry["limits"] = [values["lower"], values["upper"]]
    for key, what, unit in (("effort", "an effort", "N m"), ("velocity", "a velocity", "rad/s")):
        if values.get(key, 0) < 0:
            raise InputError(f"{path}: joint '{joint.name}' has {what} of {values[key]:g} {unit} (allowed: >= 0)")
    if values.get("effort", 0) > 0:
        entry["torque_limit"] = values["effort"]
    if dynamics is not None:
        told = {key: float(dynamics.get(key, 0)) for key in _NUMBERS["dynamics"]}
        for key, value in told.items():
            if value < 0:
                raise InputError(f"{path}: joint '{joint.name}' has a {key} of {value:g} (allowed: >= 0)")
        entry["viscous"] = told["damping"]
        entry["coulomb"] = {"positive": told["friction"], "negative": -told["friction"]}
    return entry
