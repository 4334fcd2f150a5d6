"""Write and read netCDF-4 files that xarray opens, without paying for xarray.

A file appears under its name only when it is complete; it holds no time stamps, so the same inputs give the
same bytes.
"""

from __future__ import annotations

import json
import math
import os
import zlib
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import netCDF4
import numpy as np

from jointwear.files.errors import TRUNCATED, InputError, shown
from jointwear.files.regular_files import check_regular
from jointwear.files.text_files import remove, unwritable

# What the CF conventions (version 1.8, sections 2.6.1 and 2.6.2) ask of every file. A history without a date: the
# same inputs give the same bytes.
CONVENTIONS = {
    "Conventions": "CF-1.8",
    "institution": "computed by jointwear, no institution",
    "references": (
        "V. Sathish, S. Ramaswamy, S. Butail: A simulation based approach to detect wear in industrial robots, "
        "IEEE CASE 2015"
    ),
}
#: Folder whose files carry their own name: what stands below it is read under the name that it was written under.
RESULTS = "results"
#: Attribute with that name.
NAME = "result"
#: Attribute with the checksum of all that is not numbers, which have checksums of their own.
CHECKSUM = "jointwear_checksum"
#: Attribute of a variable that holds finite numbers alone.
FINITE = "finite"
#: Size of the parts of a variable that have a checksum each: large enough not to matter, small enough to read slices.
CHUNK = 1 << 20  # bytes
#: Deflate packs at most 1,032 to 1 (https://zlib.net/zlib_tech.html): a file cannot hold more than that.
LARGEST_RATIO = 1032
#: Size below which what a file declares does not matter. Bytes.
HARMLESS = 64 << 20


@dataclass(frozen=True)
class Variable:
    """Content of one netCDF variable: dimension names, values (None: filled in later), units, meaning.

    `kind` is the numpy type on disk; it is needed where there are no values yet. `compressed` pays for what is
    mostly zeros, not for noise. `finite` says of a variable that is filled in later that it must hold finite numbers
    alone; of values that are there it is found out. Reading holds the variable to it.
    """

    dimensions: tuple[str, ...]
    values: Any
    long_name: str
    units: str | None = None
    kind: str | None = None
    attributes: dict[str, Any] = field(default_factory=dict)
    compressed: bool = False
    finite: bool = False


@contextmanager
def create_dataset(
    path: str | Path, sizes: Mapping[str, int], variables: Mapping[str, Variable], attributes: Mapping[str, Any]
) -> Iterator[netCDF4.Dataset]:
    """Open a new netCDF file for writing; it replaces `path` when the block ends without an error.

    Parameters
    ----------
    path : the file; missing folders are made.
    sizes : length of every dimension.
    variables : what the file holds; a variable named like its only dimension is a coordinate. A dimension called
        `time` is for dates alone (CF 1.8, section 4.4); durations take another name, such as `instant`.
    attributes : global attributes, such as :func:`jointwear.files.provenance.attributes` gives them; what the CF
        conventions ask of every file is added.

    Raises
    ------
    InputError : naming the file, where it cannot be written.
    """
    path = Path(path)
    part = path.with_name(path.name + ".part")
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        with netCDF4.Dataset(part, "w", format="NETCDF4") as dataset:
            dataset.set_fill_off()
            dataset.setncatts({**CONVENTIONS, "history": _history(attributes), **_own_name(path), **attributes})
            for name, size in sizes.items():
                dataset.createDimension(name, size)
            for name, content in variables.items():
                _create_variable(dataset, name, content, sizes)
            yield dataset
            dataset.setncattr(CHECKSUM, _checksum(dataset))
        os.replace(part, path)
    except (OSError, RuntimeError) as error:
        raise _unwritten(path, error) from None
    finally:
        remove(part)


