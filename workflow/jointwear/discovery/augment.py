"""The augmented robot file: the nominal robot with retuned numbers and the effects that were found."""

from __future__ import annotations

import xml.etree.ElementTree as ElementTree
from dataclasses import replace
from typing import Any

import numpy as np

from jointwear.discovery.estimation import Estimate, Final
from jointwear.effects import effect_torque, get_effect, make_state
from jointwear.files.json_values import builtin
from jointwear.robots.inertia import links_from_parameters
from jointwear.robots.robot import EffectEntry, Link, Robot


def augmented_robot(final: Final, urdf_name: str | None = None, with_effects: bool = True) -> dict[str, Any]:
    """Return the augmented robot in the layout of a robot file; without effects the robot that is only retuned.

    A robot given by a URDF names `urdf_name`, the file that :func:`augmented_urdf` gives the content of.
    """
    robot = final.outcome.problem.robot
    delta = final.delta_friction if with_effects else final.retuned_friction
    inertial = final.delta_inertial if with_effects else final.retuned_inertial
    estimates = final.estimates if with_effects else ()
    data: dict[str, Any] = {"name": robot.name, "gravity": [float(x) for x in robot.gravity]}
    if robot.dh is not None:
        data["dh"] = [
            {"d": r.d, "a": r.a, "alpha": r.alpha, **({"offset": r.offset} if r.offset else {})} for r in robot.dh
        ]
        data["links"] = links_from_parameters(robot, inertial)
    else:
        data["urdf"] = urdf_name or str(robot.urdf)
        # Fitted parameters give the torques; they need not be those of bodies.
        data["inertia_check"] = "none"
    gear = np.abs(robot.gear_ratio)
    data["joints"] = []
    for j, name in enumerate(robot.joint_names):
        limit = float(robot.torque_limit[j])
        data["joints"].append(
            {
                "name": name,
                "limits": [float(robot.lower[j]), float(robot.upper[j])],
                "gear_ratio": float(robot.gear_ratio[j]),
                "motor_inertia": float(max(robot.armature[j] + delta[j, 3], 0.0) / gear[j] ** 2),
                "viscous": float(max(robot.viscous[j] + delta[j, 2], 0.0) / gear[j] ** 2),
                "coulomb": {
                    "positive": float(max(robot.coulomb_positive[j] + delta[j, 0], 0.0) / gear[j]),
                    "negative": float(min(robot.coulomb_negative[j] + delta[j, 1], 0.0) / gear[j]),
                },
                "torque_limit": limit if np.isfinite(limit) else None,
            }
        )
    payload = [e for e in estimates if e.named.candidate.effect == "payload"]
    data["payload"] = _payload(robot.payload, payload[0] if payload else None)
    data["effects"] = [builtin(vars(e)) for e in robot.effects]
    for e in estimates:
        if e.named.candidate.effect != "payload":
            data["effects"] += _entries(e)
    data["provenance"] = {
        **robot.provenance,
        "note": (
            robot.provenance.get("note", "")
            + " Numbers retuned"
            + (" and effects added" if with_effects else "")
            + " by discovery."
        ).strip(),
    }
    return data


def augmented_urdf(final: Final, with_effects: bool = True) -> str | None:
    """Return the URDF with corrected inertial parameters, None for a robot given by DH parameters."""
    robot = final.outcome.problem.robot
    if robot.urdf is None:
        return None
    inertial = final.delta_inertial if with_effects else final.retuned_inertial
    tree = ElementTree.parse(robot.urdf)
    root = tree.getroot()
    child_of = {e.get("name"): e.find("child").get("link") for e in root.findall("joint")}
    links = {e.get("name"): e for e in root.findall("link")}
    for name, body in zip(robot.joint_names, links_from_parameters(robot, inertial), strict=True):
        element = links[child_of[name]]
        for old in element.findall("inertial"):
            element.remove(old)
        xx, yy, zz, xy, yz, xz = body["inertia"]
        inertial = ElementTree.SubElement(element, "inertial")
        ElementTree.SubElement(inertial, "origin", xyz=" ".join(f"{x:.9g}" for x in body["com"]), rpy="0 0 0")
        ElementTree.SubElement(inertial, "mass", value=f"{body['mass']:.9g}")
        values = {"ixx": xx, "iyy": yy, "izz": zz, "ixy": xy, "iyz": yz, "ixz": xz}
        ElementTree.SubElement(inertial, "inertia", {k: f"{x:.9g}" for k, x in values.items()})
    # Bodies welded to a link are part of the parameters above.
    for joint in root.findall("joint"):
        if joint.get("type") == "fixed" and joint.get("name") not in robot.joint_names:
            parent_moves = joint.find("parent").get("link") in {child_of[n] for n in robot.joint_names}
            element = links.get(joint.find("child").get("link"))
            for old in element.findall("inertial") if parent_moves else []:
                element.remove(old)
    return ElementTree.tostring(root, encoding="unicode", xml_declaration=True)


