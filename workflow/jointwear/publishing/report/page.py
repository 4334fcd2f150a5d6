"""Write the report of the reproduction: one page and its results as JSON."""

from __future__ import annotations

import json
import os
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from jointwear import __version__
from jointwear.files.json_documents import read_json, write_json
from jointwear.files.json_values import as_json
from jointwear.files.provenance import check_lineage
from jointwear.files.text_files import replace_text
from jointwear.publishing.report import origin
from jointwear.publishing.report.assembly import Results, assemble
from jointwear.publishing.report.first_screen import claims, left_out
from jointwear.publishing.report.inline import inline_svg
from jointwear.publishing.report.rendering import render_chapters, render_page
from jointwear.publishing.report.wording import summary


def other_pages(results: Path) -> list[dict[str, str]]:
    """Return the pages that other targets have built beside the report, as links relative to it."""
    paths = [path.relative_to(results) for level in ("*", "*/*") for path in results.glob(f"{level}/*.html")]
    return [
        {
            "name": " ".join([*path.parts[:-1], *([] if path.stem in ("index", path.parts[0]) else [path.stem])]),
            "link": f"../{path.as_posix()}",
        }
        for path in sorted(paths)
        if path.parts[0] != "report"
    ]


def read_chapter(path: str | Path) -> Any:
    """Read the results of a further chapter.

    Raises
    ------
    InputError : if the file is missing or not JSON.
    """
    return read_json(path, object)


def settings_behind(config: Mapping[str, Any]) -> dict[str, Any]:
    """Return what the configuration says about every result of the reproduction, under the keys that results have."""
    return {
        **{key: config[key] for key in ("seed", "replicates", "sampling", "noise", "reading")},
        **config["detection"],
        "bins": config["histogram"]["bins"],
        "shape": config["wear"]["shape"],
        "wear_hours": config["wear"]["hours"],
    }


def write_report(
    output: str | Path,
    scores: str | Path,
    results: Results,
    figures: Mapping[str, str],
    config: Mapping[str, Any],
    *,
    chapters: Mapping[str, str] | None = None,
    root: str | Path = ".",
) -> None:
    """Write the page and its results.

    Parameters
    ----------
    output : the page; figures are put into it and data are linked relative to it.
    scores : JSON file with all scores and the summary.
    results : result files.
    figures : SVG files by name, as `figure_1`, `table_ii`.
    config : the part of the configuration that the reproduction uses.
    chapters : JSON files of further chapters, by the name under which their template sees them.
    root : folder of the project, for its commit and Snakemake's records.

    Raises
    ------
    InputError : naming the file, if one is missing, damaged, or was made with another configuration.
    """
    check_lineage(results.computed(), settings_behind(config))
    data = assemble(results, config)
    further = {name: read_chapter(path) for name, path in (chapters or {}).items()}
    words = summary(data)
    words |= {"claims": claims(data, words["statements"]), "left_out": left_out(data, further)}
    source = {"version": __version__, "commit": origin.commit(root), "packages": origin.versions()}
    kept = {k: v for k, v in data.items() if k not in ("rows", "assumptions", "paper")}
    content = {"summary": words, **kept, "seed": config["seed"], "source": source}
    context = {
        **data,
        "summary": words,
        "source": source,
        "config_text": json.dumps(as_json(data["config"]), indent=2, ensure_ascii=False),
        "plots": {name: inline_svg(path, name.replace("_", "-")) for name, path in figures.items()},
        "figure_files": {name: os.path.relpath(path, Path(output).parent) for name, path in figures.items()},
        "times": origin.rule_times(Path(root) / ".snakemake" / "metadata"),
        "pages": other_pages(Path(output).parent.parent),
        **further,
    }
    context["chapters"] = render_chapters(context)
    write_json(scores, content)
    replace_text(output, render_page("index.html.j2", context))
