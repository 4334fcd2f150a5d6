"""The reference under docs/reference, written from schemas and docstrings.

Call: ``python -m jointwear.publishing.reference docs/reference``.
"""

from __future__ import annotations

import ast
import sys
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

from jointwear.effects import library
from jointwear.files.schemas import read_schema
from jointwear.files.text_files import replace_text
from jointwear.reproduction import readings
from jointwear.running.configuration import config_schema

LIBRARY = Path(__file__).resolve().parents[1]
MARK = "Written by `make reference` from {source}; edits here are lost.\n"
#: What other programs may build on; everything else may change without notice.
PUBLIC = (
    "files.errors", "files.registered", "files.storage",
    "statistics.intervals", "statistics.randomness",
    "robots.robot", "robots.robot_file", "robots.dynamics", "robots.inertia", "robots.trajectory",
    "effects", "effects.effect", "effects.state",
    "measurement.recording", "measurement.recording_files", "measurement.formats", "measurement.units",
    "reproduction.wear", "reproduction.simulation", "reproduction.worn_run", "reproduction.features",
    "reproduction.normal_model", "reproduction.detection", "reproduction.location", "reproduction.tables",
    "reproduction.verdicts",
    "discovery.pipeline", "discovery.settings", "discovery.stages",
    "monitor.reading.windows", "monitor.reading.reading_stages", "monitor.normal.normal_state",
    "monitor.watching.decision", "monitor.judging.judge",
    "monitor.stages",
)  # fmt: skip
_BOUNDS = {"minimum": ">=", "exclusiveMinimum": ">", "maximum": "<=", "exclusiveMaximum": "<"}


def pages() -> dict[str, str]:
    """Return the text of every page of the reference by file name."""
    return {
        "files.md": _files(),
        "readings.md": _readings(),
        "effects.md": _effects(),
        "library.md": _library(),
    }


def write_reference(folder: str | Path) -> None:
    """Write every page into a folder."""
    for name, text in pages().items():
        replace_text(Path(folder) / name, text)


def _cell(text: str) -> str:
    return " ".join(text.split()).replace("|", "\\|")


def _kind(schema: Mapping[str, Any]) -> str:
    """Return type and limits of one key in words."""
    kind = schema.get("type", "")
    words = " or ".join(kind) if isinstance(kind, list) else kind
    if "enum" in schema:
        words = "one of " + ", ".join(f"`{value}`" for value in schema["enum"])
    if "items" in schema and schema["items"].get("type"):
        inner = schema["items"]["type"]
        words = f"{words} of {' or '.join(inner) if isinstance(inner, list) else inner}"
    bounds = [f"{sign} {schema[key]:g}" for key, sign in _BOUNDS.items() if key in schema]
    return f"{words}, {' and '.join(bounds)}" if bounds else words


def _resolve(schema: Mapping[str, Any], whole: Mapping[str, Any]) -> Mapping[str, Any]:
    if "$ref" not in schema:
        return schema
    found: Any = whole
    for part in schema["$ref"].lstrip("#/").split("/"):
        found = found[part]
    return {**found, **{k: v for k, v in schema.items() if k != "$ref"}}


def _keys(schema: Mapping[str, Any], whole: Mapping[str, Any], prefix: str = "") -> Iterator[tuple[str, Mapping, bool]]:
    """Yield name, schema and whether it is required of every key, depth first."""
    required = schema.get("required", [])
    for key, given in schema.get("properties", {}).items():
        inner = _resolve(given, whole)
        name = f"{prefix}{key}"
        yield name, inner, key in required
        yield from _keys(inner, whole, f"{name}.")
        items = _resolve(inner.get("items", {}), whole)
        yield from _keys(items, whole, f"{name}[].")
        entries = inner.get("additionalProperties")
        if isinstance(entries, Mapping):
            yield from _keys(_resolve(entries, whole), whole, f"{name}.<name>.")


