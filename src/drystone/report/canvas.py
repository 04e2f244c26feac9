"""Paper and ink shared by all figures: sizes, colours, saving.

Figures are made through matplotlib's objects, never through pyplot, and no setting of
matplotlib is changed: a program that uses the library keeps its own figures as they were.
"""

from __future__ import annotations

import base64
import io
import warnings
from html import escape
from pathlib import Path
from typing import IO, TYPE_CHECKING, Any

from drystone.common.language import current, with_mark
from drystone.model.construction.words import printable

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

#: Resolution of every figure [dots per inch].
RESOLUTION = 150
#: What files of a format are written with.  Compression 3 of 9 makes PNG twice as fast as the usual
#: 6, and a tenth larger.
_OF_FORMAT: dict[str, dict[str, Any]] = {
    "png": {"pil_kwargs": {"compress_level": 3}},
    "svg": {"metadata": {"Date": None}},
}
#: Letters of a title.
LONGEST = 100

INK = "#1a1a1a"
FAINT = "#8c8c8c"
#: Of curves, dark before light, told apart by colour-blind readers; line styles go with them.
CURVE_COLOURS = ("#0b3c6f", "#c1440e", "#2a7f62", "#7a4b9a", "#8a6d00", "#444444")
CURVE_STYLES = ("-", "--", "-.", (0, (5, 1, 1, 1, 1, 1)), (0, (1, 1)), (0, (8, 2)))

#: Behind words that stand on lines.
BACKING = {"boxstyle": "round,pad=0.2", "facecolor": "white", "edgecolor": "none", "alpha": 0.85}


def made_ready() -> None:
    """Import what draws and draw a letter, before there is anything to draw.

    With the first letter fonts are read, and what reads formulas is made.
    """
    import matplotlib.backends.backend_agg  # noqa: F401
    from matplotlib.figure import Figure

    figure = Figure(figsize=(1.0, 1.0))
    figure.text(0.0, 0.0, "$λ$")
    save(figure, io.BytesIO())


def new_figure(width: float, height: float) -> Figure:
    """An empty figure of that size [inches] that belongs to no window and no global list."""
    from matplotlib.figure import Figure

    return Figure(figsize=(width, height), layout="constrained")


def literal(text: str) -> str:
    """A user's text, drawn letter by letter: no formula, no control characters, not too long."""
    shown = text if len(text) <= LONGEST else text[:LONGEST] + "..."
    return printable(shown).replace("$", r"\$")


def save(
    figure: Figure, path: Path | str | IO[bytes], format: str = "png", resolution: int = RESOLUTION
) -> None:
    """Write the figure, as PNG where nothing is said; the same figure gives the same file."""
    from matplotlib import rc_context

    # Letters of SVG stay letters, which can be found and marked.
    with (
        warnings.catch_warnings(),
        rc_context({"svg.fonttype": "none", "svg.hashsalt": "drystone"}),
    ):
        # A title may be in letters that the font has no picture of: they become boxes.
        warnings.filterwarnings("ignore", message="Glyph .* missing from")
        if format == "png":
            _lay_out(figure, resolution)
        figure.savefig(
            path,
            format=format,
            dpi=resolution,
            facecolor="white",
            **_OF_FORMAT.get(format, {}),
        )


def _lay_out(figure: Figure, resolution: int) -> None:
    """Give everything its place, for pixels of a resolution [dots per inch].

    To save a figure matplotlib draws it twice where its places are still to be found.
    """
    engine = figure.get_layout_engine()
    if engine is not None:
        figure.set_dpi(resolution)
        engine.execute(figure)
        figure.set_layout_engine(None)


#: What a browser is told that a picture is, by its format.
_KINDS = {"svg": "image/svg+xml", "png": "image/png"}


def element(figure: Figure, label: str, format: str, resolution: int = RESOLUTION) -> str:
    """The figure as an element of a page that needs no other file; ``label`` is what is on it, for
    those who do not see it."""
    stream = io.BytesIO()
    save(figure, stream, format, resolution)
    return image(stream.getvalue(), label, format)


def image(picture: bytes, label: str, format: str) -> str:
    """The same of a picture that is a file already."""
    data = base64.b64encode(picture).decode("ascii")
    return f'<img alt="{escape(label)}" src="data:{_KINDS[format]};base64,{data}">'


def plain_axes(axes: Axes) -> None:
    """Thin frame on two sides, faint grid behind the data; figures of the language spoken."""
    axes.spines[["top", "right"]].set_visible(False)
    axes.grid(visible=True, color="#dddddd", linewidth=0.6)
    axes.set_axisbelow(True)
    axes.tick_params(labelsize=9)
    speak_ticks(axes)


def speak_ticks(axes: Axes) -> None:
    """Numbers along the axes have the decimal mark of the language that is spoken."""
    from matplotlib.ticker import ScalarFormatter

    language = current()

    class Spoken(ScalarFormatter):
        def __call__(self, x: float, pos: int | None = None) -> str:
            return with_mark(super().__call__(x, pos), language)

        def get_offset(self) -> str:  # what all numbers of an axis have in common
            return with_mark(super().get_offset(), language)

    if language != "en":
        for axis in (axes.xaxis, axes.yaxis):
            axis.set_major_formatter(Spoken())
