"""A small experiment, computed once a test session by the library's own functions, with its figures and report."""

import atexit
import shutil
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from tempfile import mkdtemp

import yaml

from jointwear.publishing.figures.detection_map import draw_detection_map
from jointwear.publishing.figures.figure_1 import draw_figure_1
from jointwear.publishing.figures.figure_2 import draw_figure_2
from jointwear.publishing.figures.figure_3 import draw_figure_3
from jointwear.publishing.figures.figure_4 import draw_figure_4
from jointwear.publishing.figures.lag_map import draw_lag_map
from jointwear.publishing.report.assembly import TABLES, Results
from jointwear.publishing.report.page import write_report
from jointwear.reproduction.commanded_motion import write_trajectory
from jointwear.reproduction.detection import write_detection
from jointwear.reproduction.features import write_features, write_reference
from jointwear.reproduction.grid import Cell
from jointwear.reproduction.location import write_location
from jointwear.reproduction.normal_model import write_normal_model
from jointwear.reproduction.simulation import simulate_run
from jointwear.reproduction.tables import write_tables
from jointwear.reproduction.worn_run import simulate_worn_run
from jointwear.running.configuration import prepare, reading_of

ROOT = Path(__file__).resolve().parent.parent
PUBLISHED = "config/paper/published.yaml"
FIGURES = ("figure_1", "figure_2", "figure_3", "figure_4", "table_ii", "table_iv")


@dataclass(frozen=True)
class Experiment:
    """Results under `folder`/results, the configuration behind them, and the run that the figures show."""

    folder: Path
    config: dict
    runs: tuple[str, ...]
    figure_run: str

    def path(self, *parts: str) -> str:
        return str(self.folder.joinpath("results", *parts))

    @property
    def figure_task(self) -> str:
        """Task of the run that the figures show."""
        return self.figure_run.partition("/")[0]

    @property
    def results(self) -> Results:
        tasks = self.config["tasks"]

        def by_task(stage: str, name: str) -> dict[str, str]:
            return {task: self.path(stage, task, name) for task in tasks}

        def worn(stage: str) -> list[str]:
            return [self.path(stage, run) for run in self.runs]

        return Results(
            published=str(ROOT / PUBLISHED),
            robot=str(ROOT / self.config["robot"]),
            tables={name: self.path("tables", f"{name}.nc") for name in TABLES},
            simulations=worn("simulation"),
            detections=worn("detection"),
            locations=worn("location"),
            models=by_task("detection", "model.nc"),
            tasks={task: str(ROOT / "config/tasks" / f"{task}.yaml") for task in self.config["tasks"]},
            training_features=by_task("features", "training.nc"),
            training_simulations=by_task("simulation", "training.nc"),
            normal_simulations=by_task("simulation", "normal.nc"),
            normal_detections=by_task("detection", "normal.nc"),
            normal_locations=by_task("location", "normal.nc"),
            figure_run={
                "simulation": self.path("simulation", self.figure_run),
                "features": self.path("features", self.figure_run),
                "detection": self.path("detection", self.figure_run),
                "task": str(ROOT / "config/tasks" / f"{self.figure_task}.yaml"),
            },
        )

    def write_report(self, **how) -> Path:
        """Write the report; `how` replaces arguments of :func:`jointwear.publishing.report.page.write_report`."""
        page = Path(how.pop("output", self.path("report", "index.html")))
        given = {
            "results": self.results,
            "figures": {name: self.path("figures", f"{name}.svg") for name in FIGURES},
            "config": self.config,
            "root": self.folder,
            **how,
        }
        write_report(page, page.with_name("summary.json"), **given)
        return page


def small_config(**change) -> dict:
    """Return the shipped configuration on a small grid; `change` replaces further keys."""
    config = yaml.safe_load((ROOT / "config/config.yaml").read_text(encoding="utf-8"))
    config.update(replicates=4, tasks=["T1", "T2"], normal={"test_hours": 48}, **change)
    config["wear"].update(axes=[1, 6], increase_percent=[10, 20])
    config = prepare(config)
    return {k: v for k, v in config.items() if k not in ("discover", "monitor")}


