"""The stage ``snakemake discover``: one data set in, every file of it out."""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from jointwear.discovery.estimates.scan import scan
from jointwear.discovery.experiment import Experiment
from jointwear.discovery.findings import argument_of
from jointwear.discovery.pipeline import MODELS, Discovery, discover
from jointwear.discovery.settings import settings_of
from jointwear.discovery.verdict import NamedEffect, NextExperiment, Verdict
from jointwear.effects import check_effects
from jointwear.files import provenance
from jointwear.files.errors import InputError
from jointwear.files.json_documents import write_json
from jointwear.files.json_values import six_digits
from jointwear.files.storage import Variable, write_dataset
from jointwear.files.text_files import replace_text
from jointwear.measurement.recording_files import load_recording, write_recording
from jointwear.measurement.refused import what_mends
from jointwear.robots.robot import load_robot

#: Files of one data set, in its folder.
VERDICT, AUGMENTED, RETUNED = "verdict.json", "robot.yaml", "retuned.yaml"
RECORDING, MODELS_FILE, WHERE, EVIDENCE = "recording.nc", "models.nc", "where.nc", "evidence.nc"
REFUSED, NEXT, PAGE = "refused.json", "next_experiment.csv", "discover.html"


def discover_dataset(
    name: str, entry: Mapping[str, Any], robot: str | Path, folder: str | Path, log: str | Path | None = None
) -> Discovery:
    """Run discovery on one data set and write all its files into `folder`.

    A data set that must not be judged leaves ``refused.json`` there, no verdict and no page.

    Parameters
    ----------
    entry : of ``discover.datasets``. robot : the robot file that it names. log : file that gets what a user should
        know: searches that went wrong, models that were put back.

    Raises
    ------
    InputError : names what is wrong; the reason has been written first.
    """
    folder = Path(folder)
    refused = folder / REFUSED
    refused.unlink(missing_ok=True)
    try:
        arm = load_robot(robot)
        check_effects(arm)
        found = discover(load_recording(entry, name), arm, settings_of(entry))
    except InputError as error:
        # A page without the verdict that it shows would be read as that of this data.
        for stale in (VERDICT, PAGE):
            (folder / stale).unlink(missing_ok=True)
        content = {"dataset": name, "reason": str(error), "suggestion": what_mends(error)}
        replace_text(refused, json.dumps(content, indent=1) + "\n")
        raise
    settings = {"dataset": name, **entry}
    write_recording(found.recording, folder / RECORDING, {"dataset": name, "entry": dict(entry)})
    found.files["augmented"].write(folder / AUGMENTED)
    found.files["retuned"].write(folder / RETUNED)
    _write_models(found, folder / MODELS_FILE)
    _write_where(found, folder / WHERE, settings)
    _write_evidence(found, folder / EVIDENCE, settings)
    (folder / NEXT).unlink(missing_ok=True)
    if found.experiment is not None:
        _write_trajectory(folder / NEXT, found.experiment.time, found.experiment.position)
    write_json(folder / VERDICT, complete_verdict(found, folder / NEXT).to_data())
    if log is not None:
        lines = [f"{name}: {words}" for words in found.content.misfits]
        lines += [
            f"{name}: joint {f.axis}, {f.model} model: as fitted its error on records left out was {f.ratio:.3g} times "
            f"that of the given robot; {f.step}; written are {f.kept}"
            for f in found.content.fallbacks
        ]
        replace_text(log, "".join(f"{line}\n" for line in lines))
    return found


def complete_verdict(found: Discovery, next_experiment: str | Path) -> Verdict:
    """Return the verdict with the proposed experiment, to be found in a file, and the free identification."""
    experiment: Experiment | None = found.experiment
    purpose = None
    if experiment is not None:
        purpose = NextExperiment(
            experiment.pair, experiment.axis + 1, six_digits(experiment.share_now), six_digits(experiment.share_then)
        )
    return replace(
        found.content,
        next_experiment=None if experiment is None else str(next_experiment),
        next_experiment_purpose=purpose,
        free_identification=tuple(None if e is None else six_digits(e) for e in found.free_identification),
    )


