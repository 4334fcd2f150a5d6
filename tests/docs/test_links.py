"""Links within the documentation lead to headings that are there."""

import re

from scratch_project import ROOT


def heading_anchors(page):
    """Return the anchors that the headings of a page have."""
    headings = re.findall(r"^#+ (.*)$", page.read_text(), re.MULTILINE)
    plain = (re.sub(r"\[([^\]]*)\]\([^)]*\)", r"\1", heading) for heading in headings)
    return {re.sub(r"[^\w\- ]", "", heading.strip().lower()).replace(" ", "-") for heading in plain}


def test_links_lead_to_headings_that_are_there():
    for page in [*(ROOT / "docs").rglob("*.md"), ROOT / "README.md", ROOT / "config/README.md"]:
        for file, anchor in re.findall(r"\]\(([^)#\s]*)#([^)\s]+)\)", page.read_text()):
            if not file.startswith(("http:", "https:")):
                assert anchor in heading_anchors(page.parent / file if file else page), f"{page.name}: {file}#{anchor}"
