"""The stages of ``snakemake discover``, one function each: files in, files out."""

from __future__ import annotations

import json
from collections.abc import Mapping
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import yaml

from jointwear.discovery.augment import augmented_robot, augmented_urdf
from jointwear.discovery.base_parameters import free_identification
from jointwear.discovery.decide import Outcome, search, unexplained
from jointwear.discovery.estimation import finalise
from jointwear.discovery.experiment import propose
from jointwear.discovery.problem import build_problem, estimate_noise, whiten
from jointwear.discovery.restrictions import motion_restrictions
from jointwear.discovery.settings import Settings
from jointwear.discovery.verdict import make_verdict
from jointwear.effects import check_effects, effect_torque, make_state
from jointwear.files import provenance
from jointwear.files.errors import InputError
from jointwear.files.json_values import six_digits
from jointwear.files.storage import Variable, read_variables, write_dataset
from jointwear.files.text_files import replace_text
from jointwear.measurement.checks import Refused, check_recording
from jointwear.measurement.motion import measure
from jointwear.measurement.recording import split
from jointwear.measurement.recording_files import load_recording, read_recording, write_recording
from jointwear.robots.dynamics import Dynamics
from jointwear.robots.robot import Robot, load_robot


def settings_of(entry: Mapping[str, Any]) -> Settings:
    """Return the settings that a data set's entry asks for."""
    prior = entry.get("inertial_prior")
    return Settings() if prior is None else Settings(inertial_prior=float(prior))


def ingest_recording(name: str, entry: Mapping[str, Any], robot: str | Path, output: str | Path) -> None:
    """Read, convert, split and check one data set; write it under native names.

    A data set that must not be judged leaves ``refused.json`` beside `output` and no verdict.

    Raises
    ------
    InputError : names what is wrong; :class:`Refused` has written the reason first.
    """
    folder = Path(output).parent
    refused = folder / "refused.json"
    refused.unlink(missing_ok=True)
    try:
        recording = split(load_recording(entry, name))
        arm = load_robot(robot)
        check_effects(arm)
        check_recording(recording, arm)
    except InputError as error:
        (folder / "verdict.json").unlink(missing_ok=True)
        content = {
            "dataset": name,
            "reason": str(error),
            "suggestion": getattr(error, "suggestion", "mend the entry or the file that the reason names"),
        }
        replace_text(refused, json.dumps(content, indent=1) + "\n")
        raise
    write_recording(recording, output, {"dataset": name, "entry": dict(entry)})


def _motion_variables(measured) -> dict[str, Variable]:
    n = measured.position.shape[1]
    pair = ("instant", "joint")
    return {
        "joint": Variable(("joint",), np.arange(1, n + 1), "number of the joint", "1"),
        "time": Variable(("instant",), measured.time, "time, never running backwards", "s"),
        "trajectory": Variable(("instant",), measured.trajectory, "label of the trajectory", "1"),
        "position": Variable(pair, measured.position, "joint position", "rad"),
        "velocity": Variable(pair, measured.velocity, "joint velocity", "rad/s"),
        "acceleration": Variable(pair, measured.acceleration, "joint acceleration", "rad/s2"),
        "temperature": Variable(pair, measured.temperature, "temperature, NaN where unknown", "degC"),
        "torque": Variable(pair, measured.torque, "measured torque", "N m"),
        "usable": Variable(pair, measured.usable.astype(np.int8), "1 where the joint moves and can be judged", "1"),
        "cutoff": Variable(("joint",), measured.cutoff, "cut-off of the zero-phase filter, NaN without one", "Hz"),
    }


def simulate_robot(robot: Robot, measured) -> tuple[np.ndarray, np.ndarray]:
    """Return the torque of a robot, effects included, and its rigid-body part without motor inertia, (m, n)."""
    q, v, a = measured.position, measured.velocity, measured.acceleration
    rigid = np.array(Dynamics(robot).rigid_body_torque(q, v, a))
    state = make_state(
        robot, q, v, a, rigid, time=measured.time, temperature=measured.temperature, record=measured.trajectory
    )
    return state.torque + effect_torque(robot, state), state.load


