# What the rules of fleet.smk take from the entries of the robots.
import time

from jointwear.files.digests import digest
from jointwear.monitor.fleet.plan import batches, seen, processes_of_job
from jointwear.monitor.learned_model import model_file
from jointwear.monitor.plan import window_seconds

MONITOR = config["monitor"]
# Which configuration names the robots: two of them do not take each other's histories.
CONFIGURATION = digest(
    [from_here(Path(path).resolve()) for path in workflow.configfiles]
)[:16]
FLEET = batches(list(MONITOR["robots"]))


def fleet_entries(wildcards):
    """Entries of the robots of a batch, with the robot files that they are judged with."""
    entries = {name: MONITOR["robots"][name] for name in FLEET[wildcards.fleet_batch]}
    return {
        name: {**entry, "robot": model_file(name, entry)}
        for name, entry in entries.items()
    }
