"""Units as products of units with prefixes: ``kg m2 s-2``, ``mdeg/s``, ``1e-3 N m``.

Read by the Snakefile at every call: nothing heavy is imported here.
"""

from __future__ import annotations

import itertools
import math
import re

#: Factors of prefixes; the micro sign and the Greek letter look alike.
_PREFIXES = {
    "": 1.0,
    "n": 1e-9,
    "µ": 1e-6,
    "μ": 1e-6,
    "u": 1e-6,
    "m": 1e-3,
    "c": 1e-2,
    "d": 0.1,
    "da": 10.0,
    "k": 1e3,
    "M": 1e6,
}
_POUND = 4.4482216152605
#: Units that take prefixes: factor in kg, m, s and rad, and their powers of these.
_PREFIXED: dict[str, tuple[float, tuple[int, ...]]] = {
    "N": (1.0, (1, 1, -2, 0)),
    "g": (1e-3, (1, 0, 0, 0)),
    "m": (1.0, (0, 1, 0, 0)),
    "s": (1.0, (0, 0, 1, 0)),
    "rad": (1.0, (0, 0, 0, 1)),
    "deg": (math.pi / 180, (0, 0, 0, 1)),
    "gf": (9.80665e-3, (1, 1, -2, 0)),
    "p": (9.80665e-3, (1, 1, -2, 0)),
}
#: Units that take none.
_PLAIN: dict[str, tuple[float, tuple[int, ...]]] = {
    "°": (math.pi / 180, (0, 0, 0, 1)),
    "gon": (math.pi / 200, (0, 0, 0, 1)),
    "arcmin": (math.pi / 10800, (0, 0, 0, 1)),
    "arcsec": (math.pi / 648000, (0, 0, 0, 1)),
    "rev": (2 * math.pi, (0, 0, 0, 1)),
    "lbf": (_POUND, (1, 1, -2, 0)),
    "lb": (_POUND, (1, 1, -2, 0)),
    "ozf": (_POUND / 16, (1, 1, -2, 0)),
    "oz": (_POUND / 16, (1, 1, -2, 0)),
    "in": (0.0254, (0, 1, 0, 0)),
    "ft": (0.3048, (0, 1, 0, 0)),
    "min": (60.0, (0, 0, 1, 0)),
    "h": (3600.0, (0, 0, 1, 0)),
}
_UNITS = {
    prefix + name: (size * unit[0], unit[1])
    for (prefix, size), (name, unit) in itertools.product(_PREFIXES.items(), _PREFIXED.items())
} | _PLAIN
#: What each role is made of: powers of kg, m, s and rad.
_OF_ROLE = {
    "time": (0, 0, 1, 0),
    "position": (0, 0, 0, 1),
    "velocity": (0, 0, -1, 1),
    "acceleration": (0, 0, -2, 1),
    "torque": (1, 2, -2, 0),
}
_TERM = re.compile(r"([^\W\d_]+|°)(?:\^?([-+]?\d))?")
_NUMBER = re.compile(r"(?:\d+(?:\.\d*)?(?:[eE][-+]?\d+)?|10\^-?\d+)(?=[ *·x])[ *·x]+")
_RAISED = str.maketrans({"²": "2", "³": "3", "⁻": "-", "¹": "1"})
#: Words of prefixes in front of a unit, beside the letters.
_PREFIX_WORDS = ("nano", "micro", "milli", "centi", "deci", "kilo", "mega")


def size_of_terms(role: str, text: str) -> float | None:
    """Return the size of a unit in that of the project, rad, s and N m, where it is a product of units that is of the
    role; else None."""
    left = text.strip().translate(_RAISED)
    size = 1.0
    if number := _NUMBER.match(left):
        told = number[0].rstrip(" *·x")
        size = 10.0 ** int(told[3:]) if told.startswith("10^") else float(told)
        left = left[number.end() :]
    powers, sign, first = [0, 0, 0, 0], 1, True
    while left:
        between = re.match(r" *([*·./]|-(?=\D))? *", left)
        if not first and not between[0]:
            return None
        sign = -1 if between[1] == "/" else 1
        left = left[between.end() :]
        term = _TERM.match(left)
        known = _terms(term[1]) if term else None
        if known is None:
            return None
        power = sign * int(term[2] or 1)
        for place, (factor, dimension) in enumerate(known, start=1):
            # An exponent holds for the last of units that are written together.
            each = power if place == len(known) else sign
            size *= factor**each
            powers = [p + each * d for p, d in zip(powers, dimension, strict=True)]
        left, first = left[term.end() :], False
    return size if size > 0 and tuple(powers) == _OF_ROLE.get(role) else None


def _terms(word: str) -> list[tuple[float, tuple[int, ...]]] | None:
    """Return the unit that a word is, or the two of a force and a length that are written together, as in cNm."""
    if word in _UNITS:
        return [_UNITS[word]]
    for end in range(1, len(word)):
        force, length = _UNITS.get(word[:end]), _UNITS.get(word[end:])
        if force and length and (force[1], length[1]) == ((1, 1, -2, 0), (0, 1, 0, 0)):
            return [force, length]
    return None


def other_size(text: str, word: str) -> bool:
    """Return whether what is written holds a known word behind a number or a prefix, or beside another unit, and so
    means another size or another quantity than the word alone."""
    plain, known = text.strip().lower(), word.strip().lower()
    alike = zip(reversed(plain), reversed(known), strict=False)
    tail = sum(1 for _ in itertools.takewhile(lambda pair: pair[0] == pair[1], alike))
    if tail and plain != known:
        before, own = (x[: len(x) - tail].strip(" *·-") for x in (plain, known))
        prefixes = {*_PREFIX_WORDS, *(p.lower() for p in _PREFIXES)}
        if own in prefixes and (before in prefixes or re.search(r"\d", before)):
            return True
    return plain.count("/") != known.count("/") or bool(re.search(r"\d", plain)) != bool(re.search(r"\d", known))
