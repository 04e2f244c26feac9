"""A mechanism as it goes along its curve, as a GIF or an MP4."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from drystone.common.arrays import Array
from drystone.model.construction.errors import ModelError
from drystone.model.model import Model
from drystone.report import canvas
from drystone.report.mechanism import Mechanism
from drystone.report.mechanism_figure import plot_mechanism
from drystone.report.quantities import Quantities, state_text
from drystone.results.curve import CapacityCurve
from drystone.results.frames import rows_along

if TYPE_CHECKING:
    from matplotlib.axes import Axes

Frame = NDArray[np.uint8]

ENDINGS = (".gif", ".mp4")
#: Resolution [dots per inch] and size [inches] of a frame: even numbers of pixels, for MP4.
RESOLUTION, SIZE = 100, (7.2, 6.0)
#: States from which the frame of all pictures is taken.
LOOKED_AT = 5
#: Seconds for which the last frame stands.
LAST = 1.5


def animate(
    curve: CapacityCurve,
    model: Model,
    path: Path | str,
    *,
    n_frames: int = 48,
    frames_per_second: float = 12.0,
    title: str = "",
) -> None:
    """Write an animation of a curve: its states true to scale, a marker on the curve below them.

    Parameters
    ----------
    curve
        With poses.
    path
        Ends in .gif, or in .mp4, which needs the extra ``animation``.
    n_frames
        States that are shown at most, evenly along the way of the control point.
    title
        Above the picture; the model's by default.

    Raises
    ------
    ModelError
        The ending is another one, what writes it is not installed, or the curve has no poses.
    """
    path, model = Path(path), curve.traced_of(model)
    if path.suffix.lower() not in ENDINGS:
        raise ModelError([f"{path}: must end in {' or '.join(ENDINGS)}"])
    if curve.poses is None or not curve.points:
        raise ModelError(["the curve has no poses: trace it with keep_poses=True"])
    if path.suffix.lower() == ".mp4":
        _write_mp4(
            path, _writer_of_mp4(), _frames(curve, model, n_frames, title), frames_per_second
        )
    else:
        _write_gif(path, _frames(curve, model, n_frames, title), frames_per_second)


def _frames(curve: CapacityCurve, model: Model, n_frames: int, title: str) -> Iterator[Frame]:
    """Pictures (height, width, 3) of 8 bits."""
    from matplotlib.backends.backend_agg import FigureCanvasAgg

    assert curve.poses is not None
    peak = curve.points.index(curve.peak)
    rows = rows_along(curve.control_displacement, n_frames, keep=[peak])
    figure = canvas.new_figure(*SIZE)
    surface = FigureCanvasAgg(figure)
    figure.set_dpi(RESOLUTION)
    above, below = figure.subplots(2, 1, height_ratios=(3.2, 1.0))
    figure.suptitle(canvas.literal(title or model.title), fontsize=11)
    limits = _common_limits(above, curve, model, rows)
    (marker,) = _plot_curve(below, curve)
    shown = Quantities.of(curve)
    x, y = shown.x(curve), shown.y(curve)
    surface.draw()
    figure.set_layout_engine("none")  # what stands still is laid out once
    for row in rows:
        _plot_state(above, curve, model, row)
        above.set_xlim(*limits[0])
        above.set_ylim(*limits[1])
        marker.set_data([x[row]], [y[row]])
        surface.draw()
        yield np.asarray(surface.buffer_rgba())[..., :3].copy()


def _plot_state(axes: Axes, curve: CapacityCurve, model: Model, row: int) -> None:
    assert curve.poses is not None
    axes.clear()
    point, initial = curve.points[row], curve.poses[0]
    departed = curve.departed(model.assembly.ids, point.step)
    pose = np.where(departed[:, None], initial, curve.poses[row])
    plot_mechanism(
        axes,
        Mechanism(
            assembly=model.assembly,
            pose=pose,
            initial=initial,
            departed=departed,
            load_direction=model.load_shown,
            control_point=model.control_point,
            ties=model.ties,
            dead_loads=model.dead_loads,
            tie_branch=curve.ties.branch[row] if curve.ties else None,
        ),
    )
    if legend := axes.get_legend():
        legend.remove()
    axes.set_title(state_text(curve, point), fontsize=9)


def _plot_curve(axes: Axes, curve: CapacityCurve) -> list[Any]:
    canvas.plain_axes(axes)
    shown = Quantities.of(curve)
    colour = canvas.CURVE_COLOURS[0]
    axes.plot(shown.x(curve), shown.y(curve), color=colour, linewidth=1.4)
    axes.set_xlabel(f"{shown.motion} [{shown.motion_unit}]", fontsize=8)
    axes.set_ylabel(f"{shown.force} [{shown.force_unit or '-'}]", fontsize=8)
    return axes.plot([0.0], [0.0], "o", color=canvas.CURVE_COLOURS[1], markersize=6)


def _common_limits(axes: Axes, curve: CapacityCurve, model: Model, rows: Sequence[int]) -> Array:
    """Limits (2, 2) of the axes that show a few states along the curve."""
    found = []
    for place in np.linspace(0, len(rows) - 1, LOOKED_AT).round().astype(int):
        _plot_state(axes, curve, model, rows[place])
        found.append((axes.get_xlim(), axes.get_ylim()))
    low, high = np.array(found).min(axis=0)[:, 0], np.array(found).max(axis=0)[:, 1]
    return np.column_stack((low, high))


def _write_gif(path: Path, frames: Iterator[Frame], frames_per_second: float) -> None:
    from PIL import Image

    pictures = [Image.fromarray(frame).quantize(64) for frame in frames]
    each = round(1000.0 / frames_per_second)
    lasting = [each] * (len(pictures) - 1) + [each + round(1000.0 * LAST)]
    pictures[0].save(
        path, format="GIF", save_all=True, append_images=pictures[1:], duration=lasting, loop=0
    )


def _writer_of_mp4() -> Any:
    try:
        import imageio.v2 as imageio
        import imageio_ffmpeg  # noqa: F401
    except ImportError:
        raise ModelError(
            [
                "MP4 needs imageio with ffmpeg, which is not installed: pip install "
                "drystone[animation], or write a .gif"
            ]
        ) from None
    return imageio.get_writer


def _write_mp4(
    path: Path, writer_of: Any, frames: Iterator[Frame], frames_per_second: float
) -> None:
    writer = writer_of(str(path), format="FFMPEG", fps=frames_per_second, macro_block_size=2)
    try:
        for frame in frames:
            writer.append_data(frame)
        for _ in range(round(LAST * frames_per_second)):
            writer.append_data(frame)
    finally:
        writer.close()
