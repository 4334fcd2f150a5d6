"""Fetch a registered data set: download its sources, convert them, check the numbers, put the files in their place."""

from __future__ import annotations

import importlib
import shutil
from collections.abc import Mapping
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np

from jointwear.files.errors import InputError
from jointwear.files.registered import REGISTRY, read_registry
from jointwear.files.storage import read_variables
from jointwear.files.wording import count

#: Largest relative difference of a root mean square: the registry gives six digits.
DIGITS = 1e-5


def fetch(
    name: str, folder: str | Path, registry: str | Path = REGISTRY, cache: str | Path | None = None
) -> list[Path]:
    """Download and convert a data set of the registry, and return its files in `folder`.

    Parameters
    ----------
    folder : where the files go, each whole or not at all.
    cache : where downloads are kept; default the user's cache folder. What is there is not loaded again.

    Raises
    ------
    InputError : if an address cannot be reached, a checksum is wrong, or the numbers are not those of the registry.
    """
    import pooch

    entry = read_registry(registry)[name]
    kept = Path(cache or pooch.os_cache("jointwear")) / name
    sources = {}
    for path, checksum in entry["sources"].items():
        address = f"{entry['address'].rstrip('/')}/{path}"
        try:
            known = None if checksum is None else f"sha256:{checksum}"
            fetched = pooch.retrieve(address, known, fname=path.replace("/", "__"), path=kept, progressbar=False)
        except ValueError as error:  # pooch raises it for a wrong checksum
            raise InputError(f"registry: {name}: {path}: the checksum is wrong ({_first_line(error)})") from None
        except Exception as error:  # whatever the network library raises
            raise InputError(
                f"registry: {name}: cannot load {address} ({_first_line(error)}); with the files at hand set "
                f"JOINTWEAR_DATA to the folder that holds {name}/"
            ) from None
        sources[path] = Path(fetched)
    converter = importlib.import_module(f"jointwear.measurement.published.{entry['convert']}")
    folder = Path(folder)
    folder.mkdir(parents=True, exist_ok=True)
    with TemporaryDirectory(dir=folder) as work:
        try:
            converter.convert(sources, Path(work))
        except (ValueError, KeyError, OSError, StopIteration) as error:
            raise InputError(f"registry: {name}: cannot be converted ({_first_line(error)})") from None
        for file, expected in entry["files"].items():
            _check(name, Path(work) / file, expected)
        for file in entry["files"]:
            shutil.move(Path(work) / file, folder / file)
    return [folder / file for file in entry["files"]]


def _check(name: str, path: Path, expected: Mapping[str, Any]) -> None:
    """Hold a converted file to the count of samples and the root mean squares of the registry."""
    for variable, given in (expected.get("rms") or {}).items():
        (values,) = read_variables(path, variable)
        if len(values) != expected["samples"]:
            raise InputError(
                f"registry: {name}: {path.name} has {count(len(values), 'sample')}, not {expected['samples']}"
            )
        found = np.sqrt(np.nanmean(values.astype(float) ** 2, axis=0))
        if not np.allclose(found, given, rtol=DIGITS, atol=0):
            raise InputError(f"registry: {name}: '{variable}' of {path.name} does not hold the registered numbers")


def _first_line(error: Exception) -> str:
    return next(iter(str(error).splitlines()), type(error).__name__)[:200]
