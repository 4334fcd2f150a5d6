"""Which modules a script depends on, and the stale lock."""

import os
import subprocess
import sys
import time

from jointwear.running.modules import LIBRARY, imported_by
from jointwear.running.stale_lock import call_at_work, clear_stale_lock, note_run


def names(root, script):
    return {p.relative_to(LIBRARY).as_posix() for p in imported_by(root / f"workflow/scripts/{script}.py")}


def printed_by(root, code):
    """What the code prints in a Python of its own, which has loaded nothing yet."""
    done = subprocess.run(
        [sys.executable, "-c", code],
        capture_output=True,
        text=True,
        check=True,
        env={**os.environ, "PYTHONPATH": str(root / "workflow")},
    )
    return done.stdout


def test_modules_are_those_that_python_loads(root):
    for script in ("simulate_wear", "compute_features", "diagnose_run", "fit_normal_model"):
        source = (root / f"workflow/scripts/{script}.py").read_text().split("if __name__")[0]
        listing = "(m.__file__ for n, m in sys.modules.items() if n.startswith('jointwear'))"
        code = f"{source}\nimport sys\nprint('\\n'.join({listing}))"
        printed = printed_by(root, code)
        loaded = {os.path.relpath(line, LIBRARY) for line in printed.splitlines()}
        assert loaded <= names(root, script), script


def test_values_that_a_module_reads_beside_itself_count_with_it(root):
    values = [p for p in LIBRARY.rglob("*") if p.is_file() and p.suffix not in (".py", ".pyc")]
    assert values, "the library ships the calibration of the search"
    for path in values:
        readers = [p for p in path.parent.glob("*.py") if f'Path(__file__).with_name("{path.name}")' in p.read_text()]
        assert readers, f"{path} is read by no module in a way that makes it an input"
    assert "discovery/search/calibration.json" in names(root, "discover_dataset")
    assert "discovery/search/calibration.json" in names(root, "learn_normal")
    assert "discovery/search/calibration.json" not in names(root, "simulate_wear")


def test_a_stage_does_not_depend_on_what_it_does_not_use(root):
    assert "reproduction/detection.py" not in names(root, "simulate_wear")
    assert "reproduction/readings/onset_rule.py" not in names(root, "compute_features")
    assert "robots/dynamics.py" not in names(root, "diagnose_run")
    assert "reproduction/normal_model.py" not in names(root, "diagnose_run")


def test_reading_logs_does_not_depend_on_discovery(root):
    """An edited module of discovery must not read the logs of a customer again."""
    for script in ("survey_logs", "accumulate_windows"):
        assert not [name for name in names(root, script) if name.startswith("discovery/")]


def test_robot_months_are_not_simulated_again_for_an_edited_judge(root):
    simulated, judged = names(root, "simulate_shop_floor"), names(root, "judge_shop_floor")
    assert simulated < judged
    decides = {
        "judge",
        "judge_settings",
        "records",
        "decision",
        "recent_shifts",
        "baseline",
        "learning",
        "watching",
        "state",
    }

    def of_monitor(paths):
        return {path.rsplit("/", 1)[-1].removesuffix(".py") for path in paths if path.startswith("monitor/")}

    assert decides - {"state"} <= of_monitor(judged)
    assert not decides & of_monitor(simulated)
    assert not {f"studies/shop_floor/{name}.py" for name in ("stages", "judging", "scores", "aims")} & simulated


def test_training_does_not_depend_on_wear(root):
    assert "reproduction/wear.py" in names(root, "simulate_wear")
    assert "reproduction/wear.py" not in names(root, "simulate_training")
    assert "reproduction/wear.py" not in names(root, "simulate_normal")


def test_of_the_effects_those_of_the_robot_count(root):
    script = root / "workflow/scripts/simulate_wear.py"

    def effects(*chosen):
        modules = imported_by(script, frozenset(chosen))
        return {p.name for p in modules if "effects" in p.relative_to(LIBRARY).parts}

    assert effects() == set()
    assert "payload.py" in effects("payload")
    assert "cogging_torque.py" not in effects("payload")
    assert "state.py" in effects("payload")


def test_scoring_a_cell_imports_neither_scikit_learn_nor_pinocchio(root):
    heavy = ("sklearn", "pinocchio", "xarray", "pandas", "matplotlib", "scipy")
    modules = "jointwear.reproduction.detection, jointwear.reproduction.location"
    code = f"import sys, {modules}; print([m for m in {heavy} if m in sys.modules])"
    assert printed_by(root, code).strip() == "[]"


def lock(root):
    locks = root / ".snakemake" / "locks"
    locks.mkdir(parents=True, exist_ok=True)
    (locks / "0.input.lock").write_text("a\n")
    return locks


def test_a_stale_lock_is_cleared(tmp_path):
    locks = lock(tmp_path)
    assert clear_stale_lock(tmp_path)
    assert not locks.exists()
    assert not clear_stale_lock(tmp_path)


def test_the_lock_of_a_live_run_stays(tmp_path):
    locks = lock(tmp_path)
    script = tmp_path / "snakemake"
    script.write_text("import time; time.sleep(60)")
    process = subprocess.Popen([sys.executable, str(script)], cwd=tmp_path)
    try:
        time.sleep(0.5)
        assert not clear_stale_lock(tmp_path, patience=0.1)
        assert locks.exists()
    finally:
        process.kill()
        process.wait()
    assert clear_stale_lock(tmp_path)


def test_another_call_at_work_is_told_as_long_as_it_holds_the_lock(tmp_path):
    """Snakemake proposes to unlock the folder, which would let two calls write the same files."""
    locks, script = lock(tmp_path), tmp_path / "snakemake"
    script.write_text("import time; time.sleep(60)")
    process = subprocess.Popen([sys.executable, str(script)], cwd=tmp_path)
    try:
        time.sleep(0.5)
        assert call_at_work(tmp_path) is None
        note_run(tmp_path)
        marker = tmp_path / ".snakemake" / "jointwear_host"
        marker.write_text(marker.read_text().replace(str(os.getpid()), str(process.pid)))
        assert call_at_work(tmp_path) == process.pid
        (locks / "0.input.lock").unlink()
        assert call_at_work(tmp_path) is None
    finally:
        process.kill()
        process.wait()
    lock(tmp_path)
    assert call_at_work(tmp_path) is None


def test_the_lock_of_another_host_stays(tmp_path):
    lock(tmp_path)
    note_run(tmp_path)
    (tmp_path / ".snakemake" / "jointwear_host").write_text("elsewhere 1\n")
    assert not clear_stale_lock(tmp_path)
