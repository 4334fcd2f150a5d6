"""A URDF with other inertial parameters of its links."""

from __future__ import annotations

import xml.etree.ElementTree as ElementTree

import numpy as np

from jointwear.robots.inertia import links_from_parameters
from jointwear.robots.robot import Robot


def urdf_with_links(robot: Robot, change: np.ndarray) -> str:
    """Return the text of the URDF of `robot` with the inertial parameters changed by `change` (10 n,).

    The child link of every moving joint carries all that moves with it; bodies that are welded to it, at any depth,
    are part of its parameters and carry nothing themselves.
    """
    root = ElementTree.parse(robot.urdf).getroot()
    child_of = {e.get("name"): e.find("child").get("link") for e in root.findall("joint")}
    links = {e.get("name"): e for e in root.findall("link")}
    welded: dict[str, list[str]] = {}
    for joint in root.findall("joint"):
        if joint.get("name") not in robot.joint_names:
            welded.setdefault(joint.find("parent").get("link"), []).append(joint.find("child").get("link"))
    for name, body in zip(robot.joint_names, links_from_parameters(robot, change), strict=True):
        waiting = [child_of[name]]
        while waiting:
            link = waiting.pop()
            for old in links[link].findall("inertial"):
                links[link].remove(old)
            waiting += welded.get(link, [])
        _write_inertial(links[child_of[name]], body)
    return ElementTree.tostring(root, encoding="unicode", xml_declaration=True)


def _write_inertial(link: ElementTree.Element, body: dict) -> None:
    """Give a link its mass, centre of mass and inertia, to the last digit."""
    xx, yy, zz, xy, yz, xz = body["inertia"]
    inertial = ElementTree.SubElement(link, "inertial")
    ElementTree.SubElement(inertial, "origin", xyz=" ".join(repr(float(x)) for x in body["com"]), rpy="0 0 0")
    ElementTree.SubElement(inertial, "mass", value=repr(float(body["mass"])))
    values = {"ixx": xx, "iyy": yy, "izz": zz, "ixy": xy, "iyz": yz, "ixz": xz}
    ElementTree.SubElement(inertial, "inertia", {k: repr(float(x)) for k, x in values.items()})
