"""How time, memory and disk grow: replicates 10 to 10,000, readings 10 to 5,000, a fleet of 1 to 1,000 robots.

Every point runs in a process of its own. Prints JSON: the points, the growth exponent between neighbours and over the
largest three, where growth bends (the size at which the part that grows equals the part that does not), and a plan
for a fleet of 10,000 robots.

    PYTHONPATH=workflow python workflow/benchmarks/scaling.py [--quick]
"""

from __future__ import annotations

import argparse
import itertools
import json
import math
import os
import re
import resource
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable, Iterable
from pathlib import Path

import numpy as np

from jointwear.running.processes import one_thread_each

ROOT = Path(__file__).resolve().parents[2]
ROBOT, TASK = "config/robots/puma560.yaml", "config/tasks/T2.yaml"
SIZES = {
    "replicates": (10, 30, 100, 300, 1000, 3000, 10_000),
    "readings": (10, 50, 200, 1000, 5000),
    "robots": (1, 10, 100, 1000),
}
QUICK = {"replicates": (10, 30, 100), "readings": (10, 30), "robots": (1, 4)}
HOURS = 48  # of logs that every robot of the fleet brings
ARMS = 20  # different simulated arms, used in turn
PLANNED = 10_000
FEWEST_READINGS, SIMULATIONS = 60, 16  # readings of the smallest design; simulations that readings share


def replicates(count: int, folder: Path) -> None:
    """Run one cell with so many replicates through every stage."""
    import simulation as bench

    for stage in bench.STAGES:
        bench.memory_of(stage, folder, ROBOT, TASK, count)


def readings(count: int, folder: Path) -> None:
    """Run so many readings of the paper on one task, the paper's twelve cells and two replicates."""
    import yaml

    from jointwear.reproduction.published import load_published
    from jointwear.studies.multiverse.design import build_design
    from jointwear.studies.multiverse.dimensions import default_reading, dimensions
    from jointwear.studies.multiverse.evaluation import evaluate
    from jointwear.studies.multiverse.pose_sets import configured_pose_set
    from jointwear.studies.multiverse.records import write_outcomes
    from jointwear.studies.multiverse.settings import analysis_of, experiment_of

    config = yaml.safe_load((ROOT / "config/config.yaml").read_text(encoding="utf-8"))
    default = default_reading(config["reading"], config["wear"]["shape"], config["detection"]["consecutive_hours"])
    # A design needs one reading for every alternative; of a smaller number the first are taken.
    points = build_design(dimensions(default), max(count, FEWEST_READINGS), 0, SIMULATIONS, config["seed"])[:count]
    settings = {
        "seed": config["seed"],
        "noise": config["noise"],
        "sampling": config["sampling"],
        "wear_hours": config["wear"]["hours"],
        "normal_hours": config["normal"]["test_hours"],
        "bins": config["histogram"]["bins"],
        "confidence": config["detection"]["confidence"],
        "variance_share": config["detection"]["variance_share"],
    }
    published = load_published(ROOT / "config/paper/published.yaml")
    outcomes = evaluate(
        [p.reading for p in points],
        configured_pose_set(config["robot"], ["config/tasks/T1.yaml"]),
        experiment_of(settings, 2),
        analysis_of(settings, published),
    )
    write_outcomes(folder / "outcomes.nc", outcomes, list(range(len(points))), settings)


