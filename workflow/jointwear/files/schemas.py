"""Hold documents against their schemas: one line of key, what is wrong, what is allowed and the nearest valid value.

Imported by the Snakefile at every call of Snakemake, so nothing heavy is imported here.
"""

from __future__ import annotations

import math
import re
from collections.abc import Callable
from pathlib import Path
from typing import Any

from jointwear.files.documents import read_yaml
from jointwear.files.errors import InputError, nearest, quoted, shown
from jointwear.files.schema_parts import values_of
from jointwear.files.wording import count as counted

SCHEMAS = Path(__file__).resolve().parents[2] / "schemas"
#: A number in quotes, with a decimal comma (1,000 is left alone, which means two things) or a percent sign.
_NUMBER = re.compile(r"(?P<number>[-+]?[0-9]+(?:\.[0-9]+|,(?![0-9]{3}\b)[0-9]+)?)\s*(?P<percent>%?)")
#: A number as Snakemake, which reads 1e-4 as text, may hand it on.
_AS_TEXT = re.compile(r"[-+]?(\d+\.?\d*|\.\d+)(?P<exponent>[eE][-+]?\d+)?", re.ASCII)
#: What stands in a YAML file for values that Python has its own words for.
_SAID = {None: "empty", True: "true", False: "false"}
#: Keys of a robot file that have no sign: one that is negative is no small one.
_WITHOUT_SIGN = (".mass", ".motor_inertia", ".viscous", ".coulomb.positive")
#: What a plain name does not hold.
_NOT_PLAIN = re.compile(r"[^A-Za-z0-9_-]+")
#: A ratio as data sheets of gears print it: 80:1.
_TO_ONE = re.compile(r"\s*:\s*1(?:\.0*)?$")


def read_schema(name: str) -> dict[str, Any]:
    """Read the schema `name` of workflow/schemas."""
    return read_yaml(SCHEMAS / f"{name}.schema.yaml")


def _dotted(path: list) -> str:
    text = ""
    for part in path:
        text += f"[{part}]" if isinstance(part, int) else (f".{part}" if text else str(part))
    return quoted(text)[1:-1]


