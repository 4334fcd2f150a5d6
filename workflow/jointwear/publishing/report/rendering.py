"""Pages from Jinja2 templates under report/.

Every page extends `base.html.j2`. A chapter of the report is one file `chapters/NN_name.html.j2`: NN orders it,
name is its anchor, `{% set title = ... %}` its heading; a chapter that renders to nothing is left out. Text is
escaped by default.
"""

from __future__ import annotations

from collections.abc import Collection, Mapping
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Any

from jinja2 import Environment, FileSystemLoader, StrictUndefined, meta
from markupsafe import Markup

from jointwear.files import shown_numbers as numbers
from jointwear.files.digests import digest
from jointwear.files.wording import count

TEMPLATES = Path(__file__).resolve().parents[4] / "report"


@dataclass(frozen=True)
class Chapter:
    """A rendered chapter: anchor, heading, content."""

    anchor: str
    title: str
    body: Markup


def environment() -> Environment:
    """Return the template environment with the number formats as filters."""
    return _environment(TEMPLATES)


@cache
def _environment(templates: Path) -> Environment:
    """Return the environment of one folder of templates: each is compiled once a process."""
    env = Environment(
        loader=FileSystemLoader(templates),
        autoescape=True,
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
        keep_trailing_newline=True,
    )
    env.filters.update(number=numbers.number, with_std=numbers.with_std, fixed=numbers.fixed, percent=numbers.percent)
    env.globals.update(span=numbers.span, span_percent=numbers.span_percent, count=count)
    env.filters.update(run_name=numbers.run_name, unit=numbers.unit)
    return env


def render_chapters(context: Mapping[str, Any], only: Collection[str] | None = None) -> list[Chapter]:
    """Render the chapters of the report, in order; empty ones are left out.

    `only` holds the anchors of those to render; default all.
    """
    env, chapters = environment(), []
    for name in sorted(n for n in env.list_templates() if n.startswith("chapters/") and n.endswith(".html.j2")):
        anchor = Path(name).name.removesuffix(".html.j2").partition("_")[2]
        if only is not None and anchor not in only:
            continue
        module = env.get_template(name).make_module(dict(context))
        body = str(module).strip()
        if body:
            chapters.append(Chapter(anchor, str(module.title), Markup(body)))
    return chapters


def render_page(template: str, context: Mapping[str, Any]) -> str:
    """Render one page; `template` is a file under report/, as `index.html.j2`."""
    text = environment().get_template(template).render(**context)
    return "\n".join(line.rstrip() for line in text.splitlines() if line.strip()) + "\n"


def digest_of_page(template: str) -> str:
    """Return a digest of a template under report/ and of all that it extends, imports or includes, as they are now."""
    return digest([[name, (TEMPLATES / name).read_text(encoding="utf-8")] for name in _parts_of(TEMPLATES, template)])


@cache
def _parts_of(templates: Path, template: str) -> tuple[str, ...]:
    """Return a template and the files that go into its page, found once a process."""
    env, found, waiting = _environment(templates), [], [template]
    while waiting:
        name = waiting.pop()
        found.append(name)
        text = (templates / name).read_text(encoding="utf-8")
        parts = meta.find_referenced_templates(env.parse(text)) if name.endswith(".j2") else ()
        waiting += [part for part in parts if part is not None and part not in (*found, *waiting)]
    return tuple(sorted(found))
