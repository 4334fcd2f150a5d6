"""What the site holds: pages, data files with size and checksum, commands with their measured time."""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from jointwear.files.json_documents import read_json
from jointwear.publishing.soundness import checksum

# Torque samples are a thousand times what is computed from them, and follow from the seed: not published.
SAMPLES = "simulation"
LEFT_OUT = (SAMPLES, "logs", "benchmarks")
STAGES = {
    "tables": "Tables II to VI",
    "report": "The report and its results",
    "figures": "Figures",
    "trajectories": "Commanded motion",
    "detection": "Normal models, scores and onsets",
    "location": "Lags and sources",
    "features": "Histograms and hourly statistics",
    "simulation": "Torque samples",
    "discover": "Discovery",
    "monitor": "Monitoring",
    "recovery": "Recovery of what the paper left out",
    "multiverse": "Readings of the paper",
    "challenge": "Hidden-effect test",
}
_LINK = re.compile(r'<a href="(?:\.\./)+(?P<target>[^"#]+)">(?P<words>.*?)</a>', re.DOTALL)


@dataclass(frozen=True)
class DataFile:
    """One file of the results: path under results, size [bytes], SHA-256, whether the site holds it."""

    path: str
    size: int
    sha256: str
    published: bool


@dataclass(frozen=True)
class Page:
    """A page that the site shows: path under results, kind (a name of STAGES) and what it is called."""

    path: str
    kind: str
    name: str


def data_files(results: Path) -> list[DataFile]:
    """Return every file of the results but logs, in the order of STAGES."""
    order = {stage: index for index, stage in enumerate(STAGES)}
    files = []
    for path in sorted(p for p in results.rglob("*") if p.is_file() and p.suffix != ".part"):
        name = path.relative_to(results)
        if name.parts[0] in LEFT_OUT and name.parts[0] != SAMPLES:
            continue
        published = name.parts[0] not in LEFT_OUT
        files.append(DataFile(name.as_posix(), path.stat().st_size, checksum(path), published))
    return sorted(files, key=lambda f: (order.get(f.path.split("/")[0], len(order)), f.path))


def pages(results: Path) -> list[Page]:
    """Return the pages that have been built: the report first, then one for every study, robot and data set."""
    links = []
    for path in sorted([*results.glob("*/*.html"), *results.glob("*/*/*.html")]):
        name = path.relative_to(results)
        kind = name.parts[0]
        if kind in LEFT_OUT:
            continue
        words = name.parts[1].replace("_", " ") if len(name.parts) > 2 else STAGES.get(kind, kind)
        links.append(Page(name.as_posix(), kind, words))
    order = {stage: index for index, stage in enumerate(("report", *STAGES))}
    return sorted(links, key=lambda p: (order.get(p.kind, len(order)), p.path))


def without_dead_links(page: str, published: Iterable[str], folder: str) -> str:
    """Turn links to files that the site does not hold into plain words.

    Parameters
    ----------
    page : HTML of a page.
    published : paths under results that the site holds.
    folder : the folder of the page under results, as `report`.
    """
    held = set(published)
    here = Path("/results") / folder

    def settle(link: re.Match[str]) -> str:
        ups = link[0].count("../", 0, link[0].index(link["target"]))
        base = here
        for _ in range(ups):
            base = base.parent
        target = (base / link["target"]).as_posix().removeprefix("/results/")
        return link[0] if target in held else link["words"]

    return _LINK.sub(settle, page)


def reruns(measured: str | Path) -> list[dict[str, Any]]:
    """Return the measured reruns of `make bench` , empty where none have been measured."""
    path = Path(measured)
    if not path.is_file():
        return []
    found: Mapping[str, Any] = read_json(path)
    return list(found.get("reruns", {}).get("edits", []))


def size_words(size: int) -> str:
    """Return a size in bytes as people read it: 12 kB, 3.4 MB."""
    for unit, factor in (("GB", 1e9), ("MB", 1e6), ("kB", 1e3)):
        if size >= factor:
            return f"{size / factor:.3g} {unit}"
    return f"{size} B"
