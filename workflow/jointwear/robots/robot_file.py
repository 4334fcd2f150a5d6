"""Read and check a robot file without building the robot.

Kept apart from :mod:`jointwear.robots.robot` because the Snakefile checks robot files at every call and must not
pay for numpy.
"""

from __future__ import annotations

import math
import xml.etree.ElementTree as ElementTree
from pathlib import Path
from typing import Any

from jointwear.files.documents import check, normalise_numbers, read_schema, read_yaml
from jointwear.files.errors import InputError, nearest
from jointwear.files.registered import path_in, will_be_fetched

_DEFAULTS: dict[str, Any] = {
    "gear_ratio": 1.0,
    "motor_inertia": 0.0,
    "viscous": 0.0,
    "coulomb": {"positive": 0.0, "negative": 0.0},
    "torque_limit": None,
}


def read_robot_file(path: str | Path) -> dict[str, Any]:
    """Read a robot file, fill defaults (and, with a URDF, names and limits) and check it.

    Returns
    -------
    dict : the layout of config/README.md with `gravity` and a complete `joints` list.

    Raises
    ------
    InputError : one line naming the file, the key, what is allowed and the nearest valid value.
    """
    path = Path(path)
    data = read_yaml(path)
    schema = read_schema("robot")
    check(data, schema, path)
    data = normalise_numbers(data, schema)
    data.setdefault("gravity", [0.0, 0.0, -9.81])
    if ("dh" in data) == ("urdf" in data):
        raise InputError(f"{path}: give the kinematics either as 'dh' (with 'links') or as 'urdf'")
    bodies = {f"links[{i}]": body for i, body in enumerate(data.get("links", []))}
    for where, body in {**bodies, "payload": data.get("payload", {})}.items():
        if not _is_inertia(body.get("inertia", [0.0] * 6)):
            raise InputError(
                f"{path}: '{where}.inertia' is {body['inertia']}, which no body has: as a matrix it must not have "
                "negative principal moments (order: xx yy zz xy yz xz)"
            )
    if "urdf" in data:
        if "links" in data:
            raise InputError(f"{path}: 'links' is only for robots given by 'dh'; a URDF brings its own")
        data["joints"] = _joints_of_urdf(path, data)
    else:
        count = len(data["dh"])
        for key in ("links", "joints"):
            if key not in data:
                raise InputError(f"{path}: '{key}' is missing; a robot given by 'dh' needs one entry for each row")
            if len(data[key]) != count:
                raise InputError(f"{path}: '{key}' has {len(data[key])} entries, 'dh' has {count}")
    data["joints"] = [_complete(path, i, joint) for i, joint in enumerate(data["joints"])]
    names = [j["name"] for j in data["joints"]]
    for i, name in enumerate(names):
        if name in names[:i]:
            raise InputError(f"{path}: 'joints[{i}].name' is '{name}', which an earlier joint has")
    for i, entry in enumerate(data.get("effects", [])):
        for key in ("axis", "source_axis"):
            if entry.get(key) is not None and entry[key] > len(names):
                raise InputError(
                    f"{path}: 'effects[{i}].{key}' is {entry[key]}; the robot has {len(names)} axes "
                    f"(allowed: 1 to {len(names)}); the nearest valid value is {len(names)}"
                )
    return data


def _is_inertia(six: list[float]) -> bool:
    """Whether (xx, yy, zz, xy, yz, xz) has no negative principal moment: all principal minors are >= 0."""
    xx, yy, zz, xy, yz, xz = six
    size = max(map(abs, six))
    pairs = (xx * yy - xy * xy, yy * zz - yz * yz, xx * zz - xz * xz)
    determinant = xx * (yy * zz - yz * yz) - xy * (xy * zz - yz * xz) + xz * (xy * yz - yy * xz)
    return min(xx, yy, zz) >= -1e-9 * size and min(pairs) >= -1e-9 * size**2 and determinant >= -1e-9 * size**3


