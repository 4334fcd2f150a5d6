"""The tier "world" without its plants: the plan of cases, the scores and the page. The plants: test_world_plants."""

import ast

import numpy as np
import pytest

from jointwear.files.errors import InputError
from jointwear.files.json_documents import read_json
from jointwear.studies.challenge import tiers
from jointwear.studies.challenge.judge import gap_closed, worse_axes
from jointwear.studies.challenge.reliability import reliability
from jointwear.studies.challenge.tracking import ArmLost, follows
from jointwear.studies.hidden_effect_page.stored import write_stored_page
from jointwear.studies.tallies import QUESTIONS
from jointwear.studies.world import answers, packages, plan
from jointwear.studies.world.control import CONTROLLERS, Controller, Reader, Reference
from jointwear.studies.world.plan import BATCH, COUNTS, EFFECTS, OUTSIDE, batches, cases, part_batches
from jointwear.studies.world.scores import TARGETS, WORDS, score
from jointwear.studies.world.stages import solve_if_possible, summary


def row(kind="nothing", **more):
    return {
        "kind": kind, "subject": None, "identifiable": True, "verdict": "none", "named": [], "names": [],
        "false_name": False, "seconds": 1.0, "worse": [], "worse_than_truth": [], "arm": "ur5", **more,
    }  # fmt: skip


@pytest.mark.parametrize(("stored", "drawings"), [("challenge", tiers.DRAWINGS), ("challenge_world", plan.DRAWINGS)])
def test_the_command_of_a_stored_score_draws_the_cases_that_it_was_made_on(root, stored, drawings):
    assert read_json(root / f"data/benchmarks/{stored}.json")["drawing"] == drawings["report"]


