"""A crate that somebody hands over: nothing of it runs before it is whole, and no foreign code without consent."""

import json
import os
import shutil
from pathlib import Path

import pytest
from small_crate import RESULTS, sign, write_small_crate

from jointwear.files.errors import InputError
from jointwear.publishing.crate.layout import CONFIG, FILES, METADATA, STAMP
from jointwear.publishing.verification import recomputation
from jointwear.publishing.verification.packed_run import check_contents, unpacked
from jointwear.publishing.verification.recomputation import check_trust, compare_runs, verify


@pytest.fixture
def own(tmp_path):
    return tmp_path / "own"


@pytest.fixture
def crate(tmp_path, own):
    write_small_crate(tmp_path / "crate", own)
    return tmp_path / "crate"


def listing(crate, change):
    """Change run/files.json by a function and sign the crate again."""
    listed = json.loads((crate / FILES).read_text())
    change(listed)
    (crate / FILES).write_text(json.dumps(listed))
    sign(crate)


def test_a_whole_crate_of_this_workflow_is_trusted(crate, own):
    (crate / STAMP).touch()
    check_contents(crate)
    check_trust(crate, own)


@pytest.mark.parametrize(
    ("change", "words"),
    [
        (lambda c: (c / "sitecustomize.py").write_text("x"), "sitecustomize.py: is not listed"),
        (lambda c: (c / "results/more.csv").write_text("x"), "results/more.csv: is not listed"),
        (lambda c: (c / "workflow/jointwear/more.py").write_text("x"), "more.py: is not listed"),
        (lambda c: (c / "results/tables/table_v.csv").unlink(), "is listed but not there"),
        (lambda c: (c / "results/tables/table_v.csv").write_text("axis,value\n1,9.5\n"), "SHA-256 is not the one"),
        (lambda c: (c / "Snakefile").write_text("import os"), "Snakefile: its SHA-256"),
        (lambda c: (c / "results/link").symlink_to("/etc/passwd"), "is a link or a special file"),
        (lambda c: os.mkfifo(c / "results/pipe"), "is a link or a special file"),
        (lambda c: (c / FILES).write_text("{"), "cannot be read as JSON"),
        (lambda c: (c / FILES).write_text("[]"), "must hold a mapping"),
        (lambda c: (c / METADATA).write_text('{"@graph": 5}'), "must be a list"),
        (lambda c: listing(c, lambda d: d.update(results={})), "lists no results"),
        (lambda c: listing(c, lambda d: d.update(wanted=[])), "lists no results"),
        (lambda c: listing(c, lambda d: d.update(wanted=5)), "must be a list"),
        (lambda c: listing(c, lambda d: d.pop("seed")), "'seed' is missing"),
        (lambda c: listing(c, lambda d: d["wanted"].append("--snakefile=/tmp/x")), "no file below results"),
        (lambda c: listing(c, lambda d: d["wanted"].append("results/../Snakefile")), "no file below results"),
        (lambda c: listing(c, lambda d: d["wanted"].append("/etc/passwd")), "no file below results"),
        (lambda c: listing(c, lambda d: d["wanted"].append("results/none.csv")), "not among the results"),
        (lambda c: listing(c, lambda d: d["results"].pop("results/report/index.html")), "not among the results"),
        (lambda c: listing(c, lambda d: d["results"].pop("results/report/summary.json")), "not among the results"),
        (lambda c: listing(c, lambda d: d["results"].pop("results/tables/table_v.csv")), "is not listed"),
    ],
)
def test_a_crate_that_is_not_what_it_lists_is_refused(crate, own, change, words):
    change(crate)
    with pytest.raises(InputError, match=words):
        verify(crate, 1, own=own)


@pytest.mark.parametrize("name", ["Snakefile", "workflow/jointwear/__init__.py", "report/index.html.j2"])
def test_foreign_code_runs_only_with_consent(crate, own, name, monkeypatch):
    (crate / name).write_text("import os; os.system('touch executed')")
    sign(crate)
    ran = []
    monkeypatch.setattr(recomputation, "recompute", lambda source, folder, cores: ran.append(source))
    with pytest.raises(InputError, match=f"1 files differ, as {name}.*trust=true"):
        verify(crate, 1, own=own)
    assert not ran
    assert not verify(crate, 1, trust=True, own=own)  # nothing was made, so nothing is equal
    assert ran


def test_code_beside_the_listed_code_is_foreign_too(crate, own):
    (crate / "workflow/jointwear/reading.py").write_text("")
    sign(crate)
    with pytest.raises(InputError, match=r"reading\.py"):
        check_trust(crate, own)
    (crate / "workflow/jointwear/reading.py").unlink()
    (own / "workflow/rules/b.smk").write_text("")
    with pytest.raises(InputError, match=r"1 files differ, as workflow/rules/b\.smk"):
        check_trust(crate, own)


def test_a_configuration_that_asks_to_be_evaluated_is_refused(crate, own):
    text = (crate / CONFIG).read_text()
    (crate / CONFIG).write_text(f"__use_yte__: true\n{text}")
    sign(crate)
    with pytest.raises(InputError, match="unknown key '__use_yte__'"):
        check_trust(crate, own)


def test_a_broken_archive_is_one_line(crate, tmp_path):
    archive = shutil.make_archive(str(tmp_path / "packed"), "zip", crate)
    with unpacked(archive) as folder:
        check_contents(folder)
    data = Path(archive).read_bytes()
    for broken in (data[: len(data) // 2], b"", data[:60] + b"\xff" * 200 + data[260:]):
        (tmp_path / "broken.zip").write_bytes(broken)
        with pytest.raises(InputError), unpacked(tmp_path / "broken.zip") as folder:
            check_contents(folder)
    os.mkfifo(tmp_path / "pipe.zip")
    with pytest.raises(InputError, match="neither a folder nor a zip"), unpacked(tmp_path / "pipe.zip"):
        pass


def test_what_was_made_and_is_not_listed_counts_against_the_crate(crate, tmp_path):
    made = tmp_path / "made"
    for name in RESULTS:
        (made / name).parent.mkdir(parents=True, exist_ok=True)
        shutil.copyfile(crate / name, made / name)
    (made / "results/logs").mkdir()
    (made / "results/logs/a.log").write_text("x")
    assert {o.verdict for o in compare_runs(crate, made).values()} == {"equal"}
    (made / "results/more.csv").write_text("x")
    (made / "results/tables/table_v.csv").unlink()
    verdicts = compare_runs(crate, made)
    assert verdicts["results/more.csv"].verdict == "missing"
    assert verdicts["results/tables/table_v.csv"].verdict == "missing"