def _payload(old: Link | None, found: Estimate | None) -> dict[str, Any]:
    """Return the payload of the robot file, the old one and the one found put together."""
    mass, moment, inertia = 0.0, np.zeros(3), np.zeros((3, 3))
    if old is not None:
        mass, moment = old.mass, old.mass * old.com
        inertia = old.inertia + old.mass * (old.com @ old.com * np.eye(3) - np.outer(old.com, old.com))
    if found is not None:
        p = found.parameters
        mass += p["mass"]
        moment = moment + np.array([p["moment_x"], p["moment_y"], p["moment_z"]])
        inertia = inertia + np.array(
            [[p["xx"], p["xy"], p["xz"]], [p["xy"], p["yy"], p["yz"]], [p["xz"], p["yz"], p["zz"]]]
        )
    if mass <= 1e-9:
        return {"mass": 0.0, "com": [0.0, 0.0, 0.0]}
    com = moment / mass
    about = inertia - mass * (com @ com * np.eye(3) - np.outer(com, com))
    # An estimate may be no body's inertia; the nearest positive one is.
    moments, axes = np.linalg.eigh((about + about.T) / 2)
    about = (axes * np.maximum(moments, 0.0)) @ axes.T
    return {
        "mass": float(mass),
        "com": [float(x) for x in com],
        "inertia": [float(about[i]) for i in ((0, 0), (1, 1), (2, 2), (0, 1), (1, 2), (0, 2))],
    }


def _entries(e: Estimate) -> list[dict[str, Any]]:
    """Return the entries of the robot file for one effect; the bends of its form become a table or further entries."""
    candidate = e.named.candidate
    effect = get_effect(candidate.effect)
    own = len(e.coefficients) - (_width(e) if e.form is not None else 0)
    entry = {
        "effect": candidate.effect,
        "axis": candidate.axis + 1,
        "source_axis": None if candidate.source is None else candidate.source + 1,
        "parameters": builtin(e.parameters),
    }
    if e.form is None:
        return [entry]
    bend = e.coefficients[own:]
    if e.form.knots is not None and not effect.needs_source:
        entry["parameters"]["correction"] = builtin({"knots": e.form.knots, "values": bend})
        return [entry]
    if effect.argument == "motor angle":
        angle = np.linspace(0, 2 * np.pi, 97)
        values = sum(
            bend[2 * i] * np.sin(k * angle) + bend[2 * i + 1] * np.cos(k * angle) for i, k in enumerate((2, 3))
        )
        entry["parameters"]["correction"] = builtin({"knots": angle, "values": values})
        return [entry]
    if candidate.effect == "presliding_hysteresis":
        more = [
            {**entry, "parameters": {"level": float(b), "distance": float(f * candidate.nonlinear["distance"])}}
            for f, b in zip((0.3, 0.6, 1.7, 3.5), bend, strict=True)
        ]
        return [entry, *more]
    return [entry]


def corrected_robot(robot: Robot, friction: np.ndarray, entries: list[dict[str, Any]]) -> Robot:
    """Return `robot` with friction and motor inertia corrected by (n, 4) numbers, and further effects.

    Links are left alone: torques of corrected links follow from the regressor, which is exact.
    """
    more = tuple(EffectEntry(e["effect"], e["axis"], e["source_axis"], e["parameters"]) for e in entries)
    return replace(
        robot,
        coulomb_positive=np.maximum(robot.coulomb_positive + friction[:, 0], 0.0),
        coulomb_negative=np.minimum(robot.coulomb_negative + friction[:, 1], 0.0),
        viscous=np.maximum(robot.viscous + friction[:, 2], 0.0),
        armature=np.maximum(robot.armature + friction[:, 3], 0.0),
        effects=robot.effects + more,
    )


def simulate(final: Final) -> dict[str, np.ndarray]:
    """Return the torques (m, n) of the nominal, the retuned and the augmented model at every sample.

    The augmented torque is that of the augmented robot file, tables and bounds included, not that of the fit.
    """
    problem = final.outcome.problem
    nominal = problem.measured.torque - problem.discrepancy
    entries = [x for e in final.estimates if e.named.candidate.effect != "payload" for x in _entries(e)]
    retuned = _simulate(final, final.retuned_friction, final.retuned_inertial, [], None)
    loads = [e for e in final.estimates if e.named.candidate.effect == "payload"]
    augmented = _simulate(final, final.delta_friction, final.delta_inertial, entries, loads[0] if loads else None)
    return {"nominal": nominal, "retuned": retuned, "augmented": augmented}


def _simulate(final: Final, friction, inertial, entries, payload: Estimate | None) -> np.ndarray:
    problem = final.outcome.problem
    old, state = problem.robot, problem.state
    robot = corrected_robot(old, friction, entries)
    rigid = state.load + robot.armature * state.acceleration + problem.regressor @ inertial
    if payload is not None:
        rigid = rigid + state.tip_regressor() @ payload.coefficients
    new = make_state(
        robot,
        state.position,
        state.velocity,
        state.acceleration,
        rigid,
        time=state.time,
        temperature=state.temperature,
        record=state.record,
        tip_regressor=state.tip_regressor,
    )
    return new.torque + effect_torque(robot, new)


def _width(e: Estimate) -> int:
    effect = get_effect(e.named.candidate.effect)
    if e.form.knots is not None:
        return len(e.form.knots)
    return 4 if effect.argument == "motor angle" or e.named.candidate.effect == "presliding_hysteresis" else 5