def _describe(error) -> str:
    """One line for one jsonschema error: the key, what is wrong, what is allowed, the nearest valid value."""
    where = _dotted(list(error.absolute_path))
    rule, value = error.validator, error.instance
    if rule == "additionalProperties":
        allowed = list(error.schema.get("properties", {}))
        key = next(k for k in value if k not in allowed)
        full = f"{where}.{key}" if where else str(key)
        # What a schema says of a key that it knows not to have.
        why = error.schema.get("x-unknown", {}).get(key) or _decimal_comma(value, key)
        near = f"; {why}" if why else nearest(key, allowed)
        return f"unknown key {quoted(full)}{near} (allowed: {', '.join(allowed)})"
    if rule == "required":
        missing = next(k for k in error.validator_value if k not in value)
        allowed = _one_of(error.schema.get("properties", {}).get(missing, {}))
        return f"'{where + '.' if where else ''}{missing}' is missing{allowed}"
    where = where or "the document"
    said = _SAID[value] if value is None or isinstance(value, bool) else shown(value)
    if error.schema.get("writeOnly"):
        # What a schema marks so may be a secret.
        said = "a value that is not repeated here"
    if rule == "enum":
        allowed = [str(v) for v in error.validator_value]
        return f"'{where}' is {said}; allowed: {', '.join(allowed)}{nearest(str(value), allowed)}"
    if rule == "type":
        near = _number_in(where, value, error.validator_value, error.schema)
        near = near or _list_of(where, value, error.validator_value, error.schema)
        if where.endswith(".coulomb") and isinstance(value, (int, float)) and not isinstance(value, bool):
            near = f", as {{positive: {abs(value):g}, negative: {-abs(value):g}}}"
        if isinstance(value, bool) and "string" in error.validator_value:
            near = f"{_one_of(error.schema)}; YAML reads yes, no, on and off so: put text between quotation marks"
        return f"'{where}' is {said}, must be {_words(error.validator_value)}{_limits(error.schema)}{near}"
    if rule in ("minimum", "maximum", "exclusiveMinimum", "exclusiveMaximum"):
        bound = error.validator_value
        near = "" if rule.startswith("exclusive") else f"; the nearest valid value is {bound}"
        if math.isclose(abs(bound), 2 * math.pi):
            near = f"; this looks like degrees: {math.radians(value):.6g}"
        if ".torque_constant" in where and value < 0 and _within(-value, error.schema):
            near = f"; without its sign it is {-value:g}: 'scale' turns a torque, 'sign' a joint with its torque"
        if value < 0 and where.endswith(_WITHOUT_SIGN) and _within(-value, error.schema):
            near = f"; without its sign it is {-value:g}"
        if value > 0 and where.endswith(".coulomb.negative") and _within(-value, error.schema):
            near = f"; with the sign of the velocity it is {-value:g}"
        if rule == "minimum" and where.endswith("_percent") and 0 < value < 1 and _within(100 * value, error.schema):
            near += f", or {100 * value:.6g} if a share of one is meant"
        if rule == "maximum" and bound <= 1 and _within(value / 100, error.schema):
            near += f", or {value / 100:.6g} if {value:.6g} % is meant"
        return f"'{where}' is {said}, out of range{_limits(error.schema)}{near}"
    if rule == "uniqueItems":
        twice = next(v for i, v in enumerate(value) if v in value[:i])
        return f"'{where}' holds {shown(twice)} twice"
    if rule in ("minItems", "maxItems"):
        has, limit = f"'{where}' has {counted(len(value), 'entry', 'entries')}", error.validator_value
        if error.schema.get("minItems") == error.schema.get("maxItems"):
            what = error.schema.get("description", "").rstrip(".")
            return f"{has}; allowed: {limit}{f' ({what})' if what else ''}"
        return f"{has}, {_words(rule)} {limit}"
    if rule == "oneOf":
        layouts = error.schema.get("description", "the schema")
        return f"'{where}' must hold exactly one of the layouts described in {layouts}"
    if rule == "pattern":
        form = error.schema.get("description", "it does not match " + error.validator_value)
        # An address that is given in place of a name may hold a password.
        of_keys = "propertyNames" in error.absolute_schema_path
        plain = _NOT_PLAIN.sub("_", value).strip("_") if of_keys or where.endswith("name") else ""
        if of_keys:
            # The names of a mapping are its keys.
            told, plain = f"'{where}' has the name {said}", plain.replace("-", "_")
            plain = f"{where.rpartition('.')[2].rstrip('s')}_{plain}" if plain[:1].isdigit() else plain
            near = f"; the nearest valid name is '{plain}'" if re.search(error.validator_value, plain) else ""
            return f"{told}; {form}{near}"
        near = f"; the nearest valid value is '{plain}'" if plain and re.search(error.validator_value, plain) else ""
        return f"'{where}' is {said}; {form}{near}"
    if rule in ("minLength", "maxLength", "minProperties", "maxProperties"):
        few, what = rule.startswith("min"), ("character",) if rule.endswith("Length") else ("entry", "entries")
        keys = ", ".join(error.schema.get("properties", {}))
        told = f" (allowed: {keys})" if keys else ""
        limit = error.validator_value
        return f"'{where}' has {counted(len(value), *what)}, at {'least' if few else 'most'} {limit}{told}"
    if rule == "not" and "const" in error.validator_value:
        return f"'{where}' is {said}; allowed: anything but {error.validator_value['const']}{_limits(error.schema)}"
    return f"'{where}' is {said}; it breaks '{rule}' of the schema"


def _decimal_comma(value: dict, key: Any) -> str:
    """Return in words that a key of a mapping is what stands behind the decimal comma of the value before it, as 5 in
    {mass: 9,5, com: ...}; empty where it is not."""
    before = list(value)[: list(value).index(key)][-1:]
    if isinstance(key, bool) or not isinstance(key, int) or value[key] is not None or not before:
        return ""
    number = value[before[0]]
    if isinstance(number, bool) or not isinstance(number, int):
        return ""
    return f"a comma ends the value of '{before[0]}', {number}: write its decimals behind a point"


def _within(value: float, schema: dict[str, Any]) -> bool:
    """Whether a number is within the limits of a schema."""
    return schema.get("minimum", -math.inf) <= value <= schema.get("maximum", math.inf) and schema.get(
        "exclusiveMinimum", -math.inf
    ) < value < schema.get("exclusiveMaximum", math.inf)


def _number_in(where: str, value: Any, rule: str | list[str], schema: dict[str, Any]) -> str:
    """Return the valid number that a text holds, as a proposal: 0.05 of '0,05', and of '5 %' for a share; 80 of the
    ratio '80:1'.

    Nothing is proposed for a text with a unit: 500 is not what '500 ms' means.
    """
    kinds = rule if isinstance(rule, list) else [rule]
    said = _NUMBER.fullmatch(_of_ratio(where, value.strip())) if isinstance(value, str) else None
    if said is None or not {"number", "integer"} & set(kinds):
        return ""
    number = float(said["number"].replace(",", "."))
    if said["percent"] and "_percent" not in where.rpartition(".")[2]:
        if schema.get("maximum", math.inf) > 1:
            return ""
        number /= 100
    if not _within(number, schema) or ("number" not in kinds and number != int(number)):
        return ""
    return f"; the nearest valid value is {number:.10g}"


