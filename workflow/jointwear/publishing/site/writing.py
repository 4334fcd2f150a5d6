"""Write the static site: pages, data, checksums, one archive; nothing that is not in the results or the project."""

from __future__ import annotations

import shutil
import tempfile
import zipfile
from collections.abc import Mapping, Sequence
from itertools import groupby
from pathlib import Path
from typing import Any

from jointwear import __version__
from jointwear.publishing.crate.records import trace
from jointwear.publishing.report.rendering import render_page
from jointwear.publishing.site.contents import (
    STAGES,
    DataFile,
    data_files,
    pages,
    reruns,
    size_words,
    without_dead_links,
)
from jointwear.publishing.soundness import check_results

ARCHIVE = "jointwear-results.zip"
# Everything but the largest stage fits one small archive.
ARCHIVED = tuple(stage for stage in STAGES if stage not in ("simulation", "features"))
EPOCH = (1980, 1, 1, 0, 0, 0)  # the earliest date that a zip file can hold: the same results, the same archive


#: JSON file of `make bench`; without it the page of changes names no times.
MEASURED = "data/benchmarks/results.json"


def write_site(
    output: str | Path,
    *,
    edits: Sequence[Mapping[str, Any]],
    wanted: Sequence[str] = (),
    root: str | Path = ".",
) -> None:
    """Write the site of the results under `root`/results.

    Parameters
    ----------
    output : folder of the site; what it held is replaced when the new site is complete.
    edits : changes to try: `command`, `what`, for the page that lists them; times come from :data:`MEASURED`.
    wanted : results of which everything behind them must be there, as Snakemake has recorded it.
    root : folder of the project.

    Raises
    ------
    InputError : if a result is missing, damaged, or not what the jobs after it have read.
    """
    output, results = Path(output), Path(root) / "results"
    run = trace(wanted, root)
    files, found = data_files(results), pages(results)
    # Registered data of others have checksums of their own, and layouts that this workflow does not know.
    own = [f"results/{f.path}" for f in files if not f.path.startswith("registry/")]
    check_results(Path(root), own, run.checksums)
    held = [f.path for f in files if f.published]
    with tempfile.TemporaryDirectory(dir=output.resolve().parent, prefix=".site-") as name:
        site = Path(name) / "site"
        for path in held:
            target = site / "results" / path
            target.parent.mkdir(parents=True, exist_ok=True)
            if path.endswith(".html"):
                page = (results / path).read_text(encoding="utf-8")
                target.write_text(without_dead_links(page, held, Path(path).parent.as_posix()), encoding="utf-8")
            else:
                shutil.copyfile(results / path, target)
        write_archive(site / ARCHIVE, results, held)
        common = {
            "version": __version__,
            "archive": ARCHIVE,
            "archive_size": size_words((site / ARCHIVE).stat().st_size),
        }
        groups = [
            {"title": STAGES.get(stage, stage), "files": list(group)}
            for stage, group in groupby(files, key=lambda f: f.path.split("/")[0])
        ]
        total = size_words(sum(f.size for f in files))
        render = {
            "index.html": ("site.html.j2", {"pages": found, "count_files": len(files), "total": total}),
            "data.html": ("site_data.html.j2", {"groups": groups, "size": size_words, "total": total}),
            "change.html": ("site_change.html.j2", {"edits": joined(edits, reruns(Path(root) / MEASURED))}),
        }
        for page, (template, context) in render.items():
            (site / page).write_text(render_page(template, {**common, **context}), encoding="utf-8")
        (site / "SHA256SUMS").write_text(checksums(files), encoding="utf-8")
        # Without it some hosts drop files whose names begin with an underscore.
        (site / ".nojekyll").touch()
        shutil.rmtree(output, ignore_errors=True)
        site.rename(output)


def write_archive(path: Path, results: Path, held: Sequence[str]) -> None:
    """Write tables, figures, scores, pages and verdicts as one zip file, with dates left out."""
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED, compresslevel=6) as archive:
        for name in held:
            if name.split("/")[0] in ARCHIVED:
                entry = zipfile.ZipInfo(f"jointwear-results/{name}", EPOCH)
                entry.compress_type, entry.external_attr = zipfile.ZIP_DEFLATED, 0o644 << 16
                archive.writestr(entry, (results / name).read_bytes())


def checksums(files: Sequence[DataFile]) -> str:
    """Return the checksums of the files that the site holds, as `sha256sum --check` reads them.

    Pages are left out: the site's copies of them differ in links to files that it does not hold.
    """
    return "".join(f"{f.sha256}  results/{f.path}\n" for f in files if f.published and not f.path.endswith(".html"))


def joined(edits: Sequence[Mapping[str, Any]], times: Sequence[Mapping[str, Any]]) -> list[dict[str, Any]]:
    """Return every edit with its measured time [s] and number of jobs, None where it has not been measured."""
    known = {time["command"]: time for time in times}
    return [
        {**edit, **{k: known.get(edit["command"], {}).get(k) for k in ("seconds", "jobs", "rules")}} for edit in edits
    ]
