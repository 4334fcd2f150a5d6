"""Write the page of one study: the same chapter that the report quotes, from results just made."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from jointwear import __version__
from jointwear.files.errors import InputError
from jointwear.files.text_files import replace_text
from jointwear.publishing.report.inline import inline_svg
from jointwear.publishing.report.page import read_chapter
from jointwear.publishing.report.rendering import render_chapters, render_page


def write_study_page(study: str, chapter: str | Path, figures: Sequence[str | Path], output: str | Path) -> None:
    """Write the page of a study.

    Parameters
    ----------
    study : name of the study; its template is report/chapters/NN_<study>.html.j2.
    chapter : JSON file with the results of the chapter.
    figures : SVG files; the template sees a figure as `<study>_<name of its file>`.
    output : the page.

    Raises
    ------
    InputError : if a file is missing or corrupt, or no template belongs to the study.
    """
    names = {f"{study}_{Path(path).stem}": path for path in figures}
    context = {
        study: read_chapter(chapter),
        "plots": {name: inline_svg(path, name.replace("_", "-")) for name, path in names.items()},
        "figure_files": {name: f"figures/{Path(path).name}" for name, path in names.items()},
    }
    chapters = render_chapters(context, only=[study])
    if not chapters:
        raise InputError(f"report/chapters: no template NN_{study}.html.j2 makes a chapter of {chapter}")
    replace_text(output, render_page("study.html.j2", {**context, "chapter": chapters[0], "version": __version__}))