def _checksum(dataset: netCDF4.Dataset) -> str:
    """Return the CRC-32 of names, shapes, attributes and text of a file; HDF5 has none for these."""

    def attributes(holder: Any) -> dict[str, Any]:
        return {k: np.asarray(holder.getncattr(k)).tolist() for k in sorted(holder.ncattrs()) if k != CHECKSUM}

    content: list[Any] = [attributes(dataset), {name: len(d) for name, d in dataset.dimensions.items()}]
    for name, variable in dataset.variables.items():
        content.append([name, variable.dimensions, str(variable.dtype), attributes(variable)])
        if variable.dtype is str:
            content.append(np.asarray(variable[...]).tolist())
    return f"{zlib.crc32(json.dumps(content, default=str).encode()):08x}"


def _unwritten(path: Path, error: Exception) -> Exception:
    """Return what to raise for an error while `path` was written: one line where the disk is to blame."""
    if isinstance(error, OSError) or str(error).startswith("NetCDF:"):
        return unwritable(path, error)
    return error


def _create_variable(dataset: netCDF4.Dataset, name: str, content: Variable, sizes: Mapping[str, int]) -> None:
    values = None if content.values is None else _storable(name, np.asarray(content.values))
    text = values is not None and values.dtype.kind in "UO"
    kind = content.kind or (str if text else values.dtype)
    how: dict[str, Any] = {"compression": "zlib", "complevel": 1} if content.compressed else {}
    if content.dimensions and not text:
        shape = [sizes[d] for d in content.dimensions]
        # A checksum a part; netCDF fails to read a part that does not match.
        how.update(fletcher32=True, chunksizes=_parts(shape, np.dtype(kind).itemsize))
    variable = dataset.createVariable(name, kind, content.dimensions, fill_value=None if text else False, **how)
    variable.long_name = content.long_name
    if content.units is not None:
        variable.units = content.units
    variable.setncatts(content.attributes)
    if content.finite or (values is not None and values.dtype.kind == "f" and bool(np.isfinite(values).all())):
        variable.setncattr(FINITE, np.int8(1))
    if text:
        variable[...] = values.astype(object)
    elif values is not None:
        variable[...] = values


