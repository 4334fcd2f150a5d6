import sys
import time
from functools import cache
from pathlib import Path

from snakemake.settings.types import Quietness

# The library beside this file counts, here and in every script that a job starts, installed or not; also where
# another workflow takes this one as a module.
LIBRARY = Path(str(workflow.current_basedir)).parent
sys.path.insert(0, str(LIBRARY))
# From within another checkout, Snakemake has read the profile of that one, which imports the library beside it.
if (
    "jointwear" in sys.modules
    and Path(sys.modules["jointwear"].__file__).resolve().parents[1]
    != LIBRARY.resolve()
):
    for name in [name for name in sys.modules if name.split(".")[0] == "jointwear"]:
        del sys.modules[name]

# Snakemake would import pandas, a quarter of a second, only to ask whether a parameter is a data frame; none is.
sys.modules.setdefault("pandas", None)

from jointwear.running.closing import closing_lines
from jointwear.running.command_line import check_command_line
from jointwear.running.configuration import (
    check_experiment,
    config_layers,
    experiment_of,
    layer_files,
    prepare,
    reading_of,
)
from jointwear.files.errors import InputError
from jointwear.running.project import check_writable
from jointwear.running.script import message_of
from jointwear.running.modules import imported_by, lend_to_children
from jointwear.running.shipped import shipped, shipped_glob
from jointwear.running.told_of import lend_sources, named_as_lent
from jointwear.running.stale_lock import call_at_work, clear_stale_lock, note_run

# Without the default profile this is the first look at what Snakemake was given; it has read the files by now, and
# what made it hang is not caught (docs/decisions/checked_before_snakemake.md). Another workflow answers for its own.
OURS = (LIBRARY.parent / "Snakefile").resolve()
if workflow.is_main_process and Path(workflow.main_snakefile).resolve() == OURS:
    check_command_line(sys.argv[1:], workflow.overwrite_configfiles)
lend_to_children()
if workflow.is_main_process and clear_stale_lock(Path.cwd()):
    print("jointwear: an earlier run was killed; its lock is cleared", file=sys.stderr)
elif workflow.is_main_process and (other := call_at_work(Path.cwd())) is not None:
    print(
        f"jointwear: another call (process {other}) is at work in this folder; wait until it has ended, "
        "and do not unlock the folder before",
        file=sys.stderr,
    )


BEGIN = time.time()
# None where nothing asks for cores: on a cluster, and for --unlock and --summary. `workflow.cores` would end the call.
CORES = workflow.resource_settings.cores


onstart:
    note_run(Path.cwd())
    if workflow.local_exec:
        # Under a rate limit every finished job makes Snakemake look at all ready jobs once a second more, on a core
        # that jobs could use. There is no queue to protect here.
        workflow.scheduler.job_rate_limiter = None


onsuccess:
    # Who asks for --quiet all, as cron does, is told of what is wrong alone.
    if Quietness.ALL not in (workflow.output_settings.quiet or ()):
        print(*closing_lines(Path.cwd(), BEGIN), sep="\n")


def from_here(path):
    """A path as seen from the working directory: relative within it, absolute elsewhere."""
    here = Path.cwd()
    return str(path.relative_to(here) if path.is_relative_to(here) else path)


@cache
def tell_of_example(key, kind, name):
    """Say that a shipped example stands in for what nobody named: a lost --configfile must not look fine."""
    if workflow.is_main_process:
        # In one piece: Snakemake writes its own lines meanwhile, one of which came before the end of this one.
        sys.stderr.write(
            f"jointwear: the configuration names no {kind} under '{key}'; this is the shipped example, {name}\n"
        )


# The shipped values, config/config.yaml of the working directory, then --configfile; --config lies over them.
lend_sources(
    (
        from_here(path.resolve())
        for path in map(Path, [*config_layers(), *workflow.configfiles])
    ),
    workflow.config_settings.config,
)


def told(error):
    """The line that ends a call: a key of the configuration with the file that holds it."""
    return f"jointwear: {named_as_lent(str(error))}"


try:
    if workflow.is_main_process:
        check_writable(Path.cwd())
    config = prepare(layer_files(config), workflow.configfiles)
    ROBOT = check_experiment(config)
    # What `verify` looks at is no part of the experiment.
    CRATE, TRUST = config.pop("crate", None), config.pop("trust", False)
except (InputError, OSError) as error:
    sys.exit(
        told(error)
        if isinstance(error, InputError)
        else message_of(error) or f"jointwear: {error}"
    )


def checkout_alone(target, why):
    """No input where the call works on the checkout itself, else the refusal of the folder, before a job starts."""

    def asked(wildcards):
        if not Path.cwd().samefile(LIBRARY.parent):
            sys.exit(
                f"jointwear: {target} {why}; run it in {LIBRARY.parent}, without --directory"
            )
        return []

    return asked


wildcard_constraints:
    task="[A-Za-z][A-Za-z0-9]*",
    axis="[1-9][0-9]*",
    increase="[0-9]+(\\.[0-9]+)?",
    run="training|normal|axis[1-9][0-9]*_[0-9]+(\\.[0-9]+)?percent",


def modules_of(rule):
    """Library files that the script of a rule imports; an edit of one of them reruns the rule.

    An input function: scripts of rules that a run has no job of are not read.
    """
    script = LIBRARY / "scripts" / f"{rule}.py"

    @cache
    def files():
        return [from_here(path) for path in imported_by(script)]

    return lambda wildcards: files()


# Effects of the robot of the reproduction; an edit of any other effect leaves its runs alone.
ROBOT_EFFECTS = frozenset(entry["effect"] for entry in ROBOT.get("effects", []))


def simulation_modules(rule):
    """Library files behind a simulation of the reproduction; of the effects, those that its robot has."""
    script = LIBRARY / "scripts" / f"{rule}.py"
    return lambda wildcards: [
        from_here(path) for path in imported_by(script, ROBOT_EFFECTS)
    ]


def task_file(wildcards):
    """The task file of a job."""
    return shipped(f"config/tasks/{wildcards.task}.yaml")


def templates(*names):
    """Templates of a page, and the frame of all pages."""
    frame = ("base.html.j2", "macros.html.j2", "style.css")
    return [shipped(f"report/{name}") for name in (*names, *frame)]


def percent(value):
    """An increase as it stands in file names: 10.0 is 10, 12.5 stays."""
    return f"{value:g}"


CELLS = [
    f"axis{axis}_{percent(increase)}percent"
    for axis in config["wear"]["axes"]
    for increase in config["wear"]["increase_percent"]
]


def cells(stage):
    """Files of all worn runs of a stage."""
    return expand(
        "results/{stage}/{task}/{cell}.nc",
        stage=stage,
        task=config["tasks"],
        cell=CELLS,
    )


def simulation_settings(**more):
    """What every simulated run depends on."""
    return {
        "seed": config["seed"],
        "replicates": config["replicates"],
        "sampling": config["sampling"],
        "noise": config["noise"],
        "reading": reading_of(config, "simulation"),
        **more,
    }


# Long studies: the figures of each, by the name of its folder under results. Every study makes chapter.json too.
STUDY_PICTURES = {}


def study_pictures(study):
    """Files of the figures of a study."""
    return [f"results/{study}/figures/{name}.svg" for name in STUDY_PICTURES[study]]