def _files() -> str:
    lines = ["# Robot, task and configuration files", "", MARK.format(source="`workflow/schemas`")]
    schemas = {
        "Robot files": read_schema("robot"),
        "Task files": read_schema("task"),
        "Configuration": config_schema(),
    }
    for title, schema in schemas.items():
        lines += [f"## {title}", "", _cell(schema.get("description", "")), ""]
        lines += ["| key | meaning | allowed | required |", "|---|---|---|---|"]
        lines += [
            f"| `{name}` | {_cell(inner.get('description', ''))} | {_cell(_kind(inner))} | {'yes' if needed else ''} |"
            for name, inner, needed in _keys(schema, schema)
        ]
        lines.append("")
    return "\n".join(lines)


def _readings() -> str:
    lines = ["# Readings of the paper", "", MARK.format(source="`workflow/jointwear/reproduction/readings`")]
    for point in readings.ambiguities().values():
        lines += [f"## `reading.{point.name}`", "", point.question, "", f"The paper: *{_cell(point.paper)}*", ""]
        for name, function in point.alternatives.items():
            default = " (default)" if name == point.default else ""
            lines.append(f"- `{name}`{default}: {_cell((function.__doc__ or '').strip())}")
        lines += ["", f"Asked by the stage `{point.stage}`.", ""]
    return "\n".join(lines)


def _effects() -> str:
    lines = ["# Effects", "", MARK.format(source="`workflow/jointwear/effects/entries`")]
    for effect in library().values():
        lines += [f"## `{effect.identifier}`: {effect.name}", "", f"Torque: {_cell(effect.equation)}.", ""]
        if effect.parameters:
            lines += ["| parameter | unit | meaning | default |", "|---|---|---|---|"]
            for p in effect.parameters:
                default = f"fixed at {p.default:g}" if p.fixed else f"{p.default:g}"
                lines.append(f"| `{p.name}` | {_cell(p.unit)} | {_cell(p.description)} | {default} |")
            lines.append("")
        if effect.confused_with:
            names = ", ".join(f"`{name}`" for name in effect.confused_with)
            lines += [f"Looks like {names}; told apart by {_cell(effect.excitation)}.", ""]
        if not effect.identifiable:
            lines += [f"Cannot be found: {_cell(effect.reason)}", ""]
        lines += [f"Source: {_cell(effect.source)}.", ""]
    return "\n".join(lines)


def _public(node: ast.AST) -> bool:
    return isinstance(node, (ast.FunctionDef, ast.ClassDef)) and not node.name.startswith("_")


def _first(node: ast.AST) -> str:
    """Return the first paragraph of a docstring."""
    return _cell((ast.get_docstring(node) or "").split("\n\n")[0])


def _signature(node: ast.FunctionDef) -> str:
    """Return name and arguments, without types and defaults: those are a keystroke away in the source."""
    found = node.args
    names = [a.arg for a in (*found.posonlyargs, *found.args)]
    names += [f"*{found.vararg.arg}"] if found.vararg else ["*"] if found.kwonlyargs else []
    names += [a.arg for a in found.kwonlyargs] + ([f"**{found.kwarg.arg}"] if found.kwarg else [])
    return f"{node.name}({', '.join(names)})"


def _library() -> str:
    """Public modules, their functions and classes with the first paragraph of each docstring; read, never imported."""
    lines = ["# Library", "", MARK.format(source="the docstrings of `workflow/jointwear`")]
    lines += ["The modules that other programs may build on. Readings and effects have pages of their own.", ""]
    for module_name in PUBLIC:
        base = LIBRARY.joinpath(*module_name.split("."))
        path = base / "__init__.py" if base.is_dir() else base.with_suffix(".py")
        name = path.relative_to(LIBRARY)
        tree = ast.parse(path.read_text(encoding="utf-8"))
        module = ".".join(["jointwear", *name.with_suffix("").parts]).removesuffix(".__init__")
        lines += [f"## {module}", "", _first(tree), ""]
        for node in filter(_public, tree.body):
            title = _signature(node) if isinstance(node, ast.FunctionDef) else f"class {node.name}"
            lines.append(f"- `{title}`: {_first(node)}" if _first(node) else f"- `{title}`")
        if lines[-1]:
            lines.append("")
    return "\n".join(lines)


if __name__ == "__main__":
    write_reference(sys.argv[1] if len(sys.argv) > 1 else "docs/reference")
