"""What monitoring costs end to end, on logs of the simulated shop floor.

Ten robots of both types with a month of logs each are judged by one call of ``snakemake fleet``; a new day of logs
arrives for all of them; the logs of one robot around the clock (720,000 samples) are read and judged in a process of
their own. Writing the logs is not counted. Prints JSON; `largest_mib` is that of the largest process.
"""

from __future__ import annotations

import json
import os
import resource
import subprocess
import sys
import tempfile
import time
from pathlib import Path

from jointwear.studies.shop_floor.cell import draw_cell
from jointwear.studies.shop_floor.log_files import write_fleet, write_robot_logs
from jointwear.studies.shop_floor.month import DAYS

ROOT = Path(__file__).resolve().parents[2]
ROBOTS, SAMPLES, FIRST_DAYS = 10, 720_000, DAYS - 1
#: A process that reads and judges the logs of one robot as the only job of a machine does. Prints seconds, processor
#: seconds, those of the processes that it forks for reading among them, and memory [MiB] of the largest.
ALONE = """
import json, os, resource, sys, time
from pathlib import Path
import yaml
from jointwear.monitor.fleet.plan import processes_of_job
from jointwear.monitor.fleet.watch import watch_robot
from jointwear.running.script import reported
config, name = sys.argv[1:3]
entry = yaml.safe_load(Path(config).read_text())["monitor"]["robots"][name]
logs = sorted(str(p) for pattern in entry["logs"] for p in Path().glob(pattern))
WHOSE = resource.RUSAGE_SELF, resource.RUSAGE_CHILDREN
def processor():
    return sum(used.ru_utime + used.ru_stime for used in map(resource.getrusage, WHOSE))
begin, clock = processor(), time.perf_counter()
with reported(absent=["pandas"]):
    row = watch_robot(name, entry, logs, Path("alone"), processes=processes_of_job(1, len(os.sched_getaffinity(0))))
print(json.dumps({"seconds": round(time.perf_counter() - clock, 2), "processor": round(processor() - begin, 2),
    "mib": round(max(resource.getrusage(who).ru_maxrss for who in WHOSE) / 1024), "result": row["result"]}))
"""


def fleet(folder: Path) -> float:
    """Run `snakemake fleet` in a folder and return its seconds."""
    command = [sys.executable, "-m", "snakemake", "-s", str(ROOT / "Snakefile"), "--directory", str(folder)]
    begin = time.perf_counter()
    done = subprocess.run(
        [*command, "--cores", "2", "--configfile", str(folder / "fleet.yaml"), "--quiet", "all", "--", "fleet"],
        capture_output=True, text=True, check=False,
    )  # fmt: skip
    if done.returncode:
        sys.exit(done.stderr[-4000:])
    return time.perf_counter() - begin


def fleet_seconds(folder: Path) -> dict:
    """Return the seconds of a whole fleet, of a call with nothing new, and of a new day of logs of every robot."""
    write_fleet(folder, "choose", range(ROBOTS), days=range(FIRST_DAYS))
    whole, nothing = fleet(folder), fleet(folder)
    for index in range(ROBOTS):
        cell = draw_cell("choose", index)
        write_robot_logs(cell, folder / "logs" / cell.name, range(FIRST_DAYS, DAYS))
    return {
        "robots": ROBOTS,
        "fleet_seconds": round(whole, 1),
        "nothing_new_seconds": round(nothing, 1),
        "new_day_seconds": round(fleet(folder), 1),
    }


def samples_seconds(folder: Path) -> dict:
    """Return the seconds in which the logs of one robot around the clock are read and judged."""
    steady = draw_cell("choose", 1)
    count, days = 0, 0
    while count < SAMPLES:
        count, days = count + int(steady.samples[steady.logged // 24 == days].sum()), days + 1
    write_fleet(folder, "choose", [1], days=range(days))
    done = subprocess.run(
        [sys.executable, "-c", ALONE, "fleet.yaml", steady.name],
        cwd=folder, env={**os.environ, "PYTHONPATH": str(ROOT / "workflow")},
        capture_output=True, text=True, check=False,
    )  # fmt: skip
    if done.returncode:
        sys.exit(done.stderr[-4000:])
    alone = json.loads(done.stdout.splitlines()[-1])
    return {
        "samples": count,
        "samples_seconds": alone["seconds"],
        "samples_processor_seconds": alone["processor"],
        "samples_result": alone["result"],
        "samples_mib": alone["mib"],
    }


def main(parts: list[str]) -> None:
    """Measure the parts asked for (`fleet`, `samples`; default both) and print."""
    measured = {"fleet": fleet_seconds, "samples": samples_seconds}
    result = {}
    for part in parts or list(measured):
        with tempfile.TemporaryDirectory() as folder:
            result |= measured[part](Path(folder))
    largest = max(resource.getrusage(who).ru_maxrss for who in (resource.RUSAGE_SELF, resource.RUSAGE_CHILDREN))
    print(json.dumps(result | {"largest_mib": round(largest / 1024)}))


if __name__ == "__main__":
    main(sys.argv[1:])
