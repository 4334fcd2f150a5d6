"""``snakemake notify``: rows of the fleet in, messages out, the outbox and its metrics beside them."""

from __future__ import annotations

import time
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Any

from prometheus_client import CollectorRegistry, Gauge, write_to_textfile

from jointwear.monitor.local_time import zone_of
from jointwear.monitor.notify.channels import send as send_through
from jointwear.monitor.notify.notices import closures, notices
from jointwear.monitor.notify.outbox import Outbox
from jointwear.monitor.presentation.standing import left_of, rows_of


def notify(
    rows: str | Path,
    channels: Sequence[Mapping[str, Any]],
    outbox: str | Path,
    metrics: str | Path,
    *,
    time_zone: str | None = None,
    now: float | None = None,
    send: Callable[[Mapping[str, Any], Mapping[str, Any]], str] = send_through,
) -> list[str]:
    """Tell every channel what it has not been told yet.

    Parameters
    ----------
    rows : file of :func:`~jointwear.monitor.fleet.summary.summarise_fleet`. channels : ``monitor.notify``.
    outbox : file that says what was told and what waits. metrics : file for Prometheus. now : [s since 1970].

    Returns
    -------
    list : one line, without secrets, for every channel that could not be reached. Its messages wait.

    Raises
    ------
    InputError : if the rows or the outbox cannot be read.
    """
    found = rows_of(
        rows, ("reason", "dated", "axes", "episodes", "stale", "silence_hours", "refused_newest", "refusals")
    )
    now = time.time() if now is None else now
    box = Outbox.open(outbox)
    told, closed = notices(found, zone_of(time_zone)), closures(found, zone_of(time_zone))
    gone = left_of(rows)
    by_name = {channel["name"]: channel for channel in channels}
    box.keep(by_name)
    for name, channel in by_name.items():
        mine = [row for row in found if row["robot"] in channel.get("robots", [row["robot"]])]
        robots = {row["robot"] for row in mine}
        # A robot that is refused has no alarms to compare with: what was told of it stays.
        kept = {row["folder"] for row in mine if row["result"] != "judged"}
        current = [notice for notice in told if notice.robot in robots]
        box.note(name, current, {row["folder"] for row in mine} - kept, now, closed, gone)
    box.save()
    failed = box.deliver(list(by_name), lambda name, message: send(by_name[name], message))
    _write_metrics(box, list(by_name), metrics)
    return failed


def _write_metrics(box: Outbox, channels: Sequence[str], output: str | Path) -> None:
    registry = CollectorRegistry()
    waiting = Gauge("jointwear_messages_waiting", "Messages that could not be sent yet", ["channel"], registry=registry)
    for channel in channels:
        waiting.labels(channel).set(sum(m["channel"] == channel for m in box.waiting))
    write_to_textfile(str(output), registry)
