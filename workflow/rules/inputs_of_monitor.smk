# Which logs every monitored robot has, and what the rules of monitor.smk take from its entry.
from jointwear.robots.robot_file import robot_sources
from jointwear.files.documents import read_yaml
from jointwear.files.registered import will_be_fetched
from jointwear.running.configuration import beside_workflow
from jointwear.monitor.plan import READING_KEYS, batches_of, check_robots, log_sources

try:
    LOGS = {
        name: batches_of(logs, config["monitor"]["robots"][name])
        for name, logs in check_robots(config).items()
    }
except InputError as error:
    sys.exit(f"jointwear: {error}")


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
CHOSEN_ROBOTS = list(LOGS) or ["puma560_example"]


@cache
def logs_of(name):
    """Batches of logs of a robot; those of a shipped example are looked up only where they are wanted."""
    if name in LOGS:
        return LOGS[name]
    entry = SHIPPED_ROBOTS[name]
    return batches_of(check_robots({"monitor": {"robots": {name: entry}}})[name], entry)


def monitored_entry(wildcards):
    """The entry of a robot."""
    entries = {**SHIPPED_ROBOTS, **config["monitor"]["robots"]}
    return dict(entries[wildcards.monitored])


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
    """The first log of a robot."""
    return next(iter(logs_of(wildcards.monitored).values()))[0]


def first_log_files(wildcards):
    """Files of the first log."""
    return log_sources(first_log(wildcards))


def batch_logs(wildcards):
    """Logs of one batch."""
    return logs_of(wildcards.monitored)[wildcards.batch_key]


def batch_files(wildcards):
    """Files of the logs of one batch."""
    return [path for log in batch_logs(wildcards) for path in log_sources(log)]


def window_files(wildcards):
    """Window statistics of all logs of a robot."""
    name = wildcards.monitored
    return [f"results/monitor/{name}/windows/{key}.nc" for key in logs_of(name)]
