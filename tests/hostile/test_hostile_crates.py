"""Crates that somebody changed, as folders and as zip files: refused, or exactly what was packed."""

import hashlib
import io
import json
import os
import shutil
import zipfile

import pytest
from hypothesis import given
from hypothesis import strategies as st
from isolation import held, outcome_of
from mutations import WORDS, broken_bytes, broken_documents, seeds, tree
from small_crate import sign, write_small_crate

from jointwear.publishing.crate.layout import CONFIG, FILES, METADATA
from jointwear.publishing.verification.packed_run import check_contents, listing, unpacked
from jointwear.publishing.verification.recomputation import check_trust

pytestmark = pytest.mark.hostile
NAMES = ("sitecustomize.py", "results/more.csv", "workflow/jointwear/more.py", "profiles/default/config.yaml", "-x")


@pytest.fixture(scope="module")
def packed(tmp_path_factory):
    """A sound crate, the project that it comes from, and what the crate lists."""
    folder = tmp_path_factory.mktemp("packed")
    listed = write_small_crate(folder / "crate", folder / "own")
    return folder / "crate", folder / "own", listed


def accepted_crate(path, own):
    """What `verify` asks before it runs anything; returns the files as they would be used."""
    with unpacked(path) as crate:
        check_contents(crate)
        check_trust(crate, own)
        wanted = listing(crate)["wanted"]
        assert all(name.startswith("results/") for name in wanted)
        return tree(crate)


def used(files):
    """The files that a verification uses: the metadata cannot hold a checksum of themselves, and describe."""
    return {name: content for name, content in files.items() if name != METADATA}


def test_the_sound_crate_is_accepted(packed):
    crate, own, _ = packed
    assert outcome_of(lambda: accepted_crate(crate, own)).value == tree(crate)


@st.composite
def changes(draw):
    """What is done to one file of a crate: its place among the files, and how."""
    how = draw(st.sampled_from(["bytes", "bytes", "delete", "add", "link", "move", "pipe", "empty"]))
    return how, draw(st.integers(0, 10**6)), draw(st.sampled_from(NAMES)), draw(st.randoms(use_true_random=False))


@given(changes(), st.booleans())
@seeds(150)
def test_changed_files(packed, tmp_path_factory, change, signed):
    crate, own, _ = packed
    copy = tmp_path_factory.getbasetemp() / "copy"
    shutil.rmtree(copy, ignore_errors=True)
    shutil.copytree(crate, copy)
    how, place, name, random = change
    names = sorted(tree(copy))
    path = copy / names[place % len(names)]
    if how == "bytes":
        data = bytearray(path.read_bytes() or b"x")
        data[random.randrange(len(data))] ^= 1 << random.randrange(8)
        path.write_bytes(data)
    elif how == "add":
        (copy / name).parent.mkdir(parents=True, exist_ok=True)
        (copy / name).write_text("x")
    elif how == "move":
        path.rename(path.with_name("moved" + path.suffix))
    else:
        path.unlink()
        if how == "link":
            path.symlink_to("/etc/hostname")
        elif how == "pipe":
            os.mkfifo(path)
        elif how == "empty":
            path.touch()
    forged = signed and how in ("bytes", "add") and path.name not in ("files.json", METADATA)
    if forged:
        sign(copy)
    found = held(outcome_of(lambda: accepted_crate(copy, own)))
    changed = name if how == "add" else path.relative_to(copy).as_posix()
    if not forged:
        assert found.kind == "refused" or used(found.value) == used(tree(crate))
    elif changed.startswith(("workflow/", "report/", "Snakefile", "results/more")):
        # With new checksums it is a whole crate, but of another workflow.
        assert found.kind == "refused"


@st.composite
def listings(draw, listed):
    """A list of files in which values are replaced."""
    return json.dumps(draw(broken_documents(listed)), default=str)


def test_changed_lists(packed, tmp_path):
    crate, _, listed = packed
    copy = tmp_path / "copy"
    shutil.copytree(crate, copy)

    @given(st.one_of(listings(listed), broken_bytes(json.dumps(listed).encode())))
    @seeds(200)
    def check(text):
        (copy / FILES).write_bytes(text.encode() if isinstance(text, str) else text)
        found = held(outcome_of(lambda: check_and_list(copy)))
        if found.kind == "accepted":
            sums = {name: facts["sha256"] for name, facts in listed["results"].items()}
            assert {name: facts["sha256"] for name, facts in found.value["results"].items()} == sums
            assert set(found.value["wanted"]) <= set(listed["results"])

    check()


