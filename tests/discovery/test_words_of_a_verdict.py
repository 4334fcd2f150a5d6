"""The words of a verdict: heading, first words, what is told once, and bodies, ranges and gaps as people read them."""

import pytest

from jointwear.discovery import findings
from jointwear.discovery.findings import make_verdict
from jointwear.discovery.held_out import above_the_noise, noise_too_high, with_told_floor
from jointwear.discovery.presentation.page import (
    below_the_floor,
    body_in_words,
    hardly_told,
    heading,
    joint_table,
    lead,
    put_back_in_words,
    refused_alone,
    strongest_at,
    strongest_first,
    what_follows,
)
from jointwear.discovery.search.leftovers import LINE
from jointwear.discovery.verdict import Gap, Retuned
from jointwear.effects import library


def test_the_page_does_not_claim_the_noise_where_it_is_not_reached(found):
    content = {**found.data, "to_the_noise": False}
    content["above_the_noise"] = [{"axis": 1, "ratio": 2.0}]
    text = " ".join(lead(content))
    assert "nothing beyond the noise" not in text
    assert "2 times on joint 1" in text
    assert heading(content).endswith(", and more than noise is left on joint 1")
    assert joint_table(content)[0]["left"] == ["error 2 times the noise"]
    assert heading(found.data) == "The model lacks an effect"


def test_friction_that_builds_up_is_told_before_what_is_missing(found):
    """A model whose only fault is that its simulator rounds the sign was headed "Nothing is missing"."""
    content = {**found.data, "verdict": "none", "above_the_noise": [], "effects": [], "suspects": []}
    content["builds_up"] = [{"axis": k, "form": "tanh", "speed": 0.02} for k in (1, 3)]
    assert heading(content) == "Nothing is missing; friction builds up with the speed on joints 1 and 3"
    assert lead(content)[0].startswith("Friction of joints 1 and 3 builds up with the speed")
    content["builds_up"] = [{"axis": k, "form": "tanh", "speed": 0.02} for k in range(1, 7)]
    assert heading(content).endswith("friction builds up with the speed on every joint")
    assert lead(content)[0].startswith("Friction of every joint builds up with the speed")
    assert not found.data["builds_up"]


def test_what_has_no_name_is_put_beside_a_gap_that_is_closed():
    """The page said that retuning closes all, and that a part has no name."""
    gap = {"nominal": [9.0], "retuned": [1.02], "augmented": [1.02], "noise_floor": [1.0]}
    content = {"verdict": "unknown", "effects": [], "above_the_noise": [], "suspects": [], "gap": gap}
    closed = lead(content)[-1]
    assert "retuning alone closes 100 %, the augmented model closes 100 %; what has no name is small" in closed.replace(
        "\u202f", " "
    ).replace("\u00a0", " ")
    assert lead({**content, "gap": {**gap, "retuned": [4.0], "augmented": [3.0]}})[-1].endswith("75\u202f%.")
    named = {**content, "verdict": "retuned", "to_the_noise": True}
    assert "no name" not in lead(named)[-1]


def test_what_has_no_name_where_all_of_the_gap_is_closed_is_an_order():
    """A page closed 100 % of the gap and said that more than noise has no name."""
    gap = {"nominal": [9.0], "retuned": [1.02], "augmented": [1.02], "noise_floor": [1.0]}
    content = {"verdict": "unknown", "effects": [], "above_the_noise": [], "suspects": [], "gap": gap}
    assert "it shows in how what is left is ordered, not in the size of this error" in lead(content)[-1]
    content |= {"above_the_noise": [{"axis": 1, "ratio": 1.2}], "to_the_noise": False}
    assert lead(content)[-1].endswith("is small beside that gap, but more than noise.")


def test_the_strongest_of_every_joint_is_told_before_the_rest():
    found = [{"axis": a, "argument": x} for a, x in ((1, "position"), (1, "time"), (2, "time"), (1, "torque"))]
    first, further = strongest_first(found)
    assert [(u["axis"], u["argument"]) for u in first] == [(1, "position"), (2, "time")]
    assert [u["argument"] for u in further] == ["time", "torque"]


