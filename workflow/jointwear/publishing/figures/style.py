"""The look of every figure, and how it is written: SVG with the same bytes for the same data."""

from __future__ import annotations

import io
from dataclasses import dataclass
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


@dataclass(frozen=True)
class Margins:
    """Room [inches] around the panels of a figure for their labels, and `between` columns and rows of them."""

    left: float
    bottom: float
    right: float = 0.1
    top: float = 0.25
    between: tuple[float, float] = (0.0, 0.0)

    def apply(self, figure: Figure, columns: int, rows: int) -> None:
        """Place the panels of a grid."""
        width, height = figure.get_size_inches()
        inner = width - self.left - self.right, height - self.bottom - self.top
        # Matplotlib wants the space between panels in sizes of one panel.
        space = [
            gap / max((whole - (count - 1) * gap) / count, 1e-3)
            for gap, whole, count in zip(self.between, inner, (columns, rows), strict=True)
        ]
        figure.subplots_adjust(
            left=self.left / width, right=1 - self.right / width, bottom=self.bottom / height,
            top=1 - self.top / height, wspace=space[0], hspace=space[1],
        )  # fmt: skip


def new_figure(height: float, width: float = WIDTH, layout: str | None = "constrained") -> Figure:
    """Return an empty figure of the given size [inches] in the project's style.

    Parameters
    ----------
    layout : "constrained" finds the room that labels need, which takes as long as drawing; None where
        :class:`Margins` gives it.
    """
    # Not what a matplotlibrc of the user says: figures are the same to the byte wherever they are drawn.
    matplotlib.rcdefaults()
    matplotlib.rcParams.update(_SETTINGS)
    figure = Figure(figsize=(width, height), layout=layout)
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
