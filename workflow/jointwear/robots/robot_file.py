"""Read and check a robot file without building the robot.

Kept apart from :mod:`jointwear.robots.robot` because the Snakefile checks robot files at every call and must not
pay for numpy.
"""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any

from jointwear.files.documents import read_yaml
from jointwear.files.errors import InputError, nearest, shown
from jointwear.files.registered import path_in, will_be_fetched
from jointwear.files.regular_files import nearest_file
from jointwear.files.schemas import check, normalise_numbers, read_schema
from jointwear.files.wording import count as counted
from jointwear.robots.plausible_drives import check_drives, check_payload, check_ratio
from jointwear.robots.rigid_body import has_no_negative_moment
from jointwear.robots.urdf_file import moving_mass, read_urdf_joints

#: Position [rad], four turns, that no limit of a joint lies beyond: 90 and 180 are degrees. Length [m] of the DH table
#: beyond which it is one in mm.
FARTHEST_TURN, LONGEST = 25.2, 100.0
#: Largest mass of a link [kg], largest radius of gyration [m], and mass [kg] below which the latter says nothing.
HEAVIEST, LARGEST_RADIUS, LIGHTEST = 5000.0, 5.0, 1e-3
#: Distance [m] of a centre of mass that is taken of any arm: a link of next to no mass, as `discover` may write one,
#: has it far outside.
FARTHEST_MASS = 20.0
#: Longest name of a joint, characters: messages and pages hold it.
LONGEST_NAME = 100
#: Gravity [m/s2] above which it is in another unit, and by how much it may differ from 1 and still be one g: a flat arm
#: may be given the share of gravity in its plane alone. Units that gravity is found in [m/s2].
MOST_GRAVITY, ONE_G = 30.0, 0.01
_OF_GRAVITY = {"g": 9.81, "mm/s2": 1e-3, "cm/s2": 1e-2}
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
    _check_kind(path)
    schema = read_schema("robot")
    data = read_yaml(path, schema)
    _check_lengths(path, data)
    _check_gravity(path, data)
    check(data, schema, path)
    data = normalise_numbers(data, schema)
    data.setdefault("gravity", [0.0, 0.0, -9.81])
    if ("dh" in data) == ("urdf" in data):
        raise InputError(f"{path}: give the kinematics either as 'dh' (with 'links') or as 'urdf'")
    for where, body in _bodies(data).items():
        if not has_no_negative_moment(body.get("inertia", [0.0] * 6)):
            raise InputError(
                f"{path}: '{where}.inertia' is {shown(body['inertia'])}, which no body has: as a matrix it must not "
                "have negative principal moments (order: xx yy zz xy yz xz)"
            )
        _check_size(path, where, body, sum(abs(row["a"]) + abs(row["d"]) for row in data.get("dh", [])))
    if "urdf" in data:
        if "links" in data:
            raise InputError(f"{path}: 'links' is only for robots given by 'dh'; a URDF brings its own")
        data["joints"] = _joints_of_urdf(path, data)
    else:
        if "inertia_check" in data:
            raise InputError(f"{path}: 'inertia_check' is only for robots given by 'urdf'; 'links' are always checked")
        count = len(data["dh"])
        for key in ("links", "joints"):
            if key not in data:
                raise InputError(f"{path}: '{key}' is missing; a robot given by 'dh' needs one entry for each row")
            if len(data[key]) != count:
                raise InputError(f"{path}: '{key}' has {counted(len(data[key]), 'entry', 'entries')}, 'dh' has {count}")
    data["joints"] = [_complete(path, i, joint) for i, joint in enumerate(data["joints"])]
    _check_names(path, data["joints"])
    if "dh" in data:
        check_payload(path, data, sum(body["mass"] for body in data["links"]))
        check_drives(path, data)
    elif "payload" in data:
        check_payload(path, data, moving_mass(path_in(data["urdf"], path.parent)))
    axes = len(data["joints"])
    for i, entry in enumerate(data.get("effects", [])):
        for key in ("axis", "source_axis"):
            if entry.get(key) is not None and entry[key] > axes:
                raise InputError(
                    f"{path}: 'effects[{i}].{key}' is {entry[key]}; the robot has "
                    f"{counted(axes, 'axis', 'axes')} (allowed: 1 to {axes}); the nearest valid value is {axes}"
                )
    return data


