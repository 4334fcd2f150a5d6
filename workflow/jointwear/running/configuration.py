"""Check the configuration before any job starts, and hand each rule the part that it uses.

Imported by the Snakefile at every call: nothing heavy is imported here.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from datetime import date
from pathlib import Path
from typing import Any

from jointwear.files.documents import read_yaml
from jointwear.files.errors import InputError, nearest
from jointwear.files.numbers import check_numbers
from jointwear.files.patterns import matches
from jointwear.files.registered import is_registered, locate
from jointwear.files.regular_files import ROOT, check_regular
from jointwear.files.schemas import check, check_no_quoted_numbers, normalise_numbers, read_numbers, read_schema
from jointwear.reproduction import readings
from jointwear.robots.robot_file import read_robot_file
from jointwear.robots.task_file import read_task_file
from jointwear.running.shipped import shipped, shipped_glob

#: Keys of `monitor` that a config may leave out.
MONITOR_DEFAULTS: dict[str, Any] = {"robots": {}, "time_zone": "UTC", "stale_after": "72h", "notify": []}
#: The experiment that comes with the workflow, and the user's own in the working directory.
CONFIG = "config/config.yaml"
#: Sections of a config that are the user's own: the reproduction and its crate know nothing of them.
OF_THE_USER = ("discover", "monitor")


def config_schema() -> dict[str, Any]:
    """Return the schema of the configuration, with the alternatives of every reading filled in."""
    schema = read_schema("config")
    entries = {
        a.name: {"type": "string", "enum": list(a.alternatives), "description": a.question, "default": a.default}
        for a in readings.ambiguities().values()
    }
    schema["properties"]["reading"].update(additionalProperties=False, properties=entries)
    return schema


def _plain(value: Any) -> Any:
    """Turn what Snakemake loaded into plain dicts, lists, numbers and text."""
    if isinstance(value, Mapping):
        return {str(k): _plain(v) for k, v in value.items()}
    if isinstance(value, (list, tuple)):
        return [_plain(v) for v in value]
    # YAML turns a date without quotes into one of its own.
    return value.isoformat() if isinstance(value, date) else value


def _laid_over(base: Mapping[str, Any], more: Mapping[str, Any]) -> dict[str, Any]:
    """Return `base` with the values of `more`, mappings merged key by key."""
    merged = dict(base)
    for key, value in more.items():
        both = isinstance(value, Mapping) and isinstance(merged.get(key), Mapping)
        merged[key] = _laid_over(merged[key], value) if both else value
    return merged


def config_layers() -> list[Path]:
    """Return the shipped configuration and, where it is another, the working directory's own."""
    if Path(CONFIG).is_file():
        return [Path(CONFIG)] if Path(CONFIG).samefile(ROOT / CONFIG) else [ROOT / CONFIG, Path(CONFIG)]
    return [ROOT / CONFIG]


def layer_files(config: Mapping[str, Any]) -> dict[str, Any]:
    """Return the shipped configuration, the working directory's own and `config`, each laid over the last.

    Parameters
    ----------
    config : what Snakemake merged from ``--configfile`` and ``--config``, or what another workflow hands to this one
        as a module.

    Raises
    ------
    InputError : if a file is no YAML mapping or holds a key twice.
    """
    merged: dict[str, Any] = {}
    for path in config_layers():
        merged = _laid_over(merged, read_yaml(path))
    return _laid_over(merged, config)


def beside_workflow(config: Mapping[str, Any]) -> Mapping[str, Any]:
    """Return a configuration whose data sets and monitored robots name existing files: the user's or the shipped ones.

    A robot file, a recording or a pattern of logs that the working directory does not have is looked up beside the
    workflow; what neither has stays as it is.
    """

    def entry_of(entry: Any) -> Any:
        if not isinstance(entry, Mapping):
            return entry
        entry = {k: shipped(v) if k in ("robot", "measured") and isinstance(v, str) else v for k, v in entry.items()}
        if isinstance(entry.get("logs"), list):
            entry["logs"] = [_log_pattern(p) for p in entry["logs"]]
        return entry

    def entries_of(entries: Any) -> Any:
        return {k: entry_of(v) for k, v in entries.items()} if isinstance(entries, Mapping) else entries

    result = dict(config)
    for section, key in (("discover", "datasets"), ("monitor", "robots")):
        if isinstance(result.get(section), Mapping) and key in result[section]:
            result[section] = {**result[section], key: entries_of(result[section][key])}
    if "recover" in result:
        result["recover"] = entry_of(result["recover"])
    return entry_of(result)


