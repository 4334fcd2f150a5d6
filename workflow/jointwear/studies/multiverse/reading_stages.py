"""The stages of the multiverse that sample, run and score readings on the configured pose set; files in, files out."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from jointwear.files import provenance
from jointwear.files.errors import InputError
from jointwear.files.storage import Variable, open_dataset, read_variable, write_dataset
from jointwear.files.text_files import replace_text
from jointwear.reproduction.published import load_published
from jointwear.studies.multiverse import choice, records
from jointwear.studies.multiverse.design import DesignPoint, build_design, read_design, split_design, write_design
from jointwear.studies.multiverse.dimensions import default_reading, dimensions
from jointwear.studies.multiverse.evaluation import evaluate
from jointwear.studies.multiverse.influence import Effect, influence
from jointwear.studies.multiverse.pose_sets import configured_pose_set
from jointwear.studies.multiverse.scoring import WEIGHTS, claims, scores_and_shortfalls
from jointwear.studies.multiverse.search import starting_readings
from jointwear.studies.multiverse.settings import analysis_of, experiment_of, paper_target


def sample_readings(output: str | Path, settings: Mapping[str, Any]) -> None:
    """Write the design of the multiverse.

    Parameters
    ----------
    settings : `seed`, `readings`, `pairs`, `simulations` and the default: `reading`, `wear_shape`,
        `consecutive_hours`.
    """
    default = default_reading(settings["reading"], settings["wear_shape"], settings["consecutive_hours"])
    points = build_design(
        dimensions(default), settings["readings"], settings["pairs"], settings["simulations"], settings["seed"]
    )
    write_design(output, points)


def evaluate_readings(
    design: str | Path,
    robot: str | Path,
    tasks: Sequence[str | Path],
    published: str | Path,
    output: str | Path,
    part: int,
    settings: Mapping[str, Any],
) -> None:
    """Run one part (0-based) of the design on the configured pose set.

    Parameters
    ----------
    settings : of :func:`experiment_of` and :func:`analysis_of`, `replicates` and `parts`.
    """
    points = read_design(design)
    indices = split_design(points, settings["parts"])[part]
    analysis = analysis_of(settings, load_published(published))
    outcomes = evaluate(
        [points[i].reading for i in indices],
        configured_pose_set(robot, tasks),
        experiment_of(settings, settings["replicates"]),
        analysis,
    )
    records.write_outcomes(output, outcomes, indices, settings)


def best_readings(outcomes: records.Outcomes, penalty: np.ndarray, count: int) -> list[int]:
    """Return the `count` readings of least penalty that differ in what they detect.

    Readings that differ only in what does not reach the detector, such as the histogram where the PCA runs on
    mean torques, count once.
    """
    order = np.argsort(penalty, kind="stable")
    different = choice.first_of_each([records.detections(outcomes, i) for i in order], count)
    return [int(order[k]) for k in different]


def score_readings(
    design: str | Path,
    parts: Sequence[str | Path],
    published: str | Path,
    output: str | Path,
    table: str | Path,
    best: str | Path,
    start: str | Path,
    settings: Mapping[str, Any],
) -> None:
    """Score all readings; write the table (netCDF and CSV), the best readings, and those to search on from.

    Parameters
    ----------
    design, parts : the readings, and files of their outcomes. published : file of the published values.
    output, table, best, start : files to write.
    settings : of :func:`analysis_of`; `best` and `start`, how many readings.

    Raises
    ------
    InputError : if the parts do not hold the readings of the design.
    """
    points = read_design(design)
    loaded = [records.read_outcomes(path) for path in parts]
    indices = np.concatenate([n for _, n in loaded])
    outcomes = records.taken(records.joined([o for o, _ in loaded]), np.argsort(indices))
    if len(indices) != len(points):
        raise InputError(f"{design}: has {len(points)} readings, the parts have {len(indices)}; delete them, run again")
    printed = load_published(published)
    target = paper_target(printed, analysis_of(settings, printed))
    (scores, shortfalls), supported = scores_and_shortfalls(outcomes, target), claims(outcomes)
    probability = np.isfinite(outcomes.onset).mean(axis=-1)
    chosen = best_readings(outcomes, scores["penalty"], settings["best"])
    names = list(points[0].reading)
    cell = ("reading", "task", "increase", "axis")
    variables = {
        "reading": Variable(("reading",), np.arange(len(points)), "number of the reading in the design", "1"),
        "kind": Variable(("reading",), np.array([p.kind for p in points]), "why the reading is in the design"),
        "dimension": Variable(("dimension",), np.array(names), "ambiguous point of the text"),
        "default": Variable(("dimension",), np.array([str(points[0].reading[k]) for k in names]), "default choice"),
        **records.choice_variables([p.reading for p in points]),
        **{k: Variable(("reading",), scores[k], *records.SCORES[k]) for k in records.SCORES},
        **{
            f"claim_{k}": Variable(("reading",), supported[k].astype("i1"), f"supports: {text}", "1")
            for k, text in records.CLAIMS.items()
        },
        "detection_probability": Variable(cell, probability, "share of replicates that detect", "1"),
        "best": Variable(("rank",), np.array(chosen), "readings that go on to the pose sets, best first", "1"),
        "wrong_share": Variable(
            cell[1:], choice.wrong_everywhere(probability, target), "share of readings that disagree with Table IV", "1"
        ),
        "published_hour": Variable(cell[1:], target.hours, "hour of Table IV, NaN if not detected", "h"),
    }
    attributes = provenance.attributes("readings of the paper and how well they reproduce it", settings)
    write_dataset(output, variables, {**attributes, **{f"weight_{k}": v for k, v in WEIGHTS.items()}})
    _write_table(table, points, scores, supported)
    write_design(best, [points[i] for i in chosen])
    beginning = starting_readings([p.reading for p in points], shortfalls, WEIGHTS, settings["start"])
    write_design(start, [DesignPoint("start", r) for r in beginning])


def _write_table(
    path: str | Path, points: Sequence[DesignPoint], scores: Mapping[str, np.ndarray], supported: Mapping[str, Any]
) -> None:
    names = list(points[0].reading)
    lines = [",".join(["reading", "kind", *names, *records.SCORES, *records.CLAIMS])]
    for i, p in enumerate(points):
        row = [str(i), p.kind, *(str(p.reading[k]) for k in names)]
        row += [f"{scores[k][i]:.6g}" for k in records.SCORES] + [str(int(supported[k][i])) for k in records.CLAIMS]
        lines.append(",".join(row))
    replace_text(path, "\n".join(lines) + "\n")


def measure_influence(design: str | Path, scored: str | Path, output: str | Path) -> None:
    """Write which dimensions decide the scores, over the space-filling sample alone.

    The variables have dimensions score, effect: main effects strongest first, then the strongest pairs.
    """
    points = read_design(design)
    sample = [i for i, p in enumerate(points) if p.kind == "sample"]
    readings = [points[i].reading for i in sample]
    found: dict[str, tuple[list[Effect], list[Effect]]] = {}
    chosen = ("penalty", "agreement", "hour_error", "located_share")
    with open_dataset(scored) as dataset:
        for name in chosen:
            found[name] = influence(readings, read_variable(dataset, scored, name)[sample])
    width = max(len(main) for main, _ in found.values())
    depth = max(len(pairs) for _, pairs in found.values())

    def text(effects: list[Effect], place: int, count: int) -> list[str]:
        names = [e.names[place] for e in effects]
        return names + [""] * (count - len(names))

    def padded(effects: list[Effect], field: str, count: int) -> list[float]:
        values = [getattr(e, field) for e in effects]
        return values + [np.nan] * (count - len(values))

    by = ("score", "main")
    of = ("score", "pair")
    mains, pairs = [found[k][0] for k in chosen], [found[k][1] for k in chosen]
    share = "share of the variance beyond chance (omega squared)"
    variables = {
        "score": Variable(("score",), np.array(chosen), "score"),
        "main_name": Variable(by, np.array([text(m, 0, width) for m in mains]), "dimension"),
        "main_share": Variable(by, np.array([padded(m, "share", width) for m in mains]), share, "1"),
        "main_p_value": Variable(by, np.array([padded(m, "p_value", width) for m in mains]), "p value", "1"),
        "main_levels": Variable(
            by,
            np.array([[json.dumps(e.levels) for e in m] + [""] * (width - len(m)) for m in mains]),
            "mean score of every choice, as JSON",
        ),
        "pair_first": Variable(of, np.array([text(p, 0, depth) for p in pairs]), "first dimension"),
        "pair_second": Variable(of, np.array([text(p, 1, depth) for p in pairs]), "second dimension"),
        "pair_share": Variable(of, np.array([padded(p, "share", depth) for p in pairs]), share, "1"),
        "pair_p_value": Variable(of, np.array([padded(p, "p_value", depth) for p in pairs]), "p value", "1"),
        "pair_levels": Variable(
            of,
            np.array([[json.dumps(e.levels) for e in p] + [""] * (depth - len(p)) for p in pairs]),
            "mean score of every pair of choices, as JSON",
        ),
    }
    attributes = provenance.attributes("which ambiguity decides", {"readings": len(readings)})
    write_dataset(output, variables, attributes)
