"""Figures: what they show, that they say it in words, and that the same numbers give the same bytes."""

import os
import re
import subprocess
import sys
import xml.etree.ElementTree as ElementTree
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from small_experiment import FIGURES, PUBLISHED, ROOT, draw, small_experiment

from jointwear.files.errors import InputError
from jointwear.files.storage import Variable, read_variables, write_dataset
from jointwear.publishing.figures import figure_3, palette
from jointwear.publishing.figures.cells import figure_cell
from jointwear.publishing.figures.curves import divergence_curves, friction_curves, residual_curves
from jointwear.publishing.figures.detection_map import draw_detection_map
from jointwear.publishing.figures.figure_4 import draw_figure_4
from jointwear.publishing.figures.lag_map import draw_lag_map
from jointwear.publishing.figures.style import new_figure, save
from jointwear.publishing.report.inline import inline_svg
from jointwear.reproduction.grid import Cell
from jointwear.reproduction.tables import write_table
from jointwear.reproduction.wear import Wear
from jointwear.robots.robot import load_robot

SVG = "{http://www.w3.org/2000/svg}"
COLOUR = re.compile(r"#[0-9a-f]{6}")


@pytest.fixture(scope="session")
def experiment():
    return small_experiment()


def text_of(path):
    return " ".join("".join(e.itertext()) for e in ElementTree.parse(path).iter(f"{SVG}text"))


@pytest.mark.parametrize("name", FIGURES)
def test_figure_is_svg_with_words_and_without_date(experiment, name):
    path = Path(experiment.path("figures", f"{name}.svg"))
    root = ElementTree.parse(path).getroot()
    assert root.findtext(f"{SVG}title")
    assert len(root.findtext(f"{SVG}desc")) > 40
    content = path.read_text(encoding="utf-8")
    assert "dc:date" not in content
    assert "<image" not in content
    assert len(content) < 300_000


def test_same_numbers_give_the_same_bytes(experiment, tmp_path):
    """Drawn again into another folder, in another order of calls, every byte is the same."""
    (tmp_path / "results").mkdir()
    for stage in ("simulation", "features", "detection", "trajectories", "tables"):
        (tmp_path / "results" / stage).symlink_to(experiment.path(stage))
    draw(replace(experiment, folder=tmp_path))
    for name in FIGURES:
        again = (tmp_path / "results/figures" / f"{name}.svg").read_bytes()
        assert again == Path(experiment.path("figures", f"{name}.svg")).read_bytes(), name


def test_a_matplotlibrc_of_the_user_changes_nothing(tmp_path):
    """As of somebody who writes papers: there is no TeX where the workflow runs."""
    code = (
        "from jointwear.publishing.figures.style import new_figure, save; "
        "f = new_figure(2.0); a = f.add_subplot(); a.plot([1, 2], [3, 5]); a.set_xlabel('time [h]'); "
        "save(f, {output!r}, 'A line', 'It rises.')"
    )
    (tmp_path / "matplotlibrc").write_text("text.usetex: True\nfont.size: 20\naxes.facecolor: red\n")
    drawn = []
    for name, more in (("plain.svg", {}), ("own.svg", {"MATPLOTLIBRC": str(tmp_path / "matplotlibrc")})):
        output = tmp_path / name
        environment = {k: v for k, v in os.environ.items() if k != "MATPLOTLIBRC"} | {
            "PYTHONPATH": str(ROOT / "workflow")
        }
        command = [sys.executable, "-c", code.format(output=str(output))]
        subprocess.run(command, env=environment | more, check=True)
        drawn.append(output.read_bytes())
    assert drawn[0] == drawn[1]


def test_drawing_imports_neither_pyplot_nor_scipy_nor_xarray():
    modules = [f"jointwear.publishing.figures.{n}" for n in ("figure_1", "figure_2", "figure_3", "figure_4", "lag_map")]
    code = f"import sys, {', '.join(modules)}, jointwear.publishing.figures.detection_map; print(' '.join(sys.modules))"
    done = subprocess.run(
        [sys.executable, "-c", code], cwd=ROOT / "workflow", capture_output=True, text=True, check=True
    )
    loaded = set(done.stdout.split())
    assert not loaded & {"matplotlib.pyplot", "scipy", "xarray", "pandas", "sklearn", "pinocchio"}