def test_a_suspect_is_not_told_as_refused_too():
    one = {"effect": "joint_spring", "axis": 1, "source_axis": None}
    other = {**one, "axis": 2}
    assert refused_alone({"suspects": [one], "lost": [one, other]}) == [other]


@pytest.mark.parametrize(("mass", "way"), [(2.58, "heavier"), (-2.58, "lighter")])
def test_a_body_that_would_explain_a_link_is_among_the_first_words(found, mass, way):
    content = {**found.data, "bodies": [{"link": 2, "mass": mass, "sigmas": 4.0}]}
    told = [
        words for words in lead(content) if words.startswith(f"Link 2 came out 2.58 kg {way}, 4 standard deviations")
    ]
    assert len(told) == 1
    assert not any(words.startswith("Link") for words in lead({**found.data, "bodies": []}))


def test_a_body_that_would_explain_a_link_is_told_once(found, monkeypatch):
    """Its sentence stood among the restrictions too."""
    off = [Retuned("link_mass", 2, 2.0, 4.58, 0.01, "kg")]
    monkeypatch.setattr(findings, "retuned_parameters", lambda final: off)
    verdict = make_verdict("a", found.final, found.map, found.torques, [])
    assert [body.link for body in verdict.bodies] == [2]
    assert not any("mass" in words for words in verdict.restrictions)


def test_an_elastic_gear_is_told_with_its_stiffness():
    (stiffness,) = library()["joint_flexibility"].derived
    assert stiffness.value({"inertia": 3.0, "inertia_over_stiffness": 1e-3}) == pytest.approx(3000.0)
    assert stiffness.value({"inertia": 0.0, "inertia_over_stiffness": 1e-3}) is None
    assert "K = inertia" in what_follows("joint_flexibility", "stiffness")
    assert what_follows("joint_spring", "stiffness") == ""


def test_what_a_model_does_to_the_gap_is_told_in_words_that_can_be_true(found):
    """A page said that a model closes 102 % of a gap, and that another widens it by 0 %."""
    gap = {"nominal": [9.0], "retuned": [49.0], "augmented": [0.9], "noise_floor": [1.0]}
    content = {**found.data, "verdict": "effects", "suspects": [], "gap": gap}
    told = lead(content)[-1].replace("\u202f", " ").replace("\u00a0", " ")
    assert (
        "retuning alone widens it by 500 % (its file is not the one to use), the augmented model closes 100 %" in told
    )
    assert "the augmented model leaves it as it is" in lead({**content, "gap": {**gap, "augmented": [9.01]}})[-1]
    neither = {**gap, "augmented": [9.01], "retuned": [9.0]}
    assert lead({**content, "gap": neither})[-1].endswith(": neither retuning nor the augmented model changes it.")


def test_a_model_that_widens_the_gap_is_not_the_one_to_use(found):
    """Of an augmented model as bad as the retuned one the page had warned of the latter alone."""
    gap = {"nominal": [9.0], "retuned": [10.0], "augmented": [10.0], "noise_floor": [1.0]}
    told = lead({**found.data, "gap": gap})[-1]
    assert told.count("its file is not the one to use") == 2


def test_of_joints_whose_noise_is_not_known_no_gap_is_told(found):
    gap = {"nominal": [9.0, 5.0], "retuned": [9.0, 5.0], "augmented": [2.0, 3.0], "noise_floor": [2.0, 1.0]}
    content = {**found.data, "suspects": [], "gap": gap, "noise_untold": [1]}
    assert "closes 50" in lead(content)[-1]
    assert not any("closes" in words for words in lead({**content, "noise_untold": [1, 2]}))


def test_noise_is_no_more_than_what_is_left_of_the_held_out_motion():
    gap = Gap((33.0, 1.0, 9.0), (33.0, 1.0, 9.0), (1.97, 1.0, 9.0), (7.7, 1.3, 4.0))
    told, unsure = with_told_floor(gap, [2])
    assert told.noise_floor == (1.97, 1.3, None)
    assert unsure == {1: 7.7}
    words = list(noise_too_high(told, unsure))
    assert len(words) == 1
    assert "7.7 N m" in words[0]
    assert below_the_floor({"augmented": told.augmented, "noise_floor": told.noise_floor}) == [2]


