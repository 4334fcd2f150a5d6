"""Plans that tests ask of a process with Snakemake loaded are those of the command."""

import re

import pytest
from warm_snakemake import warm_snakemake

#: What two runs of the command differ by (the hour, in three places), and the folder in which Snakemake was loaded,
#: which is only told.
OWN = re.compile(
    r"^(  (Date|Workflow ID|Run directory): .*|\[\w{3} \w{3} .* \d{4}\]|─+ Workflow start .* @ \d\d:\d\d ─+)$",
    re.MULTILINE,
)


@pytest.mark.long
@pytest.mark.parametrize(
    ("arguments", "status"),
    [
        (["--dry-run", "--workflow-profile", "none"], 0),
        (["--dry-run", "--workflow-profile", "none", "--forceall", "results/features/T1/training.nc"], 0),
        (["--dry-run", "--workflow-profile", "none", "--config", "replicate=3"], 1),
        (["--dry-run", "no_such_rule"], 1),
        (["--list-rules", "--workflow-profile", "none"], 0),
    ],
)
def test_a_warm_process_answers_as_the_command_does(built, arguments, status):
    command, warm = built.snakemake(*arguments, ok=False), warm_snakemake(arguments, built.folder, 600)
    assert warm.returncode == command.returncode == status
    for one, other in ((warm.stdout, command.stdout), (warm.stderr, command.stderr)):
        # Jobs that wait for nothing come in any order.
        assert sorted(OWN.sub("", one).splitlines()) == sorted(OWN.sub("", other).splitlines())


def test_two_runs_may_begin_in_different_minutes():
    """The head of a plan tells when it began: a run that follows another can be the first of the next minute."""
    first, second = (
        f"{'─' * 22} Workflow start 28 Nov 2026 @ {hour} {'─' * 22}\nplan\n" for hour in ("19:41", "19:42")
    )
    assert OWN.sub("", first) == OWN.sub("", second) == "\nplan\n"


def test_each_plan_reads_the_library_of_its_own_folder(project):
    assert project.planned() == {}
    (project.folder / "workflow/jointwear/running/configuration.py").write_text("raise SystemExit('of this copy')\n")
    assert "of this copy" in warm_snakemake(["--dry-run", "--workflow-profile", "none"], project.folder, 600).stderr