def test_units_and_published_values_stand_in_the_figures(experiment):
    figure = {name: text_of(experiment.path("figures", f"{name}.svg")) for name in FIGURES}
    assert "[h]" in figure["figure_1"]
    assert "27.5 to 30 N m" in figure["figure_1"]
    assert "[nat]" in figure["figure_2"]
    assert "10 nat" in figure["figure_2"]
    assert "paper 72 h" in figure["figure_3"]
    assert "x [m]" in figure["figure_4"]
    assert "paper: 60 h" in figure["table_iv"]
    assert "−27" in figure["table_ii"]


@pytest.mark.parametrize("ours", [40.0, 71.0, 73.0, 118.0])
def test_labels_of_figure_3_stay_apart(experiment, tmp_path, monkeypatch, ours):
    placed = {}
    curves = figure_3.residual_curves
    monkeypatch.setattr(
        figure_3, "residual_curves", lambda *told: replace(c := curves(*told), onset=np.full(len(c.onset), ours))
    )
    monkeypatch.setattr(
        figure_3, "direct_label", lambda axes, x, y, text, colour, **how: placed.update({text.split()[0]: (x, y, how)})
    )
    model = experiment.results.models[experiment.figure_task]
    run = experiment.results.figure_run["detection"]
    figure_3.draw_figure_3(model, run, ROOT / PUBLISHED, tmp_path / "figure_3.svg", 1, 0.95)
    (our_hour, our_height, our_side), (hour, height, side) = placed["our"], placed["paper"]
    assert our_height > 1.5 * height
    if our_hour > hour:
        assert side["ha"] == "right"
    else:
        assert (our_side["ha"], side["ha"]) == ("right", "left")


def test_friction_of_figure_1_is_equation_8(experiment):
    run = experiment.results.figure_run
    curves = friction_curves(run["simulation"], experiment.results.robot, run["task"], 1)
    arm = load_robot(experiment.results.robot)
    wear = Wear(10, experiment.config["wear"]["shape"])
    for curve, levels in zip(curves, (arm.coulomb_positive, -arm.coulomb_negative), strict=True):
        expected = levels[0] * (1 + wear.growth(curve.hour)) + arm.viscous[0] * abs(curve.velocity)
        np.testing.assert_allclose(curve.friction, expected, rtol=1e-12)
        assert np.abs(curve.measured - curve.friction).max() < 0.1 * levels[0]
        assert np.abs(curve.measured - curve.friction).max() > 0


def test_an_axis_at_rest_shows_its_coulomb_friction_alone(experiment):
    arm = load_robot(experiment.results.robot)
    task = str(ROOT / "config/tasks/T1.yaml")
    curves = friction_curves(experiment.path("simulation/T1/axis6_20percent.nc"), experiment.results.robot, task, 1)
    assert [c.velocity for c in curves] == [0, 0]
    assert curves[0].friction[-1] == pytest.approx(1.2 * arm.coulomb_positive[5])


def test_curves_summarise_the_replicates(experiment):
    run = experiment.results.figure_run
    (kl,) = read_variables(run["features"], "kl_divergence")
    curves = divergence_curves(run["features"], 2)
    np.testing.assert_allclose(curves.divergence.median, np.median(kl, axis=0), rtol=1e-12)
    np.testing.assert_array_equal(curves.divergence.single, kl[1])
    assert (curves.divergence.low <= curves.divergence.median).all()
    assert (curves.divergence.median <= curves.divergence.high).all()
    np.testing.assert_array_equal(curves.peak, kl.max(axis=(1, 2)))
    residuals = residual_curves(experiment.results.models["T1"], run["detection"], 1)
    assert residuals.training_hour[-1] == 0
    assert residuals.hour[0] == 1
    assert residuals.run.median[-1] > residuals.limit.median


def test_the_run_of_the_paper_is_shown_where_the_grid_has_it():
    wanted = Cell("T1", 10.0, 1)
    assert figure_cell(wanted, ["T2", "T1"], [6, 1], [20, 10]) == wanted
    assert figure_cell(wanted, ["T2", "T1"], [3, 2], [10]) == Cell("T2", 10.0, 3)
    assert figure_cell(wanted, ["Weld"], [7], [12.5]) == Cell("Weld", 12.5, 7)


