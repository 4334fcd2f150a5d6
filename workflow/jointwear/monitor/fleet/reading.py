"""Read each log of a robot once: what a log came to is kept until the log, the model or the library changes.

`read.json` beside the statistics says which log was read with what. Statistics of logs that are no longer on disk are
kept: a store that deletes old logs does not take the baseline away. Where the model changes, or how logs are read, they
cannot be read again: such a robot is refused until somebody decides. Otherwise all logs are read into a folder of its
own, whose content takes the place of what was there once it is complete: an edit that is refused, interrupted or undone
changes nothing.
"""

from __future__ import annotations

import math
import os
import shutil
from collections.abc import Collection, Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from jointwear.files.digests import digest
from jointwear.files.errors import InputError
from jointwear.files.json_documents import read_json, write_json
from jointwear.files.schemas import check
from jointwear.files.wording import count
from jointwear.measurement.refused import Refused
from jointwear.monitor.fleet.plan import stamp_of
from jointwear.monitor.lengths_of_time import window_seconds
from jointwear.monitor.made_with import READING_KEYS, made_with
from jointwear.monitor.order_of_logs import in_order
from jointwear.monitor.reading.assembly import Piece, fingerprint
from jointwear.monitor.reading.piece_files import read_pieces, write_pieces
from jointwear.monitor.reading.reading_stages import log_pieces, survey_logs
from jointwear.monitor.reading.survey import read_survey
from jointwear.monitor.reading.windows import WindowStatistics, blank_statistics
from jointwear.running.script import with_suggestion

#: Logs between two saves: what a run that is killed has to read again at most.
SAVE_EVERY = 64
#: Files of statistics of a robot beyond which they are put into one: opening a file costs more than its content.
MOST_FILES = 16
#: Logs that are tried, the first ones, until one can be surveyed.
SURVEY_TRIES = 3

#: Folder in the robot's own in which logs are read anew after an edit, until all of them are, and the kept baseline.
ANEW, BASELINE = "anew", "baseline.nc"

#: What the record keeps.
_KEPT = ("settings", "code", "surveyed", "judged", "misfits", "logs")
_TEXT = {"type": "string"}
#: Layout of `read.json`; statistics lie in the robot's own folder.
_RECORD = {
    "type": "object",
    "required": ["settings", "code", "judged", "logs"],
    "properties": {
        "settings": _TEXT,
        "code": _TEXT,
        # Digest of the library that surveyed the first log.
        "surveyed": _TEXT,
        "judged": _TEXT,
        # First logs that contradicted the model, so that a later one was surveyed.
        "misfits": {"type": "array", "items": _TEXT},
        "logs": {
            "type": "object",
            "additionalProperties": {
                "type": "object",
                "required": ["stamp", "file"],
                "properties": {"stamp": _TEXT, "file": {"type": "string", "pattern": r"^[0-9a-f]{16}(_all)?\.nc$"}},
            },
        },
    },
}


