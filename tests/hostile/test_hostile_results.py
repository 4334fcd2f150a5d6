"""Damaged intermediates: the next stage refuses them, or what it writes is what it would have written."""

import shutil

import netCDF4
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from isolation import held, outcome_of
from mutations import broken_bytes, seeds
from small_experiment import ROOT, compute, small_config

from jointwear.files.errors import InputError
from jointwear.publishing.soundness import check_whole
from jointwear.reproduction.diagnosis import diagnose_run
from jointwear.reproduction.features import write_features, write_reference
from jointwear.reproduction.normal_model import write_normal_model
from jointwear.reproduction.tables import write_tables
from jointwear.running.configuration import reading_of

pytestmark = pytest.mark.hostile
RUN, OTHER = "axis1_10percent", "axis6_20percent"
#: Stage -> the results that it reads; every stage is run on its own.
READ = {
    "reference": ["simulation/T1/training"],
    "features": [f"simulation/T1/{RUN}", "features/T1/reference"],
    "model": ["features/T1/training"],
    "diagnosis": [f"features/T1/{RUN}", "features/T1/training", "detection/T1/model"],
    "table_iv": [f"detection/T1/{RUN}", f"location/T1/{RUN}"],
    "table_vi": [f"features/T1/{RUN}", f"detection/T1/{RUN}"],
}
CASES = [(stage, name) for stage, names in READ.items() for name in names]


@pytest.fixture(scope="module")
def whole(tmp_path_factory):
    """A small experiment on one task, computed once."""
    folder = tmp_path_factory.mktemp("whole")
    compute(folder, {**small_config(), "tasks": ["T1"]})
    return folder / "results"


def run(stage, results, output):
    """Run one stage on the results in a folder and return what it wrote, as arrays by file and variable."""
    config = small_config()
    features = {"bins": config["histogram"]["bins"], "reading": reading_of(config, "features")}
    detection = {**config["detection"], "reading": reading_of(config, "detection")}

    def path(name):
        return str(results / f"{name}.nc")

    out = output / "results"
    if stage == "reference":
        write_reference(path("simulation/T1/training"), out / "x.nc", features)
    elif stage == "features":
        write_features(path(f"simulation/T1/{RUN}"), path("features/T1/reference"), out / "x.nc", features)
    elif stage == "model":
        write_normal_model(path("features/T1/training"), out / "x.nc", detection)
    elif stage == "diagnosis":
        diagnose_run(
            path(f"features/T1/{RUN}"),
            path("features/T1/training"),
            path("detection/T1/model"),
            detection=out / "x.nc",
            location=out / "y.nc",
            detection_settings=detection,
            location_settings={"reading": reading_of(config, "location")},
        )
    else:
        files = {f"{what}s": [path(f"{what}/T1/{r}") for r in (RUN, OTHER)] for what in ("detection", "location")}
        files["features"] = [path(f"features/T1/{r}") for r in (RUN, OTHER)]
        write_tables(stage, out / "x", ROOT / "config/paper/published.yaml", **files)
    return {p.name: numbers(p) for p in sorted(out.glob("*.nc"))}


def numbers(path):
    with netCDF4.Dataset(path) as data:
        data.set_auto_mask(False)
        return {name: np.asarray(v[...]).astype(str).tobytes() for name, v in data.variables.items()}


def damage(path, how, seed, other):
    """Damage a netCDF file through its own library, so that its checksums hold."""
    random = np.random.default_rng(seed)
    if how == "another cell":
        shutil.copyfile(other, path)
        return
    with netCDF4.Dataset(path, "a") as data:
        data.set_auto_mask(False)
        names = [n for n, v in data.variables.items() if v.dtype != str and v.dtype.kind == "f" and v.size]
        if how in ("nan", "infinity") and not names:
            return  # whole numbers cannot be either
        variable = data[names[random.integers(len(names))] if names else "lag"]
        if how in ("nan", "infinity"):
            values = variable[...]
            values.flat[random.integers(values.size)] = np.nan if how == "nan" else np.inf
            variable[...] = values
        elif how == "rename":
            data.renameVariable(variable.name, "something_else")
        elif how == "settings":
            lineage = data.lineage.replace("20150824", str(20150824 + 1 + int(random.integers(99))))
            data.lineage = lineage.replace('"bins": 12', '"bins": 13')


@pytest.mark.parametrize(("stage", "name"), CASES)
def test_bytes_of_a_result(whole, tmp_path, stage, name):
    expected = run(stage, whole, tmp_path / "expected")
    results = tmp_path / "results"
    shutil.copytree(whole, results)
    path = results / f"{name}.nc"
    data = path.read_bytes()

    @given(broken_bytes(data), st.integers(0, 10**6))
    @seeds(35)
    def check(damaged, number):
        path.write_bytes(damaged)
        out = tmp_path / f"out{number}"
        found = held(outcome_of(lambda: run(stage, results, out)))
        shutil.rmtree(out, ignore_errors=True)
        if found.kind == "accepted":
            assert found.value == expected
        if len(damaged) < len(data) // 2:
            assert held(outcome_of(lambda: check_whole(path))).kind == "refused"

    check()


@pytest.mark.parametrize("how", ["nan", "infinity", "rename", "another cell", "settings"])
@pytest.mark.parametrize(("stage", "name"), CASES)
def test_a_result_changed_by_hand(whole, tmp_path, stage, name, how):
    expected = run(stage, whole, tmp_path / "expected")
    for seed in range(3):
        results = tmp_path / f"{seed}/results"
        shutil.copytree(whole, results)
        path = results / f"{name}.nc"
        damage(path, how, seed, whole / f"{name.split('/')[0]}/T1/{OTHER if name.endswith(RUN) else RUN}.nc")
        found = held(outcome_of(lambda results=results: run(stage, results, results.parent / "out")))
        if found.kind == "accepted":
            assert found.value == expected, (stage, name, how)
        if how == "another cell":
            assert found.kind == "refused"
            assert "not its own" in found.value or "no such file" in found.value


def test_a_missing_result_is_named(whole, tmp_path):
    with pytest.raises(InputError, match="no such file"):
        run("model", tmp_path / "results", tmp_path / "out")