def _check_names(path: Path, joints: list[dict[str, Any]]) -> None:
    """Check that joints have names that a message can hold, and no two the same; of two entries of a URDF's joint the
    later one would hide the first."""
    names = [joint["name"] for joint in joints]
    for i, name in enumerate(names):
        if not name.strip() or len(name) > LONGEST_NAME:
            said = f"has {counted(len(name), 'character')}" if name.strip() else f"is {shown(name)}, which is blank"
            near = f"; the nearest valid value is {shown(f'joint_{i + 1}')}"
            raise InputError(f"{path}: 'joints[{i}].name' {said} (allowed: 1 to {LONGEST_NAME}){near}")
    for i, name in enumerate(names):
        if name in names[:i]:
            raise InputError(f"{path}: 'joints[{i}].name' is '{name}', which an earlier joint has")


def _bodies(data: dict[str, Any]) -> dict[str, Any]:
    """Return key -> entry of the links and of the payload of a robot file, checked or not."""
    links = data.get("links")
    bodies = {f"links[{i}]": body for i, body in enumerate(links if isinstance(links, list) else [])}
    return bodies | ({"payload": data["payload"]} if "payload" in data else {})


def _check_lengths(path: Path, data: dict[str, Any]) -> None:
    """Check that no length of the DH table, and no centre of mass, is as large as one in mm.

    Raises
    ------
    InputError : naming the key and its value in m.
    """
    for where, body in _bodies(data).items():
        com = body.get("com") if isinstance(body, dict) else None
        numbers = isinstance(com, list) and all(isinstance(x, (int, float)) for x in com)
        if numbers and LONGEST < max(map(abs, com), default=0.0) < float("inf"):
            metres = ", ".join(f"{x / 1000:g}" for x in com)
            raise InputError(
                f"{path}: '{where}.com' is {shown(com)}, in m; this looks like mm: [{metres}] (allowed: "
                f"-{LONGEST:g} to {LONGEST:g})"
            )
    rows = data.get("dh")
    for i, row in enumerate(rows if isinstance(rows, list) else []):
        for key in ("a", "d"):
            value = row.get(key) if isinstance(row, dict) else None
            if isinstance(value, (int, float)) and LONGEST < abs(value) < float("inf"):
                raise InputError(
                    f"{path}: 'dh[{i}].{key}' is {value:g}, in m; this looks like mm: {value / 1000:g} (allowed: "
                    f"-{LONGEST:g} to {LONGEST:g})"
                )


def _check_gravity(path: Path, data: dict[str, Any]) -> None:
    """Check that gravity is a vector, in m/s2.

    Raises
    ------
    InputError : naming the unit that it looks like, and its value in m/s2.
    """
    given = data.get("gravity", [])
    if isinstance(given, (int, float)):
        raise InputError(
            f"{path}: 'gravity' is {shown(given)}, must be a list of three numbers, in m/s2 along x, y and z of the "
            "base frame; [0, 0, -9.81] for an arm that stands upright"
        )
    if not isinstance(given, list) or not all(isinstance(g, (int, float)) for g in given):
        return  # the schema tells what is wrong
    size = math.hypot(*given)
    if not math.isfinite(size) or (size <= MOST_GRAVITY and abs(size - 1.0) > ONE_G):
        return
    unit = min(_OF_GRAVITY, key=lambda u: abs(math.log(size * _OF_GRAVITY[u] / 9.81)))
    there = ", ".join(f"{g * _OF_GRAVITY[unit]:.4g}" for g in given)
    raise InputError(
        f"{path}: 'gravity' is {shown(given)}, in m/s2; this looks like {unit}: [{there}] (allowed: up to "
        f"{MOST_GRAVITY:g} m/s2 in size)"
    )