def compute(folder: Path, config: dict) -> Experiment:
    """Run every stage of the workflow for a configuration, in order, and write figures and report."""
    wear, robot = config["wear"], str(ROOT / config["robot"])
    cells = {
        f"axis{axis}_{increase:g}percent.nc": (increase, axis)
        for axis in wear["axes"]
        for increase in wear["increase_percent"]
    }
    names = list(cells)
    runs = tuple(f"{task}/{name}" for task in config["tasks"] for name in names)
    wanted = "T1/axis1_10percent.nc"
    done = Experiment(folder, config, runs, wanted if wanted in runs else runs[0])
    base = {
        "seed": config["seed"],
        "replicates": config["replicates"],
        "sampling": config["sampling"],
        "noise": config["noise"],
        "reading": reading_of(config, "simulation"),
    }
    features = {"bins": config["histogram"]["bins"], "reading": reading_of(config, "features")}
    detection = {**config["detection"], "reading": reading_of(config, "detection")}
    for task in config["tasks"]:
        file = str(ROOT / "config/tasks" / f"{task}.yaml")
        write_trajectory(robot, file, done.path("trajectories", f"{task}.nc"))
        for name, hours in (("training", 120), ("normal", config["normal"]["test_hours"])):
            output = done.path("simulation", task, f"{name}.nc")
            simulate_run(robot, file, output, key=(name, task), hours=hours, settings=base)
        for name in names:
            simulate_worn_run(
                robot,
                file,
                done.path("simulation", task, name),
                cell=Cell(task, *cells[name]),
                settings={**base, "shape": wear["shape"], "wear_hours": wear["hours"]},
            )
        reference = done.path("features", task, "reference.nc")
        write_reference(done.path("simulation", task, "training.nc"), reference, features)
        for name in ("training.nc", "normal.nc", *names):
            write_features(done.path("simulation", task, name), reference, done.path("features", task, name), features)
        model, training = done.path("detection", task, "model.nc"), done.path("features", task, "training.nc")
        write_normal_model(training, model, detection)
        for name in ("normal.nc", *names):
            own, scored = done.path("features", task, name), done.path("detection", task, name)
            write_detection(own, model, scored, detection)
            write_location(
                own, training, scored, done.path("location", task, name), {"reading": reading_of(config, "location")}
            )
    for name in TABLES:
        write_tables(
            name,
            done.path("tables", name),
            ROOT / PUBLISHED,
            features=[done.path("features", run) for run in runs],
            detections=[done.path("detection", run) for run in runs],
            locations=[done.path("location", run) for run in runs],
            replicate=config["report"]["replicate"],
        )
    draw(done)
    done.write_report()
    return done


def draw(done: Experiment) -> None:
    """Draw all figures of an experiment."""
    published, replicate = ROOT / PUBLISHED, done.config["report"]["replicate"]
    run = done.results.figure_run
    task = done.figure_task

    def svg(name: str) -> str:
        return done.path("figures", f"{name}.svg")

    draw_figure_1(run["simulation"], done.results.robot, run["task"], published, svg("figure_1"), replicate)
    draw_figure_2(run["features"], published, svg("figure_2"), replicate)
    draw_figure_3(
        done.results.models[task],
        run["detection"],
        published,
        svg("figure_3"),
        replicate,
        done.config["detection"]["confidence"],
    )
    draw_figure_4([done.path("trajectories", f"{t}.nc") for t in done.config["tasks"]], published, svg("figure_4"))
    draw_lag_map(done.path("tables", "table_ii.nc"), svg("table_ii"), replicate)
    draw_detection_map(done.path("tables", "table_iv.nc"), svg("table_iv"))


@cache
def small_experiment() -> Experiment:
    """Return the small experiment; it is computed at the first call of a test session."""
    folder = mkdtemp(prefix="jointwear-")
    atexit.register(shutil.rmtree, folder, ignore_errors=True)
    return compute(Path(folder), small_config())