def _of_ratio(where: str, text: str) -> str:
    """Return the number of a ratio to one, 80 of '80:1'; any other text, and that of a key of no ratio, as it is."""
    return _TO_ONE.sub("", text) if where.endswith("_ratio") else text


def _one_of(schema: dict[str, Any]) -> str:
    """Return which words a schema allows, empty where it has no list of them."""
    return f" (allowed: {', '.join(map(str, schema['enum']))})" if "enum" in schema else ""


def _list_of(where: str, value: Any, rule: str | list[str], schema: dict[str, Any]) -> str:
    """Return the list of a single value as a proposal where a list of such values is allowed: [2] of 2."""
    from jsonschema import Draft202012Validator

    plain = isinstance(value, (str, int, float)) and not isinstance(value, bool)
    # What a schema refers to is out of reach here: it holds mappings, none of which is plain.
    if (
        rule != "array"
        or not plain
        or "$ref" in schema.get("items", {})
        or not Draft202012Validator(schema).is_valid([value])
    ):
        return ""
    if where.endswith(".sign"):
        return "; one for each axis, as [1, 1, -1, 1, 1, 1] of an arm that has six"
    return f"; the nearest valid value is {shown([value])}"


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
    """Return the limits of a number, with the reason where the schema has one as its comment."""
    parts = [
        f"{sign} {schema[key]}"
        for key, sign in (("minimum", ">="), ("exclusiveMinimum", ">"), ("maximum", "<="), ("exclusiveMaximum", "<"))
        if key in schema
    ]
    why = f": {schema['$comment']}" if "$comment" in schema else ""
    return f" (allowed: {' and '.join(parts)}{why})" if parts else ""


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
    return _by_kind(data, schema, _normalised)


def read_numbers(data: Any, schema: dict[str, Any]) -> Any:
    """Return `data` with text that holds a number read as one where the schema says number and not text.

    Snakemake reads 1e-4 as text; where the schema says number or text, what has such an exponent is read, too, and all
    other text stays what it is: "4711" in quotes is text.
    """
    return _by_kind(data, schema, _number_read)


def check_no_quoted_numbers(data: Any, schema: dict[str, Any], name: str | Path) -> None:
    """Check that a file, as it was written, holds no number as text where the schema says number and not text.

    :func:`read_numbers` mends what Snakemake has read alone, of which nobody knows any more how it was written.

    Raises
    ------
    InputError : one line that names the document, the key, what is allowed and the nearest valid value.
    """
    for where, text, part in values_of(data, schema):
        kinds = _kinds(part)
        if not isinstance(text, str) or not {"number", "integer"} & set(kinds) or "string" in kinds:
            continue
        if _AS_TEXT.fullmatch(text):
            near = _number_in(where, f"{float(text):.10f}".rstrip("0").rstrip("."), kinds, part)
            raise InputError(f"{name}: '{where}' is {shown(text)}, must be {_words(kinds)}{_limits(part)}{near}")


def _kinds(schema: dict[str, Any]) -> list:
    """Return the types that a schema allows for a value."""
    kinds = schema.get("type")
    return kinds if isinstance(kinds, list) else [kinds]


def _by_kind(data: Any, schema: dict[str, Any], change: Callable[[Any, list], Any]) -> Any:
    """Return `data` with each value changed by `change`, which is told the types that the schema allows for it."""
    if isinstance(data, dict):
        properties = schema.get("properties", {})
        rest = schema.get("additionalProperties", {})
        rest = rest if isinstance(rest, dict) else {}
        return {k: _by_kind(v, properties.get(k, rest), change) for k, v in data.items()}
    if isinstance(data, list):
        return [_by_kind(v, schema.get("items", {}), change) for v in data]
    return change(data, _kinds(schema))


def _normalised(value: Any, kinds: list) -> Any:
    if isinstance(value, bool) or not isinstance(value, (int, float)):
        return value
    if "number" in kinds:
        return float(value)
    return int(value) if "integer" in kinds and float(value).is_integer() else value


def _number_read(value: Any, kinds: list) -> Any:
    if not isinstance(value, str) or not {"number", "integer"} & set(kinds):
        return value
    found = _AS_TEXT.fullmatch(value)
    return float(value) if found and ("string" not in kinds or found["exponent"]) else value
