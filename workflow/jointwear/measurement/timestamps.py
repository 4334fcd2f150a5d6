"""Times of day as text. Read by the Snakefile at every call: nothing heavy is imported here."""

from __future__ import annotations

from datetime import UTC, datetime


def utc_seconds(text: str) -> float:
    """Return seconds since 1970 UTC of an ISO 8601 time; without a zone it counts as UTC.

    Raises
    ------
    ValueError : if the text is no such time.
    """
    moment = datetime.fromisoformat(text)
    return (moment if moment.tzinfo else moment.replace(tzinfo=UTC)).timestamp()