def check_and_list(crate):
    """The list alone, which the metadata of a forged crate would agree with."""
    document = json.loads((crate / METADATA).read_text())
    document["@graph"] = [e for e in document["@graph"] if e["@id"] != FILES] + [
        {"@id": FILES, "sha256": own_sum(crate)}
    ]
    (crate / METADATA).write_text(json.dumps(document))
    check_contents(crate)
    return listing(crate)


def own_sum(crate):
    return hashlib.sha256((crate / FILES).read_bytes()).hexdigest()


def archive_of(crate):
    data = io.BytesIO()
    with zipfile.ZipFile(data, "w", zipfile.ZIP_DEFLATED) as file:
        for name, content in tree(crate).items():
            file.writestr(zipfile.ZipInfo(f"crate/{name}"), content)
    return data.getvalue()


def test_broken_archives(packed, tmp_path):
    crate, own, _ = packed
    path = tmp_path / "crate.zip"

    @given(broken_bytes(archive_of(crate)))
    @seeds(150)
    def check(data):
        path.write_bytes(data)
        found = held(outcome_of(lambda: accepted_crate(path, own)))
        if found.kind == "accepted":
            assert used(found.value) == used(tree(crate))

    check()
    assert os.listdir(tmp_path) == ["crate.zip"]


@pytest.mark.parametrize("name", ["../outside.txt", "/tmp/outside.txt", "crate/../../outside.txt", "C:\\outside.txt"])
def test_an_archive_writes_nothing_outside(packed, tmp_path, name):
    crate, own, _ = packed
    data = io.BytesIO(archive_of(crate))
    with zipfile.ZipFile(data, "a") as file:
        file.writestr(name, "x")
    (tmp_path / "crate.zip").write_bytes(data.getvalue())
    found = held(outcome_of(lambda: accepted_crate(tmp_path / "crate.zip", own)))
    assert found.kind == "refused"
    assert "lies outside" in found.value or "not listed" in found.value
    assert not list(tmp_path.parent.glob("outside*"))
    assert not os.path.exists("/tmp/outside.txt")


#: Names of entries that an archive has no use for.
ODD = (
    *("", "/", ".", "crate/../../x", "/tmp/x", "..\\x", "crate/" + "d/" * 1900 + "x", "crate/" + "n" * 300),
    *(
        "crate/run/files.json",
        "crate/run/files.json/x",
        "ro-crate-metadata.json",
        "a/ro-crate-metadata.json",
        "crate/x",
    ),
    *("crate/a\nb", "CRATE/run/files.json", "crate//run//files.json", "crate/é"),
)


@pytest.mark.filterwarnings("ignore:Duplicate name")
@given(
    st.lists(st.tuples(st.sampled_from(ODD), st.sampled_from([0, 1000, 20 << 20])), min_size=1, max_size=2),
    st.sampled_from([zipfile.ZIP_DEFLATED, zipfile.ZIP_STORED, zipfile.ZIP_BZIP2, zipfile.ZIP_LZMA]),
    st.booleans(),
)
@seeds(60)
def test_archives_with_odd_entries(packed, tmp_path_factory, odd, method, first):
    crate, own, _ = packed
    path = tmp_path_factory.getbasetemp() / "odd.zip"
    sound = [(f"crate/{name}", content) for name, content in tree(crate).items()]
    more = [(name, bytes(size if method != zipfile.ZIP_STORED else min(size, 1000))) for name, size in odd]
    with zipfile.ZipFile(path, "w", method) as file:
        for name, content in more + sound if first else sound + more:
            file.writestr(zipfile.ZipInfo(name), content, method)
    found = held(outcome_of(lambda: accepted_crate(path, own)))
    if found.kind == "accepted":
        assert used(found.value) == used(tree(crate))


@given(st.sampled_from(WORDS), st.sampled_from(["seed", "robot", "tasks", "__use_yte__", "crate", "?import os"]))
@seeds(60)
def test_a_configuration_in_a_crate_is_checked_before_snakemake_sees_it(packed, tmp_path_factory, word, key):
    crate, own, _ = packed
    copy = tmp_path_factory.getbasetemp() / "configured"
    shutil.rmtree(copy, ignore_errors=True)
    shutil.copytree(crate, copy)
    text = (copy / CONFIG).read_text()
    (copy / CONFIG).write_text(f"{json.dumps(key)}: {json.dumps(word)}\n{text}", encoding="utf-8")
    sign(copy)
    found = held(outcome_of(lambda: accepted_crate(copy, own)))
    assert found.kind == "refused" or key == "crate"
