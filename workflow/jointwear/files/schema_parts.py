"""Each value of a document with the part of its schema that is on it."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

Schema = dict[str, Any]


def values_of(document: Any, schema: Schema) -> Iterator[tuple[str, Any, Schema]]:
    """Yield the key, the value and the schema of all that is neither mapping nor list in a document, in its order; the
    schema is empty where it says nothing of a value."""
    yield from _below(document, "", schema, schema)


def _below(value: Any, where: str, part: Schema, schema: Schema) -> Iterator[tuple[str, Any, Schema]]:
    """Yield the values of a document at `where`; `part` of its schema is on this one."""
    if "$ref" in part:
        part = schema.get("$defs", {}).get(part["$ref"].removeprefix("#/$defs/"), {})
    if isinstance(value, dict):
        rest = part.get("additionalProperties")
        for key, inner in value.items():
            below = part.get("properties", {}).get(key, rest if isinstance(rest, dict) else {})
            yield from _below(inner, f"{where}.{key}" if where else str(key), below, schema)
    elif isinstance(value, (list, tuple)):
        for index, inner in enumerate(value):
            yield from _below(inner, f"{where}[{index}]", part.get("items", {}), schema)
    else:
        yield where, value, part
