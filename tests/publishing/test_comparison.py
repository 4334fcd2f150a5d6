"""Two files are equal, equal within a tolerance, or different; dates, run times and versions do not count."""

import json
import time

import numpy as np
import pytest

from jointwear.files.storage import Variable, write_dataset
from jointwear.publishing.verification.comparison import (
    CLOSE,
    DIFFERENT,
    EQUAL,
    MISSING,
    compare_files,
    relative_difference,
)


def pair(folder, name, ours, theirs):
    for side, text in (("a", ours), ("b", theirs)):
        (folder / side).mkdir(exist_ok=True)
        (folder / side / name).write_text(text, encoding="utf-8")
    return compare_files(folder / "a" / name, folder / "b" / name)


@pytest.mark.parametrize(
    ("ours", "theirs", "verdict"),
    [
        ("1,2.5\n", "1,2.5\n", EQUAL),
        ("1,2.5000001\n", "1,2.5\n", CLOSE),
        ("1,2.6\n", "1,2.5\n", DIFFERENT),
        ("one,2.5\n", "two,2.5\n", DIFFERENT),
        ("1,2.5\n3\n", "1,2.5\n", DIFFERENT),
        ("1,2.5\n", "1,1e999\n", DIFFERENT),
        ("1,2.5\n", "1,٢.٥\n", DIFFERENT),
    ],
)
def test_text(tmp_path, ours, theirs, verdict):
    assert pair(tmp_path, "x.csv", ours, theirs).verdict == verdict


@pytest.mark.parametrize("theirs", ["1" + "0" * 400, "true", '"1"', "1e400", '1, "x": 2, "x": 1'])
def test_no_value_of_json_passes_for_another(tmp_path, theirs):
    assert pair(tmp_path, "x.json", '{"x": 1}', f'{{"x": {theirs}}}').verdict == DIFFERENT


@pytest.mark.parametrize(
    "text", ["<!--", "<![CDATA[", "<a", "</", '<a a="', "<a b='\n", "<script>", "<title></titl", "<?"]
)
def test_a_page_of_beginnings_without_ends_takes_no_time(tmp_path, text):
    """Python's parser would look through the rest of the page at each of them."""
    begin = time.process_time()
    assert pair(tmp_path, "x.html", "<html><p>1.5</p></html>", text * 200_000).verdict == DIFFERENT
    assert pair(tmp_path, "y.html", "<html><p>1.5</p></html>", f"<p {text * 200_000}>").verdict == DIFFERENT
    assert time.process_time() - begin < 5.0


def test_what_varies_in_a_page_does_not_count(tmp_path):
    page = '<p>kept 1.5</p><div data-varies="timings"><p>{}</p><br></div><p>end</p>'
    assert pair(tmp_path, "x.html", page.format("3 s"), page.format("4 s and more")).verdict == EQUAL
    other = page.replace("kept 1.5", "kept 1.6")
    assert pair(tmp_path, "y.html", other.format("3 s"), page.format("3 s")).verdict == DIFFERENT


def test_versions_in_a_summary_do_not_count(tmp_path):
    ours, theirs = ({"source": {"numpy": v}, "score": [1, 2.0]} for v in ("1", "2"))
    assert pair(tmp_path, "x.json", json.dumps(ours), json.dumps(theirs)).verdict == EQUAL
    found = pair(tmp_path, "y.json", json.dumps({**ours, "score": [1, 3.0]}), json.dumps(theirs))
    assert found.verdict == DIFFERENT
    assert "score[1]" in found.detail
    assert pair(tmp_path, "z.json", json.dumps({**ours, "more": 1}), json.dumps(theirs)).verdict == DIFFERENT


def test_a_missing_file_is_no_equal_one(tmp_path):
    (tmp_path / "x").write_text("")
    assert compare_files(tmp_path / "none", tmp_path / "x").verdict == MISSING


def test_differences_count_against_each_number():
    x = np.array([1000.0, 1.0])
    assert relative_difference(x + np.array([0, 1e-3]), x) == pytest.approx(1e-3, rel=1e-2)
    # What is left where large numbers cancel is round-off.
    x = np.array([1000.0, 1e-15])
    assert relative_difference(x + np.array([0, 1e-15]), x) == pytest.approx(1e-12, rel=1e-6)
    assert relative_difference(np.zeros(2), np.zeros(2)) == 0
    assert relative_difference(np.array([np.nan, 1.0]), np.array([np.nan, 1.0])) == 0
    assert relative_difference(np.array([np.nan, 1.0]), np.array([0.0, 1.0])) == np.inf
    assert relative_difference(np.array(["a"], dtype=object), np.array(["b"], dtype=object)) == np.inf


def test_netcdf_files_are_compared_by_their_numbers(tmp_path):
    for name, values, title in (("a", [1.0, 2.0], "x"), ("b", [1.0, 2.0 + 1e-9], "x"), ("c", [1.0, 2.1], "x")):
        write_dataset(tmp_path / f"{name}.nc", {"v": Variable(("n",), np.array(values), "v", "m")}, {"title": title})
    assert compare_files(tmp_path / "b.nc", tmp_path / "a.nc").verdict == CLOSE
    found = compare_files(tmp_path / "c.nc", tmp_path / "a.nc")
    assert found.verdict == DIFFERENT
    assert found.detail.startswith("v:")
