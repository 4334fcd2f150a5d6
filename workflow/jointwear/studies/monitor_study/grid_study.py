"""One task of the paper's grid: both detectors, wrong models, other wear, two axes at once, noise, forecasts."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from jointwear.files import provenance
from jointwear.files.storage import Variable, read_variables, write_dataset
from jointwear.monitor.normal.estimate import Sums
from jointwear.reproduction.grid import Cell, by_cell, worn_runs
from jointwear.robots.robot import load_robot
from jointwear.robots.trajectory import load_task
from jointwear.statistics.randomness import generator
from jointwear.studies.monitor_study.charts import mean_variance
from jointwear.studies.monitor_study.forecast import forecast
from jointwear.studies.monitor_study.nominal import wrong_nominal
from jointwear.studies.monitor_study.normal_period import Normal
from jointwear.studies.monitor_study.runs import (
    Regression,
    TaskWear,
    joined,
    learn,
    louder,
    read_torque,
    regression_of,
    sums_of_torque,
    with_axis,
)
from jointwear.studies.monitor_study.scores import Charted, chart, factor_for, first_hour, reset_alarms

#: False alarms per 1,000 h at which the tables are made. A wrong name comes from a false alarm before the true one;
#: for one in a hundred at most, within the 60 h that wear takes to show, the rate must stay below 0.17.
RATE = 0.3
RATES = (0.1, 0.3, 1.0, 3.0, 10.0, 30.0)
SHAPES = (1.5, 2.0, 3.0)
SIZES = (2.0, 5.0, 10.0, 15.0, 20.0)
NOISES = (1.0, 2.0, 4.0, 7.0, 10.0)
PAIR = (10.0, 20.0)
LATER = 24
WRONG_MODELS = 4


@dataclass(frozen=True)
class TaskRuns:
    """Sums of all runs of a task under one nominal model (or several), and what they taught."""

    regression: Regression
    training: Sums
    normal: Normal
    test: Sums
    worn: dict[Cell, Sums]


def read_runs(files: Mapping[Any, str | Path], regressions: Sequence[Regression], replicates: int) -> TaskRuns:
    """Read training, normal and worn runs; replicate i is judged with regression i modulo their number."""
    groups = [np.arange(k, replicates, len(regressions)) for k in range(len(regressions))]
    order = np.argsort(np.concatenate(groups))

    def sums(path: str | Path) -> Sums:
        torque = read_torque(path, slice(0, replicates))
        parts = [sums_of_torque(torque[g], x) for g, x in zip(groups, regressions, strict=True)]
        if len(parts) == 1:
            return parts[0]
        whole = joined(parts)
        return Sums(*(getattr(whole, name)[order] for name in Sums.__dataclass_fields__))

    training = sums(files["training"])
    worn = {cell: sums(path) for cell, path in files.items() if isinstance(cell, Cell)}
    return TaskRuns(regressions[0], training, learn(training, regressions[0]), sums(files["normal"]), worn)


def study_task(
    robot: str | Path, task: str | Path, runs: Sequence[str], detection: Sequence[str], location: Sequence[str],
    output: str | Path, settings: Mapping[str, Any],
) -> None:  # fmt: skip
    """Measure one task and write everything that the chapter needs.

    Parameters
    ----------
    runs : files of the simulation: training, normal and worn runs. detection : the paper's, of normal and worn runs;
        location : what its lag rule names in worn runs.
    settings : `seed`, `replicates`, `shape`, `wear_hours`, `time_step`, `interval`, `samples`, `consecutive_hours`.
    """
    arm, the_task = load_robot(robot), load_task(task)
    motion = the_task.samples(settings["interval"], settings["samples"])
    true = regression_of(arm, motion)
    files: dict[Any, str] = dict(worn_runs(runs))
    for name in ("training", "normal"):
        files[name] = next(p for p in runs if Path(p).stem == name)
    exact = read_runs(files, [true], settings["replicates"])
    names = [generator(settings["seed"], "monitor", "nominal", replicate=k) for k in range(WRONG_MODELS)]
    wrong = read_runs(files, [regression_of(wrong_nominal(arm, g), motion) for g in names], settings["replicates"])
    wear = TaskWear(arm, the_task, true, true, settings["time_step"], settings["wear_hours"])
    cells = sorted(exact.worn)
    writer = _Results(cells, arm.joints, settings["replicates"])
    for k, case in enumerate((exact, wrong)):
        writer.grid(k, case)
    writer.curves(exact)
    writer.paper(dict(worn_runs(detection)), detection, settings["consecutive_hours"])
    writer.paper_axis(by_cell(list(location)))
    writer.other_wear(exact, wear, settings["shape"])
    writer.pairs(exact)
    writer.noise(exact, wear, settings["shape"])
    title = f"monitor on {the_task.name}, both detectors"
    write_dataset(output, writer.variables, provenance.attributes(title, dict(settings)) | writer.attributes)


class _Results:
    """Collects the variables of the file."""

    def __init__(self, cells: Sequence[Cell], joints: int, replicates: int) -> None:
        self.cells, self.joints, self.replicates = list(cells), joints, replicates
        self.variables: dict[str, Variable] = {
            "axis": Variable(("axis",), np.arange(1, joints + 1), "axis of the robot", "1"),
            "cell_axis": Variable(("cell",), np.array([c.axis for c in cells]), "worn axis", "1"),
            "cell_increase": Variable(("cell",), np.array([c.increase_percent for c in cells]), "growth", "percent"),
            "nominal": Variable(("nominal",), np.array(["exact", "wrong"]), "nominal model of the monitor"),
            "rate": Variable(("rate",), np.array(RATES), "false alarms per 1,000 h that are asked for", "1"),
            "size": Variable(("size",), np.array(SIZES), "growth of friction", "percent"),
            "noise": Variable(("noise",), np.array(NOISES), "factor on all noise", "1"),
            "later": Variable(("issue",), np.array([0.0, LATER]), "time of issue after the alarm", "h"),
        }
        self.attributes: dict[str, Any] = {"rate_per_1000_h": RATE}

    def _put(self, name: str, dimensions: tuple[str, ...], values: Any, meaning: str, unit: str = "1") -> None:
        self.variables[name] = Variable(dimensions, np.asarray(values), meaning, unit)

    def grid(self, which: int, case: TaskRuns) -> None:
        """Both tables of the grid under one nominal model."""
        name = ("exact", "wrong")[which]
        test = chart(case.test, case.normal, RATE)
        self._put(f"{name}_false", ("axis",), test.trace.alarm.sum(axis=(0, 1)), "false alarms in normal hours")
        self._put(f"{name}_judged", ("axis",), (case.normal.windows > 0).astype(int), "1 where the axis can be judged")
        self._put(
            f"{name}_std", ("axis",), 100 * np.where(np.isfinite(test.std), test.std, np.nan).mean(axis=(0, 1)),
            "standard deviation of the growth in one hour", "percent",
        )  # fmt: skip
        self.attributes["normal_hours"] = int(np.prod(test.change.shape[:2]))
        charted = [chart(case.worn[c], case.normal, RATE) for c in self.cells]
        pair = ("cell", "replicate")
        self._put(f"{name}_hour", pair, [c.hour for c in charted], "hour of the first alarm, NaN without", "h")
        self._put(f"{name}_named", pair, [c.named for c in charted], "axis that it names, 0 without alarm")
        self._put(f"{name}_probability", pair, [c.probability for c in charted], "probability that it gives the axis")

    def curves(self, case: TaskRuns) -> None:
        """False alarms and hours at every rate."""
        false, hours, named = [], [], []
        for rate in RATES:
            false.append(chart(case.test, case.normal, rate).trace.alarm.sum())
            charted = [chart(case.worn[c], case.normal, rate) for c in self.cells]
            hours.append([c.hour for c in charted])
            named.append([c.named for c in charted])
        self._put("curve_false", ("rate",), false, "false alarms in the normal hours")
        self._put("curve_hour", ("rate", "cell", "replicate"), hours, "hour of the first alarm", "h")
        self._put("curve_named", ("rate", "cell", "replicate"), named, "axis that it names")

    def paper(self, worn: Mapping[Cell, str], detection: Sequence[str], consecutive: int) -> None:
        """The paper's detector with its limit raised to the same rates: chosen on half of the replicates."""
        normal = next(p for p in detection if Path(p).stem == "normal")

        def ratio(path: str) -> np.ndarray:
            q, limit = read_variables(path, "q", "q_limit")
            return (q / limit[:, None])[: self.replicates]

        normal_ratio = ratio(normal)
        chosen, checked = normal_ratio[0::2], normal_ratio[1::2]
        published = reset_alarms(normal_ratio, 1.0, consecutive).sum()
        false, hours, factors = [], [], []
        for rate in RATES:
            factor = factor_for(chosen, rate, consecutive)
            factors.append(factor)
            false.append(reset_alarms(checked, factor, consecutive).sum())
            hours.append([first_hour(reset_alarms(ratio(worn[c]), factor, consecutive)) for c in self.cells])
        as_published = [first_hour(reset_alarms(ratio(worn[c]), 1.0, consecutive)) for c in self.cells]
        self._put("paper_factor", ("rate",), factors, "factor on the Q-limit for that rate")
        self._put("paper_false", ("rate",), false, "false alarms in the normal hours that did not choose the factor")
        self._put("paper_hour", ("rate", "cell", "replicate"), hours, "hour of detection by Q", "h")
        self._put("paper_limit_hour", ("cell", "replicate"), as_published, "hour of detection at the 95 % limit", "h")
        self.attributes |= {"paper_checked_hours": int(checked.size), "paper_limit_false": int(published)}

    def paper_axis(self, location: Mapping[Cell, str]) -> None:
        """The axis that the paper's lag rule names in every worn run."""
        named = [np.asarray(read_variables(location[c], "source")[0])[: self.replicates] for c in self.cells]
        self._put("paper_named", ("cell", "replicate"), np.nan_to_num(named).astype(int), "axis of the lag rule")

    def other_wear(self, case: TaskRuns, wear: TaskWear, shape: float) -> None:
        """Other shapes and sizes of wear, and the forecasts of every shape."""
        shapes = (shape, *SHAPES)
        hours, named = [], []
        for s in shapes:
            charted = []
            for c in self.cells:
                before, after = wear.growth(c.increase_percent, shape), wear.growth(c.increase_percent, s)
                charted.append(chart(wear.changed(case.worn[c], c.axis - 1, before, after), case.normal, RATE))
            self._forecasts(s, shapes.index(s), charted, wear, case.normal)
            hours.append([c.hour for c in charted])
            named.append([c.named for c in charted])
        each = ("shape", "cell", "replicate")
        self._put("shape", ("shape",), shapes, "c2 x 120 h of equation (7)")
        self._put("shape_hour", each, hours, "hour of the first alarm", "h")
        self._put("shape_named", each, named, "axis that it names")
        sizes = []
        smallest = min(c.increase_percent for c in self.cells)
        chosen = [c for c in self.cells if c.increase_percent == smallest]
        for size in SIZES:
            row = []
            for c in chosen:
                before, after = wear.growth(c.increase_percent, shape), wear.growth(size, shape)
                sums = wear.changed(case.worn[c], c.axis - 1, before, after)
                row.append(chart(sums, case.normal, RATE).axis_hour(c.axis - 1))
            sizes.append(row)
        self._put("size_axis", ("worn",), [c.axis for c in chosen], "worn axis")
        self._put("size_hour", ("size", "worn", "replicate"), sizes, "hour at which the worn axis alarms", "h")

    def _forecasts(self, shape: float, index: int, charted: Sequence[Charted], wear: TaskWear, normal: Normal) -> None:
        name = f"forecast_{index}"
        values = np.full((4, 2, len(self.cells), self.replicates), np.nan)
        hour, spread = np.arange(1.0, wear.hours + 1), np.sqrt(mean_variance(normal))
        for i, (c, seen) in enumerate(zip(self.cells, charted, strict=True)):
            growth, limit = wear.growth(c.increase_percent, shape), c.increase_percent / 200
            reached = float(np.interp(limit, growth, hour))
            alarm = seen.axis_hour(c.axis - 1)
            for r in range(self.replicates):
                for issue, wait in enumerate((0, LATER)):
                    last = alarm[r] + wait
                    if not last <= wear.hours:
                        continue
                    k, j = int(last), c.axis - 1
                    told = forecast(
                        hour[:k], seen.change[r, :k, j], seen.std[r, :k, j], limit,
                        mean_std=float(spread[r, j]), start=0.0,
                    )  # fmt: skip
                    values[:, issue, i, r] = told.low, told.hours, told.high, reached - last
        dims = ("issue", "cell", "replicate")
        words = ("lower end of the 80 % interval", "median", "upper end", "true hours to the limit, negative if past")
        for suffix, meaning, part in zip(("low", "median", "high", "true"), words, values, strict=True):
            self._put(f"{name}_{suffix}", dims, part, f"forecast at c2 x 120 h = {shape:g}: {meaning}", "h")

    def pairs(self, case: TaskRuns) -> None:
        """Two axes that wear at once, 10 and 20 %: hours at which either is named."""
        light = {c.axis: s for c, s in case.worn.items() if c.increase_percent == PAIR[0]}
        heavy = {c.axis: s for c, s in case.worn.items() if c.increase_percent == PAIR[1]}
        hours = np.full((2, self.joints, self.joints, self.replicates), np.nan)
        for a, first in light.items():
            for b, second in heavy.items():
                if a != b:
                    seen = chart(with_axis(first, second, b - 1), case.normal, RATE)
                    hours[:, a - 1, b - 1] = seen.axis_hour(a - 1), seen.axis_hour(b - 1)
        dims = ("axis", "second_axis", "replicate")
        self._put("pair_light", dims, hours[0], "hour at which the axis with 10 % is named", "h")
        self._put("pair_heavy", dims, hours[1], "hour at which the axis with 20 % is named", "h")

    def noise(self, case: TaskRuns, wear: TaskWear, shape: float) -> None:
        """All noise several times as large, in the normal period too; false alarms and hours of the worn axis."""
        false, hours = [], []
        for factor in NOISES:
            normal = learn(louder(case.training, factor), case.regression)
            false.append(chart(louder(case.test, factor), normal, RATE).trace.alarm.sum())
            row = []
            for c in self.cells:
                rise = wear.growth(c.increase_percent, shape)[:, None] * wear.moment[c.axis - 1]
                row.append(chart(louder(case.worn[c], factor, c.axis - 1, rise), normal, RATE).axis_hour(c.axis - 1))
            hours.append(row)
        self._put("noise_false", ("noise",), false, "false alarms in the normal hours")
        self._put("noise_hour", ("noise", "cell", "replicate"), hours, "hour at which the worn axis alarms", "h")
