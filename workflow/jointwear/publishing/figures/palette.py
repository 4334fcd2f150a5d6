"""Colours of all figures and pages; no drawing library is imported here.

The series colours are those of Okabe and Ito, told apart with every common form of colour blindness. The
report replaces each colour by a CSS variable, so that a figure follows the light or dark theme of the page.
"""

from __future__ import annotations

import re

INK = "#1c1c1f"
MUTED = "#62626a"
GRID = "#dadade"
PAPER = "#ffffff"
PUBLISHED = "#a1367f"
PUBLISHED_AREA = "#f1dfeb"
# Text on a coloured patch keeps its colour in every theme: these two differ from INK and PAPER on purpose.
ON_LIGHT = "#0d0d10"
ON_DARK = "#fffffe"

SERIES = ("#0072b2", "#d55e00", "#009e73", "#cc79a7", "#e69f00", "#56b4e9", "#7a5fb5", "#8c6d31")
DASHES = ("solid", (0, (6, 1.5)), (0, (3, 1)), (0, (6, 1.5, 1.5, 1.5)), (0, (1.2, 1.2)), (0, (8, 2, 1, 1, 1, 2)))

# Light to dark; and orange, white, blue.
SEQUENTIAL = ("#f4f7fa", "#c3d7ea", "#8dbbdf", "#1f6fa9", "#084a82")
DIVERGING = ("#a65000", "#e79a52", "#f7f6f4", "#78b0d6", "#0a5a96")

VARIABLES = {
    INK: "--ink",
    MUTED: "--muted",
    GRID: "--rule",
    PAPER: "--paper",
    PUBLISHED: "--published",
    PUBLISHED_AREA: "--published-area",
    **{colour: f"--series-{i}" for i, colour in enumerate(SERIES, start=1)},
}
_COLOUR = re.compile(r"#[0-9a-f]{6}")


def axis_colour(axis: int) -> str:
    """Return the colour of a 1-based axis; beyond the palette the colours repeat."""
    return SERIES[(axis - 1) % len(SERIES)]


def axis_dashes(axis: int) -> str | tuple:
    """Return the line style of a 1-based axis, so that colour is never the only mark."""
    return DASHES[(axis - 1) % len(DASHES)]


def mix(stops: tuple[str, ...], share: float) -> str:
    """Return the colour at `share` in [0, 1] along evenly spaced stops; values beyond count as the end."""
    place = min(max(share, 0.0), 1.0) * (len(stops) - 1)
    k = min(int(place), len(stops) - 2)
    first, second = (tuple(int(stops[i][j : j + 2], 16) for j in (1, 3, 5)) for i in (k, k + 1))
    return "#" + "".join(f"{round(a + (place - k) * (b - a)):02x}" for a, b in zip(first, second, strict=True))


def text_on(colour: str) -> str:
    """Return the text colour with the higher contrast on `colour` (relative luminance of WCAG 2)."""
    channel = [int(colour[j : j + 2], 16) / 255 for j in (1, 3, 5)]
    red, green, blue = (c / 12.92 if c <= 0.04045 else ((c + 0.055) / 1.055) ** 2.4 for c in channel)
    luminance = 0.2126 * red + 0.7152 * green + 0.0722 * blue
    return ON_LIGHT if (luminance + 0.05) ** 2 > 0.05 * 1.05 else ON_DARK


def themed(style: str) -> str:
    """Replace every colour of the palette in a CSS text by its variable."""
    return _COLOUR.sub(lambda m: f"var({VARIABLES[m[0]]})" if m[0] in VARIABLES else m[0], style)
