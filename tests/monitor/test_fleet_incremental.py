"""A month fed in pieces says what the whole month says, whatever came first and whatever was changed on the way."""

import numpy as np
import pytest
from monitor_logs import ROBOT, START, columns, make_log, write_parquet

from jointwear.files.storage import open_dataset
from jointwear.monitor.fleet import watch

pytestmark = pytest.mark.usefixtures("surveyed_once", "no_pages")
DAYS, DAY, WORN = 9, 86400.0, 2
ENTRY = {"logs": ["logs/*"], "robot": str(ROBOT), "window": "12s", "baseline": {"until": START + DAY * 4}}
EVENTS = [{"time": START + DAY * 6, "axes": [WORN + 1], "kind": "service", "note": "greased"}]


@pytest.fixture(scope="module")
def days(tmp_path_factory):
    """Logs of a robot, axis 3 of which wears."""
    folder = tmp_path_factory.mktemp("days")
    paths = []
    for number in range(DAYS):
        log = make_log(36.0, seed=number, start=START + DAY * number, noise=0.02)
        log.torque[:, WORN] += 2.0 * max(number - 3, 0) * np.sign(log.velocity[:, WORN])
        # Each axis logs a temperature of its own, so that no warm-up state is looked for.
        rise = np.linspace(0, 3, len(log.time)) + number % 3
        warm = {f"temperature_{j + 1}": 30.0 + (1 + 0.1 * j) * rise for j in range(6)}
        paths.append(str(write_parquet(folder / f"day_{number:02d}.parquet", columns(log) | warm)))
    return paths


def said(folder):
    """What was judged: the alarms as text, and every number and word of the state."""
    with open_dataset(folder / "arm/state.nc") as dataset:
        state = {name: np.ma.getdata(dataset.variables[name][:]) for name in dataset.variables}
        state |= {name: getattr(dataset, name) for name in ("alarms", "findings")}
    return (folder / "arm/alarms.csv").read_text(), state


def assert_alike(ours, theirs):
    assert ours[0] == theirs[0]
    assert ours[1].keys() == theirs[1].keys()
    for name, values in theirs[1].items():
        if isinstance(values, np.ndarray) and values.dtype.kind == "f":
            np.testing.assert_allclose(ours[1][name], values, rtol=1e-9, atol=1e-9, err_msg=name)
        else:
            np.testing.assert_array_equal(ours[1][name], values, err_msg=name)


def judged(logs, folder, entry=ENTRY):
    row = watch.watch_robot("arm", entry, sorted(logs), folder, page=False)
    assert row["result"] == "judged", row["reason"]
    return said(folder)


@pytest.fixture(scope="module")
def whole(days, tmp_path_factory):
    return judged(days, tmp_path_factory.mktemp("whole"))


@pytest.mark.long
@pytest.mark.parametrize("seed", range(2))
def test_pieces_in_any_order_say_what_the_whole_says(days, whole, tmp_path, seed):
    """The first log comes first, as the survey rests on it; some of the others come late."""
    random = np.random.default_rng(seed)
    # The baseline is there before anything is judged; within both parts logs come as they like.
    order = [days[0], *random.permutation(days[1:5]), *random.permutation(days[5:])]
    for stop in (5, int(random.integers(6, DAYS)), DAYS):
        found = judged(order[:stop], tmp_path)
    assert_alike(found, whole)
    assert "coulomb" in whole[0], "the example has no alarm to compare"


@pytest.mark.long
def test_what_is_changed_on_the_way_counts_from_the_first_window_on(days, whole, tmp_path):
    judged(days[:7], tmp_path / "pieces")
    for number, change in enumerate(
        (
            {"events": EVENTS, "limits": {"coulomb_increase_percent": 5.0}},
            {"baseline": {"until": START + DAY * 5}, "false_alarms_per_1000_h": 30.0},
        )
    ):
        ours = judged(days, tmp_path / "pieces", ENTRY | change)
        assert_alike(ours, judged(days, tmp_path / f"anew_{number}", ENTRY | change))
        assert ours[0] != whole[0]
    assert_alike(judged(days, tmp_path / "pieces"), whole)
