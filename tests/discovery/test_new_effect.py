"""Discovery knows the library by what effects say of themselves: a new one is one file."""

import re
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from discovery_cases import coarse

from jointwear import effects
from jointwear.discovery import discover


def test_discovery_knows_no_effect_by_name():
    # A robot file has a key `payload` of its own.
    names = "|".join(sorted(set(effects.library()) - {"payload"}))
    for path in sorted(Path("workflow/jointwear/discovery").rglob("*.py")):
        text = path.read_text(encoding="utf-8")
        assert not re.search(rf"\b(?:{names})\b", text), path
        assert not re.search(r"effect\w*\s*[!=]=\s*[\"']|label\.split\(", text), path


NEW = '''
"""A hump of the housing that the joint rides over."""
import numpy as np
from jointwear.effects.effect import Effect, Parameter

def _columns(state, axis, source, p):
    return (1 / np.cosh((state.position[..., axis] - p["place"]) / p["width"]) ** 2)[..., None]

EFFECT = Effect(
    identifier="housing_hump", name="Hump of the housing", equation="h / cosh^2((q - q0) / w)",
    parameters=(
        Parameter("height", "N m", -1e4, 1e4, "h"),
        Parameter("place", "rad", -9.0, 9.0, "q0", fixed=True),
        Parameter("width", "rad", 0.01, 1.0, "w", 0.1),
    ),
    confused_with=("joint_spring",), excitation="both directions", source="a test", argument="position",
    argument_unit="rad", columns=_columns,
    torque=lambda state, axis, source, p: p["height"] * _columns(state, axis, source, p)[..., 0],
    parameters_of=lambda p, c: {**p, "height": float(c[0])},
    grid=lambda state, axis: [{"place": float(x), "width": 0.1} for x in np.linspace(-0.5, 0.5, 11)],
)
'''


def test_an_effect_of_one_new_file_is_found_named_and_written(robot, tmp_path):
    recording = coarse(robot, seed=9, step=1e-6)
    hump = 3.0 / np.cosh((recording.position[:, 2] - 0.2) / 0.12) ** 2
    torque = recording.torque.copy()
    torque[:, 2] += hump
    (tmp_path / "housing_hump.py").write_text(NEW, encoding="utf-8")
    with effects.more_entries(tmp_path):
        found = discover(replace(recording, torque=torque), robot)
        assert [(e["effect"], e["axis"]) for e in found.effects] == [("housing_hump", 3)]
        (entry,) = found.augmented_robot["effects"]
        assert entry["parameters"]["height"] == pytest.approx(3.0, rel=0.1)
        with found.files["augmented"].robot() as written:
            effects.check_effects(written)


def test_the_effect_of_the_how_to_is_found_where_it_begins(robot, tmp_path):
    """Its grid held the median of the positions alone, as a convention: what began elsewhere had no name."""
    block = re.search(r"```python\n# file: \S+\n(.*?)```", Path("docs/howto/effect.md").read_text("utf-8"), re.DOTALL)
    (tmp_path / "one_sided_load.py").write_text(block[1], encoding="utf-8")
    recording = coarse(robot, seed=9, step=1e-6)
    torque = recording.torque.copy()
    torque[:, 1] += 6.0 * (recording.position[:, 1] > np.quantile(recording.position[:, 1], 0.63))
    with effects.more_entries(tmp_path):
        found = discover(replace(recording, torque=torque), robot)
    assert [(e["effect"], e["axis"]) for e in found.effects] == [("one_sided_load", 2)]
    size = found.effects[0]["parameters"]["torque"]
    assert size["value"] == pytest.approx(6.0, abs=3 * size["std"])
    assert size["std"] < 1.0


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        ("EFFECT =", "EFECT =", "defines no EFFECT"),
        ('"housing_hump"', '"hump"', "'identifier' is 'hump', the file says 'housing_hump'"),
        ("joint_spring", "joint_sprin", "'confused_with' names 'joint_sprin', .*; did you mean 'joint_spring'"),
        ("columns=_columns", "colums=_columns", "is no effect: TypeError: .*'colums'"),
        ("-9.0, 9.0", "9.0, -9.0", "parameter 'place' goes from 9 to -9; the lower bound comes first"),
        ("EFFECT = Effect(", "EFFECT = Effect((", "is no effect: SyntaxError: "),
    ],
)
def test_a_file_that_defines_no_effect_is_named(tmp_path, old, new, words):
    (tmp_path / "housing_hump.py").write_text(NEW.replace(old, new), encoding="utf-8")
    with (
        pytest.raises(effects.InputError, match=rf"housing_hump\.py: {words}"),
        effects.more_entries(tmp_path),
    ):
        effects.library()
    assert "joint_spring" in effects.library()


@pytest.mark.parametrize(
    ("old", "new", "shape"),
    [("** 2)[..., None]", "** 2)", r"\(\d+,\)"), ("** 2)[..., None]", "** 2)[..., None].T", r"\(1, \d+\)")],
)
def test_columns_of_another_shape_are_named(robot, tmp_path, old, new, shape):
    """Columns of one dimension went through the fit without a word."""
    (tmp_path / "housing_hump.py").write_text(NEW.replace(old, new), encoding="utf-8")
    with (
        effects.more_entries(tmp_path),
        pytest.raises(
            effects.InputError, match=rf"'housing_hump': 'columns' gives shape {shape} \(allowed: \(\d+, k\)"
        ),
    ):
        discover(coarse(robot, seed=9, step=1e-6), robot)


def test_columns_that_are_not_finite_are_told_as_not_tried(robot, tmp_path):
    """They were a candidate that no evidence could ever speak for."""
    (tmp_path / "housing_hump.py").write_text(NEW.replace("** 2)[..., None]", "** 2)[..., None] / 0"), "utf-8")
    with effects.more_entries(tmp_path), np.errstate(divide="ignore"):
        found = discover(coarse(robot, seed=9, step=1e-6), robot)
    (untried,) = (one for one in found.content.not_tried if one.effect == "housing_hump")
    assert (untried.axis, untried.reason) == (None, "its columns are not finite on these data")
