"""False alarms per week of both detectors under factory conditions, before and after discovery corrects the model.

Four cases: `steady` conditions; `uncorrected`, the nominal model and the quiet normal period; `longer`, the same model
with the week of discovery counted as normal too; `corrected`, the augmented robot with that longer normal period. The
third tells what the longer period alone would do.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import yaml

from jointwear.discovery.stages import discover_dataset
from jointwear.files import provenance
from jointwear.files.json_documents import write_json
from jointwear.files.storage import Variable, write_dataset
from jointwear.files.text_files import replace_text
from jointwear.reproduction.detection import score
from jointwear.reproduction.features import build_reference, hourly_features
from jointwear.reproduction.normal_model import fit_normal_model
from jointwear.robots.robot import Robot, inertia_entries, inertia_matrix, load_robot
from jointwear.studies.monitor_study.confounders import (
    JUDGED,
    LEARNT,
    NORMAL,
    SAMPLES,
    WEAR_HOURS,
    Factory,
    motion_at,
)
from jointwear.studies.monitor_study.runs import learn
from jointwear.studies.monitor_study.scores import chart, factor_for, first_hour, reset_alarms

#: Rate asked of both detectors, hours of the week that discovery is given, and how often it may be run.
RATE, RECORDINGS, ROUNDS = 1.0, 28, 3
WEEK = 168


def write_recording_of_week(factory: Factory, path: Path) -> None:
    """Write hours of the week after the normal period as a data set for discovery, one trajectory an hour."""
    hours = np.linspace(NORMAL, NORMAL + LEARNT - 1, RECORDINGS).astype(int)
    week = factory.torque(slice(NORMAL, NORMAL + LEARNT), 1, "learnt")[0]
    rows: dict[str, list[np.ndarray]] = {k: [] for k in ("time", "label", "q", "v", "a", "torque", "temperature")}
    for k, hour in enumerate(hours):
        m = motion_at(float(factory.conditions.speed[hour]))
        rows["time"].append(3600.0 * hour + m.time)
        rows["label"].append(np.full(SAMPLES, k))
        for name, values in (("q", m.position), ("v", m.velocity), ("a", m.acceleration)):
            rows[name].append(values)
        rows["torque"].append(week[hour - NORMAL].astype(float))
        rows["temperature"].append(np.full(SAMPLES, factory.measured_temperature(slice(hour, hour + 1))[0]))
    whole = {name: np.concatenate(values) for name, values in rows.items()}
    pair = ("time", "joint")
    variables = {
        "joint": Variable(("joint",), np.arange(1, whole["q"].shape[1] + 1), "number of the joint", "1"),
        "time": Variable(("time",), whole["time"], "time", "s"),
        "trajectory": Variable(("time",), whole["label"], "hour of the recording", "1"),
        "position": Variable(pair, whole["q"], "joint position", "rad"),
        "velocity": Variable(pair, whole["v"], "joint velocity", "rad/s"),
        "acceleration": Variable(pair, whole["a"], "joint acceleration", "rad/s2"),
        "torque": Variable(pair, whole["torque"], "joint torque", "N m"),
        "temperature": Variable(("time",), whole["temperature"], "temperature of the joints", "degC"),
    }
    write_dataset(path, variables, {"title": "log of a simulated arm in a factory"})


def discover_effects(factory: Factory, robot: str | Path, folder: Path) -> tuple[list[dict[str, Any]], Path]:
    """Give a week of logs to discovery; return its decisions and the file of the augmented robot.

    Discovery names a few effects at a time: it is run again on the augmented robot while it names new ones.
    """
    folder.mkdir(parents=True, exist_ok=True)
    measured = folder / "log.nc"
    write_recording_of_week(factory, measured)
    decisions: list[dict[str, Any]] = []
    current = Path(robot)
    for turn in range(1, ROUNDS + 1):
        place = folder / f"round_{turn}"
        place.mkdir(exist_ok=True)
        entry = {"measured": str(measured), "robot": str(current), "inertial_prior": 0.05}
        found = discover_dataset(f"factory_{factory.scenario}", entry, current, place)
        decisions.append(found.data)
        if not decisions[-1]["effects"] and turn > 1:
            break
        current = place / "robot_of_bodies.yaml"
        replace_text(current, yaml.safe_dump(of_bodies(found.augmented_robot), sort_keys=False, width=120))
    return decisions, current


def of_bodies(data: dict[str, Any]) -> dict[str, Any]:
    """Return a robot file's content with the nearest inertia that a body can have on every link.

    An estimated inertia may have negative principal moments, a little below zero, where the motion hardly shows them.
    """
    for link in data.get("links", []):
        moments, axes = np.linalg.eigh(inertia_matrix(link.get("inertia")))
        if moments[0] < 0:
            link["inertia"] = inertia_entries((axes * np.maximum(moments, 1e-9)) @ axes.T)
    return data


def models_of(nominal: Robot, augmented: str | Path, folder: Path) -> dict[bool, Robot]:
    """Return the augmented robot without and with what discovery says of the load, which only holds with the tool."""
    data = yaml.safe_load(Path(augmented).read_text(encoding="utf-8"))
    data["effects"] = [e for e in data.get("effects", []) if e["effect"] != "payload"]
    bare = folder / "robot_without_tool.yaml"
    replace_text(bare, yaml.safe_dump(data, sort_keys=False, width=120))
    return {False: replace(load_robot(bare), payload=nominal.payload), True: load_robot(augmented)}


class PaperDetector:
    """The paper's detector on torque (r, h, s, n): fitted on the normal hours of each replicate."""

    def __init__(self, normal: np.ndarray, settings: Mapping[str, Any]) -> None:
        self._settings, reading = settings, settings["reading"]
        self._reference = build_reference(normal.astype(float), settings["bins"], reading)
        series = self._kl(normal)
        self._moving = np.flatnonzero(series.std(axis=1).min(axis=0) > 1e-12)
        self._model = fit_normal_model(
            series[..., self._moving], settings["confidence"], settings["variance_share"], reading
        )

    def _kl(self, torque: np.ndarray) -> np.ndarray:
        s = self._settings
        return hourly_features(torque.astype(float), self._reference, s["bins"], s["reading"])["kl_divergence"]

    def ratio(self, torque: np.ndarray) -> np.ndarray:
        """Return Q over its limit (r, h)."""
        q, _ = score(self._kl(torque)[..., self._moving], self._model)
        return q / self._model.q_limit[:, None]