def _write_models(found: Discovery, path: Path) -> None:
    """Write the samples used with the torque of every model along them."""
    measured, name = found.problem.measured, found.recording.name
    n = measured.position.shape[1]
    pair = ("instant", "joint")
    variables = {
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
        "load": Variable(
            pair, found.problem.state.load, "rigid-body torque of the nominal model without motor inertia", "N m"
        ),
    }
    if found.content.effects:
        variables["argument"] = Variable(
            ("effect", "instant"),
            np.stack([_argument(found, e) for e in found.content.effects]),
            "what each named effect depends on, in the unit of its regime; NaN of one on the whole arm",
            "1",
        )
    for kind in MODELS:
        variables[kind] = Variable(pair, found.torques[kind], f"torque of the {kind} model", "N m")
    attributes = provenance.attributes(f"models of data set {name}", {"dataset": name})
    attributes |= {"train": list(found.recording.train), "test": list(found.recording.test), "rate_hz": measured.rate}
    write_dataset(path, variables, attributes)


def _argument(found: Discovery, effect: NamedEffect) -> np.ndarray:
    """Return the argument (m,) of a named effect at the samples used, NaN for an effect on the whole arm."""
    state = found.problem.state
    if effect.axis is None:
        return np.full(len(state.time), np.nan)
    source = None if effect.source_axis is None else effect.source_axis - 1
    named = [e.named.candidate for e in (*found.final.estimates, *found.final.unwritten)]
    own = next(c for c in named if (c.effect, c.axis, c.source) == (effect.effect, effect.axis - 1, source))
    return argument_of(own, state, own.axis)[0]


def _write_where(found: Discovery, path: Path, settings: Mapping[str, Any]) -> None:
    """Write in which axis and over which argument retuning leaves structure: the map of the page."""
    groups = sorted({_group(u.argument) for u in found.where})
    n = found.problem.robot.joints
    nats = np.full((n, len(groups)), np.nan)
    p_value = np.full((n, len(groups)), np.nan)
    for u in found.where:
        k = groups.index(_group(u.argument))
        if not nats[u.axis, k] >= u.nats:
            nats[u.axis, k], p_value[u.axis, k] = u.nats, u.p_value
    variables = {
        "joint": Variable(("joint",), np.arange(1, n + 1), "number of the joint", "1"),
        "argument": Variable(("argument",), np.array(groups), "argument over which the residual was binned"),
        "structure": Variable(("joint", "argument"), nats, "chi-square beyond its expectation, halved", "nat"),
        "p_value": Variable(("joint", "argument"), p_value, "probability of that much structure by chance", "1"),
    }
    title = f"where data set {found.recording.name} disagrees"
    write_dataset(path, variables, provenance.attributes(title, settings))


def _group(argument: str) -> str:
    """Arguments of one kind over other joints share a column."""
    words = argument.split()
    return " ".join("another joint" if w == "joint" else w for w in words if not w.isdigit())


def _write_trajectory(path: Path, time: np.ndarray, position: np.ndarray) -> None:
    header = ",".join(["time", *(f"position_{j + 1}" for j in range(position.shape[1]))])
    lines = [header, *(",".join(f"{x:.6f}" for x in (t, *q)) for t, q in zip(time, position, strict=True))]
    replace_text(path, "\n".join(lines) + "\n")


def _write_evidence(found: Discovery, path: Path, settings: Mapping[str, Any]) -> None:
    outcome, seen = found.final.outcome, found.map
    scored = [] if outcome.white is None else scan(outcome.white, outcome.dictionary, outcome.white.fit())
    scored = [s for s in scored if np.isfinite(s.evidence)]

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
