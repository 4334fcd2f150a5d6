# Which logs every monitored robot has, and what the rules of monitor.smk take from its entry.
import time

from jointwear.files.errors import nearest
from jointwear.robots.robot_file import robot_sources
from jointwear.files.documents import read_yaml
from jointwear.monitor.events import acting
from jointwear.monitor.reading.kept_surveys import surveyed_log
from jointwear.monitor.local_time import zone_of
from jointwear.monitor.learned_model import learnt_of_other, model_file
from jointwear.monitor.notify.plan import check_channels
from jointwear.monitor.batches import batches_of
from jointwear.monitor.found_logs import (
    find_all_logs,
    find_logs,
    may_be_read,
    programs_without_logs,
    readable_files,
)
from jointwear.monitor.made_with import READING_KEYS
from jointwear.monitor.robot_entries import check_robots
from jointwear.monitor.shared_logs import check_shared_logs
from jointwear.files.registered import will_be_fetched
from jointwear.running.configuration import beside_workflow

try:
    zone_of(config["monitor"]["time_zone"])
    check_channels(config["monitor"])
    check_robots(config)
    FOUND_LOGS, SILENT = find_all_logs(config)
    SHARED_LOGS = (
        check_shared_logs(FOUND_LOGS, config) if workflow.is_main_process else ()
    )
except InputError as error:
    sys.exit(told(error))
if workflow.is_main_process:
    for reason in SHARED_LOGS:
        print(told(reason), file=sys.stderr)
    for name, reason in SILENT.items():
        others = "logs" if FOUND_LOGS[name] else "robots"
        print(f"{told(reason)}; the other {others} go on", file=sys.stderr)
    for name, entry in config["monitor"]["robots"].items():
        if reason := learnt_of_other(name, entry):
            print(f"jointwear: {reason}", file=sys.stderr)
        if reason := programs_without_logs(name, entry, FOUND_LOGS[name]):
            print(told(reason), file=sys.stderr)
LOGS = {
    name: batches_of(logs, config["monitor"]["robots"][name])
    for name, logs in FOUND_LOGS.items()
    if logs
}
if SILENT and not LOGS:
    sys.exit("jointwear: no robot has a log that can be reached")

# Time of this call: an event of the config acts from its own on.
NOW = time.time()


# Templates of the page of a robot.
PAGE_TEMPLATES = templates("monitor.html.j2", "robots.html.j2")


# The shipped examples, of which `monitor` takes the first where the config names no robot.
SHIPPED_ROBOTS = {
    name: entry
    for example in shipped_glob("config/examples/monitor_*.yaml")
    for name, entry in beside_workflow(read_yaml(str(example)))["monitor"][
        "robots"
    ].items()
}
# Those whose logs are here: the registered ones only once they have been fetched.
OWN_ROBOTS = [
    name
    for name, entry in SHIPPED_ROBOTS.items()
    if not any(will_be_fetched(pattern) for pattern in entry["logs"])
]
EXAMPLE_ROBOT = "puma560_example"


def of_chosen_robots(pattern, **more):
    """An input function: files of the robots of the configuration, or of the shipped example where it names none."""

    def files(wildcards):
        if not LOGS:
            tell_of_example("monitor.robots", "robot", EXAMPLE_ROBOT)
        return expand(pattern, monitored=list(LOGS) or [EXAMPLE_ROBOT], **more)

    return files


@cache
def logs_of(name):
    """Batches of logs of a robot; those of a shipped example are looked up only where they are wanted."""
    if name in LOGS:
        return LOGS[name]
    if name in config["monitor"]["robots"]:
        sys.exit(told(SILENT[name]))
    entry = entry_of(name)
    return batches_of(find_logs(entry["logs"]), entry)


def entry_of(name):
    """The entry of a robot of the configuration or of a shipped example; ends the call where neither has it."""
    known = {**SHIPPED_ROBOTS, **config["monitor"]["robots"]}
    if name not in known:
        hint = nearest(name, config["monitor"]["robots"] or known)
        sys.exit(told(f"config: 'monitor.robots' has no '{name}'{hint}"))
    return known[name]


def given_entry(wildcards):
    """The entry of a robot as it is given, with the events that act by now."""
    return acting(entry_of(wildcards.monitored), NOW)


def monitored_entry(wildcards):
    """The entry of a robot, with the robot file that was learnt from its own logs where there is one."""
    entry = given_entry(wildcards)
    return {**entry, "robot": model_file(wildcards.monitored, entry)}


def reading_entry(wildcards):
    """The part of the entry that decides how logs are read."""
    entry = monitored_entry(wildcards)
    return {key: entry[key] for key in READING_KEYS if key in entry}


def monitored_robot(wildcards):
    """Robot file of a monitored robot."""
    return monitored_entry(wildcards)["robot"]


def monitored_model(wildcards):
    """All files that a monitored robot is made of."""
    return robot_sources(monitored_robot(wildcards))


def first_log(wildcards):
    """The log that the survey of a robot rests on; one that may not be read is passed over while there are others."""
    logs = [log for batch in logs_of(wildcards.monitored).values() for log in batch]
    logs = [log for log in logs if may_be_read(log)] or logs
    return surveyed_log(
        f"results/monitor/{wildcards.monitored}/survey.json",
        logs,
        monitored_robot(wildcards),
        reading_entry(wildcards),
    )


def batch_logs(wildcards):
    """Logs of one batch."""
    return logs_of(wildcards.monitored)[wildcards.batch_key]


def batch_files(wildcards):
    """Files of the logs of one batch that may be read."""
    return readable_files(batch_logs(wildcards))


def window_files(wildcards):
    """Window statistics of all logs of a robot."""
    name = wildcards.monitored
    return [f"results/monitor/{name}/windows/{key}.nc" for key in logs_of(name)]