def write_logs(folder: Path) -> list[Path]:
    """Write the logs of the simulated arms; the last third of them wear."""
    from jointwear.robots.robot import load_robot
    from jointwear.statistics.randomness import generator
    from jointwear.studies.monitor_study.example import real_arm, simulate_day, write_netcdf

    paths = []
    for arm in range(ARMS):
        real = real_arm(load_robot(ROOT / ROBOT), generator(arm, "fleet", replicate=0))
        days = [simulate_day(real, day) for day in range(HOURS // 24)]
        paths.append(folder / f"arm_{arm:02d}.nc")
        paths[-1].parent.mkdir(parents=True, exist_ok=True)
        write_netcdf(paths[-1], *(np.concatenate(parts) for parts in zip(*days, strict=True)))
    return paths


def fleet(count: int, folder: Path) -> dict:
    """Watch a fleet through Snakemake; return what `measure` cannot see: useful time and number of jobs."""
    import yaml

    from workflow import copy_project

    copy_project(folder)
    arms = write_logs(folder / "logs")
    entry = {
        "robot": ROBOT,
        "window": "1h",
        "baseline": {"windows": HOURS // 2},
        "limits": {"coulomb_increase_percent": 20},
        "false_alarms_per_1000_h": 1,
    }
    robots = {
        f"robot_{number:05d}": {**entry, "logs": [str(arms[number % ARMS].relative_to(folder))]}
        for number in range(count)
    }
    (folder / "fleet.yaml").write_text(yaml.safe_dump({"monitor": {"robots": robots}}), encoding="utf-8")
    snakemake = str(Path(sys.executable).parent / "snakemake")
    cores = os.cpu_count() or 1
    call = [snakemake, "--cores", str(cores), "fleet", "--configfile", "fleet.yaml"]
    begin = time.perf_counter()
    done = subprocess.run(call, cwd=folder, capture_output=True, text=True, check=False)
    wall = time.perf_counter() - begin
    if done.returncode:
        sys.exit(f"fleet of {count} failed:\n{done.stderr[-3000:]}")
    spent = resource.getrusage(resource.RUSAGE_CHILDREN)
    core_seconds = spent.ru_utime + spent.ru_stime
    batches = [json.loads(p.read_text(encoding="utf-8")) for p in (folder / "results/fleet/batches").glob("*.json")]
    useful = sum(batch["process_seconds"] for batch in batches)
    refused = sum(row["result"] != "judged" for batch in batches for row in batch["robots"])
    if refused:
        sys.exit(f"fleet of {count}: {refused} robots were refused")
    jobs = int(re.search(r"of (\d+) steps \(100%\) done", done.stdout + done.stderr)[1])
    return {
        "jobs": jobs,
        "wall_seconds": round(wall, 1),
        "core_seconds": round(core_seconds, 1),
        "useful_seconds": round(useful, 1),
        "useful_share": round(useful / core_seconds, 3),
        "overhead_seconds_a_job": round((core_seconds - useful) / jobs, 2),
        "megabytes": round(sum(p.stat().st_size for p in (folder / "results").rglob("*") if p.is_file()) / 1e6, 2),
    }


POINTS: dict[str, Callable[[int, Path], dict | None]] = {
    "replicates": replicates,
    "readings": readings,
    "robots": fleet,
}


def measure(kind: str, size: int) -> dict:
    """Run one point in this process; its processor time [s], peak memory [MiB] and disk [MB]."""
    with tempfile.TemporaryDirectory() as name:
        more = POINTS[kind](size, Path(name)) or {}
        written = sum(p.stat().st_size for p in Path(name).rglob("*") if p.is_file())
    own, children = resource.getrusage(resource.RUSAGE_SELF), resource.getrusage(resource.RUSAGE_CHILDREN)
    # Linux gives kibibytes.
    peak = max(own.ru_maxrss, children.ru_maxrss) / 1024
    point = {
        "size": size,
        "core_seconds": round(own.ru_utime + own.ru_stime, 2),
        "peak_mib": round(peak),
        "megabytes": round(written / 1e6, 2),
    }
    return {**point, **more}


def exponent(points: Iterable[dict], key: str) -> float | None:
    """Return b of key = a size^b by least squares in logarithms; None where the key is zero."""
    pairs = [(p["size"], p[key]) for p in points if p[key] > 0]
    if len(pairs) < 2:
        return None
    x, y = np.log(np.array(pairs, dtype=float)).T
    return round(float(np.polyfit(x, y, 1)[0]), 2)


def bend(points: list[dict], key: str) -> float | None:
    """Return the size at which the part of key = a + b size that grows equals the part that does not.

    b is the slope between the two largest points, a what the smallest point costs beyond it.
    """
    (small, *_, before, last) = points if len(points) > 2 else (points[0], points[0], points[-1])
    slope = (last[key] - before[key]) / (last["size"] - before["size"])
    fixed = small[key] - slope * small["size"]
    return None if slope <= 0 or fixed <= 0 else float(f"{fixed / slope:.2g}")


def growth(points: list[dict]) -> dict:
    """Return exponents between neighbours and over the largest three points, and the bend, of time, memory, disk."""
    found = {}
    for key in ("core_seconds", "peak_mib", "megabytes"):
        between = [exponent(pair, key) for pair in itertools.pairwise(points)]
        found[key] = {"between": between, "largest": exponent(points[-3:], key), "bend": bend(points, key)}
    return found


def plan(points: list[dict]) -> dict:
    """Return what a fleet of 10,000 robots costs a day, from the largest fleet measured."""
    last = points[-1]
    factor = PLANNED / last["size"] * 24 / HOURS
    core_hours = last["core_seconds"] * factor / 3600
    return {
        "robots": PLANNED,
        "measured_on": last["size"],
        "core_hours_a_day": round(core_hours, 1),
        "cores_for_one_hour_a_day": math.ceil(core_hours),
        "results_gigabytes_a_day": round(last["megabytes"] * factor / 1000, 2),
        "jobs_a_day": math.ceil(last["jobs"] * PLANNED / last["size"]),
        "largest_job_mib": last["peak_mib"],
        "useful_share": last["useful_share"],
    }


def main() -> None:
    """Measure every point, each in a process of its own, and print."""
    parser = argparse.ArgumentParser()
    parser.add_argument("--quick", action="store_true", help="small sizes, to see that it runs")
    parser.add_argument("--point", nargs=2, metavar=("KIND", "SIZE"))
    given = parser.parse_args()
    if given.point:
        print(json.dumps(measure(given.point[0], int(given.point[1]))))
        return
    one_thread_each()  # as Snakemake starts a job: idle threads would count as time spent
    found = {}
    for kind, sizes in (QUICK if given.quick else SIZES).items():
        points = []
        for size in sizes:
            call = [sys.executable, __file__, "--point", kind, str(size)]
            done = subprocess.run(call, capture_output=True, text=True, check=False, cwd=ROOT)
            if done.returncode:
                sys.exit(f"{kind} {size} failed:\n{done.stderr[-3000:]}")
            points.append(json.loads(done.stdout.strip().splitlines()[-1]))
            print(kind, points[-1], file=sys.stderr, flush=True)
        found[kind] = {"points": points, "growth": growth(points)}
    found["plan"] = plan(found["robots"]["points"])
    found["useful_share_of_largest_fleet"] = found["plan"]["useful_share"]
    print(json.dumps(found))


if __name__ == "__main__":
    main()
