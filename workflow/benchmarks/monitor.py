"""From a log to friction estimates: this project against the same estimate written with roboticstoolbox-python's rne.

A log of a PUMA 560 at 100 Hz is written and turned into window statistics, reading and derivation included; the peer
gets the motion for nothing and works on a part of it, sample by sample as its functions are called, and batched. Run
with the Python of .venv-bench; prints JSON. Times are those of the processor; the time
of a week counts 60 million samples on two cores, a log a core.
"""

from __future__ import annotations

import json
import resource
import sys
import tempfile
import time
from pathlib import Path

import numpy as np
import roboticstoolbox

from jointwear.files.storage import Variable, create_dataset
from jointwear.measurement.formats import layout_of
from jointwear.monitor.reading.logs import log_statistics
from jointwear.monitor.reading.model import TorqueModel
from jointwear.monitor.reading.survey import survey_log
from jointwear.robots.robot import load_robot
from jointwear.robots.trajectory import load_task

SAMPLES, RATE, WINDOW = 2_000_000, 100.0, 3600.0
CALLS, WEEK, CORES = 6_000, 60_000_000, 2
AXES = 6


def write_log(path: Path, model: TorqueModel, task: str) -> tuple[np.ndarray, ...]:
    """Write a log with a Coulomb friction 10 % larger than nominal; return motion and torque of its first cycle."""
    motion = load_task(task).motion(np.arange(CALLS) / RATE)
    clean = model(motion.position, motion.velocity, motion.acceleration).total
    clean = clean + 0.1 * np.sign(motion.velocity) * model.robot.coulomb_positive
    random = np.random.default_rng(1)
    variables = {
        "time": Variable(("time",), None, "time", "s", kind="f8"),
        "position": Variable(("time", "joint"), None, "position", "rad", kind="f8"),
        "torque": Variable(("time", "joint"), None, "torque", "N m", kind="f4"),
    }
    with create_dataset(path, {"time": SAMPLES, "joint": AXES}, variables, {}) as dataset:
        for start in range(0, SAMPLES, CALLS):
            count = min(CALLS, SAMPLES - start)
            part = slice(start, start + count)
            noise = 0.02 * np.std(clean, axis=0) * random.standard_normal((count, AXES))
            dataset["time"][part] = (start + np.arange(count)) / RATE
            dataset["position"][part] = motion.position[:count] + 1e-5 * random.standard_normal((count, AXES))
            dataset["torque"][part] = clean[:count] + noise
    return motion.position, motion.velocity, motion.acceleration, clean


def fit(gram: np.ndarray, moment: np.ndarray) -> np.ndarray:
    """Coefficients (axis, column); columns that show nothing get 0."""
    scale = np.sqrt(np.maximum(np.einsum("jpp->jp", gram), 1e-12))
    inverse = np.linalg.pinv(gram / scale[:, :, None] / scale[:, None, :], rcond=1e-9, hermitian=True)
    return np.einsum("jpk,jk->jp", inverse, moment / scale) / scale


def peer_estimate(peer, q, qd, qdd, torque, band, batched: bool) -> tuple[np.ndarray, float]:
    """The same regression with the peer's inverse dynamics; return coefficients and seconds."""
    start = time.process_time()
    if batched:
        total, gravity = peer.rne(q, qd, qdd), peer.rne(q, 0 * qd, 0 * qd)
    else:
        rest = np.zeros(AXES)
        total = np.array([peer.rne(a, b, c) for a, b, c in zip(q, qd, qdd, strict=True)])
        gravity = np.array([peer.rne(a, rest, rest) for a in q])
    coefficients = np.zeros((AXES, 5))
    for j in range(AXES):
        v = qd[:, j]
        used = np.abs(v) > band[j]
        if not used.any():
            continue
        friction = peer.links[j].friction
        own = np.array([-friction(x) for x in v[used]])
        rigid = total[used, j] - own
        columns = [v[used] > 0, -1.0 * (v[used] < 0), v[used], gravity[used, j], rigid - gravity[used, j]]
        x = np.stack(columns, axis=1).astype(float)
        coefficients[j] = fit((x.T @ x)[None], (x.T @ (torque[used, j] - total[used, j]))[None])[0]
    return coefficients, time.process_time() - start


def main(robot: str, task: str) -> None:
    """Measure and print."""
    model, peer = TorqueModel(load_robot(robot)), roboticstoolbox.models.DH.Puma560()
    layout = layout_of({}, model.robot.joint_names)
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "log.nc"
        q, qd, qdd, clean = write_log(path, model, task)
        survey = survey_log(str(path), layout, model, WINDOW)
        start = time.process_time()
        found = log_statistics(str(path), layout, model, survey, WINDOW).statistics
        ours = (time.process_time() - start) / SAMPLES
    band = np.array(survey.dead_band)
    batched, seconds_batched = peer_estimate(peer, q, qd, qdd, clean, band, batched=True)
    single, seconds_single = peer_estimate(peer, q, qd, qdd, clean, band, batched=False)
    mean = fit(found.gram.sum(axis=0), found.moment.sum(axis=0))[:, :2].mean(axis=1)
    coulomb = model.robot.coulomb_positive
    moving = found.count.sum(axis=0) > 0
    print(
        json.dumps(
            {
                "microseconds_per_sample": round(1e6 * ours, 3),
                "peer_per_call_microseconds": round(1e6 * seconds_single / CALLS, 2),
                "peer_batched_microseconds": round(1e6 * seconds_batched / CALLS, 2),
                "against_per_call": round(seconds_single / CALLS / ours, 1),
                "against_batched": round(seconds_batched / CALLS / ours, 2),
                "week_minutes": round(WEEK * ours / CORES / 60, 2),
                "largest_mib": round(resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024),
                "largest_difference_percent": round(
                    100 * float(np.abs(mean - single[:, :2].mean(axis=1))[moving].max() / coulomb[moving].min()), 3
                ),
                "batched_difference": float(np.abs(batched - single).max()),
            }
        )
    )


if __name__ == "__main__":
    main(*sys.argv[1:])