def study_factory(
    robot: str | Path, scenario: str, output: str | Path, decision: str | Path, settings: Mapping[str, Any]
) -> None:
    """Measure one scenario.

    Parameters
    ----------
    robot : the nominal model. scenario : of :data:`jointwear.studies.monitor_study.confounders.SCENARIOS`.
    output : netCDF file. decision : what discovery said, JSON; its other files go beside it.
    settings : `seed`, `factory_replicates`, `consecutive_hours`, and for the paper's detector `bins`, `confidence`,
        `variance_share`, `reading`.
    """
    nominal, folder = load_robot(robot), Path(decision).parent
    steady = Factory(nominal, None, settings["seed"])
    factory = Factory(nominal, scenario, settings["seed"])
    said, augmented = discover_effects(factory, robot, folder)
    write_json(decision, {"rounds": said})
    uncorrected, corrected = {False: nominal, True: nominal}, models_of(nominal, augmented, folder)
    results = {
        "steady": _measure(steady, uncorrected, settings, NORMAL, residual=False),
        "uncorrected": _measure(factory, uncorrected, settings, NORMAL, residual=False),
        "longer": _measure(factory, uncorrected, settings, NORMAL + LEARNT, residual=False),
        "corrected": _measure(factory, corrected, settings, NORMAL + LEARNT, residual=True),
    }
    n = nominal.joints
    variables = {
        "axis": Variable(("axis",), np.arange(1, n + 1), "axis of the robot", "1"),
        "case": Variable(("case",), np.array(list(results)), "conditions and model"),
        "detector": Variable(("detector",), np.array(["model", "paper"]), "detector"),
    }
    for name, dims, meaning, unit in (
        ("false", ("case", "detector"), "false alarms in the judged normal hours", "1"),
        (
            "hour",
            ("case", "detector", "axis", "replicate"),
            "hour at which the worn axis alarms; with the paper's detector, which names none, any alarm",
            "h",
        ),
        ("located", ("case", "axis", "replicate"), "1 where the model's first alarm names the worn axis", "1"),
    ):
        variables[name] = Variable(dims, np.array([r[name] for r in results.values()]), meaning, unit)
    attributes = provenance.attributes(f"factory scenario {scenario}", dict(settings))
    attributes |= {
        "scenario": scenario,
        "weeks": settings["factory_replicates"] * JUDGED / WEEK,
        "rate_per_1000_h": RATE,
    }
    write_dataset(output, variables, attributes)


def _measure(
    factory: Factory, models: Mapping[bool, Robot], settings: Mapping[str, Any], learnt: int, residual: bool
) -> dict[str, np.ndarray]:
    """Return `false` (detector,), `hour` (detector, n, r) and `located` (n, r) of a factory under a model.

    The first `learnt` hours are the normal period. The paper's detector sees the torque, or, where `residual`, what
    the corrected model leaves of it.
    """
    count, n = settings["factory_replicates"], factory.real.joints
    first, judged = slice(0, learnt), slice(NORMAL + LEARNT, NORMAL + LEARNT + JUDGED)
    worn_hours = slice(judged.start, judged.start + WEAR_HOURS)

    def both(hours: slice, key: str, axis: int | None, replicates: int):
        torque = factory.torque(hours, replicates, key, axis)
        model, regressions = factory.model_torque(models, hours)
        left = torque - model.astype(np.float32)
        return factory.sums(left, regressions, hours), left if residual else torque, regressions

    sums, seen, regressions = both(first, "normal", None, count)
    normal = learn(sums, regressions[1.0])
    paper = PaperDetector(seen, settings)
    # The paper's limit is raised on hours like the normal period, so that conditions do not choose it.
    _, quiet_seen, _ = both(first, "quiet", None, count)
    factor = factor_for(paper.ratio(quiet_seen), RATE, settings["consecutive_hours"])
    sums, seen, _ = both(judged, "judged", None, count)
    false = [
        chart(sums, normal, RATE).trace.alarm.sum(),
        reset_alarms(paper.ratio(seen), factor, settings["consecutive_hours"]).sum(),
    ]
    hour, located = np.full((2, n, count), np.nan), np.zeros((n, count))
    for axis in range(n):
        sums, seen, _ = both(worn_hours, "worn", axis, count)
        charted = chart(sums, normal, RATE)
        hour[0, axis] = charted.axis_hour(axis)
        located[axis] = charted.named == axis + 1
        alarm = reset_alarms(paper.ratio(seen), factor, settings["consecutive_hours"])
        hour[1, axis] = first_hour(alarm)
    return {"false": np.array(false), "hour": hour, "located": located}