def simulate_nominal(recording: str | Path, robot: str | Path, output: str | Path) -> None:
    """Derive the motion and simulate the nominal model along it."""
    data = read_recording(recording)
    measured = measure(data)
    torque, load = simulate_robot(load_robot(robot), measured)
    variables = _motion_variables(measured)
    variables["nominal"] = Variable(("instant", "joint"), torque, "torque of the nominal model", "N m")
    variables["load"] = Variable(("instant", "joint"), load, "rigid-body torque without motor inertia", "N m")
    attributes = provenance.attributes(f"nominal model of data set {data.name}", {"dataset": data.name})
    attributes |= {"train": list(data.train), "test": list(data.test), "rate_hz": measured.rate}
    write_dataset(output, variables, attributes)


def locate_discrepancy(recording: str | Path, robot: str | Path, output: str | Path, entry: Mapping[str, Any]) -> None:
    """Tell in which axis and over which argument retuning leaves structure: the map of the page."""
    data = read_recording(recording)
    problem = build_problem(data, load_robot(robot), settings_of(entry))
    motion_restrictions(problem)
    white = whiten(problem, estimate_noise(problem))
    outcome = Outcome(problem, white, white.fit(), None)
    _, profile = unexplained(outcome)
    groups = sorted({_group(u.argument) for u in profile})
    n = problem.robot.joints
    nats = np.full((n, len(groups)), np.nan)
    p_value = np.full((n, len(groups)), np.nan)
    for u in profile:
        k = groups.index(_group(u.argument))
        if not nats[u.axis, k] >= u.nats:
            nats[u.axis, k], p_value[u.axis, k] = u.nats, u.p_value
    variables = {
        "joint": Variable(("joint",), np.arange(1, n + 1), "number of the joint", "1"),
        "argument": Variable(("argument",), np.array(groups), "argument over which the residual was binned"),
        "structure": Variable(("joint", "argument"), nats, "chi-square beyond its expectation, halved", "nat"),
        "p_value": Variable(("joint", "argument"), p_value, "probability of that much structure by chance", "1"),
    }
    attributes = provenance.attributes(f"where data set {data.name} disagrees", {"dataset": data.name, **entry})
    write_dataset(output, variables, attributes)


def _group(argument: str) -> str:
    """Arguments of one kind over other joints share a column."""
    words = argument.split()
    return " ".join("another joint" if w == "joint" else w for w in words if not w.isdigit())


def decide_effects(
    recording: str | Path,
    robot: str | Path,
    entry: Mapping[str, Any],
    decision: str | Path,
    augmented: str | Path,
    retuned: str | Path,
    evidence: str | Path,
) -> None:
    """Score every candidate, decide, and write the verdict without its gap, both robots and the evidence."""
    data = read_recording(recording)
    arm = load_robot(robot)
    measured = cache(lambda: measure(data))
    problem = build_problem(data, arm, settings_of(entry), measured())
    restrictions = check_recording(data, arm, measured) + motion_restrictions(problem)
    outcome = search(problem)
    final = finalise(outcome)
    verdict = make_verdict(data.name, final, restrictions)
    content = {k: v for k, v in verdict.data.items() if k != "gap"}
    experiment = propose(outcome)
    folder = Path(decision).parent
    if experiment is not None:
        path = folder / "next_experiment.csv"
        content["next_experiment"] = str(path)
        content["next_experiment_purpose"] = {
            "effects": list(experiment.pair),
            "axis": experiment.axis + 1,
            "share_now": six_digits(experiment.share_now),
            "share_then": six_digits(experiment.share_then),
        }
        _write_trajectory(path, experiment.time, experiment.position)
    content["noise_floor"] = verdict.data["gap"]["noise_floor"]
    content["free_identification"] = [None if e is None else six_digits(e) for e in free_identification(problem)]
    content["filter_cutoff_hz"] = [six_digits(c) if np.isfinite(c) else None for c in problem.measured.cutoff]
    replace_text(decision, json.dumps(content, indent=1, allow_nan=False) + "\n")
    for path, with_effects in ((Path(augmented), True), (Path(retuned), False)):
        urdf = path.with_suffix(".urdf")
        text = augmented_urdf(final, with_effects)
        if text is not None:
            replace_text(urdf, text + "\n")
        data_of = augmented_robot(final, urdf.name, with_effects)
        replace_text(path, yaml.safe_dump(data_of, sort_keys=False, allow_unicode=True, width=120))
    _write_evidence(verdict, evidence, {"dataset": data.name, **entry})


def _write_trajectory(path: Path, time: np.ndarray, position: np.ndarray) -> None:
    header = ",".join(["time", *(f"position_{j + 1}" for j in range(position.shape[1]))])
    lines = [header, *(",".join(f"{x:.6f}" for x in (t, *q)) for t, q in zip(time, position, strict=True))]
    replace_text(path, "\n".join(lines) + "\n")


