"""Every Snakemake command that a document shows, those too that no test runs: options and targets that there are."""

import os
import re
import shlex
import shutil
import subprocess

import pytest
from scratch_project import ROOT
from snakemake.cli import get_argument_parser

DOCUMENTS = [
    *(p for p in ROOT.glob("*.md")),
    *(p for folder in ("docs", "config", "data", ".github", "workflow/profiles") for p in (ROOT / folder).rglob("*")),
]
_CODE = re.compile(r"```.*?^```|(?<!`)`[^`]+`(?!`)", re.MULTILINE | re.DOTALL)
_COMMAND = re.compile(
    r"(?<![\w/.-])(?:\S*\.venv/bin/)?snakemake(?P<arguments>(?: +(?:'[^'\n]*'|\"[^\"\n]*\"|[^\s`#|)>]+(?!>)))*)"
)
RULES = {
    name
    for path in [ROOT / "Snakefile", *(ROOT / "workflow/rules").glob("*.smk")]
    for name in re.findall(r"^rule (\w+):", path.read_text(), re.MULTILINE)
}


def commands():
    """Yield document and arguments of the commands between backquotes, in code blocks and in comments."""
    for path in DOCUMENTS:
        if path.suffix not in (".md", ".yaml", ".yml"):
            continue
        text = path.read_text()
        code = "\n".join(found[0] for found in _CODE.finditer(text)) if path.suffix == ".md" else text
        for found in _COMMAND.finditer(re.sub(r"\s*\n\s+(?=--)", " ", code)):
            arguments = found["arguments"].strip()
            if arguments not in ("", "--version") and "..." not in arguments:
                yield str(path.relative_to(ROOT)), arguments


@pytest.mark.parametrize(("document", "arguments"), sorted(set(commands())))
def test_a_command_is_one_that_snakemake_takes(document, arguments):
    given = get_argument_parser().parse_args(shlex.split(arguments))
    assert not [target for target in given.targets or [] if "/" not in target and target not in RULES]


def test_the_commands_of_a_schedule_are_among_them():
    assert sum("howto/scheduled" in document for document, _ in commands()) >= 3


@pytest.mark.skipif(not shutil.which("flock"), reason="needs flock of util-linux")
def test_the_line_of_the_crontab_runs_as_its_user_and_prints_only_what_failed(tmp_path):
    page = (ROOT / "docs/howto/scheduled.md").read_text()
    (line,) = re.findall(r"^10 \* \* \* \*  (.*)$", page, re.MULTILINE)
    (address,) = re.findall(r"^JOINTWEAR_\w+='.*'$", page, re.MULTILINE)
    (tmp_path / "jointwear.env").write_text(f"{address}\n")
    program = tmp_path / ".venv/bin/snakemake"
    program.parent.mkdir(parents=True)
    program.write_text('#!/bin/sh\necho "$JOINTWEAR_SHIFT"; exit $FAILED\n')
    program.chmod(0o755)
    line = line.replace("/srv/jointwear", shlex.quote(str(tmp_path)))
    for failed, printed in (("0", ""), ("1", f"{address.partition('=')[2].strip(chr(39))}\n")):
        environment = {"PATH": os.environ["PATH"], "FAILED": failed}
        done = subprocess.run(["sh", "-c", line], env=environment, capture_output=True, text=True, check=False)
        assert (done.stdout, done.stderr) == (printed, "")


def test_a_page_that_calls_snakemake_says_first_where_it_comes_from():
    for page in sorted((ROOT / "docs/howto").glob("*.md")):
        before, called, _ = page.read_text().partition("\nsnakemake ")
        if called:
            assert re.search(r"\bmake environment\b", before), page.name
            assert re.search(r"\bsource \S*\.venv/bin/activate", before), page.name


def test_the_targets_that_the_first_page_lists_are_there():
    table = (ROOT / "README.md").read_text().partition("## Further studies")[2].partition("## ")[0]
    listed = re.findall(r"^\| `(\w+)` \|", table, re.MULTILINE)
    assert len(listed) > 10
    assert set(listed) <= RULES
