"""The stages of the multiverse that search, run and choose readings on many pose sets; files in, files out."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from jointwear.files import provenance
from jointwear.files.errors import InputError
from jointwear.files.storage import Variable, open_dataset, read_variable, write_dataset
from jointwear.files.text_files import replace_text
from jointwear.files.wording import count as counted
from jointwear.reproduction.published import load_published
from jointwear.studies.multiverse import choice, records
from jointwear.studies.multiverse.design import DesignPoint, read_design, write_design
from jointwear.studies.multiverse.dimensions import Reading, dimensions
from jointwear.studies.multiverse.evaluation import evaluate
from jointwear.studies.multiverse.pose_sets import PoseSet, configured_solution, ensemble_pose_sets, ensemble_size
from jointwear.studies.multiverse.scoring import agreement, score
from jointwear.studies.multiverse.search import search
from jointwear.studies.multiverse.settings import analysis_of, experiment_of, paper_target, paper_tasks


def search_readings(
    design: str | Path,
    start: str | Path,
    ensemble: str | Path,
    unloaded: str | Path,
    published: str | Path,
    output: str | Path,
    table: str | Path,
    island: int,
    settings: Mapping[str, Any],
) -> None:
    """Search on from the scored readings, on a few pose sets at once.

    Parameters
    ----------
    island : number of an independent search with its own random choices.
    output : design of the best readings that the search found; table : CSV of all that it ran.
    settings : of :func:`experiment_of` and :func:`analysis_of`; `search_pose_sets`, `search_replicates`,
        `generations`, `children`, `survivors`, `kept`.
    """
    points = read_design(design)
    ambiguous = dimensions(points[0].reading)
    printed = load_published(published)
    analysis = analysis_of(settings, printed)
    target = paper_target(printed, analysis)
    sets = ensemble_pose_sets(ensemble, unloaded, range(settings["search_pose_sets"]))
    # Other random numbers than those of the pose sets' own stage.
    sets = [PoseSet(f"search {island} {poses.name}", poses.dynamics, poses.tasks) for poses in sets]
    experiment = experiment_of(settings, settings["search_replicates"])
    told: dict[tuple, bytes] = {}
    agreed: dict[tuple, float] = {}

    def penalties(readings: list[Reading]) -> np.ndarray:
        outcomes = records.pooled(_stacked([evaluate(readings, poses, experiment, analysis) for poses in sets]))
        scores = score(outcomes, target)
        for i, reading in enumerate(readings):
            told[tuple(map(str, reading.values()))] = records.detections(outcomes, i)
            agreed[tuple(map(str, reading.values()))] = float(scores["agreement"][i])
        return scores["penalty"]

    random = np.random.Generator(np.random.PCG64(np.random.SeedSequence(settings["seed"], spawn_key=(0x73, island))))
    beginning = [p.reading for p in read_design(start)]
    readings, penalty = search(
        beginning, ambiguous, penalties, settings["generations"], settings["children"], settings["survivors"], random
    )
    different = choice.first_of_each([told[tuple(map(str, r.values()))] for r in readings], settings["kept"])
    write_design(output, [DesignPoint("search", readings[k]) for k in different])
    names = list(readings[0])
    lines = [",".join([*names, "penalty", "agreement"])]
    lines += [
        ",".join([*(str(r[k]) for k in names), f"{p:.6g}", f"{agreed[tuple(map(str, r.values()))]:.0f}"])
        for r, p in zip(readings, penalty, strict=True)
    ]
    replace_text(table, "\n".join(lines) + "\n")


def _stacked(outcomes: Sequence[records.Outcomes]) -> records.Outcomes:
    names = records.Outcomes.__dataclass_fields__
    return records.Outcomes(*(np.stack([getattr(o, name) for o in outcomes]) for name in names))


def gather_candidates(
    best: str | Path, searches: Sequence[str | Path], output: str | Path, settings: Mapping[str, Any]
) -> None:
    """Put together the readings that go on to the pose sets: each source in turn gives its next best.

    Parameters
    ----------
    best, searches : designs, best first.
    settings : `best`, how many readings go on.
    """
    sources = [read_design(path) for path in (*searches, best)]
    chosen: list[DesignPoint] = []
    for rank in range(max(map(len, sources))):
        for source in sources:
            if rank < len(source) and all(source[rank].reading != p.reading for p in chosen):
                chosen.append(source[rank])
    write_design(output, chosen[: settings["best"]])


def evaluate_pose_sets(
    best: str | Path,
    ensemble: str | Path,
    unloaded: str | Path,
    published: str | Path,
    output: str | Path,
    part: int,
    settings: Mapping[str, Any],
) -> None:
    """Run the best readings on one part (0-based) of the pose sets.

    Parameters
    ----------
    settings : of :func:`experiment_of` and :func:`analysis_of`; `pose_sets` their largest number, `pose_parts`,
        `pose_replicates`. The search of `recover` may have found fewer.

    Raises
    ------
    InputError : if the ensemble has fewer solutions than there are parts.
    """
    count = min(settings["pose_sets"], ensemble_size(ensemble))
    if count < settings["pose_parts"]:
        raise InputError(
            f"{ensemble}: has {counted(count, 'solution')}, the multiverse needs at least "
            f"{settings['pose_parts']}; raise recover.solutions"
        )
    points = read_design(best)
    readings = [p.reading for p in points]
    sets = ensemble_pose_sets(ensemble, unloaded, range(count)[part :: settings["pose_parts"]])
    experiment = experiment_of(settings, settings["pose_replicates"])
    analysis = analysis_of(settings, load_published(published))
    outcomes = [evaluate(readings, poses, experiment, analysis) for poses in sets]
    records.write_outcomes(output, _stacked(outcomes), range(len(points)), settings, [p.name for p in sets])


def choose_reading(
    best: str | Path,
    parts: Sequence[str | Path],
    ensemble: str | Path,
    unloaded: str | Path,
    tasks: Sequence[str | Path],
    published: str | Path,
    output: str | Path,
    settings: Mapping[str, Any],
) -> None:
    """Choose a reading on half of the pose sets, score it on the other half, and write both.

    Parameters
    ----------
    ensemble, unloaded, tasks : to find the pose set on which the candidates were found, which must not report.
    settings : of :func:`analysis_of`, `seed` and `search_pose_sets`.
    """
    names: list[str] = []
    loaded = []
    for path in parts:
        loaded.append(records.read_outcomes(path)[0])
        with open_dataset(path) as dataset:
            names += [str(v) for v in read_variable(dataset, path, "pose_set")]
    # Parts deal pose sets out like cards; put them back in the order of the ensemble.
    order = sorted(range(len(names)), key=lambda k: int(names[k].rpartition("_")[2]))
    outcomes = records.taken(records.joined(loaded), order)
    points = read_design(best)
    printed = load_published(published)
    target = paper_target(printed, analysis_of(settings, printed))
    places = [int(names[k].rpartition("_")[2]) - 1 for k in order]
    configured = configured_solution(ensemble_pose_sets(ensemble, unloaded, places), tasks)
    seen = {places.index(k) for k in range(settings["search_pose_sets"]) if k in places}
    seen = sorted(seen if configured is None else {*seen, configured})
    chosen = choice.choose(outcomes, target, settings["seed"], seen)
    everything = records.pooled(outcomes)
    probability = np.isfinite(everything.onset).mean(axis=-1)
    plain, balanced = agreement(probability, target.detected)
    mixture = choice.best_mixture(outcomes, target)
    cell, by_pose = ("task", "increase", "axis"), ("reading", "pose_set")
    variables = {
        "reading": Variable(("reading",), np.arange(len(points)), "number of the candidate, best first", "1"),
        **records.choice_variables([p.reading for p in points]),
        "pose_set": Variable(("pose_set",), np.array([names[k] for k in order]), "pose set"),
        "choosing": Variable(("pose_set",), chosen.choosing.astype("i1"), "1 where the reading was chosen on it", "1"),
        "penalty": Variable(by_pose, chosen.penalty, "weighted shortfall from the paper", "1"),
        "agreement": Variable(by_pose, chosen.agreement, "cells of Table IV that agree, of 36", "1"),
        "pooled_agreement": Variable(("reading",), plain, "cells that agree over all pose sets together", "1"),
        "pooled_balanced_agreement": Variable(("reading",), balanced, "balanced share of the cells that agree", "1"),
        "pooled_probability": Variable(("reading", *cell), probability, "probability of detection", "1"),
        "mixture_bound": Variable(
            ("reading",), mixture.bound, "cells that agree if Table IV chooses the poses of every task", "1"
        ),
        "mixture_pose_set": Variable(
            ("task",), np.array([names[order[k]] for k in mixture.pose_set]), "poses that Table IV would choose"
        ),
        "score": Variable(("score",), np.array(list(chosen.chosen_score)), "score"),
        "chosen_score": Variable(("score",), np.array(list(chosen.chosen_score.values())), "on the choosing half", "1"),
        "honest_score": Variable(("score",), np.array(list(chosen.honest_score.values())), "on the other half", "1"),
        "honest_probability": Variable(cell, chosen.probability, "detection on the other half", "1"),
        "honest_hour": Variable(cell, chosen.hour, "median hour on the other half", "h"),
        "published_hour": Variable(cell, target.hours, "hour of Table IV, NaN if not detected", "h"),
        "wrong_share": Variable(
            cell, choice.wrong_everywhere(probability, target), "share of the candidates that disagree", "1"
        ),
    }
    attributes = provenance.attributes("choice of the reading, corrected for the search", settings)
    write_dataset(
        output, variables, {**attributes, "chosen_reading": chosen.reading, "mixture_reading": mixture.reading}
    )


def confirm_mixture(
    best: str | Path,
    chosen: str | Path,
    ensemble: str | Path,
    unloaded: str | Path,
    published: str | Path,
    output: str | Path,
    settings: Mapping[str, Any],
) -> None:
    """Run the reading and the poses that Table IV chose once more, with random numbers that chose nothing.

    Parameters
    ----------
    settings : of :func:`experiment_of` and :func:`analysis_of`, and `confirm_replicates`.
    """
    with open_dataset(chosen) as dataset:
        reading = read_design(best)[int(dataset.mixture_reading)].reading
        solutions = [str(v) for v in read_variable(dataset, chosen, "mixture_pose_set")]
    sets = ensemble_pose_sets(ensemble, unloaded, [int(name.rpartition("_")[2]) - 1 for name in solutions])
    printed = load_published(published)
    analysis = analysis_of(settings, printed)
    experiment = experiment_of(settings, settings["confirm_replicates"])
    # Every task on the arm of its own solution; the payloads differ a little.
    parts = [
        evaluate([reading], PoseSet(f"confirm {poses.name}", poses.dynamics, (poses.tasks[t],)), experiment, analysis)
        for t, poses in enumerate(sets)
    ]
    tasks = paper_tasks(printed)
    single = {"rest_torque": analysis.rest_task, "lag": analysis.lag_task, "kl_maximum": analysis.lag_task}
    outcomes = records.Outcomes(
        *(
            getattr(parts[tasks.index(single[name])], name)
            if name in single
            else np.concatenate([getattr(p, name) for p in parts], axis=1)
            for name in records.Outcomes.__dataclass_fields__
        )
    )
    target = paper_target(printed, analysis)
    scores = score(outcomes, target)
    probability = np.isfinite(outcomes.onset[0]).mean(axis=-1)
    cell = ("task", "increase", "axis")
    variables = {
        "pose_set": Variable(("task",), np.array(solutions), "poses that Table IV chose"),
        **records.choice_variables([reading]),
        **{k: Variable(("reading",), scores[k], *records.SCORES[k]) for k in records.SCORES},
        "detection_probability": Variable(cell, probability, "share of replicates that detect", "1"),
        "hour": Variable(cell, choice.median_hour(outcomes.onset[0]), "median hour, NaN below half", "h"),
        "published_hour": Variable(cell, target.hours, "hour of Table IV, NaN if not detected", "h"),
    }
    write_dataset(output, variables, provenance.attributes("the poses that Table IV would choose", settings))
