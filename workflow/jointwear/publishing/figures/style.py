"""The look of every figure, and how it is written: SVG with the same bytes for the same numbers."""

from __future__ import annotations

import io
from pathlib import Path
from xml.sax.saxutils import escape

import matplotlib
from matplotlib.axes import Axes
from matplotlib.backends.backend_svg import FigureCanvasSVG
from matplotlib.figure import Figure

from jointwear.files.text_files import replace_text
from jointwear.publishing.figures import palette
from jointwear.publishing.figures.seal import sealed

WIDTH = 6.6  # inches; 10 pt text is then 10 px or more on a page that shows the figure 480 px wide
_SETTINGS = {
    "font.family": "sans-serif",
    "font.sans-serif": ["DejaVu Sans"],
    "font.size": 9.0,
    "axes.titlesize": 9.5,
    "axes.titleweight": "bold",
    "axes.titlelocation": "left",
    "axes.labelsize": 9.0,
    "axes.edgecolor": palette.MUTED,
    "axes.labelcolor": palette.INK,
    "axes.titlecolor": palette.INK,
    "axes.facecolor": palette.PAPER,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "axes.linewidth": 0.8,
    "axes.grid": True,
    "axes.axisbelow": True,
    "axes.unicode_minus": True,
    "grid.color": palette.GRID,
    "grid.linewidth": 0.7,
    "xtick.color": palette.MUTED,
    "ytick.color": palette.MUTED,
    "xtick.labelcolor": palette.INK,
    "ytick.labelcolor": palette.INK,
    "text.color": palette.INK,
    "legend.frameon": False,
    "legend.fontsize": 8.5,
    "lines.linewidth": 1.6,
    "figure.facecolor": palette.PAPER,
    "savefig.facecolor": palette.PAPER,
    "svg.fonttype": "none",
    "svg.hashsalt": "jointwear",
}


def new_figure(height: float, width: float = WIDTH) -> Figure:
    """Return an empty figure of the given size [inches] in the project's style."""
    matplotlib.rcParams.update(_SETTINGS)
    figure = Figure(figsize=(width, height), layout="constrained")
    FigureCanvasSVG(figure)
    return figure


def direct_label(axes: Axes, x: float, y: float, text: str, colour: str, **how) -> None:
    """Write a label into the plot, on a patch of paper so that lines behind it do not disturb it."""
    axes.annotate(
        text,
        (x, y),
        xytext=how.pop("offset", (4, 0)),
        textcoords="offset points",
        color=colour,
        fontsize=how.pop("fontsize", 8.5),
        bbox={"facecolor": palette.PAPER, "edgecolor": "none", "pad": 1.0, "alpha": 0.85},
        **how,
    )


def save(figure: Figure, path: str | Path, title: str, description: str) -> None:
    """Write a figure as SVG without date, with its title and the description that stands in for the picture."""
    buffer = io.StringIO()
    figure.savefig(buffer, format="svg", metadata={"Date": None, "Creator": None, "Title": title})
    head, tag, rest = buffer.getvalue().partition("<svg")
    opening, bracket, content = rest.partition(">")
    about = f"\n <title>{escape(title)}</title>\n <desc>{escape(description)}</desc>"
    lines = (head + tag + opening + bracket + about + content).splitlines()
    replace_text(path, sealed("\n".join(line.rstrip() for line in lines) + "\n"))
