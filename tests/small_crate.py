"""A crate of a few small files beside the project that it comes from, without a run."""

import hashlib
import json
from pathlib import Path

import yaml
from scratch_project import ROOT

from jointwear.publishing.crate.layout import COMMIT, CONFIG, FILES, METADATA

PROJECT = {
    "Snakefile": "rule all:\n    input: []\n",
    "workflow/rules/a.smk": "# rules\n",
    "workflow/jointwear/__init__.py": "",
    "report/index.html.j2": "<p>{{ x }}</p>",
    "config/paper/published.yaml": "a: 1\n",
}
RESULTS = {
    "results/report/index.html": "<html><p>1.5</p></html>",
    "results/report/summary.json": '{"score": 1.5}',
    "results/tables/table_v.csv": "axis,value\n1,2.5\n",
}


def fill(folder: Path, files: dict[str, str]) -> None:
    """Write files, by their names below a folder."""
    for name, text in files.items():
        path = folder / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text, encoding="utf-8")


def checksum(text: str) -> str:
    return hashlib.sha256(text.encode()).hexdigest()


def write_small_crate(crate: Path, own: Path) -> dict:
    """Write the project into `own` and a crate of it into `crate`; return what run/files.json lists."""
    fill(own, PROJECT)
    listed = {
        "results": {
            name: {"sha256": checksum(text), "bytes": len(text.encode()), "rule": "r"} for name, text in RESULTS.items()
        },
        "inputs": ["config/paper/published.yaml"],
        "wanted": ["results/report/index.html", "results/report/summary.json"],
        "software": {"python": "3.11.7"},
        "seed": 1,
    }
    config = yaml.safe_load((ROOT / "config/config.yaml").read_text())
    files = {**PROJECT, **RESULTS, CONFIG: yaml.safe_dump(config), FILES: json.dumps(listed), COMMIT: "null"}
    fill(crate, files)
    graph = [{"@id": name, "@type": "File", "sha256": checksum(text)} for name, text in files.items()]
    fill(crate, {METADATA: json.dumps({"@graph": [{"@id": "./", "@type": "Dataset"}, *graph]})})
    return listed


def sign(crate: Path) -> None:
    """Write the checksums anew, as a forger would."""
    listed = json.loads((crate / FILES).read_text())
    for name, facts in listed["results"].items():
        if (crate / name).is_file():
            text = (crate / name).read_bytes()
            facts.update(sha256=hashlib.sha256(text).hexdigest(), bytes=len(text))
    (crate / FILES).write_text(json.dumps(listed))
    names = [p.relative_to(crate).as_posix() for p in sorted(crate.rglob("*")) if p.is_file() and p.name != METADATA]
    graph = [{"@id": n, "sha256": hashlib.sha256((crate / n).read_bytes()).hexdigest()} for n in names]
    (crate / METADATA).write_text(json.dumps({"@graph": graph}))