def test_a_range_of_most_of_the_motion_is_no_place():
    wide = {"range": [-7.2, 6.06], "unit": "rad/s", "share_of_range": 0.9}
    assert strongest_at(wide) == ""
    assert strongest_at({**wide, "range": [1.0, 2.0], "share_of_range": 0.1}) == "1 to 2 rad/s"
    assert strongest_at({**wide, "range": [2.3, 2.3], "unit": "Hz", "share_of_range": 0.0}) == "2.3 Hz"
    # A verdict of an earlier version does not say.
    del wide["share_of_range"]
    assert strongest_at(wide)


def test_a_heading_counts_effects_and_a_lead_tells_what_shakes(found):
    twice = {**found.data, "effects": 2 * found.data["effects"][:1], "above_the_noise": [], "builds_up": []}
    assert heading(twice) == "The model lacks 2 effects"
    line = {"axis": 2, "argument": LINE, "range": [2.3, 2.3], "unit": "Hz", "p_value": 1e-300}
    assert "Something shakes at a frequency of its own: joint 2 at 2.3 Hz." in lead({**twice, "unexplained": [line]})


def test_axes_above_the_noise_are_told_with_their_ratio():
    gap = Gap((9.0,) * 3 + (None,), (9.0,) * 3 + (None,), (1.05, 1.34, 3.0, None), (1.0, 1.0, 2.0, None))
    assert [(a.axis, a.ratio) for a in above_the_noise(gap, 0.1)] == [(2, 1.34), (3, 1.5)]


def test_a_load_is_given_as_a_body():
    mass, x, z = 2.0, 0.1, 0.2
    value = {"mass": mass, "moment_x": mass * x, "moment_y": 0.0, "moment_z": mass * z}
    value |= {"xx": 0.01 + mass * z**2, "yy": 0.02 + mass * (x**2 + z**2), "zz": 0.03 + mass * x**2}
    words = body_in_words({"parameters": {name: {"value": v} for name, v in value.items()}})
    assert words.startswith("2 kg with its centre of mass at (100, 0, 200) mm in the frame of the last link")
    assert "0.01, 0.02, 0.03 kg m²" in words
    assert body_in_words({"parameters": {"level": {"value": 1.0}}}) == ""


@pytest.mark.parametrize(
    ("value", "std", "told"), [(8586.0, 21532.0, False), (-2.0, 2.0, False), (-2.0, 0.1, True), (0.0, None, True)]
)
def test_a_parameter_no_larger_than_its_standard_deviation_is_hardly_told(value, std, told):
    assert hardly_told({"value": value, "std": std}) is not told


def test_what_was_put_back_is_told_once_with_its_reason():
    drive, links = "friction and motor inertia as given", "inertia of the links as given"
    same = {"axis": 2, "ratio": 1.725, "steps": [{"step": drive, "ratio": 1.725}, {"step": links, "ratio": 1.9}]}
    same |= {"kept": f"{drive}, {links}", "held_out": 1.0}
    everything = "everything of this joint as given"
    little = {"model": "retuned", "axis": 1, "ratio": 0.7608, "steps": [{"step": everything, "ratio": 0.7608}]}
    put_back = [
        {"model": "augmented", **same},
        {"model": "retuned", **same},
        {**little, "kept": "all as given", "held_out": None},
    ]
    first, second = put_back_in_words({"fallbacks": put_back, "unexplained": [{"axis": 1}]})
    assert first.startswith("Joint 1, retuned model: as fitted, its error on records left out was 0.761 times ")
    assert "stands in for what stays unexplained" in first
    assert first.endswith(f"Put back: {everything}. The file holds: all as given.")
    assert second.startswith(
        "Joint 2, augmented and retuned models: as fitted, its error on records left out was 1.73 "
    )
    assert second.endswith(
        f"Put back: {drive}; then, at 1.9 times, {links}. The file holds: {drive}, {links}. "
        "On held-out motion it has the same error as the given robot."
    )
    assert put_back_in_words({"fallbacks": [], "unexplained": []}) == []
    alike = {**little, "steps": [{"step": everything, "ratio": 0.9998}], "kept": "all as given", "held_out": None}
    (told,) = put_back_in_words({"fallbacks": [alike], "unexplained": []})
    assert "its error on records left out was as large as that of the given robot" in told
