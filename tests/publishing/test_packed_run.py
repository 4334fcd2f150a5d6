"""A crate that somebody hands over: nothing of it runs before it is whole, and no foreign code without consent."""

import errno
import json
import os
import shutil
import zipfile
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


def describe(crate, change):
    """Change the entities of the metadata by a function."""
    data = json.loads((crate / METADATA).read_text())
    change(data["@graph"])
    (crate / METADATA).write_text(json.dumps(data))


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
        (lambda c: describe(c, lambda graph: graph.append({**graph[1], "sha256": "0" * 64})), "describes .* twice"),
        (lambda c: describe(c, lambda graph: graph.append({"@id": ["x"], "sha256": "0"})), "by what is no text"),
        (lambda c: (c / FILES).write_text((c / FILES).read_text()[:-1] + ', "seed": 2}'), "the key 'seed' twice"),
        (lambda c: (c / "/".join("d" * 60)).mkdir(parents=True), "50 folders inside"),
        (lambda c: listing(c, lambda d: d.update(results={})), "lists no results"),
        (lambda c: listing(c, lambda d: d.update(wanted=[])), "lists no results"),
        (lambda c: listing(c, lambda d: d.update(wanted=5)), "must be a list"),
        (lambda c: listing(c, lambda d: d.pop("seed")), "'seed' is missing"),
        (lambda c: listing(c, lambda d: d.update(wanted=d["wanted"] * 50_000)), "'wanted' names a file twice"),
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


@pytest.mark.parametrize(
    "name", ["Snakefile", "workflow/jointwear/__init__.py", "report/index.html.j2", "data/registry.yaml"]
)
def test_foreign_code_runs_only_with_consent(crate, own, name, monkeypatch):
    (crate / name).parent.mkdir(exist_ok=True)
    (crate / name).write_text("import os; os.system('touch executed')")
    sign(crate)
    ran = []
    monkeypatch.setattr(recomputation, "recompute", lambda source, folder, cores: ran.append(source))
    with pytest.raises(InputError, match=f"1 file differs, as {name}.*trust=true"):
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
    with pytest.raises(InputError, match=r"1 file differs, as workflow/rules/b\.smk"):
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


def packed(crate, path, *more, method=zipfile.ZIP_DEFLATED):
    """Write the crate as a zip file, with further entries (name, content)."""
    with zipfile.ZipFile(path, "w", method) as file:
        for name in sorted(p.relative_to(crate).as_posix() for p in crate.rglob("*") if p.is_file()):
            file.write(crate / name, f"crate/{name}")
        for name, content in more:
            file.writestr(zipfile.ZipInfo(name), content, method)
    return path


@pytest.mark.filterwarnings("ignore:Duplicate name")
@pytest.mark.parametrize(
    ("name", "words"),
    [
        ("crate/results/tables/table_v.csv", "table_v.csv' twice"),
        ("", "without a name"),
        ("ro-crate-metadata.json", "in 2 places"),
        ("other/ro-crate-metadata.json", "in 2 places"),
        ("../outside.txt", "lies outside"),
        ("crate/../../outside.txt", "lies outside"),
        ("/tmp/outside.txt", "lies outside"),
        ("..\\outside.txt", "lies outside"),
        ("C:\\outside.txt", "lies outside"),
        ("C:/outside.txt", "lies outside"),
        ("crate/" + "d/" * 1900 + "x", "50 folders deep"),
    ],
)
def test_names_that_an_archive_must_not_hold(crate, tmp_path, name, words):
    path = packed(crate, tmp_path / "crate.zip", (name, "x"))
    with pytest.raises(InputError, match=words), unpacked(path):
        pass


@pytest.mark.parametrize("method", [zipfile.ZIP_LZMA, zipfile.ZIP_BZIP2])
def test_other_ways_of_packing_are_not_read(crate, tmp_path, method):
    path = packed(crate, tmp_path / "crate.zip", method=method)
    with pytest.raises(InputError, match="in another way than deflate"), unpacked(path):
        pass


def test_a_bomb_is_not_unpacked(crate, tmp_path):
    path = packed(crate, tmp_path / "crate.zip", ("crate/z", bytes(40 << 20)))
    with pytest.raises(InputError, match="at most 100 times"), unpacked(path):
        pass


def test_more_names_than_a_command_takes_are_one_line(crate, tmp_path, monkeypatch):
    def refuse(*arguments, **more):
        raise OSError(errno.E2BIG, os.strerror(errno.E2BIG))

    monkeypatch.setattr(recomputation.subprocess, "run", refuse)
    with pytest.raises(InputError, match="cannot be started"):
        recomputation.recompute(crate, tmp_path / "run", 1)


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
