"""The simulation step: samples per second, the shares of its parts, and memory of a cell with many replicates.

Prints JSON. With `--memory` it runs one cell through every stage and prints the peak resident memory of each.
"""

from __future__ import annotations

import argparse
import json
import os
import resource
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import numpy as np

from jointwear.reproduction import readings
from jointwear.reproduction.grid import Cell
from jointwear.reproduction.simulation import Noise, RepeatedTask
from jointwear.reproduction.wear import Wear
from jointwear.reproduction.worn_run import coulomb_levels, simulate_worn_run
from jointwear.robots.dynamics import Dynamics
from jointwear.robots.robot import load_robot
from jointwear.robots.trajectory import load_task
from jointwear.statistics.randomness import generator

CELL = Cell("T2", 10.0, 3)
HOURS = 120


def settings(replicates: int) -> dict:
    """Settings of a run with the default readings."""
    return {
        "seed": 1,
        "replicates": replicates,
        "sampling": {"interval": 10.0, "samples": 60},
        "noise": {"disturbance_share": 0.01, "encoder": 1e-4, "time_step": 0.5},
        "reading": chosen("simulation"),
        "shape": 1.5,
        "wear_hours": HOURS,
    }


def chosen(stage: str) -> dict[str, str]:
    """Default alternatives of one stage."""
    return {name: readings.ambiguities()[name].default for name in readings.of_stage(stage)}


def step(robot: str, task: str, output: Path, replicates: int, threads: int) -> float:
    """Shortest of three times [s] of the whole step: models, noise, dynamics, writing."""
    times = []
    for _ in range(3):
        start = time.perf_counter()
        simulate_worn_run(robot, task, output, cell=CELL, settings=settings(replicates), threads=threads)
        times.append(time.perf_counter() - start)
    return min(times)


def shares(robot: str, task: str, replicates: int) -> dict:
    """Time the whole step once, and its parts alone."""
    with tempfile.TemporaryDirectory() as folder:
        whole, both = (
            step(robot, task, Path(folder) / "run.nc", replicates, threads) for threads in (1, os.cpu_count() or 1)
        )
        raw = np.zeros((HOURS, 60, 6), dtype="f4")
        start = time.perf_counter()
        with open(Path(folder) / "raw", "wb") as file:
            for _ in range(replicates):
                file.write(raw.tobytes())
        writing = time.perf_counter() - start
    dynamics = Dynamics(load_robot(robot))
    hour = np.arange(1, HOURS + 1)
    levels = coulomb_levels(dynamics, hour, CELL.axis, Wear(CELL.increase_percent, 1.5, HOURS))
    repeated = RepeatedTask(dynamics, load_task(task), levels, Noise(0.01, 1e-4, 0.5, chosen("simulation")))
    motion, shape = repeated.motion, repeated.torque.shape
    still = [np.broadcast_to(a, shape).copy() for a in (motion.position, motion.velocity, motion.acceleration)]
    start = time.perf_counter()
    for _ in range(replicates):
        dynamics.inverse_dynamics(*still, repeated.coulomb, motion.velocity)
    dynamics_time = time.perf_counter() - start
    start = time.perf_counter()
    for replicate in range(replicates):
        random = generator(1, "bench", replicate=replicate)
        for _ in range(2):
            random.standard_normal(shape, dtype=np.float32)
    random_time = time.perf_counter() - start
    samples = replicates * HOURS * 60
    return {
        "samples_per_second_one_thread": round(samples / whole),
        "samples_per_second_all_cores": round(samples / both),
        "seconds_one_thread": round(whole, 3),
        "share_dynamics": round(dynamics_time / whole, 2),
        "share_random_numbers": round(random_time / whole, 2),
        "share_writing": round(writing / whole, 2),
    }


STAGES = ("simulate", "reference", "features", "model", "detection", "location")


def memory_of(stage: str, folder: Path, robot: str, task: str, replicates: int) -> None:
    """Run one stage in this process; the caller reads its peak memory."""
    bins = {"bins": 12, "reading": chosen("features")}
    detection = {"consecutive_hours": 5, "confidence": 0.95, "variance_share": 0.75, "reading": chosen("detection")}
    run, reference, features = folder / "run.nc", folder / "reference.nc", folder / "features.nc"
    model, onset = folder / "model.nc", folder / "onset.nc"
    if stage == "simulate":
        simulate_worn_run(robot, task, run, cell=CELL, settings=settings(replicates))
    elif stage == "reference":
        from jointwear.reproduction.features import write_reference

        write_reference(run, reference, bins)
    elif stage == "features":
        from jointwear.reproduction.features import write_features

        write_features(run, reference, features, bins)
    elif stage == "model":
        from jointwear.reproduction.normal_model import write_normal_model

        write_normal_model(features, model, detection)
    elif stage == "detection":
        from jointwear.reproduction.detection import write_detection

        write_detection(features, model, onset, detection)
    else:
        from jointwear.reproduction.location import write_location

        write_location(features, features, onset, folder / "location.nc", {"reading": chosen("location")})


def memory(robot: str, task: str, replicates: int) -> dict:
    """Peak resident memory [MiB] of every stage, each in a process of its own."""
    peaks = {}
    with tempfile.TemporaryDirectory() as folder:
        for stage in STAGES:
            command = [sys.executable, __file__, robot, task, "--stage", stage, "--folder", folder]
            done = subprocess.run(
                [*command, "--replicates", str(replicates)], check=True, capture_output=True, text=True
            )
            peaks[stage] = json.loads(done.stdout)
    return {"replicates": replicates, "peak_mib": peaks, "largest_mib": max(peaks.values())}


def main() -> None:
    """Measure and print JSON."""
    parser = argparse.ArgumentParser()
    parser.add_argument("robot")
    parser.add_argument("task")
    parser.add_argument("--replicates", type=int, default=100)
    parser.add_argument("--memory", action="store_true")
    parser.add_argument("--stage", choices=STAGES)
    parser.add_argument("--folder", type=Path)
    given = parser.parse_args()
    if given.stage:
        memory_of(given.stage, given.folder, given.robot, given.task, given.replicates)
        print(round(resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024))
    elif given.memory:
        print(json.dumps(memory(given.robot, given.task, given.replicates)))
    else:
        print(json.dumps(shares(given.robot, given.task, given.replicates)))


if __name__ == "__main__":
    main()
