"""Run every measurement, print it, compare it with its target and store it in data/benchmarks/results.json."""

from __future__ import annotations

import argparse
import json
import os
import platform
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
HERE = Path(__file__).resolve().parent
ROBOT, TASK = "config/robots/puma560.yaml", "config/tasks/T2.yaml"

# (part, key, comparison, target, unit)
TARGETS = [
    ("workflow", "full_seconds", "<=", 60, "s"),
    ("workflow", "nothing_to_do_against_version", "<=", 1.3, "x"),
    ("workflow", "results_megabytes", "<=", 1000, "MB"),
    ("dynamics", "two_threads_against_batched", ">=", 2, "x"),
    ("dynamics", "two_threads_against_per_call", ">=", 15, "x"),
    ("dynamics", "largest_difference_nm", "<=", 1e-9, "N m"),
    ("simulation", "samples_per_second_all_cores", ">=", 1_000_000, "/s"),
    ("memory", "largest_mib", "<=", 1024, "MiB"),
    ("monitor", "week_minutes", "<=", 10, "min"),
    ("monitor", "largest_mib", "<=", 2048, "MiB"),
    ("monitor", "against_per_call", ">=", 5, "x"),
    ("scaling", "useful_share_of_largest_fleet", ">=", 0.8, ""),
    ("shop_floor", "fleet_seconds", "<=", 60, "s"),
    ("shop_floor", "new_day_seconds", "<=", 10, "s"),
    ("shop_floor", "samples_processor_seconds", "<=", 5, "s"),
    ("shop_floor", "largest_mib", "<=", 1024, "MiB"),
    ("studies", "multiverse_seconds", "<=", 900, "s"),
]
OUTPUT = ROOT / "data" / "benchmarks" / "results.json"


def measure(python: str, script: str, *arguments: str) -> dict:
    """Run one measurement in a process of its own and return what it prints."""
    environment = {**os.environ, "PYTHONPATH": str(ROOT / "workflow"), "OMP_PROC_BIND": "false"}
    done = subprocess.run(
        [python, str(HERE / script), *arguments], capture_output=True, text=True, check=False, cwd=ROOT, env=environment
    )
    if done.returncode:
        sys.exit(f"{script} failed:\n{done.stderr[-4000:]}")
    return json.loads(done.stdout.strip().splitlines()[-1])


def parts(peers: str) -> dict[str, Callable[[], dict]]:
    """Return every part of the measurement by name; `peers` is the Python that has the peers."""
    return {
        "dynamics": lambda: measure(peers, "dynamics.py", ROBOT),
        "simulation": lambda: measure(sys.executable, "simulation.py", ROBOT, TASK),
        "memory": lambda: measure(sys.executable, "simulation.py", ROBOT, TASK, "--memory", "--replicates", "1000"),
        "workflow": lambda: measure(sys.executable, "workflow.py"),
        "studies": lambda: measure(sys.executable, "studies.py"),
        "monitor": lambda: measure(peers, "monitor.py", ROBOT, TASK),
        "reruns": lambda: measure(sys.executable, "reruns.py"),
        "scaling": lambda: measure(sys.executable, "scaling.py"),
        "shop_floor": lambda: measure(sys.executable, "shop_floor.py"),
    }


def main() -> None:
    """Measure everything, or the parts that are named; parts not measured keep their last result."""
    parser = argparse.ArgumentParser()
    parser.add_argument("--peers", required=True, help="Python of the environment that has the peers")
    parser.add_argument("parts", nargs="*", help="what to measure; default everything")
    given = parser.parse_args()
    known = parts(given.peers)
    unknown = [name for name in given.parts if name not in known]
    if unknown:
        parser.error(f"no part is called {unknown[0]}; there are {', '.join(known)}")
    results = json.loads(OUTPUT.read_text(encoding="utf-8")) if OUTPUT.is_file() else {}
    results["machine"] = {"cores": os.cpu_count(), "python": platform.python_version(), "system": platform.system()}
    for name in given.parts or known:
        results[name] = known[name]()
        print(json.dumps({name: results[name]}, indent=2), flush=True)
    targets = [t for t in TARGETS if t[0] in results]
    if "workflow" in results:
        flow = results["workflow"]
        flow["edit_confidence_allowed_seconds"] = max(15.0, round(0.25 * flow["full_seconds"], 1))
        targets.append(("workflow", "edit_confidence_seconds", "<=", flow["edit_confidence_allowed_seconds"], "s"))
    missed = 0
    for part, key, comparison, target, unit in targets:
        value = results[part][key]
        reached = value <= target if comparison == "<=" else value >= target
        missed += not reached
        word = "reached" if reached else "MISSED "
        print(f"{word}  {part}.{key} = {value:g} {unit}, target {comparison} {target:g}")
    results["missed"] = missed
    OUTPUT.parent.mkdir(exist_ok=True)
    OUTPUT.write_text(json.dumps(results, indent=2) + "\n", encoding="utf-8")
    print(f"stored in {OUTPUT.relative_to(ROOT)}")


if __name__ == "__main__":
    main()
