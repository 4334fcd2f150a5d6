"""Write and read netCDF-4 files that xarray opens, without paying for xarray.

A file appears under its name only when it is complete; it holds no time stamps, so the same inputs give the
same bytes.
"""

from __future__ import annotations

import os
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import netCDF4
import numpy as np

from jointwear.files.errors import InputError

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


@dataclass(frozen=True)
class Variable:
    """Content of one netCDF variable: dimension names, values (None: filled in later), units, meaning.

    `kind` is the numpy type on disk; it is needed where there are no values yet. `compressed` pays for what is
    mostly zeros, not for noise.
    """

    dimensions: tuple[str, ...]
    values: Any
    long_name: str
    units: str | None = None
    kind: str | None = None
    attributes: dict[str, Any] = field(default_factory=dict)
    compressed: bool = False


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
    """
    path = Path(path)
    path.parent.mkdir(parents=True, exist_ok=True)
    part = path.with_name(path.name + ".part")
    try:
        with netCDF4.Dataset(part, "w", format="NETCDF4") as dataset:
            dataset.set_fill_off()
            dataset.setncatts({**CONVENTIONS, "history": _history(attributes), **attributes})
            for name, size in sizes.items():
                dataset.createDimension(name, size)
            for name, content in variables.items():
                values = None if content.values is None else _storable(name, np.asarray(content.values))
                text = values is not None and values.dtype.kind in "UO"
                kind = content.kind or (str if text else values.dtype)
                packing = {"compression": "zlib", "complevel": 1} if content.compressed else {}
                variable = dataset.createVariable(
                    name, kind, content.dimensions, fill_value=None if text else False, **packing
                )
                variable.long_name = content.long_name
                if content.units is not None:
                    variable.units = content.units
                variable.setncatts(content.attributes)
                if text:
                    variable[...] = values.astype(object)
                elif values is not None:
                    variable[...] = values
            yield dataset
        os.replace(part, path)
    finally:
        part.unlink(missing_ok=True)


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
    InputError : naming the file, if it is missing, truncated or not netCDF.
    """
    try:
        dataset = netCDF4.Dataset(path, "r")
    except FileNotFoundError:
        raise InputError(f"{path}: no such file") from None
    except OSError as error:
        raise InputError(_corrupt(path, error)) from None
    with dataset:
        dataset.set_auto_mask(False)
        yield dataset


def read_variables(path: str | Path, *names: str) -> list[np.ndarray]:
    """Read whole variables of a netCDF file, in the order of `names`.

    Raises
    ------
    InputError : naming the file, if it is missing, truncated, not netCDF, or lacks a variable.
    """
    with open_dataset(path) as dataset:
        return [read_variable(dataset, path, name) for name in names]


def read_variable(dataset: netCDF4.Dataset, path: str | Path, name: str, part: Any = ...) -> np.ndarray:
    """Read one variable (or a part of it) of an open file; errors name the file."""
    if name not in dataset.variables:
        raise InputError(f"{path}: has no variable '{name}' (it has: {', '.join(dataset.variables)})")
    try:
        return np.asarray(dataset.variables[name][part])
    except (RuntimeError, OSError) as error:
        raise InputError(_corrupt(path, error)) from None


def _corrupt(path: str | Path, error: Exception) -> str:
    return f"{path}: is truncated or not a netCDF file ({error}); delete it and run again"
