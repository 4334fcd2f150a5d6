"""The augmented robot file: the nominal robot with retuned parameters and the effects that were found."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from jointwear.discovery.estimates.forms import written_form
from jointwear.discovery.model.estimation import Estimate, Final
from jointwear.effects import State, get_effect
from jointwear.files.json_values import builtin
from jointwear.robots.inertia import links_from_parameters
from jointwear.robots.robot import body_content
from jointwear.robots.urdf_links import urdf_with_links


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
    data["payload"] = body_content(robot.payload)
    data["effects"] = [builtin(vars(e)) for e in robot.effects]
    data = _with_effects(data, estimates, final.outcome.problem.state)
    data["provenance"] = {
        **robot.provenance,
        "note": (
            robot.provenance.get("note", "")
            + " Parameters retuned"
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
    return urdf_with_links(robot, final.delta_inertial if with_effects else final.retuned_inertial)


def _with_effects(data: dict[str, Any], estimates: Sequence[Estimate], state: State) -> dict[str, Any]:
    """Return the content of a robot file with estimated effects, each where it says that it belongs."""
    data = {**data, "effects": list(data["effects"])}
    for e in estimates:
        effect = get_effect(e.named.candidate.effect)
        if effect.writes is not None:
            data = effect.writes(data, effect.bounded(e.parameters))
        else:
            data["effects"] += entries_of(e, state)
    return data


def entries_of(e: Estimate, state: State) -> list[dict[str, Any]]:
    """Return the entries of the robot file for one effect; the bends of its form become a table or further entries, and
    a drive that two joints turn has one on each of them.

    Every parameter lies within the bounds of the effect, so that the file can be read again.
    """
    candidate = e.named.candidate
    effect = get_effect(candidate.effect)
    written = [e.parameters]
    if e.form is not None and effect.bend.written is not None:
        bends = e.form.columns(state.part(np.arange(2))).shape[1]
        written = written_form(e.form, e.parameters, e.coefficients[-bends:])
    return [
        {
            "effect": candidate.effect,
            "axis": None if half.axis is None else half.axis + 1,
            "source_axis": None if half.source is None else half.source + 1,
            "parameters": builtin(effect.bounded(parameters)),
        }
        for half in candidate.halves
        for parameters in written
    ]
