"""What each channel has been told, and messages that wait. Kept on disk before anything is sent."""

from __future__ import annotations

from collections.abc import Callable, Collection, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from jointwear.files.errors import InputError
from jointwear.files.json_documents import read_json, write_json
from jointwear.files.schemas import check
from jointwear.monitor.notify.notices import Closure, Notice

#: Lines of a message beyond which the rest is only counted: services refuse long messages.
MOST_LINES = 40
#: Bars in the key of an alarm: folder, axis, quantity, detector and number of the episode.
EPISODE_BARS = 4

_TEXT = {"type": "string"}
_LAYOUT = {
    "type": "object",
    "required": ["told", "waiting"],
    "properties": {
        "told": {
            "type": "object",
            "additionalProperties": {
                "type": "object",
                "additionalProperties": {
                    "type": "object",
                    "required": ["subject", "active"],
                    "properties": {"subject": _TEXT, "active": {"type": "boolean"}},
                },
            },
        },
        "waiting": {
            "type": "array",
            "items": {
                "type": "object",
                "required": ["channel", "since", "attempts", "title", "body"],
                "properties": {
                    **dict.fromkeys(("channel", "title", "body"), _TEXT),
                    "since": {"type": "number"},
                    "attempts": {"type": "integer", "minimum": 0},
                    "calls": {"type": "boolean"},
                    "good": {"type": "boolean"},
                },
            },
        },
    },
}


def _story(key: str) -> str:
    """Return the key of a notice with one name for friction of either kind, which may change as an episode goes on."""
    return key.replace("|coulomb friction|", "|friction|").replace("|viscous friction|", "|friction|")


def _of_what(key: str) -> str:
    """Return the :func:`_story` of an alarm without the number of its episode; other notices have none."""
    return _story(key).rpartition("|")[0] if key.count("|") == EPISODE_BARS else key


@dataclass
class Outbox:
    """`told`: channel -> key of a notice -> its subject and whether it was active; `waiting`: messages in order, each
    with whether it calls for somebody (`calls`) or tells of ends alone, and whether these are all `good`."""

    path: Path
    told: dict[str, dict[str, dict[str, Any]]] = field(default_factory=dict)
    waiting: list[dict[str, Any]] = field(default_factory=list)

    @classmethod
    def open(cls, path: str | Path) -> Outbox:
        """Read the outbox, or begin a new one.

        Raises
        ------
        InputError : if the file is broken; it is left as it is, for messages may wait in it.
        """
        path = Path(path)
        if not path.exists():
            return cls(path)
        try:
            known = read_json(path)
            check(known, _LAYOUT, path)
            return cls(path, known["told"], known["waiting"])
        except InputError:
            raise InputError(
                f"{path}: is damaged or was changed; messages may wait in it: mend it and take out its line "
                "'checksum', or delete it to begin anew"
            ) from None

    def save(self) -> None:
        """Keep the outbox."""
        content = {"told": self.told, "waiting": self.waiting}
        write_json(self.path, content)

    def note(
        self,
        channel: str,
        found: Sequence[Notice],
        folders: set[str],
        now: float,
        closed: Mapping[str, Closure] | None = None,
        gone: Collection[str] = (),
    ) -> None:
        """Put what a channel has not been told yet into the outbox: what is new, what came back, what ended.

        Parameters
        ----------
        folders : of the robots that this call knows the state of; what was told of others stays as it is.
        now : [s since 1970]. closed : by the key of a notice what closed it, where an event did.
        gone : folders of robots that have left the configuration: what was told of them ends.
        """
        told = self.told.setdefault(channel, {})
        present = {notice.key: notice for notice in found}
        closings = {_story(key): closure for key, closure in (closed or {}).items()}
        for key in [k for k in told if k not in present and _story(k) not in closings]:
            # More shifts may give an episode the name of the other friction, and one that came before it may come to
            # light or be forgotten: that is neither new nor resolved.
            renamed = next((k for k in present if k not in told and _of_what(k) == _of_what(key)), None)
            if renamed is not None:
                told[renamed] = told.pop(key)
        alarms, ends, looked_at, left = [], [], [], []
        for key, notice in present.items():
            before = told.get(key)
            if notice.active and (before is None or not before["active"]):
                alarms.append(f"{'ALARM' if before is None else 'AGAIN'}  {notice.subject}: {notice.words}")
            elif before is None:
                alarms.append(f"ALARM  {notice.subject}: {notice.words}; back to normal since")
            elif before["active"] and not notice.active:
                ends.append(f"ENDED  {notice.subject}: back to normal, but no event says why; {notice.words}")
            told[key] = {"subject": notice.subject, "active": notice.active}
        for key in [k for k in told if k not in present and k.split("|", 1)[0] in folders]:
            closure = closings.get(_story(key))
            if closure is None:
                ends.append(f"ENDED  {told[key]['subject']}: resolved")
            elif closure.mended:
                ends.append(f"ENDED  {told[key]['subject']}: {closure.words}")
            else:
                looked_at.append(f"CLOSED {told[key]['subject']}: {closure.words}")
            del told[key]
        for key in [k for k in told if k.split("|", 1)[0] in gone]:
            robot = told.pop(key)["subject"].split(", ")[0]
            left.append(f"ENDED  {robot}: no longer in the configuration")
        ends += dict.fromkeys(left)
        lines = alarms + looked_at + ends
        if lines:
            numbers = {"new": len(alarms), "closed": len(looked_at), "ended": len(ends)}
            counts = [f"{number} {what}" if number else "" for what, number in numbers.items()]
            rest = len(lines) - MOST_LINES
            body = lines[:MOST_LINES] + ([f"... and {rest} more on the page of the fleet"] if rest > 0 else [])
            title = f"Robot wear: {', '.join(c for c in counts if c)}"
            message = {"channel": channel, "since": now, "attempts": 0, "title": title, "body": "\n".join(body)}
            self.waiting.append({**message, "calls": bool(alarms), "good": not looked_at and not left})

    def keep(self, channels: Collection[str]) -> None:
        """Keep the messages that wait for channels that there are; those for one that is gone would wait for ever."""
        self.waiting = [message for message in self.waiting if message["channel"] in channels]

    def deliver(self, channels: Sequence[str], send: Callable[[str, Mapping[str, Any]], str]) -> list[str]:
        """Send what waits for the channels, in order; what cannot be sent goes on waiting.

        Parameters
        ----------
        send : takes channel and message, returns "" or why it could not be sent.

        Returns
        -------
        list : one line for every channel that failed; the later messages of such a channel are not tried.
        """
        failed: dict[str, str] = {}
        for message in list(self.waiting):
            channel = message["channel"]
            if channel not in channels or channel in failed:
                continue
            message["attempts"] += 1
            reason = send(channel, message)
            if reason:
                failed[channel] = reason
            else:
                # By identity: two messages may read alike.
                self.waiting = [other for other in self.waiting if other is not message]
            self.save()
        return [f"{channel}: {reason}" for channel, reason in failed.items()]
