"""From the rows of all batches to the page, the table, the metrics and the history of the fleet."""

from __future__ import annotations

import sys
import time
from collections.abc import Sequence
from datetime import tzinfo
from pathlib import Path

from jointwear.files.json_documents import write_json
from jointwear.monitor.fleet.folders import further_folders
from jointwear.monitor.fleet.history import join_histories
from jointwear.monitor.fleet.metrics import write_metrics
from jointwear.monitor.fleet.page import write_fleet_page
from jointwear.monitor.fleet.ranking import STALE_AFTER_HOURS, as_of, ranked
from jointwear.monitor.fleet.table import write_table
from jointwear.monitor.local_time import with_local_times, zone_of
from jointwear.monitor.notify.outbox import Outbox
from jointwear.monitor.presentation.standing import rows_of


def read_rows(batches: Sequence[str | Path]) -> list[dict]:
    """Return the rows of the robots of all batches.

    Raises
    ------
    InputError : naming the file, if one is broken.
    """
    return [row for path in batches for row in rows_of(path)]


def summarise_fleet(
    batches: Sequence[str | Path],
    folder: str | Path,
    table: str | Path,
    page: str | Path,
    metrics: str | Path,
    history: str | Path,
    rows: str | Path,
    *,
    outbox: str | Path | None = None,
    time_zone: str | None = None,
    stale_after: float = STALE_AFTER_HOURS,
    configuration: str = "",
    now: float | None = None,
) -> None:
    """Write what is known of all robots, the most urgent first.

    Parameters
    ----------
    batches : files of :func:`~jointwear.monitor.fleet.watch.watch_robots`. folder : of the robots.
    table, page, metrics, history, rows : files to write: CSV, HTML, text format of Prometheus, Parquet, JSON.
    outbox : of `notify`; the page tells of messages that wait. time_zone : IANA name, for the page.
    stale_after : silence [h] after which a robot counts as stale.
    configuration : that names the robots; those that it named once are told of by their folders, `left` of `rows`. The
        page tells of those that another configuration named: it takes the place of theirs.
    now : [s since 1970] that staleness counts from, default the clock's.
    """
    now, zone = time.time() if now is None else now, zone_of(time_zone)
    found = [_in_zone(row, zone) for row in ranked([as_of(row, now, stale_after) for row in read_rows(batches)])]
    write_table(found, table)
    write_metrics(found, now, metrics)
    join_histories(_histories(found, Path(folder)), history)
    left, others = further_folders(Path(folder), {row["folder"] for row in found}, configuration)
    write_json(rows, {"now": now, "robots": found, "left": left})
    link = Path(folder).relative_to(Path(page).parent).as_posix()
    waiting = Outbox.open(outbox).waiting if outbox else []
    write_fleet_page(found, page, zone, now, link, [message["channel"] for message in waiting], others)


def _histories(rows: Sequence[dict], folder: Path) -> list[Path]:
    """Return the files of the histories of judged robots; one that was deleted since is told of, and stops nothing."""
    parts = [folder / row["folder"] / "history.parquet" for row in rows if row["result"] == "judged"]
    for part in parts:
        if not part.is_file():
            print(f"{part} is gone: its robot is not in the history until the next call writes it", file=sys.stderr)
    return [part for part in parts if part.is_file()]


def _in_zone(row: dict, zone: tzinfo) -> dict:
    """Return a row with the times in its findings as those of a zone."""
    return {**row, "findings": [{**f, "words": with_local_times(f["words"], zone)} for f in row["findings"]]}