def _check_size(path: Path, where: str, body: dict[str, Any], reach: float) -> None:
    """Check that a body is one that an arm can have: mass in kg, centre of mass in m, inertia in kg m2.

    Parameters
    ----------
    where : key of the body. reach : summed lengths of the DH table [m], 0 with a URDF.

    Raises
    ------
    InputError : naming the key and the unit that it looks like.
    """
    mass = body.get("mass", 0.0)
    if mass > HEAVIEST:
        raise InputError(f"{path}: '{where}.mass' is {mass:g}, in kg; this looks like g (allowed: up to {HEAVIEST:g})")
    farthest = max(3 * reach, FARTHEST_MASS)
    distance = math.hypot(*body.get("com", (0.0,)))
    if distance > farthest:
        raise InputError(
            f"{path}: '{where}.com' lies {distance:.3g} m from the origin of its frame, farther than an arm of "
            f"{reach:.3g} m can have it; this looks like mm (allowed: up to {farthest:.3g} m)"
        )
    moment = max(map(abs, body.get("inertia", [0.0])))
    if mass >= LIGHTEST and moment > mass * LARGEST_RADIUS**2:
        raise InputError(
            f"{path}: '{where}.inertia' reaches {moment:g} kg m2 on {mass:g} kg, a radius of gyration of "
            f"{math.sqrt(moment / mass):.3g} m; this looks like another unit, as g m2 or kg mm2 (allowed: up to "
            f"{LARGEST_RADIUS:g} m)"
        )


def _complete(path: Path, index: int, joint: dict[str, Any]) -> dict[str, Any]:
    where = f"joints[{index}]"
    joint = {**_DEFAULTS, **joint}
    if "limits" not in joint:
        raise InputError(f"{path}: '{where}.limits' is missing")
    lower, upper = joint["limits"]
    if not lower < upper:
        raise InputError(f"{path}: '{where}.limits' is [{lower}, {upper}]; the lower limit must come first")
    if max(abs(lower), abs(upper)) > FARTHEST_TURN:
        radians = ", ".join(f"{math.radians(limit):.6g}" for limit in (lower, upper))
        raise InputError(
            f"{path}: '{where}.limits' is [{lower}, {upper}], in rad; this looks like degrees: [{radians}]"
        )
    if joint["gear_ratio"] == 0:
        raise InputError(f"{path}: '{where}.gear_ratio' is 0; a joint known on the joint side has gear_ratio 1")
    check_ratio(path, index, joint["gear_ratio"])
    return joint


def _joints_of_urdf(path: Path, data: dict[str, Any]) -> list[dict[str, Any]]:
    """Return one joint entry for each moving joint of the URDF, overridden by those of the robot file."""
    urdf = path_in(data["urdf"], path.parent)
    try:
        entries = read_urdf_joints(urdf, check_inertia=data.get("inertia_check", "full") == "full")
    except InputError as error:
        if "no such file" not in str(error):
            raise
        hint = "; `snakemake fetch_data` loads it" if will_be_fetched(urdf) else nearest_file(urdf.with_suffix(".urdf"))
        raise InputError(f"{path}: 'urdf' names {data['urdf']}, which does not exist{hint}") from None
    found = {entry["name"]: entry for entry in entries}
    given = data.get("joints", [])
    _check_names(path, given)
    for i, joint in enumerate(given):
        if joint["name"] not in found:
            raise InputError(
                f"{path}: 'joints[{i}].name' is '{joint['name']}', not a moving joint of {data['urdf']}"
                f"{nearest(joint['name'], found)} (allowed: {', '.join(found)})"
            )
        found[joint["name"]] = _on_motor_side(found[joint["name"]], joint.get("gear_ratio", 1.0)) | joint
    return list(found.values())


def _on_motor_side(entry: dict[str, Any], gear: float) -> dict[str, Any]:
    """Return a joint of a URDF, which has friction on the joint side, with friction on that of the motor."""
    if gear**2 < 1e-100 or "coulomb" not in entry:  # such a gear is none: 0 is refused later
        return entry
    coulomb = {direction: value / abs(gear) for direction, value in entry["coulomb"].items()}
    return entry | {"viscous": entry["viscous"] / gear**2, "coulomb": coulomb}


def _check_kind(path: Path) -> None:
    """Refuse a description of links that is given in place of a robot file."""
    if path.suffix.lower() in (".urdf", ".xacro", ".sdf"):
        raise InputError(
            f"{path}: is a description of links; a robot file is YAML that names it, as 'urdf: {path.name}', and adds "
            "the drives under 'joints' (docs/howto/robot.md)"
        )


def robot_sources(path: str) -> list[str]:
    """Return the files that a robot is made of: the robot file and, where it names one, the URDF.

    Raises
    ------
    InputError : where the file cannot be read, or is a description of links itself.
    """
    _check_kind(Path(path))
    data = read_yaml(path)
    if not isinstance(data.get("urdf"), str):
        return [path]
    return [path, str(path_in(data["urdf"], Path(path).parent))]
