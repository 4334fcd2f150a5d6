"""The reference is what `make reference` writes now."""

import re

from jointwear.publishing.reference import pages


def test_the_reference_is_up_to_date(root):
    stale = [name for name, text in pages().items() if (root / "docs/reference" / name).read_text() != text]
    assert stale == [], "run `make reference`"


def test_every_key_of_a_robot_file_is_in_it():
    text = pages()["files.md"]
    for key in ("`dh[].alpha`", "`joints[].coulomb.positive`", "`waypoints`", "`detection.confidence`"):
        assert key in text


def test_every_decision_is_in_the_list(root):
    folder = root / "docs/decisions"
    listed = set(re.findall(r"\(([a-z0-9_]+\.md)\)", (folder / "README.md").read_text()))
    assert listed == {path.name for path in folder.glob("*.md")} - {"README.md"}