def _parts(shape: list[int], size: int) -> list[int]:
    """Return the shape of the parts of a variable: as many of its first entries as fit :data:`CHUNK`."""
    parts = [max(1, n) for n in shape]
    for axis in range(len(parts)):
        rest = size * math.prod(parts[axis + 1 :])
        parts[axis] = max(1, min(parts[axis], CHUNK // rest))
        if rest <= CHUNK:
            break
    return parts


def _own_name(path: Path) -> dict[str, str]:
    """Return the name of a result below the folder of the results, as an attribute; nothing for other files."""
    parts = path.parts
    if RESULTS not in parts:
        return {}
    last = len(parts) - 1 - parts[::-1].index(RESULTS)
    return {NAME: "/".join(parts[last + 1 :])}


def write_dataset(path: str | Path, variables: Mapping[str, Variable], attributes: Mapping[str, Any]) -> None:
    """Write a netCDF file at once; dimension lengths are those of the values.

    Raises
    ------
    ValueError : if two variables disagree on the length of a dimension.
    """
    sizes: dict[str, int] = {}
    for name, content in variables.items():
        for dimension, size in zip(content.dimensions, np.shape(content.values), strict=True):
            if sizes.setdefault(dimension, size) != size:
                raise ValueError(f"{name}: dimension {dimension} is {size}, elsewhere {sizes[dimension]}")
    with create_dataset(path, sizes, variables, attributes):
        pass


def _storable(name: str, values: np.ndarray) -> np.ndarray:
    """Return values in a data type that CF 1.8, section 2.2, allows: it has no integers of 64 bits.

    Raises
    ------
    ValueError : naming the variable, if an integer needs more than 32 bits.
    """
    if values.dtype.kind == "b":
        return values.astype(np.int8)
    if values.dtype.kind not in "iu" or values.dtype.itemsize < 4:
        return values
    if values.size and not -(2**31) <= values.min() <= values.max() < 2**31:
        raise ValueError(f"{name}: holds integers beyond 32 bits; store them as float64")
    return values.astype(np.int32)


def _history(attributes: Mapping[str, Any]) -> str:
    return f"written by {attributes.get('source', 'jointwear')}: {attributes.get('title', 'a result')}"


@contextmanager
def open_dataset(path: str | Path) -> Iterator[netCDF4.Dataset]:
    """Open a netCDF file for reading.

    Raises
    ------
    InputError : naming the file, if it is missing, truncated, damaged, not netCDF, no regular file, declares more than
        it can hold, or is a result of another name.
    """
    check_regular(path)
    try:
        dataset = netCDF4.Dataset(path, "r")
    except (OSError, RuntimeError, ValueError, AttributeError, KeyError, TypeError, MemoryError) as error:
        raise InputError(_corrupt(path, error)) from None
    with dataset:
        dataset.set_auto_mask(False)
        try:
            _check_identity(dataset, Path(path))
            yield dataset
        except (RuntimeError, AttributeError, IndexError, UnicodeDecodeError, MemoryError) as error:
            # What netCDF finds while the caller reads; for attributes it takes that for a missing one.
            if not isinstance(error, (UnicodeDecodeError, MemoryError)) and not str(error).startswith("NetCDF:"):
                raise
            raise InputError(_corrupt(path, error)) from None


def _check_identity(dataset: netCDF4.Dataset, path: Path) -> None:
    """Check that a file declares no more than it can hold, has the name it was written under, and is as written."""
    room = max(HARMLESS, LARGEST_RATIO * path.stat().st_size)
    for name, variable in dataset.variables.items():
        size = math.prod(variable.shape) * getattr(variable.dtype, "itemsize", 1)
        if size > room:
            raise InputError(f"{path}: variable '{name}' declares {size} bytes, more than a file of its size can hold")
    if CHECKSUM in dataset.ncattrs() and str(dataset.getncattr(CHECKSUM)) != _checksum(dataset):
        raise InputError(f"{path}: was changed or damaged since it was written{_remedy(path)}")
    here = _own_name(path).get(NAME)
    written = dataset.__dict__.get(NAME)
    if here is not None and written is not None and str(written) != here:
        raise InputError(f"{path}: holds the result {shown(str(written))}, not its own; delete it and run again")


def read_variables(path: str | Path, *names: str) -> list[np.ndarray]:
    """Read whole variables of a netCDF file, in the order of `names`.

    Raises
    ------
    InputError : naming the file, if it is missing, truncated, not netCDF, or lacks a variable.
    """
    with open_dataset(path) as dataset:
        return [read_variable(dataset, path, name) for name in names]


def read_variable(dataset: netCDF4.Dataset, path: str | Path, name: str, part: Any = ...) -> np.ndarray:
    """Read one variable (or a part of it) of an open file.

    Raises
    ------
    InputError : naming the file, if it lacks the variable or is damaged.
    """
    if name not in dataset.variables:
        raise InputError(f"{path}: has no variable '{name}' (it has: {', '.join(dataset.variables)})")
    variable = dataset.variables[name]
    try:
        values = np.asarray(variable[part])
    except (RuntimeError, AttributeError, IndexError, OSError, MemoryError, UnicodeDecodeError) as error:
        raise InputError(_corrupt(path, error)) from None
    if values.dtype.kind == "f" and FINITE in variable.ncattrs() and not np.isfinite(values).all():
        raise InputError(
            f"{path}: variable '{name}' holds numbers that are not finite, which it had not when it was written"
            f"{_remedy(path)}"
        )
    return values


def read_attribute(dataset: netCDF4.Dataset, path: str | Path, name: str) -> Any:
    """Return a global attribute of an open file.

    Raises
    ------
    InputError : naming the file, if it has no such attribute.
    """
    if name not in dataset.ncattrs():
        raise InputError(f"{path}: has no attribute '{name}'{_remedy(path)}")
    return dataset.getncattr(name)


def _corrupt(path: str | Path, error: Exception) -> str:
    reason = getattr(error, "strerror", None) or str(error) or type(error).__name__
    return f"{path}: {TRUNCATED} netCDF file ({reason}){_remedy(path)}"


def _remedy(path: str | Path) -> str:
    """Return what to do about a damaged file; nobody may be told to delete what was measured."""
    return "; delete it and run again" if _own_name(Path(path)) else ""
