"""Numbers that no document may hold: not-a-number, infinity, and sizes that overflow when computed with."""

from __future__ import annotations

import math
from typing import Any

from jointwear.files.errors import InputError, shown

#: Largest size of a number in a document. Nothing that is measured in SI units comes near, and products of a dozen
#: such numbers still fit double precision.
LARGEST = 1e18


def check_numbers(value: Any, name: object, where: str = "") -> None:
    """Check that every number in mappings and lists is finite and at most :data:`LARGEST` in size.

    Parameters
    ----------
    value : content of a document.
    name : what the message calls the document.
    where : the key of `value` in it.

    Raises
    ------
    InputError : one line naming the document, the key and what is allowed.
    """
    if isinstance(value, dict):
        for key, inner in value.items():
            check_numbers(inner, name, f"{where}.{key}" if where else str(key))
    elif isinstance(value, (list, tuple)):
        for index, inner in enumerate(value):
            check_numbers(inner, name, f"{where}[{index}]")
    elif isinstance(value, float) and not math.isfinite(value):
        raise InputError(f"{name}: '{where}' is {value}; every number must be finite")
    elif isinstance(value, (int, float)) and abs(value) > LARGEST:
        near = LARGEST if value > 0 else -LARGEST
        raise InputError(
            f"{name}: '{where}' is {shown(value)}, out of range (allowed: at most {LARGEST:g} in size); "
            f"the nearest valid value is {near:g}"
        )