def test_the_plan_has_four_hundred_cases_and_every_part_is_a_like_mixture():
    every = cases("report")
    assert len(every) == len(set(every)) == sum(COUNTS.values()) >= 400
    assert [c for batch in batches("report") for c in batch] == every
    first = [c for batch in batches("report")[:4] for c in batch]
    for kind, count in COUNTS.items():
        expected = count * len(first) / len(every)
        assert abs(sum(c.kind == kind for c in first) - expected) <= 1
    assert {c.subject for c in first if c.kind == "single"} == set(EFFECTS)
    assert len({c.subject for c in first if c.kind == "outside"}) == len(OUTSIDE)
    assert part_batches("report") == ("report", -(-len(every) // BATCH))
    assert part_batches("choose_first_3") == ("choose", 3)


def test_the_plants_know_nothing_of_what_searches(root):
    folder = root / "workflow/jointwear/studies/world"
    meets = {"answers.py", "stages.py", "__main__.py", "sensitivity.py", "assumptions.py", "calibration.py"}
    for path in folder.glob("*.py"):
        if path.name in meets:
            continue
        words = [
            name
            for node in ast.walk(ast.parse(path.read_text(encoding="utf-8")))
            if isinstance(node, ast.Import | ast.ImportFrom)
            for name in [getattr(node, "module", None) or "", *(alias.name for alias in node.names)]
        ]
        assert not [w for w in words if w.startswith(("jointwear.discovery", "jointwear.effects"))], path.name


def test_a_controller_reads_whole_steps_and_answers_to_them():
    clock = np.arange(3000) * 1e-3
    position = np.stack([0.3 * np.sin(2 * clock), 0.2 * np.cos(3 * clock)], axis=1)
    velocity = np.gradient(position, 1e-3, axis=0)
    steps = np.array([1e-3, 2e-4])

    def controller(kind, read):
        still = Reference(*np.zeros((3, len(clock), 2)))
        return Controller(kind, still, np.array([2.0, 1.0]), 20.0, 1e-3, Reader(read, 1e-3))

    for kind in CONTROLLERS:
        fine, coarse = controller(kind, np.full(2, 1e-12)), controller(kind, steps)
        known = np.array([coarse.reader.read(q, v) for q, v in zip(position, velocity, strict=True)])
        assert np.abs(known[:, 0] / steps - np.round(known[:, 0] / steps)).max() < 1e-6
        # The speed of the motion is right in the mean, where it is smoothed over a few samples alone.
        assert np.abs((known[:, 1] - velocity).mean(axis=0)).max() < 5e-3
        answered = coarse.answer_to_steps(position)
        assert not controller(kind, np.zeros(2)).answer_to_steps(position).any()
        coarse.restart()
        asked, without = (
            np.array([c.torque(k, position[k], velocity[k]) for k in range(len(clock))]) for c in (coarse, fine)
        )
        # What is left is what the integral of the second law has added up.
        assert np.all((asked - without - answered).std(axis=0) < 0.2 * answered.std(axis=0))


def test_an_arm_that_its_controller_loses_is_no_case(monkeypatch):
    wanted = np.stack([np.sin(np.arange(900) / 50), np.cos(np.arange(900) / 50)], axis=1)
    assert follows(wanted + 0.2, wanted)
    assert not follows(wanted + np.where(np.arange(900) == 700, 2.0, 0.0)[:, None], wanted)

    def lost(case):
        raise ArmLost("the controller loses the arm in recording 3")

    monkeypatch.setattr("jointwear.studies.world.stages.solve_case", lost)
    assert solve_if_possible(cases("report")[0]) is None


def test_choosing_and_report_cases_have_other_seeds():
    assert not {(c.key, c.index) for c in cases("choose")} & {(c.key, c.index) for c in cases("report")}
    with pytest.raises(InputError, match="did you mean 'report'"):
        cases("reprot")


def test_every_score_with_a_target_has_words():
    assert set(TARGETS) <= set(WORDS)
    assert set(QUESTIONS) <= set(WORDS)


def test_false_names_and_what_got_worse_are_counted():
    rows = [row() for _ in range(9)] + [row(false_name=True, worse=[2], named=[["payload", None]], names=[])]
    found = score(rows)
    assert found["false_names"]["value"] == found["worse"]["value"] == 0.1
    assert found["false_names"]["reached"] is False
    assert found["exact_set"]["value"] is None
    assert found["exact_set"]["reached"] is None


def test_calibration_error_is_the_mean_distance_of_probability_and_share():
    names = [{"right": k < 15, "probability": 0.75} for k in range(20)]
    assert score([row(names=names)])["calibration_error"]["value"] == pytest.approx(0.0)
    names = [{"right": k < 10, "probability": 1.0} for k in range(20)]
    assert score([row(names=names)])["calibration_error"]["value"] == pytest.approx(0.5)
    assert [b["names"] for b in reliability([row(names=names)])] == [20]


def test_the_gap_is_measured_from_what_derived_motion_costs():
    assert gap_closed({"nominal": 3.0, "augmented": 1.0}, 1.0) == pytest.approx(1.0)
    assert gap_closed({"nominal": 3.0, "augmented": 2.0}, 1.0) == pytest.approx(0.5)
    assert gap_closed({"nominal": 1.01, "augmented": 2.0}, 1.0) is None


def test_worse_axes_are_named():
    truth = np.zeros((4, 2))
    predicted = np.array([np.ones((4, 2)), np.ones((4, 2)), np.tile([1.04, 1.06], (4, 1))])
    truth[0] = np.nan
    assert worse_axes(predicted, truth) == [2]


def test_a_refusal_of_a_disturbance_from_outside_is_a_wrong_answer():
    facts = dict.fromkeys(answers.CIRCUMSTANCES) | {
        "case": "world_4000", "tier": "world", "kind": "outside", "subject": "hose", "closed_loop": True,
        "effects": [], "wrong_parameter": None,
    }  # fmt: skip
    nothing = np.full((3, 4, 2), np.nan)
    case = answers.WorldCase(None, None, {}, facts, nothing[0], nothing[0], nothing[0])
    judged = answers.judged(case, {"refused": "joints 1 and 2 look swapped"}, nothing, 1.0)
    assert judged["refused"]
    assert judged["verdict"] == "refused"
    assert answers.is_right(judged) is False


def test_an_interval_holds_what_lies_within_two_deviations():
    given = {"mass": {"value": 1.1, "std": 0.06}, "moment_x": {"value": 0.2, "std": None}}
    assert answers._parameters({"mass": 1.0, "moment_x": 0.2, "moment_y": 0.0}, given) == {
        "mass": {"true": 1.0, "value": 1.1, "std": 0.06, "covered": True}
    }


def test_a_missing_engine_is_one_line(monkeypatch):
    packages.mujoco.cache_clear()
    monkeypatch.setitem(__import__("sys").modules, "mujoco", None)
    with pytest.raises(InputError, match="make plants installs it"):
        packages.mujoco()
    packages.mujoco.cache_clear()


def test_the_page_puts_the_tier_first(tmp_path, root, monkeypatch):
    class Engine:
        __version__ = "4.0.0"

    monkeypatch.setattr("jointwear.studies.world.stages.mujoco", lambda: Engine)
    kept = tmp_path / "world.json"
    found = summary(
        [row(), row(false_name=True), row("outside", subject="push", unknown_only=True)], "report_first_1", ["0"]
    )
    kept.write_text(__import__("json").dumps(found))
    page = tmp_path / "challenge.html"
    write_stored_page(root / "data/benchmarks/challenge.json", None, page, str(kept))
    text = page.read_text()
    assert text.index('id="world"') < text.index('id="scores"')
    assert "names where nothing is hidden" in text
    assert f"3 of {sum(COUNTS.values())} cases" in text