def test_maps_cope_with_a_grid_that_the_paper_never_ran(tmp_path):
    row = {"task": "Weld", "increase_percent": 12.5, "published": None, "verdict": "not comparable"}
    row |= dict.fromkeys(("probability_low", "probability_high", "hour_low", "hour_high", "located_probability"))
    runs = [
        {**row, "axis": 7, "detection_probability": 0.25, "hour_median": 99},
        {**row, "axis": 2, "detection_probability": 0.0, "hour_median": None},
    ]
    write_table("table_iv", runs, tmp_path / "table_iv", {})
    draw_detection_map(tmp_path / "table_iv.nc", tmp_path / "map.svg")
    assert "not comparable" in text_of(tmp_path / "map.svg")
    write_table("table_ii", [], tmp_path / "table_ii", {})
    draw_lag_map(tmp_path / "table_ii.nc", tmp_path / "lags.svg", 1)
    assert "not in the grid" in text_of(tmp_path / "lags.svg")


@pytest.mark.parametrize("tasks", [["Far"], ["T1", "T2", "T3", "T4", "Far"]])
def test_figure_4_widens_for_paths_beyond_the_papers_axes(tmp_path, tasks):
    path = np.array([[0.5, 0, 0], [1.5, -1.2, 0.3], [0.5, 0, 0]])
    content = {
        "end_effector": Variable(("time", "coordinate"), path, "path", "m"),
        "waypoint": Variable(("stop", "coordinate"), path[:2], "stops", "m"),
    }
    files = [str(tmp_path / f"{task}.nc") for task in tasks]
    for file in files:
        write_dataset(file, content, {})
    draw_figure_4(files, ROOT / PUBLISHED, tmp_path / "figure.svg")
    assert all(f"{task}, top view" in text_of(tmp_path / "figure.svg") for task in tasks)


def luminance(colour):
    channel = np.array([int(colour[j : j + 2], 16) / 255 for j in (1, 3, 5)])
    linear = np.where(channel <= 0.04045, channel / 12.92, ((channel + 0.055) / 1.055) ** 2.4)
    return float(linear @ [0.2126, 0.7152, 0.0722])


@given(share=st.floats(0, 1), stops=st.sampled_from([palette.SEQUENTIAL, palette.DIVERGING]))
def test_text_on_a_coloured_patch_is_readable(share, stops):
    colour = palette.mix(stops, share)
    dark, light = sorted((luminance(colour), luminance(palette.text_on(colour))))
    assert (light + 0.05) / (dark + 0.05) >= 4.0


def test_colours_of_a_ramp_start_and_end_at_its_stops():
    assert palette.mix(palette.SEQUENTIAL, -1) == palette.SEQUENTIAL[0]
    assert palette.mix(palette.SEQUENTIAL, 2) == palette.SEQUENTIAL[-1]
    assert palette.mix(palette.DIVERGING, 0.5) == palette.DIVERGING[2]


def test_every_colour_of_the_theme_is_defined_in_both_themes():
    style = (ROOT / "report/style.css").read_text(encoding="utf-8")
    light, _, dark = style.partition("@media (prefers-color-scheme: dark)")
    for name in palette.VARIABLES.values():
        assert f"{name}:" in light, name
        assert f"{name}:" in dark.partition("* { box-sizing")[0], name


def test_figures_use_only_colours_that_a_theme_can_replace(experiment):
    """In the line figures every colour is one of the palette, so that none stays behind in the dark theme."""
    for name in ("figure_1", "figure_2", "figure_3", "figure_4"):
        used = set(COLOUR.findall(Path(experiment.path("figures", f"{name}.svg")).read_text(encoding="utf-8")))
        assert used <= set(palette.VARIABLES), (name, used - set(palette.VARIABLES))


def test_no_flipped_bit_of_a_picture_is_believed(tmp_path):
    path = tmp_path / "map.svg"
    save(new_figure(0.4), path, "Nothing", "Nothing at all.")
    whole = path.read_bytes()
    drawn = inline_svg(path, "a")
    for place in range(0, len(whole), 7):
        path.write_bytes(whole[:place] + bytes([whole[place] ^ 1 << place % 8]) + whole[place + 1 :])
        try:
            found = inline_svg(path, "a")
        except InputError:
            continue
        # What follows the picture is the checksum itself.
        assert place > len(whole) - 30
        assert found == drawn


def test_a_picture_without_a_view_box_is_named(tmp_path):
    (tmp_path / "a.svg").write_text('<svg xmlns="http://www.w3.org/2000/svg"><desc>x</desc></svg>')
    with pytest.raises(InputError, match=r"a\.svg: has no view box"):
        inline_svg(tmp_path / "a.svg", "a")
