"""Read YAML documents strictly and check them against a schema, with one-line errors.

Imported by the Snakefile at every call of Snakemake, so nothing heavy is imported here.
"""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any

import yaml

from jointwear.files.errors import InputError, nearest

SCHEMAS = Path(__file__).resolve().parents[2] / "schemas"


class _StrictLoader(getattr(yaml, "CSafeLoader", yaml.SafeLoader)):
    """A safe loader that refuses duplicate keys and reads 1e-4 as a number, as YAML 1.2 does."""


def _mapping(loader: _StrictLoader, node: yaml.MappingNode, deep: bool = False) -> dict:
    seen: set = set()
    for key_node, _ in node.value:
        if key_node.tag == "tag:yaml.org,2002:merge":  # <<: *anchor, laid under the mapping's own keys below
            continue
        key = loader.construct_object(key_node, deep=True)
        if key in seen:
            line = key_node.start_mark.line + 1
            raise InputError(f"line {line}: key '{key}' is given twice")
        seen.add(key)
    loader.flatten_mapping(node)
    return {loader.construct_object(k, deep=True): loader.construct_object(v, deep=True) for k, v in node.value}


_StrictLoader.add_constructor(yaml.resolver.BaseResolver.DEFAULT_MAPPING_TAG, _mapping)
_StrictLoader.add_implicit_resolver(
    "tag:yaml.org,2002:float", re.compile(r"^[-+]?[0-9][0-9_]*(\.[0-9_]*)?[eE][-+]?[0-9]+$"), list("-+0123456789")
)


def read_yaml(path: str | Path) -> dict[str, Any]:
    """Read a YAML mapping.

    Raises
    ------
    InputError : if the file is missing, is not valid YAML, holds a key twice, or is not a mapping.
    """
    path = Path(path)
    try:
        data = yaml.load(path.read_text(encoding="utf-8"), Loader=_StrictLoader)
    except FileNotFoundError:
        siblings = [p.name for p in path.parent.glob("*.yaml")] if path.parent.is_dir() else []
        raise InputError(f"{path}: no such file{nearest(path.name, siblings)}") from None
    except OSError as error:
        raise InputError(f"{path}: cannot be read ({error.strerror})") from None
    except UnicodeDecodeError:
        raise InputError(f"{path}: is not a text file in UTF-8") from None
    except InputError as error:
        raise InputError(f"{path}: {error}") from None
    except yaml.YAMLError as error:
        mark = getattr(error, "problem_mark", None)
        where = f" line {mark.line + 1}:" if mark else ""
        what = getattr(error, "problem", None) or "not valid YAML"
        raise InputError(f"{path}:{where} {what}") from None
    if not isinstance(data, dict):
        raise InputError(f"{path}: must be a mapping of keys to values")
    return data


def read_schema(name: str) -> dict[str, Any]:
    """Read the schema `name` of workflow/schemas."""
    return read_yaml(SCHEMAS / f"{name}.schema.yaml")


def _dotted(path: list) -> str:
    text = ""
    for part in path:
        text += f"[{part}]" if isinstance(part, int) else (f".{part}" if text else str(part))
    return text


def _describe(error) -> str:
    """One line for one jsonschema error: the key, what is wrong, what is allowed, the nearest valid value."""
    where = _dotted(list(error.absolute_path))
    rule, value = error.validator, error.instance
    if rule == "additionalProperties":
        allowed = list(error.schema.get("properties", {}))
        key = next(k for k in value if k not in allowed)
        full = f"{where}.{key}" if where else str(key)
        return f"unknown key '{full}'{nearest(key, allowed)} (allowed: {', '.join(allowed)})"
    if rule == "required":
        missing = next(k for k in error.validator_value if k not in value)
        return f"'{where + '.' if where else ''}{missing}' is missing"
    where = where or "the document"
    shown = repr(value) if not isinstance(value, (dict, list)) or len(repr(value)) < 60 else type(value).__name__
    if rule == "enum":
        allowed = [str(v) for v in error.validator_value]
        return f"'{where}' is {shown}; allowed: {', '.join(allowed)}{nearest(str(value), allowed)}"
    if rule == "type":
        return f"'{where}' is {shown}, must be {_words(error.validator_value)}{_limits(error.schema)}"
    if rule in ("minimum", "maximum", "exclusiveMinimum", "exclusiveMaximum"):
        bound = error.validator_value
        near = "" if rule.startswith("exclusive") else f"; the nearest valid value is {bound}"
        return f"'{where}' is {shown}, out of range{_limits(error.schema)}{near}"
    if rule == "uniqueItems":
        twice = next(v for i, v in enumerate(value) if v in value[:i])
        return f"'{where}' holds {twice!r} twice"
    if rule in ("minItems", "maxItems"):
        return f"'{where}' has {len(value)} entries, {_words(rule)} {error.validator_value}"
    if rule == "oneOf":
        layouts = error.schema.get("description", "the schema")
        return f"'{where}' must hold exactly one of the layouts described in {layouts}"
    if rule == "pattern":
        return f"'{where}' is {shown}; {error.schema.get('description', 'it does not match ' + error.validator_value)}"
    return f"'{where}': {error.message.splitlines()[0]}"


def _words(rule) -> str:
    names = {
        "number": "a number",
        "integer": "a whole number",
        "string": "text",
        "boolean": "true or false",
        "array": "a list",
        "object": "a mapping",
        "null": "null",
        "minItems": "at least",
        "maxItems": "at most",
    }
    rules = rule if isinstance(rule, list) else [rule]
    return " or ".join(names.get(r, str(r)) for r in rules)


def _limits(schema: dict[str, Any]) -> str:
    parts = [
        f"{sign} {schema[key]}"
        for key, sign in (("minimum", ">="), ("exclusiveMinimum", ">"), ("maximum", "<="), ("exclusiveMaximum", "<"))
        if key in schema
    ]
    return f" (allowed: {' and '.join(parts)})" if parts else ""


def check(data: dict[str, Any], schema: dict[str, Any], name: str | Path) -> None:
    """Check `data` against a JSON schema.

    Raises
    ------
    InputError : one line that names the document, the key, what is allowed and the nearest valid value.
    """
    from jsonschema import Draft202012Validator

    errors = sorted(
        Draft202012Validator(schema).iter_errors(data),
        key=lambda e: (e.validator != "additionalProperties", len(e.absolute_path), [str(p) for p in e.absolute_path]),
    )
    if errors:
        raise InputError(f"{name}: {_describe(errors[0])}")


def normalise_numbers(data: Any, schema: dict[str, Any]) -> Any:
    """Return `data` with whole numbers turned into floats where the schema says number.

    A rule whose parameter changes from 5 to 5.0 would otherwise run again.
    """
    if isinstance(data, dict):
        properties = schema.get("properties", {})
        rest = schema.get("additionalProperties", {})
        rest = rest if isinstance(rest, dict) else {}
        return {k: normalise_numbers(v, properties.get(k, rest)) for k, v in data.items()}
    if isinstance(data, list):
        return [normalise_numbers(v, schema.get("items", {})) for v in data]
    kinds = schema.get("type")
    kinds = kinds if isinstance(kinds, list) else [kinds]
    if isinstance(data, bool) or not isinstance(data, (int, float)):
        return data
    if "number" in kinds:
        return float(data)
    if "integer" in kinds and float(data).is_integer():
        return int(data)
    return data
