"""Software bill of materials of the environment as CycloneDX 1.6 JSON (ECMA-424): packages, licences, dependencies.

Written from the lock files (which packages, which checksums) and from what the installed packages say of themselves.
Same environment, same bytes: there is no date in it.

    PYTHONPATH=workflow python -m jointwear.publishing.sbom OUTPUT LOCK_FILE...
"""

from __future__ import annotations

import json
import re
import sys
import uuid
from collections.abc import Iterable, Mapping
from importlib import metadata
from pathlib import Path
from typing import Any

from packaging.requirements import InvalidRequirement, Requirement

from jointwear import __version__
from jointwear.files.errors import InputError
from jointwear.files.regular_files import read_text
from jointwear.files.text_files import replace_text

#: Largest lock file. Bytes.
LARGEST_LOCK = 4 << 20
_PINNED = re.compile(r"^(?P<name>[A-Za-z0-9._-]+)==(?P<version>[^\s\\;]+)")
_HASH = re.compile(r"--hash=sha256:([0-9a-f]{64})")
#: Words by which the text of a licence is known, where a package ships the text and states no name.
TEXTS = {
    "MIT": "Permission is hereby granted, free of charge, to any person obtaining a copy",
    "Apache-2.0": "Apache License",
    "BSD-3-Clause": "Neither the name of",
    "Qhull": "Qhull, Copyright",
}


def locked(files: Iterable[str | Path]) -> dict[str, tuple[str, list[str]]]:
    """Return version and SHA-256 checksums of every package that lock files pin, by normalised name.

    Raises
    ------
    InputError : if a lock file cannot be read, or two pin different versions.
    """
    found: dict[str, tuple[str, list[str]]] = {}
    for path in files:
        hashes: list[str] = []
        for line in read_text(path, LARGEST_LOCK).splitlines():
            if pinned := _PINNED.match(line):
                name, version = normalised(pinned["name"]), pinned["version"]
                if name in found and found[name][0] != version:
                    raise InputError(f"{path}: pins {name} {version}, another lock file {found[name][0]}")
                hashes = found.setdefault(name, (version, []))[1]
            hashes.extend(value for value in _HASH.findall(line) if value not in hashes)
    return found


def normalised(name: str) -> str:
    """Return the name of a package as PEP 503 compares it."""
    return re.sub(r"[-_.]+", "-", name).lower()


def licence_of(package: metadata.Distribution) -> tuple[str, str]:
    """Return the licence of an installed package, and where that is said; two empty texts if nowhere.

    A package that states none but ships the text of a well-known one counts with that.
    """
    said = package.metadata
    if expression := said.get("License-Expression"):
        return expression, "stated"
    classes = [c.split(" :: ")[-1] for c in said.get_all("Classifier") or [] if c.startswith("License :: ")]
    plain = (said.get("License") or "").strip()
    if plain and plain.upper() != "UNKNOWN" and "\n" not in plain and len(plain) < 80:
        return plain, "stated"
    named = [c for c in classes if c != "OSI Approved"]
    if named:
        return " AND ".join(sorted(named)), "stated"
    for file in package.files or ():
        if re.search(r"licen[cs]e|copying", file.name, re.IGNORECASE) and "dist-info" in str(file):
            text = Path(str(file.locate())).read_text(encoding="utf-8", errors="replace")
            for name, words in TEXTS.items():
                if words in " ".join(text.split()):
                    return name, f"text of {file.name}"
    return "", ""


def component(name: str, version: str, hashes: list[str], package: metadata.Distribution | None) -> dict[str, Any]:
    """Return one package as a component; one that is locked but not installed here has no licence to tell."""
    identifier = f"pkg:pypi/{name}@{version}"
    result: dict[str, Any] = {"type": "library", "bom-ref": identifier, "name": name, "version": version}
    properties = [{"name": "jointwear:locked-sha256", "value": value} for value in sorted(hashes)]
    if package is None:
        properties.append({"name": "jointwear:installed", "value": "false"})
    else:
        licence, where = licence_of(package)
        if licence:
            result["licenses"] = [{"license": {"name": licence}}]
        properties.append({"name": "jointwear:licence", "value": where or "none found"})
    return {**result, "purl": identifier, "properties": properties}


def bill(packages: Mapping[str, tuple[str, list[str]]]) -> dict[str, Any]:
    """Return the bill of materials of packages as :func:`locked` gives them."""
    installed = {normalised(d.metadata["Name"]): d for d in metadata.distributions() if d.metadata["Name"]}
    there = {n: d for n, d in installed.items() if n in packages and d.version == packages[n][0]}
    components = [component(n, v, h, there.get(n)) for n, (v, h) in sorted(packages.items())]
    references = {c["name"]: c["bom-ref"] for c in components}
    own = f"pkg:generic/jointwear@{__version__}"
    depends = [{"ref": own, "dependsOn": sorted(references.values())}]
    for name, package in sorted(there.items()):
        wanted = {references[n] for n in _required(package) if n in references}
        depends.append({"ref": references[name], "dependsOn": sorted(wanted)})
    content = {
        "metadata": {
            "component": {
                "type": "application",
                "bom-ref": own,
                "name": "jointwear",
                "version": __version__,
                "licenses": [{"license": {"id": "BSD-3-Clause"}}],
            }
        },
        "components": components,
        "dependencies": depends,
    }
    number = uuid.uuid5(uuid.NAMESPACE_URL, json.dumps(content, sort_keys=True))
    return {
        "bomFormat": "CycloneDX",
        "specVersion": "1.6",
        "serialNumber": f"urn:uuid:{number}",
        "version": 1,
        **content,
    }


def _required(package: metadata.Distribution) -> set[str]:
    """Return the names of the packages that an installed one needs here, without extras."""
    names = set()
    for line in package.requires or ():
        try:
            requirement = Requirement(line)
        except InvalidRequirement:
            continue
        if requirement.marker is None or requirement.marker.evaluate({"extra": ""}):
            names.add(normalised(requirement.name))
    return names


def write_bill(output: str | Path, locks: Iterable[str | Path]) -> dict[str, Any]:
    """Write the bill of materials of lock files and return it."""
    found = bill(locked(locks))
    replace_text(output, json.dumps(found, indent=1, sort_keys=True, ensure_ascii=False) + "\n")
    return found


def unstated(found: Mapping[str, Any]) -> list[str]:
    """Return one line for every installed package that states no licence: what was found instead."""
    lines = []
    for part in found["components"]:
        said = {p["name"]: p["value"] for p in part["properties"]}
        where = said.get("jointwear:licence", "stated")
        if where != "stated":
            name = part["licenses"][0]["license"]["name"] if "licenses" in part else ""
            lines.append(f"{part['name']} {part['version']}: {f'{name} ({where})' if name else where}")
    return lines


if __name__ == "__main__":
    written = write_bill(sys.argv[1], sys.argv[2:])
    print(f"{sys.argv[1]}: {len(written['components'])} packages; no licence stated by:")
    print("\n".join(f"  {line}" for line in unstated(written)) or "  none")