def _complete(path: Path, index: int, joint: dict[str, Any]) -> dict[str, Any]:
    where = f"joints[{index}]"
    joint = {**_DEFAULTS, **joint}
    if "limits" not in joint:
        raise InputError(f"{path}: '{where}.limits' is missing")
    lower, upper = joint["limits"]
    if not lower < upper:
        raise InputError(f"{path}: '{where}.limits' is [{lower}, {upper}]; the lower limit must come first")
    if max(abs(lower), abs(upper)) > 100:
        raise InputError(f"{path}: '{where}.limits' is [{lower}, {upper}], in rad; this looks like degrees")
    if joint["gear_ratio"] == 0:
        raise InputError(f"{path}: '{where}.gear_ratio' is 0; a joint known on the joint side has gear_ratio 1")
    for value in (joint["gear_ratio"], joint["motor_inertia"], joint["viscous"], *joint["coulomb"].values()):
        if not math.isfinite(value):
            raise InputError(f"{path}: '{where}' holds {value}; every number must be finite")
    return joint


def _joints_of_urdf(path: Path, data: dict[str, Any]) -> list[dict[str, Any]]:
    """Return one joint entry for each moving joint of the URDF, overridden by those of the robot file."""
    urdf = path_in(data["urdf"], path.parent)
    try:
        root = ElementTree.parse(urdf).getroot()
    except OSError:
        hint = "; `snakemake fetch_data` loads it" if will_be_fetched(urdf) else ""
        raise InputError(f"{path}: 'urdf' names {data['urdf']}, which does not exist{hint}") from None
    except ElementTree.ParseError as error:
        raise InputError(f"{urdf}: is not valid XML ({error})") from None
    found: dict[str, dict[str, Any]] = {}
    by_parent: dict[str, list[ElementTree.Element]] = {}
    for element in root.findall("joint"):
        by_parent.setdefault(element.find("parent").get("link"), []).append(element)
    children = {e.find("child").get("link") for elements in by_parent.values() for e in elements}
    chain = [link.get("name") for link in root.findall("link") if link.get("name") not in children]
    if len(chain) != 1:
        raise InputError(f"{urdf}: must have one base link, found {len(chain)}")
    while chain:
        elements = by_parent.get(chain.pop(), [])
        moving = [e for e in elements if e.get("type") != "fixed"]
        if len(moving) > 1:
            raise InputError(
                f"{urdf}: link '{moving[0].find('parent').get('link')}' branches; only serial arms are known"
            )
        for element in elements:
            chain.append(element.find("child").get("link"))
            if element.get("type") == "fixed":
                continue
            if element.get("type") not in ("revolute", "continuous"):
                raise InputError(
                    f"{urdf}: joint '{element.get('name')}' is {element.get('type')}; allowed: revolute, continuous"
                )
            found[element.get("name")] = _joint_of_element(element)
    given = data.get("joints", [])
    for i, joint in enumerate(given):
        if joint["name"] not in found:
            raise InputError(
                f"{path}: 'joints[{i}].name' is '{joint['name']}', not a moving joint of {data['urdf']}"
                f"{nearest(joint['name'], found)} (allowed: {', '.join(found)})"
            )
        found[joint["name"]].update(joint)
    return list(found.values())


def _joint_of_element(element: ElementTree.Element) -> dict[str, Any]:
    joint: dict[str, Any] = {"name": element.get("name")}
    limit, dynamics = element.find("limit"), element.find("dynamics")
    if element.get("type") == "continuous":
        joint["limits"] = [-2 * math.pi, 2 * math.pi]
    elif limit is not None:
        joint["limits"] = [float(limit.get("lower", 0)), float(limit.get("upper", 0))]
    if limit is not None and float(limit.get("effort", 0)) > 0:
        joint["torque_limit"] = float(limit.get("effort"))
    if dynamics is not None:
        friction = float(dynamics.get("friction", 0))
        joint["viscous"] = float(dynamics.get("damping", 0))
        joint["coulomb"] = {"positive": friction, "negative": -friction}
    return joint


def robot_sources(path: str) -> list[str]:
    """Return the files that a robot is made of: the robot file and, where it names one, the URDF."""
    data = read_yaml(path)
    return [path, str(path_in(data["urdf"], Path(path).parent))] if "urdf" in data else [path]
