"""Judge a batch of robots in one process; one robot that is refused, or breaks, does not stop the others."""

from __future__ import annotations

import sys
import time
import traceback
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from jointwear.files.digests import digest
from jointwear.files.errors import InputError
from jointwear.files.json_documents import write_json
from jointwear.files.text_files import remove
from jointwear.monitor.fleet.folders import namesakes, own_folder
from jointwear.monitor.fleet.history import write_history
from jointwear.monitor.fleet.plan import JUDGEMENT, noted
from jointwear.monitor.fleet.ranking import asks
from jointwear.monitor.fleet.reading import Readings
from jointwear.monitor.judging.state import read_state
from jointwear.monitor.made_with import model_of
from jointwear.monitor.normal.recall import read_recall, write_recall
from jointwear.monitor.presentation.condition import CHANGED, HEALTHY, UNRESOLVED
from jointwear.monitor.presentation.page import write_page
from jointwear.monitor.presentation.standing import NOTHING, standing
from jointwear.monitor.stages import judge_pieces
from jointwear.publishing.report.rendering import digest_of_page
from jointwear.running.modules import code_of
from jointwear.running.script import with_suggestion

#: Robots of a fleet up to which each gets a page; in a larger one those on which something is to be checked.
PAGES = 50
#: The page of a robot, and its template.
PAGE, TEMPLATE = "monitor.html", "monitor.html.j2"


def watch_robot(
    name: str,
    entry: Mapping[str, Any],
    logs: Sequence[str],
    folder: Path,
    *,
    unreachable: str = "",
    time_zone: str | None = None,
    page: bool = True,
    processes: int = 1,
    configuration: str = "",
) -> dict[str, Any]:
    """Read what is new of one robot and judge it; files go to `folder`/`name`.

    An error refuses this robot, with its reason in the row, and is not raised: the other robots are still judged.

    Parameters
    ----------
    logs : that can be reached now, in order. unreachable : why some cannot; what was read of them before counts.
    time_zone : of the page. page : whether a healthy robot has one too. processes : in which logs are read.
    configuration : see :func:`own_folder`.

    Returns
    -------
    dict : `robot`, `folder`, `result` (judged or refused), `reason` of a refusal or of logs that cannot be reached,
        `logs_read` by this call, and what :func:`~jointwear.monitor.presentation.standing.standing` says.
    """
    own = folder / name
    row = {"robot": name, "folder": own.name, "result": "judged", "logs_read": 0, **NOTHING, "reason": unreachable}
    try:
        own = own_folder(folder, name, entry, logs, configuration, complete=not unreachable)
        row["folder"] = own.name
        readings = Readings(own)
        row["logs_read"] = readings.update(entry, logs, code_of("accumulate_windows"), processes)
        if not readings.logs:
            raise InputError(unreachable or "there is no log yet")
        told = namesakes(own, folder, name)
        row.update(_judged(own, name, entry, readings, logs, told=told, time_zone=time_zone, page=page))
        row["kept_logs"] = len(set(readings.logs) - set(logs))
        row["page"] = PAGE if (own / PAGE).is_file() else None
        return row
    except InputError as error:
        reason = with_suggestion(error)
    except OSError as error:
        reason = f"{error.filename or own}: {error.strerror or error}"
    except Exception as error:  # a robot that breaks the library must not cost the others their judgement
        traceback.print_exc(file=sys.stderr)
        reason = f"internal error, please report it: {type(error).__name__}: {error}"
    # A robot that is refused must not leave the files of an earlier judgement behind.
    for file in (*JUDGEMENT, PAGE):
        remove(own / file)
    refused = {"logs": len(logs), "refused_logs": len(logs)}
    return {**row, **NOTHING, **refused, "result": "refused", "reason": " ".join(reason.split())}


def _judged(
    own: Path,
    name: str,
    entry: Mapping[str, Any],
    readings: Readings,
    logs: Sequence[str],
    *,
    told: list[str],
    time_zone: str | None,
    page: bool,
) -> dict[str, Any]:
    """Return how a robot stands, judged anew where anything that it depends on has changed since it was judged last, or
    a file of that judgement is gone.

    Parameters
    ----------
    own : the folder of the robot, with its `readings`. logs, time_zone, page : as of :func:`watch_robot`.
    told : what has to be said on its page.
    """
    code = code_of("judge_windows")
    judging = [entry, model_of(entry["robot"]), readings.stamp, code, code_of("watch_fleet")]
    judging += [told, sorted(set(readings.logs) - set(logs))]
    judged = digest([judging, time_zone, page, digest_of_page(TEMPLATE)])
    if judged == readings.judged and all((own / file).is_file() for file in JUDGEMENT):
        found = standing(read_state(own / "state.nc"))
        if (own / PAGE).is_file() or not (page or _needs_page(found)):
            return found
    readings.judged = ""
    recall = read_recall(own / "recall.json", code)
    judge_pieces(
        readings.pieces(logs),
        entry["robot"],
        entry,
        own / "state.nc",
        own / "alarms.csv",
        name,
        recall=recall,
        survey=readings.survey,
        told=told,
    )
    write_recall(own / "recall.json", recall, code)
    state = read_state(own / "state.nc")
    found = standing(state)
    write_history(own / "history.parquet", state, name)
    if page or _needs_page(found):
        write_page(state, own / PAGE, own / "figures", time_zone)
    else:
        (own / PAGE).unlink(missing_ok=True)
    readings.judged = judged
    readings.save()
    return found


def _needs_page(found: Mapping[str, Any]) -> bool:
    """Return whether something is to be checked on a robot, which then has a page in a fleet of any size."""
    levels = {axis["level"] for axis in found["axes"]}
    refused = found["refused_newest"] or found["unfinished"]
    return bool(asks(found) or refused or HEALTHY not in levels or levels & {CHANGED, UNRESOLVED})


def watch_robots(
    entries: Mapping[str, Mapping[str, Any]],
    logs: Mapping[str, Sequence[str]],
    folder: str | Path,
    output: str | Path,
    *,
    unreachable: Mapping[str, str] | None = None,
    time_zone: str | None = None,
    robots: int | None = None,
    processes: int = 1,
    configuration: str = "",
    begun: Mapping[str, int] | None = None,
    notes: str | Path | None = None,
) -> None:
    """Judge every robot of a batch and write what came out as JSON.

    Parameters
    ----------
    entries : entries of ``monitor.robots`` by name.
    logs : the logs of every robot, in order of time.
    folder : where each robot gets a folder of its own.
    output : the JSON file: `robots`, one row each, and `process_seconds`, the processor time of the judging alone.
    unreachable : of robots whose logs cannot all be reached, why. time_zone : of the pages.
    robots : number of robots of the whole fleet, which decides who has a page. processes : in which logs are read.
    configuration : see :func:`own_folder`.
    begun, notes : see :func:`~jointwear.monitor.fleet.plan.begun`, and the file in which it is noted.
    """
    begin = time.process_time()
    page = (robots or len(entries)) <= PAGES
    silent = unreachable or {}
    rows = []
    for name, entry in entries.items():
        told = silent.get(name, "")
        rows.append(
            watch_robot(
                name,
                entry,
                logs[name],
                Path(folder),
                unreachable=told,
                time_zone=time_zone,
                page=page,
                processes=processes,
                configuration=configuration,
            )
        )
    spent = time.process_time() - begin
    write_json(output, {"robots": rows, "process_seconds": round(spent, 3)})
    if notes:
        write_json(notes, noted(rows, begun or {}))
