# Which logs every monitored robot has, and what the rules of monitor.smk take from its entry.
from jointwear.datasets import robot_sources
from jointwear.monitor.plan import READING_KEYS, batches_of, check_robots, log_sources

try:
    LOGS = {
        name: batches_of(logs, config["monitor"]["robots"][name])
        for name, logs in check_robots(config).items()
    }
except InputError as error:
    sys.exit(f"jointwear: {error}")


def monitored_entry(wildcards):
    """The entry of a robot in the config."""
    return dict(config["monitor"]["robots"][wildcards.monitored])


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
    return next(iter(LOGS[wildcards.monitored].values()))[0]


def first_log_files(wildcards):
    """Files of the first log."""
    return log_sources(first_log(wildcards))


def batch_logs(wildcards):
    """Logs of one batch."""
    return LOGS[wildcards.monitored][wildcards.batch_key]


def batch_files(wildcards):
    """Files of the logs of one batch."""
    return [path for log in batch_logs(wildcards) for path in log_sources(log)]


def window_files(wildcards):
    """Window statistics of all logs of a robot."""
    name = wildcards.monitored
    return [f"results/monitor/{name}/windows/{key}.nc" for key in LOGS[name]]
