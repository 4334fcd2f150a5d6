"""What the URDFs of published arms have in common: meshes go, which the dynamics never look at."""

from __future__ import annotations

import xml.etree.ElementTree as ElementTree
from pathlib import Path


def without_meshes(source: Path, target: Path) -> None:
    """Copy a URDF without its visual and collision elements; a joint named like a link gets the ending ``_joint``."""
    tree = ElementTree.parse(source)
    root = tree.getroot()
    links = {link.get("name") for link in root.iter("link")}
    for link in root.iter("link"):
        for part in [*link.findall("visual"), *link.findall("collision")]:
            link.remove(part)
    for joint in root.findall("joint"):
        if joint.get("name") in links:
            joint.set("name", f"{joint.get('name')}_joint")
    tree.write(target, encoding="utf-8", xml_declaration=True)
