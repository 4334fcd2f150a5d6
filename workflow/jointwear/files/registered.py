"""Data and models that others published: which there are, and where they lie on this machine.

They do not belong to the project. ``data/registry.yaml`` names each with its address at a fixed commit, checksum,
licence and citation. A reference ``registry:NAME/FILE`` in a configuration or a robot file means the file

1. in the folder that the environment variable ``JOINTWEAR_DATA`` names, where it is there;
2. else under ``results/registry`` of the working directory, where the rule ``fetch_registered`` puts it.

A reference ``package:example-robot-data/PATH`` means a file that an installed Python package ships.

Read by the Snakefile at every call: nothing heavy is imported here.
"""

from __future__ import annotations

import os
import sys
from pathlib import Path
from typing import Any

from jointwear.files.documents import read_yaml
from jointwear.files.errors import InputError, nearest
from jointwear.files.regular_files import ROOT

REGISTRY = ROOT / "data/registry.yaml"
#: Environment variable with a folder that already holds registered files, one subfolder per data set.
FOLDER_VARIABLE = "JOINTWEAR_DATA"
#: Where fetched files go, in the working directory.
FETCHED = Path("results/registry")
SCHEME, PACKAGE = "registry:", "package:"
#: Where a package puts the files that it ships, below its site-packages or its prefix.
_SHARED = {"example-robot-data": Path("cmeel.prefix/share/example-robot-data")}


def read_registry(registry: str | Path = REGISTRY) -> dict[str, Any]:
    """Return the entries of the registry by name."""
    return read_yaml(registry)


def is_registered(reference: str) -> bool:
    """Whether a path in a configuration is a reference to the registry."""
    return str(reference).startswith(SCHEME)


def will_be_fetched(path: str | Path) -> bool:
    """Whether a path is where the workflow puts a registered file."""
    return Path(path).is_relative_to(FETCHED)


def locate(reference: str, registry: str | Path = REGISTRY) -> Path:
    """Return where the file of a reference lies, or will lie once it has been fetched; a plain path stays as it is.

    Raises
    ------
    InputError : if the registry has no such data set or file, or the package is not installed.
    """
    text = str(reference)
    if text.startswith(PACKAGE):
        return _of_package(text)
    if not text.startswith(SCHEME):
        return Path(text)
    name, _, file = text.removeprefix(SCHEME).partition("/")
    known = read_registry(registry)
    if name not in known:
        raise InputError(f"'{text}': no registered data set '{name}'{nearest(name, known)} (there are: {_list(known)})")
    files = known[name]["files"]
    if file not in files:
        raise InputError(f"'{text}': data set '{name}' has no '{file}'{nearest(file, files)} (it has: {_list(files)})")
    own = os.environ.get(FOLDER_VARIABLE)
    if own and (Path(own) / name / file).is_file():
        return Path(own) / name / file
    return FETCHED / name / file


def _list(names: Any) -> str:
    return ", ".join(names)


def _of_package(reference: str) -> Path:
    package, _, path = reference.removeprefix(PACKAGE).partition("/")
    if package not in _SHARED:
        raise InputError(f"'{reference}': no package '{package}'{nearest(package, _SHARED)} ({_list(_SHARED)})")
    for folder in sys.path:
        found = Path(folder) / _SHARED[package] / path
        if found.is_file():
            return found
    installed = any((Path(folder) / _SHARED[package]).is_dir() for folder in sys.path)
    reason = f"the package {package} ships no such file" if installed else f"install the package {package}"
    raise InputError(f"'{reference}': {reason} (requirements/plants.txt locks it)")


def path_in(reference: str, folder: str | Path) -> Path:
    """Return the path of a file that a document in `folder` names: a reference, or a path relative to the document."""
    text = str(reference)
    return locate(text) if text.startswith((SCHEME, PACKAGE)) else Path(folder) / text
