"""The page of one data set: where, what, before and after, gap; plain words first."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from jointwear.discovery.presentation.drawing import draw_all
from jointwear.discovery.search.leftovers import LINE
from jointwear.discovery.search.rocking import SWING
from jointwear.effects import library
from jointwear.files.documents import read_yaml
from jointwear.files.json_documents import read_json
from jointwear.files.shown_numbers import number, percent, with_std
from jointwear.files.text_files import replace_text
from jointwear.files.wording import digits_apart, listed, numbered
from jointwear.publishing.report.inline import inline_svg
from jointwear.publishing.report.rendering import render_page

_WORDS = {
    "none": "Nothing is missing",
    "retuned": "Parameters are wrong, no effect is missing",
    "effects": "The model lacks an effect",
    "unknown": "Part of the disagreement has no name",
}
_PARAMETERS = {
    "coulomb_positive": "positive Coulomb friction",
    "coulomb_negative": "negative Coulomb friction",
    "viscous": "viscous friction",
}
#: Share of the error of the given robot below which a gap is too narrow for a part of it to be told.
NARROW = 0.05
#: Share of a gap that a page with whole percents would print as none.
HARDLY = 0.005
UNCHANGED = "leaves it as it is"
#: Share of what the motion covers from which a range is no place any more.
NO_PLACE = 0.5


def lead(content: dict[str, Any]) -> list[str]:
    """Return the verdict in sentences."""
    effects = library()

    def name(e: dict[str, Any]) -> str:
        where = "on the whole arm" if e["axis"] is None else f"on joint {e['axis']}"
        source = f", from joint {e['source_axis']}" if e["source_axis"] else ""
        return f"{effects[e['effect']].phrase} {where}{source}"

    named = [name(e) for e in content["effects"]]
    sentences = []
    if _builds_up(content):
        sentences.append(
            f"Friction of {_joints(content, _builds_up(content))} builds up with the speed instead of turning over at "
            "rest. No robot file can hold that; it was put right before anything else was asked."
        )
    missing = "No effect was found" if content["above_the_noise"] else "No effect is missing"
    if content["verdict"] == "none":
        sentences.append(f"{missing} and no parameter needs to change.")
    elif content["verdict"] == "retuned":
        sentences.append(f"{missing}; parameters of terms that the model has are wrong.")
    elif content["verdict"] == "effects":
        sentences.append(f"The model lacks {'; '.join(named)}.")
    elif named:
        sentences.append(f"The model lacks {'; '.join(named)}. Besides, there is structure that no effect explains.")
    elif not _too_coarse(content) + _rings(content) or content["unexplained"]:
        sentences.append("There is structure beyond the noise that no effect of the library explains.")
    else:
        sentences.append(_nothing_told(content))
    if lines := _lines(content):
        sentences.append(lines)
    if content["verdict"] != "unknown" or content["above_the_noise"]:
        sentences.append(_what_is_left(content))
    if content["suspects"]:
        suspects = "; ".join(name(e) for e in content["suspects"])
        sentences.append(f"Suspects, which are no names: {suspects}.")
    sentences += _bodies(content)
    closed = _closed(content["gap"], _untold(content))
    if closed is not None:
        alone, augmented = map(_of_the_gap, closed)
        warned = ["" if share > -NARROW else " (its file is not the one to use)" for share in closed]
        done = f"retuning alone {alone}{warned[0]}, the augmented model {augmented}{warned[1]}"
        if alone == augmented == UNCHANGED:
            done = "neither retuning nor the augmented model changes it"
        sentences.append(f"The gap between model and noise on held-out motion: {done}{_beside_it(content, closed[1])}.")
    return sentences


def _of_the_gap(share: float) -> str:
    """Say what a model does to the gap, of which it closes a share; by chance it may be nearer than the noise."""
    if abs(share) < HARDLY:
        return UNCHANGED
    return f"closes {percent(min(share, 1.0))}" if share > 0 else f"widens it by {percent(-share)}"


def _lines(content: Mapping[str, Any]) -> str:
    """Say at which frequencies joints shake that no effect explains, empty where none does."""
    lines = (u for u in content.get("unexplained", ()) if u["argument"] == LINE)
    told = [f"joint {u['axis']} at {number(u['range'][0])} Hz" for u in lines]
    if told:
        return f"Something shakes at a frequency of its own: {listed(told)}."
    swings = [u for u in content.get("unexplained", ()) if u["argument"] == SWING]
    if not swings:
        return ""
    joints = _joints(content, sorted(u["axis"] for u in swings))
    return (
        f"Something swings with the motion at {number(swings[0]['range'][0])} Hz on {joints}: a base, a column or a "
        "load that gives way."
    )


def _untold(content: Mapping[str, Any]) -> list[int]:
    """Return the joints whose noise floor is not known; a verdict of an earlier version does not ask."""
    return content.get("noise_untold", [])


def _bodies(content: Mapping[str, Any]) -> list[str]:
    """Say which body would explain a corrected link; a verdict of an earlier version does not ask."""
    told = []
    for body in content.get("bodies", ()):
        mass, more = number(abs(body["mass"])), body["mass"] > 0
        way = "heavier" if more else "lighter"
        there = "that moves with it, as a payload does," if more else "that is in the robot file alone"
        told.append(
            f"Link {body['link']} came out {mass} kg {way}, {body['sigmas']:.2g} standard deviations of its prior: a "
            f"body of that mass {there} would explain the same."
        )
    return told


def _too_coarse(content: Mapping[str, Any]) -> list[int]:
    """Return the joints whose data are too coarse in time for any noise floor."""
    return [axis for axis in _untold(content) if content["gap"]["noise_floor"][axis - 1] is None]


def _rings(content: Mapping[str, Any]) -> list[int]:
    """Return the joints on which what looks like noise is ringing; a verdict of an earlier version does not ask."""
    return content.get("rings", [])


def _nothing_told(content: Mapping[str, Any]) -> str:
    """Say of which joints nothing is known because noise is not told from what the model lacks, and why."""
    if coarse := _too_coarse(content):
        return (
            f"On {_joints(content, coarse)} these data are too coarse in time to tell noise from what the model lacks: "
            "nothing can be said there."
        )
    return (
        f"On {_joints(content, _rings(content))} what looks like noise comes in bursts that no sensor makes, "
        "as lost motion in a gear, a resonance or a poor torque signal make it: what is missing there cannot be told."
    )


def _builds_up(content: Mapping[str, Any]) -> list[int]:
    """Return the joints whose friction builds up; a verdict of an earlier version does not ask."""
    return [b["axis"] for b in content.get("builds_up", ())]


def _joints(content: Mapping[str, Any], axes: Sequence[int]) -> str:
    """Return joints by their numbers, or `every joint` where a robot of several has no other."""
    return "every joint" if 1 < len(axes) == len(content["gap"]["nominal"]) else numbered("joint", axes)


def _beside_it(content: Mapping[str, Any], closed: float) -> str:
    """Say how what has no name can be there though nearly all of the gap is closed, empty where that is no question."""
    if content["verdict"] != "unknown" or closed < 1 - NARROW:
        return ""
    if content["above_the_noise"]:
        return "; what has no name is small beside that gap, but more than noise"
    return (
        "; what has no name is small beside that gap: it shows in how what is left is ordered, not in the size of this "
        "error"
    )


def _what_is_left(content: dict[str, Any]) -> str:
    """Say whether the held-out error is down to the noise, and where it is not."""
    if content["to_the_noise"]:
        return "On held-out motion nothing beyond the noise is left."
    above = [f"{a['ratio']:.2g} times on joint {a['axis']}" for a in content["above_the_noise"]]
    if not above and _untold(content):
        return f"The noise of {_joints(content, _untold(content))} is not known: how much is left there cannot be told."
    if not above:
        return "The held-out error could not be compared with the noise."
    told = f"The error on held-out motion stays above the noise: {', '.join(above)}"
    if content["verdict"] in ("none", "retuned"):
        # Coarse positions do that to robots to which nothing is missing; so did a soft base.
        told += "; coarse positions do that, or something small without a name, as a base that gives way"
    return f"{told}."


def heading(content: Mapping[str, Any]) -> str:
    """Return the verdict as a heading that says where more than noise is left, structure told or not."""
    words = _WORDS[content["verdict"]]
    if content["verdict"] == "unknown" and not (content["unexplained"] or content["effects"]):
        if coarse := _too_coarse(content):
            return f"Too coarse in time to say what is missing on {_joints(content, coarse)}"
        if _rings(content):
            return f"Something rings on {_joints(content, _rings(content))}: what is missing there cannot be told"
    if content["verdict"] == "effects" and len(content["effects"]) > 1:
        words = f"The model lacks {len(content['effects'])} effects"
    if _builds_up(content):
        words += f"; friction builds up with the speed on {_joints(content, _builds_up(content))}"
    axes = [a["axis"] for a in content["above_the_noise"]]
    if content["verdict"] == "unknown" or not axes:
        return words
    words = words.replace("no effect is missing", "no effect was found").replace(_WORDS["none"], "No effect was found")
    return f"{words}, and more than noise is left on {_joints(content, axes)}"


def _closed(gap: dict[str, Any], untold: Sequence[int]) -> tuple[float, float] | None:
    """Return the closed part of the gap by retuning and by the augmented model, on the root sum of squares.

    Joints, from 1, whose noise is `untold` do not count: how much of their gap is left nobody knows.
    """
    total = {}
    for kind in ("nominal", "retuned", "augmented", "noise_floor"):
        values = zip(gap[kind], gap["nominal"], gap["noise_floor"], strict=True)
        total[kind] = sum(
            v**2 for axis, (v, n, f) in enumerate(values, 1) if None not in (v, n, f) and axis not in untold
        )
    root = {k: v**0.5 for k, v in total.items()}
    width = root["nominal"] - root["noise_floor"]
    if width <= NARROW * root["nominal"]:
        return None
    return tuple(1 - (root[k] - root["noise_floor"]) / width for k in ("retuned", "augmented"))


def hardly_told(parameter: Mapping[str, Any]) -> bool:
    """Return whether a fitted parameter is no larger than its standard deviation: of it the data say next to nothing,
    as where two parameters of one form trade with each other.
    """
    return parameter["std"] is not None and parameter["std"] >= abs(parameter["value"])


def body_in_words(effect: Mapping[str, Any]) -> str:
    """Return an effect given by mass and first moments as a body: mass [kg] with its standard deviation, centre of mass
    [mm] and moments of inertia about it [kg m2]; empty for others.
    """
    value = {name: p["value"] for name, p in effect["parameters"].items()}
    if not {"mass", "moment_x", "moment_y", "moment_z", "xx", "yy", "zz"} <= set(value) or value["mass"] <= 0:
        return ""
    com = [value[f"moment_{x}"] / value["mass"] for x in "xyz"]
    # Steiner: from the origin of the link to the centre of mass.
    square = sum(x * x for x in com)
    moments = [value[k] - value["mass"] * (square - x * x) for k, x in zip(("xx", "yy", "zz"), com, strict=True)]
    std = effect["parameters"]["mass"].get("std")
    return (
        f"{with_std(value['mass'], std)} kg with its centre of mass at "
        f"({', '.join(number(1e3 * x) for x in com)}) mm in the frame of the last link, "
        f"moments of inertia about it {', '.join(number(x) for x in moments)} kg m²."
    )


def parameter_words(key: str) -> str:
    """Return a parameter of a robot file as readers know it."""
    return _PARAMETERS.get(key, key.replace("_", " "))


def meaning(effect: str, parameter: str) -> str:
    """Return what a parameter of an effect is, with its symbol in the equation; empty where the effect says nothing."""
    return next((p.description for p in library()[effect].parameters if p.name == parameter), "")


def joint_table(content: Mapping[str, Any]) -> list[dict[str, Any]]:
    """Return one row per joint: what was named, corrected and left, and the part of the gap that each model leaves."""
    effects, gap = library(), content["gap"]
    whole = [effects[e["effect"]].phrase for e in content["effects"] if e["axis"] is None]
    rows = []
    for axis in range(1, len(gap["nominal"]) + 1):
        named = [
            effects[e["effect"]].phrase + (f" from joint {e['source_axis']}" if e["source_axis"] else "")
            for e in content["effects"]
            if e["axis"] == axis
        ]
        left = [u["argument"] for u in content["unexplained"] if u["axis"] == axis]
        if not left:
            above = (a["ratio"] for a in content["above_the_noise"] if a["axis"] == axis)
            left = [f"error {number(ratio)} times the noise" for ratio in above]
        retuned = [parameter_words(r["parameter"]) for r in content["retuned"] if r["axis"] == axis]
        k = axis - 1
        better = None
        if gap["retuned"][k] and gap["augmented"][k]:
            better = gap["retuned"][k] / gap["augmented"][k]
        rows.append({"axis": axis, "named": named + whole, "left": left[:3], "retuned": retuned, "better": better})
    return rows


def put_back_in_words(content: Mapping[str, Any]) -> list[str]:
    """Return for every joint on which a model was put back why, what went back in which order, and what is written.

    Models of which all that is the same are told together.
    """
    models: dict[tuple, list[str]] = {}
    for f in content["fallbacks"]:
        steps = tuple((s["step"], s["ratio"]) for s in f["steps"])
        models.setdefault((f["axis"], steps, f["kept"], f["held_out"]), []).append(f["model"])
    told, still = [], {u["axis"] for u in content["unexplained"]}
    for (axis, steps, kept, held_out), names in sorted(models.items(), key=lambda found: found[0][0]):
        put_back = "; ".join(
            step if k == 0 else f"then, at {_as_much(ratio)}, {step}" for k, (step, ratio) in enumerate(steps)
        )
        first = steps[0][1]
        times = "as large as" if number(first) == "1" else f"{number(first)} times"
        why = f"as fitted, its error on records left out was {times} that of the given robot"
        if max(ratio for _, ratio in steps) <= 1.0:
            stands_in = "it stands in for what stays unexplained there and may be worse in the next recording"
            why += f", but {stands_in if axis in still else 'it gains in some stretches of time and loses in others'}"
        end = "" if held_out is None else f" On held-out motion it has {_times_given(held_out)}."
        told.append(
            f"Joint {axis}, {' and '.join(sorted(names))} model{'s' if len(names) > 1 else ''}: {why}. Put back: "
            f"{put_back}. The file holds: {kept}.{end}"
        )
    return told


def _as_much(ratio: float) -> str:
    return "as much" if number(ratio) == "1" else f"{number(ratio)} times"


def _times_given(ratio: float) -> str:
    """Return an error, as a ratio to that of the given robot, in words."""
    return "the same error as the given robot" if number(ratio) == "1" else f"{number(ratio)} times the given error"


def strongest_first(unexplained: Sequence[Mapping[str, Any]]) -> tuple[list[Mapping], list[Mapping]]:
    """Return the strongest structure of every joint, and the rest: one cause shows over a dozen arguments."""
    first: dict[int, Mapping] = {}
    for one in unexplained:
        first.setdefault(one["axis"], one)
    return list(first.values()), [one for one in unexplained if one is not first[one["axis"]]]


def refused_alone(content: Mapping[str, Any]) -> list[Mapping[str, Any]]:
    """Return the candidates that came close and are not told as suspects already."""
    keys = ("effect", "axis", "source_axis")
    told = {tuple(one[k] for k in keys) for one in content["suspects"]}
    return [one for one in content["lost"] if tuple(one[k] for k in keys) not in told]


def what_follows(effect: str, quantity: str) -> str:
    """Return what a quantity is that follows from the parameters of an effect; empty where the effect says nothing."""
    return next((d.description for d in library()[effect].derived if d.name == quantity), "")


def strongest_at(structure: Mapping[str, Any]) -> str:
    """Return where structure is strongest, empty where that is half or more of what the motion covers.

    A verdict of an earlier version does not say how much that is.
    """
    if structure.get("share_of_range", 0.0) >= NO_PLACE:
        return ""
    low, high = map(number, structure["range"])
    return f"{low} {structure['unit']}" if low == high else f"{low} to {high} {structure['unit']}"


def below_the_floor(gap: Mapping[str, Any]) -> list[int]:
    """Return the joints of which a page shows a noise floor above the error of the augmented model."""
    pairs = enumerate(zip(gap["augmented"], gap["noise_floor"], strict=True), 1)
    return [axis for axis, (a, f) in pairs if a is not None and f is not None and number(a) != number(f) and a < f]


def compare_published(content: Mapping[str, Any], published: Mapping[str, Any]) -> list[dict[str, Any]]:
    """Return published values beside those found; `found` is None where the effect was not named."""
    rows = []
    for entry in published["values"]:
        same = [
            e
            for e in content["effects"]
            if (e["effect"], e["axis"], e["source_axis"]) == (entry["effect"], entry["axis"], entry.get("source_axis"))
        ]
        found = same[0]["parameters"].get(entry["parameter"]) if same else None
        rows.append({**entry, "found": found["value"] if found else None, "std": found["std"] if found else None})
    return rows


def write_page(
    verdict: str | Path,
    where: str | Path,
    models: str | Path,
    output: str | Path,
    figures: str | Path,
    published: str | Path | None = None,
) -> None:
    """Write the page of one data set.

    Parameters
    ----------
    figures : folder for its SVG files. published : YAML file with values that others found, or None.
    """
    content = read_json(verdict)
    files = draw_all(verdict, where, models, figures)
    effects = library()
    untried = {n["effect"] for n in content["not_tried"]}
    single = [n for n in content["not_identifiable"] if len(n["effects"]) == 1 and n["effects"][0] not in untried]
    pairs = [n for n in content["not_identifiable"] if len(n["effects"]) > 1]
    context = {
        "content": content,
        "heading": heading(content),
        "lead": lead(content),
        "library": effects,
        "number": number,
        "digits_apart": digits_apart,
        "figures": {name: inline_svg(path, name.replace("_", "-")) for name, path in files.items()},
        "files": {name: Path(path).relative_to(Path(output).parent).as_posix() for name, path in files.items()},
        "single": single,
        "joints": joint_table(content),
        "put_back": put_back_in_words(content),
        "parameter_words": parameter_words,
        "meaning": meaning,
        "body": body_in_words,
        "hardly_told": hardly_told,
        "strongest_at": strongest_at,
        "strongest": dict(zip(("first", "further"), strongest_first(content["unexplained"]), strict=True)),
        "lost": refused_alone(content),
        "what_follows": what_follows,
        "below_the_floor": numbered("joint", below) if (below := below_the_floor(content["gap"])) else "",
        "published": None,
        "pairs": pairs,
        "weak": list(dict.fromkeys(effects[n["effects"][0]].phrase for n in single)),
    }
    if published is not None:
        others = read_yaml(str(published))
        context["published"] = {**others, "rows": compare_published(content, others)}
    replace_text(output, render_page("discover.html.j2", context))