def _log_pattern(pattern: Any) -> Any:
    if not isinstance(pattern, str):
        return pattern
    if is_registered(pattern):
        return str(locate(pattern))
    if not matches(pattern) and matches(str(ROOT / pattern)):
        return str(ROOT / pattern)
    return pattern


def prepare(config: Mapping[str, Any], files: Iterable[str | Path] = ()) -> dict[str, Any]:
    """Check a configuration and return it with number types normalised and readings complete.

    Parameters
    ----------
    config : as Snakemake merged it.
    files : the configuration files, read once more for keys given twice, which Snakemake takes silently.

    Raises
    ------
    InputError : one line naming the key, what is allowed and the nearest valid value.
    """
    schema = config_schema()
    for path in files:
        check_no_quoted_numbers(read_yaml(path, schema), schema, path)
    try:
        config = read_numbers(_plain(config), schema)
        # What came by --config no reader of files has seen.
        check_numbers(config, "config", schema)
    except RecursionError:
        raise InputError("config: an anchor holds itself") from None
    check(config, schema, "config")
    config = normalise_numbers(config, schema)
    config["reading"] = {a.name: config["reading"].get(a.name, a.default) for a in readings.ambiguities().values()}
    config.setdefault("discover", {}).setdefault("datasets", {})
    config["monitor"] = {**MONITOR_DEFAULTS, **config.get("monitor", {})}
    config = dict(beside_workflow(config))
    if config["report"]["replicate"] > config["replicates"]:
        raise InputError(
            f"config: 'report.replicate' is {config['report']['replicate']}, there are {config['replicates']} "
            f"replicates; the nearest valid value is {config['replicates']}"
        )
    span = config["sampling"]["interval"] * config["sampling"]["samples"]
    if span > 3600:
        raise InputError(f"config: 'sampling' covers {span:g} s of every hour; it must fit into 3600 s")
    return config


def check_experiment(config: Mapping[str, Any]) -> dict[str, Any]:
    """Check robot and tasks of the reproduction against each other and the config; return the robot file as read.

    Raises
    ------
    InputError : one line naming file and key.
    """
    try:
        check_regular(config["robot"])
    except InputError as error:
        raise InputError(f"config: 'robot' is {error}") from None
    robot = read_robot_file(config["robot"])
    axes = len(robot["joints"])
    for axis in config["wear"]["axes"]:
        if axis > axes:
            raise InputError(
                f"config: 'wear.axes' holds {axis}; robot '{robot['name']}' has axes 1 to {axes}; "
                f"the nearest valid value is {axes}"
            )
    known = sorted(p.stem for p in shipped_glob("config/tasks/*.yaml"))
    for task in config["tasks"]:
        if task not in known:
            raise InputError(
                f"config: 'tasks' holds '{task}', but there is no config/tasks/{task}.yaml{nearest(task, known)} "
                f"(there are: {', '.join(known)})"
            )
        read_task_file(shipped(f"config/tasks/{task}.yaml"), robot)
    return robot


def experiment_of(config: Mapping[str, Any]) -> dict[str, Any]:
    """Return a configuration without the user's own data sets and robots: what the reproduction depends on."""
    return {key: value for key, value in config.items() if key not in OF_THE_USER}


def reading_of(config: Mapping[str, Any], *stages: str) -> dict[str, str]:
    """Return the chosen alternatives of the ambiguities that the given stages ask about."""
    return {name: config["reading"][name] for stage in stages for name in readings.of_stage(stage)}
