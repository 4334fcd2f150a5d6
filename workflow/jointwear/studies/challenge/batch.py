"""Generate one batch of cases as files."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import Any

from jointwear.files.json_documents import write_json
from jointwear.robots.robot import load_robot
from jointwear.studies.challenge.arms import ARMS, arm_of, arm_path
from jointwear.studies.challenge.case_files import write_case_data, write_truth
from jointwear.studies.challenge.generate import INERTIAL_PRIOR, generate
from jointwear.studies.challenge.plan import Case
from jointwear.studies.challenge.tracking import ArmLost


def generate_batch(
    cases: list[Case],
    seed: int,
    folder: str | Path,
    truth_json: str | Path,
    truth_netcdf: str | Path,
) -> None:
    """Write the data sets of a batch into `folder`, their list into `cases.json` there, and the truth elsewhere.

    A case whose arm no controller keeps on its paths is left out, and said so.

    Raises
    ------
    InputError : if the robot file of an arm is missing or broken.
    """
    folder = Path(folder)
    folder.mkdir(parents=True, exist_ok=True)
    listed, truths = [], []
    for case in cases:
        arm = arm_of(case, seed)
        try:
            data, truth = generate(case, load_robot(arm_path(arm)), seed)
        except ArmLost as lost:
            print(f"{case.name} is no case: {lost}", file=sys.stderr)
            continue
        settings: dict[str, Any] = {"seed": seed, "robot": ARMS[arm][0], **data.told}
        write_case_data(folder / f"{case.name}.nc", data, "Data set of the hidden-effect test", settings)
        listed.append(
            {
                "case": case.name,
                "file": f"{case.name}.nc",
                "robot": ARMS[arm][0],
                "told": dict(data.told),
                "train": list(data.train),
                "test": list(data.test),
            }
        )
        truths.append(truth)
    write_truth(truth_json, truth_netcdf, truths, {"seed": seed})
    content = {"inertial_prior": INERTIAL_PRIOR, "cases": listed}
    write_json(folder / "cases.json", content)
