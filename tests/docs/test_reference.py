"""The reference is what `make reference` writes now."""

from jointwear.publishing.reference import pages


def test_the_reference_is_up_to_date(root):
    stale = [name for name, text in pages().items() if (root / "docs/reference" / name).read_text() != text]
    assert stale == [], "run `make reference`"


def test_every_key_of_a_robot_file_is_in_it():
    text = pages()["files.md"]
    for key in ("`dh[].alpha`", "`joints[].coulomb.positive`", "`waypoints`", "`detection.confidence`"):
        assert key in text
