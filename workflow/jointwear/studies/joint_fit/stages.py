"""The stages of the joint fit: files in, files out."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import asdict
from pathlib import Path
from typing import Any

import numpy as np

from jointwear.files import provenance
from jointwear.files.storage import Variable, open_dataset, read_variable, write_dataset
from jointwear.robots.robot import load_robot
from jointwear.statistics.randomness import generator
from jointwear.studies.joint_fit.confirmation import confirm_fast
from jointwear.studies.joint_fit.detection import READINGS, Grid
from jointwear.studies.joint_fit.levels import Noise
from jointwear.studies.joint_fit.paper import Prior, read_paper, shuffled_paper, synthetic_paper
from jointwear.studies.joint_fit.paper_fit import JointExperiment, PaperFit, Plan, choose_reading
from jointwear.studies.joint_fit.pose_search import Arm, LocalSearch
from jointwear.studies.joint_fit.posterior import read_confirmed
from jointwear.studies.joint_fit.records import read_experiments, write_confirmed, write_experiments
from jointwear.studies.joint_fit.trade import Emphasis, bases, search_on

KINDS = ("ours", "known", "shuffled")


def plan_of(settings: Mapping[str, Any]) -> Plan:
    """Return the effort from the fields of :class:`Plan` and, under `local`, of :class:`LocalSearch`."""
    return Plan(**{**settings, "local": LocalSearch(**settings.get("local", {}))})


def _grid(settings: Mapping[str, Any], increases: Sequence[float]) -> Grid:
    return Grid(
        tuple(float(v) for v in increases),
        settings["wear_hours"],
        settings["bins"],
        settings["confidence"],
        settings["variance_share"],
    )


def _noise(settings: Mapping[str, Any]) -> Noise:
    noise = settings["noise"]
    return Noise(noise["disturbance_share"], noise["encoder"], noise["time_step"])


def _paper_fit(robot: str | Path, published: str | Path, settings: Mapping[str, Any]) -> PaperFit:
    """The fit of the paper itself."""
    paper = read_paper(published)
    grid = _grid(settings, paper.tables.increase_percent)
    return PaperFit(
        load_robot(robot), paper, settings["seed"], "paper", plan_of(settings["plan"]), grid, _noise(settings)
    )


def _reading_variables() -> dict[str, Variable]:
    return {
        f"reading_{name}": Variable(("reading",), np.array([str(getattr(r, name)) for r in READINGS]), words)
        for name, words in (
            ("scaling", "scaling of the series"),
            ("components", "number of components"),
            ("consecutive_hours", "hours in a row that make an onset"),
        )
    }


def screen_joint_readings(robot: str | Path, published: str | Path, output: str | Path, settings: dict) -> None:
    """Fit the arm to Tables V and VI, draw more around it, and choose the reading on the first of them.

    Parameters
    ----------
    settings : of the experiment; `plan` as :func:`plan_of`; `arms` how many are drawn, `screened` how many choose.
    """
    fit = _paper_fit(robot, published, settings)
    fitted, evidence = fit.fitted_arms()
    arms = fit.drawn_arms(fitted[: settings["fitted"]], settings["arms"])
    screened = [fit.screen(arm, k) for k, arm in enumerate(arms[: settings["screened"]])]
    by = ("screened", "reading")
    variables = {
        "mass": Variable(("arm",), np.array([a.mass for a in arms]), "mass of the payload", "kg"),
        "offset": Variable(("arm",), np.array([a.offset for a in arms]), "payload along the tool axis", "m"),
        "shape": Variable(("arm",), np.array([a.shape for a in arms]), "wear shape", "1"),
        "fitted_moment": Variable(
            ("fit",), np.array([a.moment for a in fitted]), "first moment of the payload", "kg m"
        ),
        "fitted_evidence": Variable(("fit",), evidence, "log evidence of Tables V and VI", "1"),
        **_reading_variables(),
        "cost": Variable(by, np.array([s.best(3) for s in screened]), "cost before the local search", "1"),
        "agreement": Variable(by, np.array([s.agreement() for s in screened]), "cells of Table IV that agree", "1"),
    }
    attributes = provenance.attributes("readings against the whole paper", settings)
    write_dataset(output, variables, {**attributes, "chosen_reading": choose_reading(screened)})


def search_joint_poses(
    robot: str | Path, published: str | Path, chosen: str | Path, output: str | Path, part: int, settings: dict
) -> None:
    """Search poses for one part (0-based) of the arms under the chosen reading.

    Parameters
    ----------
    settings : as of :func:`screen_joint_readings`; `parts` of the arms, `kept` experiments of an arm.
    """
    fit = _paper_fit(robot, published, settings)
    with open_dataset(chosen) as data:
        reading = READINGS[int(data.chosen_reading)]
        values = [read_variable(data, chosen, name) for name in ("mass", "offset", "shape")]
    experiments = []
    for k in range(len(values[0]))[part :: settings["parts"]]:
        screened = fit.screen(Arm(*(float(v[k]) for v in values)), k, [reading])
        experiments += fit.search(screened, reading, 0, k)[: settings["kept"]]
    write_experiments(output, experiments, "joint experiments", settings)


def confirm_joint_fit(
    robot: str | Path,
    published: str | Path,
    searched: Sequence[str | Path],
    output: str | Path,
    settings: dict,
) -> None:
    """Run the experiments on random numbers that took no part.

    Parameters
    ----------
    settings : of the experiment, and `confirm_replicates`.
    """
    arm, paper = load_robot(robot), read_paper(published)
    experiments = [e for path in searched for e in read_experiments(path)]
    places = range(len(experiments))
    grid, noise = _grid(settings, paper.tables.increase_percent), _noise(settings)
    confirmed = [
        confirm_fast(arm, e, paper, settings["seed"], f"confirmation {k}", settings["confirm_replicates"], grid, noise)
        for k, e in enumerate(experiments)
    ]
    write_confirmed(output, experiments, confirmed, places, "joint experiments on new random numbers", settings)


def trade_joint_aims(
    robot: str | Path, published: str | Path, confirmed: str | Path, output: str | Path, settings: dict
) -> None:
    """Search the nearest experiments on under other weights, and run the results on new random numbers.

    Parameters
    ----------
    settings : of the experiment; `plan` as :func:`plan_of`, `arms` that are searched on, `emphases` as the
        factors of :class:`Emphasis`, `confirm_replicates`.
    """
    arm, paper = load_robot(robot), read_paper(published)
    grid, noise = _grid(settings, paper.tables.increase_percent), _noise(settings)
    experiments, fields = read_confirmed([confirmed])
    emphases = [Emphasis(*factors) for factors in settings["emphases"]]
    searched: list[JointExperiment] = []
    for k, places in enumerate(bases(experiments, fields["distance"], settings["arms"])):
        members = [experiments[place] for place in places]
        plan = plan_of(settings["plan"])
        searched += search_on(arm, paper, settings["seed"], plan, grid, noise, members, emphases, k)
    again = [
        confirm_fast(arm, e, paper, settings["seed"], f"trade {k}", settings["confirm_replicates"], grid, noise)
        for k, e in enumerate(searched)
    ]
    places = range(len(experiments), len(experiments) + len(searched))
    arms = len(searched) // len(emphases)
    more = {
        f"emphasis_{name}": Variable(("experiment",), np.array([getattr(e, name) for e in emphases] * arms), words, "1")
        for name, words in (
            ("tables", "factor on the weights of Tables V and VI"),
            ("signs", "factor on the weight of Table II"),
            ("torque", "factor on the size of errors in Table V"),
        )
    }
    write_confirmed(output, searched, again, places, "joint experiments under other weights", settings, more)


def control_joint_fit(
    robot: str | Path, published: str | Path, output: str | Path, kind: str, number: int, settings: dict
) -> None:
    """Fit one control with the small effort: the paper itself, one of known origin, or one with Table IV shuffled.

    Parameters
    ----------
    kind : of :data:`KINDS`; number : keys the random numbers.
    settings : of the experiment; `plan` as :func:`plan_of`, `fitted` arms that are searched, `confirm_replicates`.
    """
    arm, paper = load_robot(robot), read_paper(published)
    grid, noise = _grid(settings, paper.tables.increase_percent), _noise(settings)
    random = generator(settings["seed"], "joint fit control", kind, replicate=number)
    truth = None
    if kind == "known":
        paper, truth = synthetic_paper(arm, settings["seed"], str(number), random, grid, noise, Prior())
    elif kind == "shuffled":
        paper = shuffled_paper(paper, random)
    fit = PaperFit(arm, paper, settings["seed"], f"{kind} {number}", plan_of(settings["plan"]), grid, noise)
    fitted, evidence = fit.fitted_arms()
    screened = [fit.screen(a, k) for k, a in enumerate(fitted[: settings["fitted"]])]
    place = choose_reading(screened)
    searched = [fit.search(s, READINGS[place], place, k)[0] for k, s in enumerate(screened)]
    best = min(searched, key=lambda e: e.cost.sum())
    name = f"control {kind} {number} again"
    checked = confirm_fast(arm, best, paper, settings["seed"], name, settings["confirm_replicates"], grid, noise)
    wanted = np.isfinite(paper.tables.hours).swapaxes(1, 2)
    agreed = (checked.probability >= 0.5) == wanted
    late = np.abs(checked.hour - paper.tables.hours.swapaxes(1, 2))[agreed & wanted]
    attributes = provenance.attributes(f"joint fit of a control: {kind}", settings)
    attributes |= {
        "kind": kind,
        "cells": int(agreed.sum()),
        "hour_error": float(np.median(late)) if len(late) else float("nan"),
        "distance": checked.distance,
        "moment": fitted[0].moment,
        "searched_moment": best.arm.moment,
        "shape": best.arm.shape,
        **{f"reading_{k}": str(v) for k, v in asdict(best.reading).items()},
    }
    if truth is not None:
        attributes |= {
            "true_moment": truth.arm.moment,
            "true_shape": truth.arm.shape,
            **{f"true_reading_{k}": str(v) for k, v in asdict(truth.reading).items()},
        }
    variables = {
        "moment": Variable(("fit",), np.array([a.moment for a in fitted]), "moment fitted to Tables V and VI", "kg m"),
        "evidence": Variable(("fit",), evidence, "log evidence of Tables V and VI", "1"),
        "searched_cost": Variable(("arm",), np.array([e.cost.sum() for e in searched]), "cost of all tables", "1"),
        "probability": Variable(("task", "increase", "axis"), checked.probability, "share that detects", "1"),
    }
    write_dataset(output, variables, attributes)
