"""Paper and ink shared by all figures: sizes, colours, saving.

Figures are made through matplotlib's objects, never through pyplot, and no setting of
matplotlib is changed: a program that uses the library keeps its own figures as they were.
"""

from __future__ import annotations

import warnings
from pathlib import Path
from typing import TYPE_CHECKING

from drystone.model.construction.words import printable

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

#: Resolution of every figure [dots per inch].
RESOLUTION = 150
#: Letters of a title.
LONGEST = 100

INK = "#1a1a1a"
FAINT = "#8c8c8c"
#: Of curves, dark before light, told apart by colour-blind readers; line styles go with them.
CURVE_COLOURS = ("#0b3c6f", "#c1440e", "#2a7f62", "#7a4b9a", "#8a6d00", "#444444")
CURVE_STYLES = ("-", "--", "-.", (0, (5, 1, 1, 1, 1, 1)), (0, (1, 1)), (0, (8, 2)))


def new_figure(width: float, height: float) -> Figure:
    """An empty figure of that size [inches] that belongs to no window and no global list."""
    from matplotlib.figure import Figure

    return Figure(figsize=(width, height), layout="constrained")


def literal(text: str) -> str:
    """A user's text, drawn letter by letter: no formula, no control characters, not too long."""
    shown = text if len(text) <= LONGEST else text[:LONGEST] + "..."
    return printable(shown).replace("$", r"\$")


def save(
    figure: Figure, path: Path | str, format: str = "png", resolution: int = RESOLUTION
) -> None:
    """Write the figure, as PNG where nothing is said."""
    with warnings.catch_warnings():
        # A title may be in letters that the font has no picture of: they become boxes.
        warnings.filterwarnings("ignore", message="Glyph .* missing from")
        figure.savefig(Path(path), format=format, dpi=resolution, facecolor="white")


def plain_axes(axes: Axes) -> None:
    """Thin frame on two sides, faint grid behind the data."""
    axes.spines[["top", "right"]].set_visible(False)
    axes.grid(visible=True, color="#dddddd", linewidth=0.6)
    axes.set_axisbelow(True)
    axes.tick_params(labelsize=9)
