"""netCDF logs: variables on (time,) and (time, joint)."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from dataclasses import replace
from datetime import timedelta
from pathlib import Path

import netCDF4
import numpy as np

from jointwear.files.errors import InputError, nearest, shown
from jointwear.files.storage import open_dataset, read_variable
from jointwear.measurement.formats.chunk import NEEDED, Chunk, make_chunk
from jointwear.measurement.formats.layout import Layout
from jointwear.measurement.formats.local_stamps import LocalStamps, goes_on_through
from jointwear.measurement.formats.programs import joined_labels
from jointwear.measurement.units import UNITS, spelled

#: Calendars that a controller can keep; the others of CF are for climate models.
CALENDARS = ("standard", "gregorian", "proleptic_gregorian")


def read(path: Path, layout: Layout, rows: int) -> Iterator[Chunk]:
    """Yield the samples of a netCDF file; see :func:`jointwear.measurement.formats.read_log`.

    Raises
    ------
    InputError : if the file cannot be read, or lacks what the layout asks for.
    """
    with open_dataset(path) as dataset:
        there = dataset.variables
        names = {}
        for role, name in layout.names.items():
            if not isinstance(name, str):
                raise InputError(f"{path}: 'variables.{role}' is a list; a netCDF file has one variable for a role")
            if name in there:
                names[role] = name
            elif role in NEEDED or role in layout.given:
                raise InputError(
                    f"{path}: has no variable '{name}' for {role}{nearest(name, there)} (it has: {', '.join(there)})"
                )
        for name in layout.program:
            if name not in there:
                raise InputError(
                    f"{path}: has no variable '{name}' of 'program.columns'{nearest(name, there)} (it has: "
                    f"{', '.join(there)})"
                )
        count = {role: there[name].shape[0] if there[name].ndim else 0 for role, name in names.items()}
        if len(set(count.values())) > 1:
            told = ", ".join(f"{role} {size}" for role, size in count.items())
            raise InputError(f"{path}: variables differ in length ({told}){_turned(there, names, count['time'])}")
        for role, name in names.items():
            if there[name].dtype == str or there[name].dtype.kind not in "fiu":
                raise InputError(f"{path}: variable '{name}' for {role} does not hold numbers")
        units = {role: str(there[name].units) for role, name in names.items() if hasattr(there[name], "units")}
        factor, origin, zoned = _date(path, there[names["time"]])
        zone = None if zoned else layout.time_zone
        if zone and _counted(dataset, path, names["time"], factor, origin, zone, rows):
            origin, zone = float(LocalStamps(zone).of_wall_clock(np.array([origin]))[0]), None
        dated, local = origin is not None, LocalStamps(zone)
        for start in range(0, count["time"], rows):
            part = slice(start, start + rows)
            values = {
                role: floats(path, there[name], read_variable(dataset, path, name, part))
                for role, name in names.items()
            }
            if layout.program:
                labels = [read_variable(dataset, path, name, part) for name in layout.program]
                values["program"] = joined_labels(path, [np.asarray(x) for x in labels])
            if dated:
                values["time"] = local.of_wall_clock(values["time"] * factor + origin)
            yield replace(make_chunk(path, values, layout, units, dated), none_such=local.none_such)


def _counted(
    dataset: netCDF4.Dataset, path: Path, name: str, factor: float, origin: float, zone: str, rows: int
) -> bool:
    """Return whether the times of a log are seconds that go on, though their origin is a time on the wall; `factor`,
    `origin` [s] of their unit. Asked of logs alone during which the clock in `zone` is turned back."""
    variable = dataset.variables[name]

    def wall(part: slice) -> np.ndarray:
        return floats(path, variable, read_variable(dataset, path, name, part)) * factor + origin

    count = variable.shape[0] if variable.ndim else 0
    if not count:
        return False
    ends = np.concatenate([wall(slice(0, 1)), wall(slice(count - 1, count))])
    east = ends - LocalStamps(zone).of_wall_clock(ends)
    # Where an end is not known, or astray, all of the times tell.
    if np.isfinite(east).all() and east[0] == east[1]:
        return False
    return goes_on_through((wall(slice(start, start + rows)) for start in range(0, count, rows)), zone)


def _turned(there: Mapping[str, netCDF4.Variable], names: Mapping[str, str], samples: int) -> str:
    """Return which variable has its dimensions the other way round, and the mend; empty where none has."""
    for name in names.values():
        if there[name].ndim == 2 and there[name].shape[1] == samples:
            axis, time = there[name].dimensions
            mend = f"write ({time}, {axis}), as xarray does by transpose('{time}', ...)"
            return f"; '{name}' has the dimensions ({axis}, {time}): {mend}"
    return ""


def floats(path: Path, variable: netCDF4.Variable, values: np.ndarray) -> np.ndarray:
    """Return values as floats, with NaN for what the file marks as missing.

    Packed numbers have been unpacked by the library; the marks have not, and are here.

    Raises
    ------
    InputError : if the variable, or what packs or marks it, holds no numbers.
    """
    if values.dtype.kind not in "fiu":
        raise InputError(f"{path}: variable '{variable.name}' does not hold numbers")
    result = np.array(values, dtype=float)
    if not result.size:
        return result
    (scale,), (offset,) = _attribute(path, variable, "scale_factor", 1.0), _attribute(path, variable, "add_offset", 0.0)
    for name in ("_FillValue", "missing_value"):
        for mark in _attribute(path, variable, name):
            unpacked = mark * scale + offset
            result[np.abs(result - unpacked) <= ROUNDING * abs(unpacked)] = np.nan
    return result


#: Largest relative difference of a mark and a value that were unpacked in single and in double precision.
ROUNDING = 1e-6


def _attribute(path: Path, variable: netCDF4.Variable, name: str, *default: float) -> np.ndarray:
    """Return the numbers of an attribute of a variable, at least one where there is a default."""
    if name not in variable.ncattrs():
        return np.array(default, dtype=float)
    found = np.atleast_1d(variable.getncattr(name))
    if found.dtype.kind not in "fiu" or (default and (found.size != 1 or not np.isfinite(found).all())):
        raise InputError(f"{path}: variable '{variable.name}': '{name}' is {shown(found.tolist())}, must be a number")
    return found.astype(float)


#: CF units of time: what the library reads, and the zone behind it, of which it leaves out what it does not know.
_SINCE = re.compile(
    r"(?P<date>.*\ssince\s+[-+]?\d+(?:-\d+){0,2}(?:(?:T|\s+)\d+(?::\d+){0,2}(?:\.\d*)?)?)\s*(?P<zone>.*?)\s*",
    re.ASCII | re.IGNORECASE | re.DOTALL,
)
_OFFSET = re.compile(r"(?P<sign>[+-])(?P<hours>\d{1,2})(?::?(?P<minutes>\d\d))?", re.ASCII)
_GREENWICH = ("Z", "UTC", "GMT")


def _date(path: Path, variable: netCDF4.Variable) -> tuple[float, float | None, bool]:
    """Return of CF time units the length [s], the origin [s since 1970] or None without a date, and whether it is UTC.

    An origin that names no zone is one of the clock on the wall, as xarray writes it, and so are the times but for
    those of :func:`_counted`. That of Unix time is UTC.

    Raises
    ------
    InputError : if the units, the calendar or the zone are not known.
    """
    units = str(getattr(variable, "units", ""))
    if " since " not in units:
        return 1.0, None, True
    calendar = str(getattr(variable, "calendar", CALENDARS[0]))
    if calendar.lower() not in CALENDARS:
        raise InputError(f"{path}: the calendar of time is {shown(calendar)} (allowed: {', '.join(CALENDARS)})")
    said = _SINCE.fullmatch(units)
    date, zone = (said["date"], said["zone"]) if said else (units, "")
    offset = _OFFSET.fullmatch(zone)
    if zone and not offset and zone.upper() not in _GREENWICH:
        raise InputError(
            f"{path}: the unit {shown(units)} of time has {shown(zone)} behind its date, which is no zone (allowed: "
            f"{', '.join(_GREENWICH)}, an offset as +01:00, or none)"
        )
    # The library knows the date of every origin, but no nanoseconds, in which xarray writes what pandas holds.
    word, moment = date.split(" since ", 1)
    length = UNITS["time"].get(spelled("time", word.lower())) if word.strip() else None
    known = date if length is None else f"seconds since {moment}"
    try:
        zero, one = netCDF4.num2date([0, 1], known, only_use_cftime_datetimes=False, only_use_python_datetimes=True)
    except (ValueError, OverflowError, TypeError) as error:
        raise InputError(f"{path}: the unit {shown(units)} of time is not known ({error})") from None
    origin = (zero - type(zero)(1970, 1, 1)).total_seconds()
    factor = (one - zero).total_seconds() if length is None else length[0]
    if offset:
        east = timedelta(hours=int(offset["hours"]), minutes=int(offset["minutes"] or 0)).total_seconds()
        return factor, origin - (east if offset["sign"] == "+" else -east), True
    return factor, origin, bool(zone) or origin == 0