def _write_evidence(verdict, path: str | Path, settings: Mapping[str, Any]) -> None:
    from jointwear.discovery.candidates import scan

    outcome = verdict.final.outcome
    scored = scan(outcome.white, outcome.dictionary, outcome.white.fit())
    scored = [s for s in scored if np.isfinite(s.evidence)]
    seen = verdict.map

    def axis_of(value: int | None) -> int:
        return 0 if value is None else value + 1

    variables = {
        "candidate": Variable(("candidate",), np.array([s.candidate.effect for s in scored]), "identifier"),
        "axis": Variable(
            ("candidate",), np.array([axis_of(s.candidate.axis) for s in scored]), "axis, 0: whole arm", "1"
        ),
        "source_axis": Variable(
            ("candidate",), np.array([axis_of(s.candidate.source) for s in scored]), "source axis, 0: none", "1"
        ),
        "evidence": Variable(
            ("candidate",), np.array([s.evidence for s in scored]), "evidence when it is the first effect", "nat"
        ),
        "map_effect": Variable(("visible",), np.array([v.effect for v in seen]), "effect of the identifiability map"),
        "map_axis": Variable(("visible",), np.array([axis_of(v.axis) for v in seen]), "axis, 0: whole arm", "1"),
        "map_energy": Variable(
            ("visible",),
            np.array([v.energy for v in seen]),
            "energy over noise variance after the base regression",
            "1",
        ),
        "map_rival": Variable(("visible",), np.array([v.rival or "-" for v in seen]), "effect that takes most of it"),
        "map_left": Variable(("visible",), np.array([v.left for v in seen]), "energy left after that rival", "1"),
    }
    write_dataset(path, variables, provenance.attributes("evidence of every candidate", settings))


def simulate_models(
    nominal: str | Path, recording: str | Path, augmented: str | Path, retuned: str | Path, output: str | Path
) -> None:
    """Simulate again, with the robot files that were written: the retuned and the augmented robot."""
    data = read_recording(recording)
    measured = measure(data)
    variables = _motion_variables(measured)
    (torque, load) = read_variables(nominal, "nominal", "load")
    pair = ("instant", "joint")
    variables["load"] = Variable(pair, load, "rigid-body torque of the nominal model without motor inertia", "N m")
    variables["nominal"] = Variable(pair, torque, "torque of the nominal model", "N m")
    for name, path in (("retuned", retuned), ("augmented", augmented)):
        robot = load_robot(path)
        check_effects(robot)
        variables[name] = Variable(pair, simulate_robot(robot, measured)[0], f"torque of the {name} model", "N m")
    attributes = provenance.attributes(f"models of data set {data.name}", {"dataset": data.name})
    attributes |= {"train": list(data.train), "test": list(data.test)}
    write_dataset(output, variables, attributes)


def measure_gap(decision: str | Path, models: str | Path, recording: str | Path, output: str | Path) -> None:
    """Measure the gap on held-out motion and complete the verdict."""
    content = json.loads(Path(decision).read_text(encoding="utf-8"))
    data = read_recording(recording)
    names = ("nominal", "retuned", "augmented")
    trajectory, usable, torque, *found = read_variables(models, "trajectory", "usable", "torque", *names)
    test = np.isin(trajectory, data.test)
    gap: dict[str, Any] = {"unit": "N m", "per": "axis, RMS over moving samples of the test trajectories"}
    for name, values in zip(names, found, strict=True):
        gap[name] = []
        for j in range(torque.shape[1]):
            chosen = test & (usable[:, j] > 0)
            error = torque[chosen, j] - values[chosen, j]
            gap[name].append(six_digits(np.sqrt(np.mean(error**2))) if chosen.any() else None)
    gap["noise_floor"] = content.pop("noise_floor")
    order = ("dataset", "verdict", "effects", "retuned", "unexplained")
    ordered = {k: content[k] for k in order} | {"gap": gap} | {k: v for k, v in content.items() if k not in order}
    replace_text(output, json.dumps(ordered, indent=1, allow_nan=False) + "\n")


__all__ = [
    "Refused",
    "decide_effects",
    "ingest_recording",
    "locate_discrepancy",
    "measure_gap",
    "simulate_models",
    "simulate_nominal",
]
