"""Deliver a message through apprise: e-mail, webhooks, Slack, Teams and many more by the scheme of an address."""

from __future__ import annotations

import logging
import os
import re
from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import Any

import apprise

from jointwear.files.errors import InputError

#: Pieces of an address that are shorter than this are not blotted out of what a service answered.
SHORTEST_SECRET = 4


def address_of(channel: Mapping[str, Any]) -> list[str]:
    """Return the addresses of a channel, one per line of its environment variable or file; `#` begins a comment.

    Raises
    ------
    InputError : if there is none. The address itself is never repeated.
    """
    if "env" in channel:
        where, text = f"environment variable {channel['env']}", os.environ.get(channel["env"], "")
    else:
        where = f"file {channel['file']}"
        try:
            text = Path(channel["file"]).read_text(encoding="utf-8")
        except (OSError, UnicodeDecodeError) as error:
            raise InputError(f"{where} cannot be read ({type(error).__name__})") from None
    lines = [line.strip() for line in text.splitlines()]
    found = [line for line in lines if line and not line.startswith("#")]
    if not found:
        raise InputError(f"{where} is not set or empty")
    return found


def without_address(channels: Iterable[Mapping[str, Any]]) -> list[str]:
    """Return one line, without secrets, for every channel whose address is not there."""
    told = []
    for channel in channels:
        try:
            address_of(channel)
        except InputError as error:
            told.append(f"{channel['name']}: {error}")
    return told


def send(channel: Mapping[str, Any], message: Mapping[str, Any]) -> str:
    """Send `title` and `body` of a message, a warning where it `calls` for somebody, a success where it tells of `good`
    ends alone, else an information; return "" or, in one line without secrets, why it could not be sent."""
    addresses: list[str] = []
    logger = logging.getLogger("apprise")
    spread, logger.propagate = logger.propagate, False
    try:
        addresses = address_of(channel)
        service = apprise.Apprise()
        for number, address in enumerate(addresses, start=1):
            if not service.add(address):
                return (
                    f"address {number} is none that apprise knows (allowed: its URLs, as mailto://, json://, slack://)"
                )
        with apprise.LogCapture(level=logging.WARNING) as said:
            sent = service.notify(
                title=message["title"],
                body=message["body"],
                body_format=apprise.NotifyFormat.TEXT,
                notify_type=_type_of(message),
            )
        return "" if sent else blot(_last_line(said.getvalue()) or "not delivered", addresses)
    except InputError as error:
        return str(error)
    except Exception as error:  # whatever a service does must not cost the message or the run
        return blot(f"{type(error).__name__}: {error}", addresses)
    finally:
        logger.propagate = spread


def _type_of(message: Mapping[str, Any]) -> apprise.NotifyType:
    if message.get("calls", True):
        return apprise.NotifyType.WARNING
    return apprise.NotifyType.SUCCESS if message.get("good", True) else apprise.NotifyType.INFO


def _last_line(text: str) -> str:
    lines = [line.strip() for line in text.splitlines() if line.strip()]
    return re.sub(r"^\S+ \S+ - \w+ - ", "", lines[-1]) if lines else ""


def blot(text: str, addresses: list[str]) -> str:
    """Return a text in one line without any piece of the addresses but their scheme."""
    text = " ".join(text.split())
    for address in addresses:
        _, _, rest = address.partition("://")
        pieces = {rest, *re.split(r"[/:@?&=#,;]+", rest)}
        for piece in sorted((p for p in pieces if len(p) >= SHORTEST_SECRET), key=len, reverse=True):
            text = text.replace(piece, "***")
    return text
