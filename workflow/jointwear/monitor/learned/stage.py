"""``snakemake learn_normal``: the logs of a robot's baseline in, the robot file that the monitor uses out."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from jointwear.discovery.model.written_robot import WrittenRobot, simulate_robot
from jointwear.discovery.pipeline import Discovery, discover
from jointwear.effects import check_effects, get_effect
from jointwear.files.errors import InputError
from jointwear.files.json_documents import write_json
from jointwear.files.json_values import six_digits
from jointwear.files.text_files import replace_text
from jointwear.files.wording import count
from jointwear.measurement.derived.motion import Measured, measure
from jointwear.measurement.formats import layout_of
from jointwear.monitor.found_logs import find_logs
from jointwear.monitor.learned.gather import SHORTEST, Piece, baseline_pieces
from jointwear.monitor.learned.programs import programs_of
from jointwear.monitor.learned.selection import FEWEST_PIECES, choose, recording_of
from jointwear.monitor.learned_model import learnt_from
from jointwear.robots.robot import Robot, load_robot
from jointwear.robots.robot_file import read_robot_file, robot_sources

#: Error on held-out motion of any axis, over that of the given robot, up to which a learnt robot is handed on.
NOT_WORSE = 1.05
#: Programs beside the one learnt from on which it is checked, and pieces of each.
CHECKED, CHECKED_PIECES = 4, 8
#: Robot files by how much they change, the one that changes most first.
KINDS = ("augmented", "retuned", "friction")
#: Verdict of discovery where the given robot is right.
NOTHING = "none"


def learn_normal(
    name: str, entry: Mapping[str, Any], folder: str | Path, logs: Sequence[str] | None = None
) -> dict[str, Any]:
    """Run discovery on the baseline of one robot and write `robot.yaml`, `verdict.json` and `learned.json`.

    Discovery sees one program, the one with most samples. What it wrote is handed on if no axis is followed worse, on
    held-out pieces of that program and on the others: the augmented robot, else the retuned one, else the given one
    with the friction of those axes that are followed no worse. Where none holds, or nothing was found, there is no
    robot file and the monitor keeps the given robot.

    Parameters
    ----------
    entry : of the robot in ``monitor.robots``; its `robot` is the given one. folder : for the files.
    logs : of the robot, in order; default those that its patterns match.

    Returns
    -------
    dict : the content of `learned.json`.

    Raises
    ------
    InputError : if the baseline holds too little motion, or contradicts the robot.
    """
    folder = Path(folder)
    arm = load_robot(entry["robot"])
    check_effects(arm)
    layout = layout_of(entry, arm.joint_names)
    logs = find_logs(entry["logs"], f"monitor.robots.{name}.logs") if logs is None else logs
    pieces, refused = baseline_pieces(logs, layout, entry)
    groups = _by_program(pieces, refused, name)
    recording = recording_of(choose(groups[0]), name)
    found = discover(recording, arm)
    checked = [_checked(group, name) for group in groups[1 : 1 + CHECKED]]

    def error_of(robot: Robot) -> list[np.ndarray]:
        return _errors(robot, found.problem.measured, recording.test, checked)

    adopted, files, errors = _adopted(found, arm, entry["robot"], error_of)
    for stale in ("robot.yaml", "robot.urdf"):
        (folder / stale).unlink(missing_ok=True)
    if adopted != "given":
        files[adopted].write(folder / "robot.yaml")
    replace_text(folder / "verdict.json", found.to_json())
    told = {
        "robot": name,
        "given": str(entry["robot"]),
        "learnt_from": learnt_from(entry, [p.log for p in pieces]),
        "adopted": adopted,
        "verdict": found.verdict,
        "left_out": dropped(found.files["augmented"]),
        "programs": [_program(group, used=k == 0) for k, group in enumerate(groups)],
        "error": {
            "unit": "N m",
            "per": "axis, RMS over held-out motion: of the program learnt from, then of the others",
        }
        | {kind: [[six_digits(e) for e in row] for row in rows] for kind, rows in errors.items()},
        "refused": refused,
    }
    write_json(folder / "learned.json", told)
    return told


def _by_program(pieces: Sequence[Piece], refused: Sequence[str], name: str) -> list[list[Piece]]:
    """Return the pieces of each program, of the one with most samples first.

    Raises
    ------
    InputError : if there are too few to learn from.
    """
    if len(pieces) < FEWEST_PIECES:
        why = f" ({refused[0]})" if refused else ""
        raise InputError(
            f"config: 'monitor.robots.{name}.baseline' holds {count(len(pieces), 'uninterrupted piece')} of motion, "
            f"{FEWEST_PIECES} are needed to learn from{why}; let it reach over more of the logs, by more 'windows' or "
            f"a later 'until': each window gives one piece, of {SHORTEST:g} s or more without a gap"
        )
    label = programs_of([p.chunk.position for p in pieces])
    groups = [[p for p, k in zip(pieces, label, strict=True) if k == program] for program in range(label.max() + 1)]
    # Hardly any two pieces run over one path: a robot that does something else each time is one program.
    return groups if len(groups[0]) >= FEWEST_PIECES else [list(pieces)]


def _adopted(
    found: Discovery, given: Robot, source: str | Path, error_of: Callable[[Robot], list[np.ndarray]]
) -> tuple[str, dict[str, WrittenRobot], dict[str, list[np.ndarray]]]:
    """Return the kind of robot file that is handed on, "given" for none, all files and their errors by kind.

    Parameters
    ----------
    source : of the given robot. error_of : a robot's RMS errors [N m], one array (n,) for each program.
    """
    files = {kind: steady(found.files[kind]) for kind in KINDS[:2]}
    files["friction"] = with_given_links(files["augmented"], source)
    errors, adopted = {"given": error_of(given)}, "given"
    for kind in KINDS:
        with files[kind].robot() as learnt:
            errors[kind] = error_of(learnt)
        spared = [] if kind != "friction" else worse_axes(errors[kind], errors["given"])
        if spared and len(spared) < given.joints:
            # Friction is a matter of its axis: those that it makes worse keep what they had.
            files[kind] = with_given_links(files["augmented"], source, spared)
            with files[kind].robot() as learnt:
                errors[kind] = error_of(learnt)
        # A run that names nothing and retunes nothing writes the given robot anew.
        same = all(
            np.allclose(a, b, rtol=1e-9, equal_nan=True) for a, b in zip(errors[kind], errors["given"], strict=True)
        )
        if adopted == "given" and found.verdict != NOTHING and not same and not worse(errors[kind], errors["given"]):
            adopted = kind
    return adopted, files, errors


def steady(file: WrittenRobot) -> WrittenRobot:
    """Return a robot file without effects that follow time: what drifted in the baseline goes on in no known way."""
    kept = [e for e in file.data["effects"] if not get_effect(e["effect"]).follows_time]
    return replace(file, data={**file.data, "effects": kept})


def with_given_links(file: WrittenRobot, robot: str | Path, spared: Sequence[int] = ()) -> WrittenRobot:
    """Return a robot file with the links and the payload of the given robot: another program carries another load.

    The 0-based axes `spared` keep their given friction too, and no effect that was found on them.
    """
    given = read_robot_file(robot)
    data = {key: value for key, value in file.data.items() if key not in ("links", "payload")}
    data |= {key: given[key] for key in ("links", "payload") if key in given}
    data["joints"] = [given["joints"][j] if j in spared else joint for j, joint in enumerate(data["joints"])]
    numbers = {j + 1 for j in spared}
    data["effects"] = [
        effect
        for effect in data["effects"]
        if effect in given.get("effects", []) or not numbers & {effect["axis"], effect.get("source_axis")}
    ]
    urdf = Path(robot_sources(str(robot))[1]).read_text(encoding="utf-8") if file.urdf is not None else None
    return replace(file, data=data, urdf=urdf)


def dropped(file: WrittenRobot) -> list[str]:
    """Return the effects that :func:`steady` leaves out, in words."""
    gone = [e for e in file.data["effects"] if get_effect(e["effect"]).follows_time]
    return [f"{e['effect']} of axis {e['axis']}" for e in gone]


def worse(errors: Sequence[np.ndarray], given: Sequence[np.ndarray]) -> bool:
    """Return whether any axis is followed worse than by the given robot in any program; as :func:`worse_axes`."""
    return bool(worse_axes(errors, given))


def worse_axes(errors: Sequence[np.ndarray], given: Sequence[np.ndarray]) -> list[int]:
    """Return the 0-based axes that are followed worse than by the given robot in any program.

    Parameters
    ----------
    errors, given : (n,) [N m] of each program; NaN where an axis has no motion in it.
    """
    return np.flatnonzero(np.any(np.stack(errors) > NOT_WORSE * np.stack(given), axis=0)).tolist()


def _checked(pieces: Sequence[Piece], name: str) -> Measured:
    recording = recording_of(choose(pieces)[:CHECKED_PIECES], name)
    return measure(replace(recording, train=None, test=None))


def _errors(robot: Robot, learnt: Measured, test: Sequence[int], others: Sequence[Measured]) -> list[np.ndarray]:
    """Return RMS errors (n,) [N m]: on the held-out pieces of the program learnt from, then on each other program."""
    rows = [_error(robot, learnt, np.isin(learnt.trajectory, test))]
    return rows + [_error(robot, m, np.ones(len(m.time), dtype=bool)) for m in others]


def _error(robot: Robot, measured: Measured, chosen: np.ndarray) -> np.ndarray:
    used = measured.usable & chosen[:, None]
    square = np.where(used, (measured.torque - simulate_robot(robot, measured)[0]) ** 2, 0.0).sum(axis=0)
    count = used.sum(axis=0)
    with np.errstate(invalid="ignore"):
        return np.sqrt(np.where(count > 0, square / np.maximum(count, 1), np.nan))


def _program(pieces: Sequence[Piece], used: bool) -> dict[str, Any]:
    warmth = [p.warmth for p in pieces]
    seconds = sum(float(p.chunk.time[-1] - p.chunk.time[0]) for p in pieces)
    known = np.isfinite(warmth).any()
    return {
        "learnt_from": used,
        "pieces": len(pieces),
        "seconds": six_digits(seconds),
        "temperature": [six_digits(np.nanmin(warmth)), six_digits(np.nanmax(warmth))] if known else None,
        "logs": len({p.log for p in pieces}),
    }
