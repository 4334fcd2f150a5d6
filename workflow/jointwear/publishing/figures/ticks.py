"""Where the ticks of an axis stand, and what they are labelled with."""

from __future__ import annotations

from dataclasses import dataclass
from datetime import UTC, datetime, timedelta, tzinfo

import numpy as np

#: Most ticks of an axis of numbers, and of one of time.
MOST, MOST_DATES = 5, 8
#: Steps between ticks of time [s] up to days, then in months.
_SECONDS = (1, 5, 15, 30, 60, 120, 300, 600, 900, 1800, 3600, 7200, 10800, 21600, 43200)
_DAYS = (1, 2, 3, 7, 14)
_MONTHS = (1, 2, 3, 6, 12, 24, 60, 120, 240, 600)
_DAY, _MONTH = 86400, 30.4 * 86400


@dataclass(frozen=True)
class Ticks:
    """`places` (k,), `labels` (k), and `common`: what all labels have in common, empty without."""

    places: np.ndarray
    labels: tuple[str, ...]
    common: str = ""


def number_ticks(low: float, high: float, most: int = MOST) -> Ticks:
    """Return ticks at multiples of 1, 2 or 5 times a power of ten."""
    raw = (high - low) / most
    power = 10.0 ** np.floor(np.log10(raw))
    step = next(s * power for s in (1, 2, 5, 10) if s * power >= raw * (1 - 1e-9))
    places = step * np.arange(np.ceil(low / step - 1e-9), np.floor(high / step + 1e-9) + 1)
    digits = max(0, -int(np.floor(np.log10(step) + 1e-9)))
    far = max(abs(low), abs(high))
    if digits > 4 or far >= 1e5:
        return Ticks(places, tuple(_minus(f"{p:.3g}") for p in places))
    return Ticks(places, tuple(_minus(f"{p + 0.0:.{digits}f}") for p in places))


def _minus(text: str) -> str:
    return text.replace("-", "−")


def date_ticks(low: float, high: float, zone: tzinfo, most: int = MOST_DATES) -> Ticks:
    """Return ticks at round times of a zone; `low`, `high` in seconds since 1970 UTC."""
    span = high - low
    begin, end = (datetime.fromtimestamp(t, tz=zone).replace(tzinfo=None) for t in (low, high))
    first = begin.replace(hour=0, minute=0, second=0, microsecond=0)
    step = next((s for s in _SECONDS if span / s <= most), None)
    if step is not None:
        # Every step divides a day.
        first += timedelta(seconds=(begin - first).total_seconds() // step * step)
        count = int((end - first).total_seconds() // step) + 1
        local = [first + timedelta(seconds=step * k) for k in range(count)]
        form = "%H:%M:%S" if step < 60 else "%H:%M"
        labels = [f"{t.day} {t:%b}" if t.hour == t.minute == t.second == 0 else t.strftime(form) for t in local]
        common = f"{begin.day} {begin:%b %Y}"
    elif (days := next((d for d in _DAYS if span / (d * _DAY) <= most), None)) is not None:
        # Multiples of the step since a Monday.
        first -= timedelta(days=first.toordinal() % 7 - 1 if days % 7 == 0 else first.toordinal() % days)
        local = [first + timedelta(days=days * k) for k in range((end - first).days // days + 1)]
        labels, common = [f"{t.day} {t:%b}" for t in local], f"{end.year}"
    else:
        months = next((m for m in _MONTHS if span / (m * _MONTH) <= most), _MONTHS[-1])
        start = (first.year * 12 + first.month - 1) // months * months
        stop = end.year * 12 + end.month
        local = [datetime(k // 12, k % 12 + 1, 1) for k in range(start, stop, months)]
        labels = [str(t.year) if t.month == 1 else f"{t:%b}" for t in local]
        common = "" if any(t.month == 1 for t in local) else f"{end.year}"
    places = np.array([t.replace(tzinfo=zone).astimezone(UTC).timestamp() for t in local])
    inside = (places >= low) & (places <= high)
    return Ticks(places[inside], tuple(w for w, keep in zip(labels, inside, strict=True) if keep), common)
