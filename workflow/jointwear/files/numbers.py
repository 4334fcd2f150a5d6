"""Numbers that no document may hold: not-a-number, infinity, and sizes that overflow when computed with."""

from __future__ import annotations

import math
from typing import Any

from jointwear.files.errors import InputError, shown
from jointwear.files.schema_parts import values_of

#: Largest size of a number in a document. Nothing that is measured in SI units comes near, and products of a dozen
#: such numbers still fit double precision.
LARGEST = 1e18


def check_numbers(value: Any, name: object, schema: dict[str, Any] | None = None) -> None:
    """Check that every number in mappings and lists is finite and at most :data:`LARGEST` in size.

    Parameters
    ----------
    value : content of a document.
    name : what the message calls the document.
    schema : of the document, whose limits the message names where they are narrower.

    Raises
    ------
    InputError : one line naming the document, the key, what is allowed and the nearest valid value.
    """
    for where, number, part in values_of(value, schema or {}):
        if isinstance(number, float) and not math.isfinite(number):
            raise InputError(f"{name}: '{where}' is {number}; every number must be finite")
        if isinstance(number, (int, float)) and abs(number) > LARGEST:
            allowed, near = _limit(part, number > 0)
            raise InputError(
                f"{name}: '{where}' is {shown(number)}, out of range (allowed: {allowed})"
                + ("" if near is None else f"; the nearest valid value is {near:g}")
            )


def _limit(part: dict[str, Any], above: bool) -> tuple[str, float | None]:
    """Return in words the limit of a number that is too large, or that is too small, and the nearest valid value, None
    where the limit itself is none."""
    rule, sign, end = ("maximum", "<", LARGEST) if above else ("minimum", ">", -LARGEST)
    exclusive = "exclusive" + rule.capitalize()
    if exclusive in part:
        return f"{sign} {part[exclusive]:g}", None
    if rule in part:
        return f"{sign}= {part[rule]:g}", part[rule]
    return f"at most {LARGEST:g} in size", end
