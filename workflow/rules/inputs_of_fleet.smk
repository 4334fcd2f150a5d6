# What the rules of fleet.smk take from the entries of the robots.
import time

from jointwear.files.digests import digest
from jointwear.monitor.events import acting
from jointwear.monitor.fleet.plan import batches, begun, seen, processes_of_job
from jointwear.monitor.learned_model import model_file
from jointwear.monitor.lengths_of_time import window_seconds

MONITOR = config["monitor"]
# Which configuration names the robots: two of them do not take each other's histories.
CONFIGURATION = digest(
    [from_here(Path(path).resolve()) for path in workflow.configfiles]
)[:16]
FLEET = batches(list(MONITOR["robots"]))


def fleet_entries(wildcards):
    """Entries of the robots of a batch, with the robot files that they are judged with and the events that act by now."""
    entries = {
        name: acting(MONITOR["robots"][name], NOW)
        for name in FLEET[wildcards.fleet_batch]
    }
    return {
        name: {**entry, "robot": model_file(name, entry)}
        for name, entry in entries.items()
    }


@cache
def begun_anew(batch):
    """How often robots of a batch were begun anew, as it was before the job makes their folders."""
    return begun(f"results/fleet/folders/{batch}.json", "results/fleet/robots")


def fleet_batches(wildcards):
    """Results of all batches; a call that lost its --configfile must neither look healthy nor empty the table."""
    if not FLEET:
        sys.exit(
            "jointwear: the configuration names no robot under 'monitor.robots', so there is no fleet to judge, and "
            "earlier results stay as they are; a configuration of your own is given as --configfile plant.yaml"
        )
    return expand("results/fleet/batches/{fleet_batch}.json", fleet_batch=FLEET)