class Readings:
    """The statistics of the logs of one robot in the folder `own`, and the record of how they were read."""

    def __init__(self, own: Path) -> None:
        self.own = own
        self._record = own / "read.json"
        try:
            known = read_json(self._record)
            check(known, _RECORD, self._record)
        except InputError:
            known = {"logs": self._kept_logs()}  # everything is read again
        self.settings: str = known.get("settings", "")
        self.code: str = known.get("code", "")
        self.surveyed: str = known.get("surveyed", "")
        self.judged: str = known.get("judged", "")
        self.misfits: list[str] = known.get("misfits", [])
        self.logs: dict[str, dict[str, str]] = known.get("logs", {})

    def save(self) -> None:
        """Keep the record."""
        write_json(self._record, {name: getattr(self, name) for name in _KEPT})

    def remove(self) -> Readings:
        """Remove the folder, if there is one; return what then is known, nothing."""
        shutil.rmtree(self.own, ignore_errors=True)
        return Readings(self.own)

    def update(self, entry: Mapping[str, Any], logs: Sequence[str], code: str, processes: int = 1) -> int:
        """Read what is new or has changed among `logs`; return how many logs were read.

        Parameters
        ----------
        entry : the robot's entry of the config. logs : that can be reached now. code : digest of the library.
        processes : in which logs are read.

        Raises
        ------
        InputError : if no survey could be made of the first logs, or logs that are gone were read otherwise.
        """
        settings, anew = made_with(entry["robot"], entry), Readings(self.own / ANEW)
        there = {*logs, *(anew.logs if anew.settings == settings else ())}
        if changed := settings != self.settings:
            other = "another robot file, or other keys that decide how logs are read"
            self._refuse_lost(there, other if self.settings else "a record that cannot be read any more")
        if not logs:
            return 0
        if not changed and self._is_surveyed():
            anew.remove()
            return self._read_new(entry, logs, code, processes)
        if not changed:
            self._refuse_lost(there, "a survey that cannot be read any more")
        if not (self.settings or self.logs):
            return self._fill(settings, entry, logs, code, processes)
        if anew.settings != settings:
            anew = anew.remove()
        read = anew._fill(settings, entry, logs, code, processes)
        self._take(anew)
        return read

    def leave_out(self, logs: Sequence[str]) -> None:
        """Forget logs that are still there but not among `logs`: the patterns match them no more."""
        self.logs = {log: kept for log, kept in self.logs.items() if log in logs or not Path(log).exists()}
        self.save()

    @property
    def survey(self) -> Path:
        """The file of the survey."""
        return self.own / "survey.json"

    @property
    def stamp(self) -> str:
        """A digest of all that was read."""
        return digest([self.settings, self.code, self.surveyed, self.logs])

    def pieces(self, logs: Sequence[str] | None = None) -> list[Piece]:
        """Return the statistics of all logs in their order; those that are not among `logs` are marked as gone."""
        found = {}
        for name in sorted({kept["file"] for kept in self.logs.values()}):
            for piece in read_pieces(self.own / "windows" / name):
                if self.logs.get(piece.log, {}).get("file") == name:
                    found[piece.log] = piece
        there = set(found if logs is None else logs)
        return [replace(found[log], gone=log not in there) for log in in_order(found)]

    def _kept_logs(self) -> dict[str, dict[str, str]]:
        """Return the logs whose statistics lie there, for a record that cannot be read; their stamps are unknown."""
        found = {}
        for path in sorted((self.own / "windows").glob("*.nc")):
            try:
                found |= {piece.log: {"stamp": "", "file": path.name} for piece in read_pieces(path)}
            except InputError:
                continue
        return found

    def _file(self, log: str) -> Path:
        return self.own / "windows" / self.logs[log]["file"]

    def _is_surveyed(self) -> bool:
        try:
            read_survey(self.survey)
        except InputError:
            return False
        return True

    def _fill(self, settings: str, entry: Mapping[str, Any], logs: Sequence[str], code: str, processes: int) -> int:
        """Survey and read all logs where nothing was read yet, or go on where that was interrupted."""
        if settings != self.settings or not self._is_surveyed():
            self.logs = {}
            self._survey(entry, logs)
            (self.own / BASELINE).unlink(missing_ok=True)
            self.settings, self.surveyed = settings, code
            self.save()
        return self._read_new(entry, logs, code, processes)

    def _read_new(self, entry: Mapping[str, Any], logs: Sequence[str], code: str, processes: int) -> int:
        """Read what is new or has changed, or was read by another version of the library, a group of logs at a time."""
        first = self._first_logs(logs) if code != self.surveyed else []
        if code != self.code or first:
            # Marked before the first is read: what an interrupted call does not come to, the next one reads.
            self.logs = {log: kept | {"stamp": ""} for log, kept in self.logs.items()}
            self.code = code
            self.save()
        if first:
            self._survey(entry, first)
            self.surveyed = code
            self.save()
        reading, stamps = _reading_keys(entry), {log: digest(stamp_of(log)) for log in logs}
        wanted = [
            log for log in logs if self.logs.get(log, {}).get("stamp") != stamps[log] or not self._file(log).is_file()
        ]
        for start in range(0, len(wanted), SAVE_EVERY):
            group = wanted[start : start + SAVE_EVERY]
            pieces = self._read(group, entry, reading, processes)
            name = f"{digest(group)[:16]}.nc"
            write_pieces(pieces, self.own / "windows" / name, reading)
            self.logs.update({log: {"stamp": stamps[log], "file": name} for log in group})
            self.save()
        if wanted:
            self._tidy(reading)
        self.save()
        return len(wanted)

    def _take(self, anew: Readings) -> None:
        """Put what was read anew in the place of what was there; the record knows nothing until all of it is there."""
        edited = anew.settings != self.settings
        self.settings, self.logs = "", {}
        self.save()
        (self.own / "windows").mkdir(exist_ok=True)
        for path in (anew.own / "windows").glob("*.nc"):
            shutil.move(path, self.own / "windows" / path.name)
        os.replace(anew.survey, self.survey)
        if edited:
            # The windows of a baseline that another model made do not compare with those to come.
            (self.own / BASELINE).unlink(missing_ok=True)
        for name in _KEPT:
            setattr(self, name, getattr(anew, name))
        self.save()
        self._remove_unused()
        anew.remove()

    def _first_logs(self, logs: Sequence[str]) -> list[str]:
        """Return the logs that another version of the library surveys anew, those first that were tried before.

        None while a log that was read is away, the first one above all: its windows were read with the survey that
        there is, and compare with no others.
        """
        was = read_survey(self.survey).log
        if was not in logs or not set(self.logs) <= set(logs):
            return []
        tried = [log for log in (*self.misfits, was) if log in logs]
        return tried + [log for log in logs if log not in tried]

    def _survey(self, entry: Mapping[str, Any], logs: Sequence[str]) -> None:
        reading, refused = _reading_keys(entry), None
        self.misfits = []
        for log in logs[:SURVEY_TRIES]:
            try:
                survey_logs(log, entry["robot"], reading, self.survey)
                return
            except InputError as error:
                refused = refused or error
                if isinstance(error, Refused):
                    self.misfits.append(log)
        raise refused or InputError("there is no log yet")

    def _read(
        self, logs: Sequence[str], entry: Mapping[str, Any], reading: Mapping[str, Any], processes: int
    ) -> list[Piece]:
        """Return the statistics of logs; a first log that contradicts the model is refused, as a survey refuses it.

        What the survey asks of a first log is more than what is asked of a later one, which may show a new gain.
        """
        reasons = {}
        for log in set(logs) & set(self.misfits):
            try:
                survey_logs(log, entry["robot"], reading, self.own / "tried.json")
            except InputError as error:
                reasons[log] = with_suggestion(error)
            (self.own / "tried.json").unlink(missing_ok=True)
        sound = [log for log in logs if log not in reasons]
        found = {p.log: p for p in log_pieces(sound, self.survey, entry["robot"], reading, processes)}
        empty = self._no_windows(entry)
        refused = {log: Piece(log, empty, math.nan, math.nan, (reason,)) for log, reason in reasons.items()}
        return [{**found, **refused}[log] for log in logs]

    def _no_windows(self, entry: Mapping[str, Any]) -> WindowStatistics:
        """Return the statistics of a log without any window."""
        survey = read_survey(self.survey)
        length = window_seconds(entry.get("window", "1h"))
        return blank_statistics(np.zeros(0), length, np.array(survey.torque_reference), survey.dated)

    def _refuse_lost(self, logs: Collection[str], what: str) -> None:
        """Refuse the robot if samples of logs that are not among `logs` would be lost; `what` they were read with.

        Raises
        ------
        InputError : with the number of these logs and what to do.
        """
        lost = set(self.logs) - set(logs)
        if not lost:
            return
        try:
            pieces = self.pieces()
        except InputError:
            pass  # nothing tells which of them hold anything
        else:
            there = {fingerprint(p) for p in pieces if p.log not in lost} - {None}
            lost = {p.log for p in pieces if p.log in lost and p.statistics.count.any() and fingerprint(p) not in there}
        if lost:
            raise InputError(
                f"{count(len(lost), 'log')} that can no longer be reached, '{in_order(lost)[0]}' the first, came in "
                f"with {what}; put them back, undo the change, or move {self.own} away to forget them and learn what "
                "is normal from the logs that are left"
            )

    def _tidy(self, reading: Mapping[str, Any]) -> None:
        """Put all statistics into one file where there are many, and remove files that nothing refers to."""
        if len({kept["file"] for kept in self.logs.values()}) > MOST_FILES:
            pieces = self.pieces()
            name = f"{digest([p.log for p in pieces])[:16]}_all.nc"
            write_pieces(pieces, self.own / "windows" / name, reading)
            for piece in pieces:
                self.logs[piece.log]["file"] = name
            self.save()
        self._remove_unused()

    def _remove_unused(self) -> None:
        """Remove files of statistics that the record does not refer to."""
        files = {kept["file"] for kept in self.logs.values()}
        for path in (self.own / "windows").glob("*.nc"):
            if path.name not in files:
                path.unlink()


def _reading_keys(entry: Mapping[str, Any]) -> dict[str, Any]:
    """Return what of an entry decides how logs are read."""
    return {key: entry[key] for key in READING_KEYS if key in entry}
