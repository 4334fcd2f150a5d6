"""What a public forge runs: the reproduction and the tests on every push, with the actions of the site."""

import re


def test_every_push_reproduces_the_paper_and_runs_the_tests(root):
    text = (root / ".github/workflows/test.yml").read_text()
    site = (root / ".github/workflows/site.yml").read_text()
    assert re.findall(r"- run: (.*)", text) == ["make reproduce", "make test"]
    assert re.search(r"^on:\n  push:\n  pull_request:\n", text, re.MULTILINE)
    actions = set(re.findall(r"uses: (\S+)", text))
    assert actions <= set(re.findall(r"uses: (\S+)", site))
    assert 'python-version: "3.11"' in text
    assert "://" not in text
