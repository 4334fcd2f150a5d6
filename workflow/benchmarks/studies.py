"""The long studies: time of `recover` and `multiverse` from nothing, and what sharing saves in the multiverse.

Prints JSON. Takes half an hour.
"""

from __future__ import annotations

import json
import tempfile
from pathlib import Path

import yaml

from jointwear.reproduction.published import load_published
from jointwear.studies.multiverse.design import read_design
from jointwear.studies.multiverse.naive import measure_sharing
from jointwear.studies.multiverse.pose_sets import configured_pose_set
from jointwear.studies.multiverse.settings import analysis_of, experiment_of
from workflow import CORES, copy_project, seconds

REPLICATES = 4


def sharing(folder: Path) -> dict[str, float]:
    """Compare the readings of the design in `folder` done together with a sample done one at a time."""
    config = yaml.safe_load((folder / "config/config.yaml").read_text(encoding="utf-8"))
    settings = {
        "bins": config["histogram"]["bins"],
        "confidence": config["detection"]["confidence"],
        "variance_share": config["detection"]["variance_share"],
        "seed": config["seed"],
        "noise": config["noise"],
        "sampling": config["sampling"],
        "wear_hours": config["wear"]["hours"],
        "normal_hours": config["normal"]["test_hours"],
    }
    points = read_design(folder / "results/multiverse/design.csv")
    poses = configured_pose_set(folder / config["robot"], [folder / f"config/tasks/T{k}.yaml" for k in (1, 2, 3)])
    analysis = analysis_of(settings, load_published(folder / "config/paper/published.yaml"))
    experiment = experiment_of(settings, REPLICATES)
    return measure_sharing([p.reading for p in points], poses, experiment, analysis, replicates=REPLICATES)


def main() -> None:
    """Measure and print."""
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        copy_project(folder)
        run = ["--cores", str(CORES)]
        recover = seconds([*run, "recover"], folder)
        multiverse = seconds([*run, "multiverse"], folder)
        shared = sharing(folder)
    print(
        json.dumps(
            {
                "cores": CORES,
                "recover_seconds": round(recover),
                "multiverse_seconds": round(multiverse),
                "multiverse_readings": round(shared["readings"]),
                "processor_seconds_a_reading_shared": round(shared["shared_seconds"], 4),
                "processor_seconds_a_reading_alone": round(shared["naive_seconds"], 3),
                "alone_against_shared": round(shared["ratio"], 1),
            }
        )
    )


if __name__ == "__main__":
    main()
