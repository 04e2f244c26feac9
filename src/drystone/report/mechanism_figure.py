"""The mechanism as a picture: blocks where they are, those that move, the joints that opened."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from drystone.assembly import Assembly
from drystone.contact.forces import SLIDING, ContactForces
from drystone.geometry.motion import moved_points
from drystone.monitor import ControlPoint
from drystone.report import canvas
from drystone.report.joints import Joints
from drystone.report.outlines import MovingOutlines, moving_blocks

if TYPE_CHECKING:
    from matplotlib.axes import Axes

Array = NDArray[np.float64]

RESTING, MOVING, SUPPORT = "#f3f1ec", "#d9b676", "#c9c9c9"
OPEN_JOINT, SLID_JOINT = "#c8102e", "#00558c"
#: A joint has opened or slid when it did by this share of the largest displacement.
VISIBLE = 0.02
#: Joints that opened by more than this share of the structure's size are not filled: a block fell.
GAPING = 0.25
#: Displacements below this share of the structure's size are those of settling: not magnified.
NOTHING = 1e-5
#: Contact points are drawn up to this many: more would hide the blocks.
MOST_CONTACTS = 3000
#: The picture reaches this share of the structure's size beyond its designed outline, no further.
MARGIN = 0.6


@dataclass(frozen=True, kw_only=True)
class Mechanism:
    """What one picture shows."""

    assembly: Assembly
    pose: Array  # (n, n_dof) m, rad, where the blocks are
    settled: Array | None = None  # (n, n_dof) m, rad, where the load began; None: as designed
    gone: NDArray[np.bool_] | None = None  # (n,) blocks that have left: designed outlines, dashed
    contacts: ContactForces | None = None  # of that state: those under load are drawn
    load_direction: Array | None = None  # (2,) unit vector, of the load's arrow
    control_point: ControlPoint | None = None  # marked where it is now
    magnification: float = 1.0  # of the displacements since settled; without contacts if not 1
    linear: bool = False  # the pose is a velocity field's, see `motion.moved_points`


def draw_mechanism(
    mechanism: Mechanism, path: Path | str, *, title: str = "", scale: str = ""
) -> None:
    """Write a picture: joints that opened in red, those that slid in blue.

    Parameters
    ----------
    path
        PNG file to write.
    title
        Above the picture; the magnification is added where it is not 1.
    scale
        What to say of the displacements' scale, where it is neither true nor a magnification.
    """
    figure = canvas.new_figure(8.0, 8.0)
    axes = figure.subplots()
    plot_mechanism(axes, mechanism)
    magnification = mechanism.magnification
    if not scale:
        scale = (
            "true to scale"
            if magnification == 1.0
            else f"displacements magnified {magnification:g} times"
        )
    figure.suptitle(f"{title} ({scale})" if title else scale, fontsize=11)
    handles, labels = axes.get_legend_handles_labels()
    figure.legend(handles, labels, loc="outside lower center", ncols=4, fontsize=9, frameon=False)
    (left, right), (bottom, top) = axes.get_xlim(), axes.get_ylim()
    beside, around = 0.7, 1.6  # inches for the y axis, and for title, x axis and legend
    height = (8.0 - beside) * (top - bottom) / (right - left) + around
    figure.set_size_inches(8.0, float(np.clip(height, 4.0, 12.0)))
    canvas.save(figure, path)


def readable_magnification(assembly: Assembly, pose: Array, settled: Array | None = None) -> float:
    """1, or a round factor where the displacements are too small to be seen in a picture."""
    outlines = MovingOutlines.of(assembly)
    displacement = outlines.displacement(pose, settled)
    share = float(displacement.max()) / outlines.size()
    if share < NOTHING or share >= 0.02:
        return 1.0
    wanted = 0.05 / share
    power = 10.0 ** np.floor(np.log10(wanted))
    return float(max(step * power for step in (1.0, 2.0, 5.0) if step * power <= wanted))


def plot_mechanism(axes: Axes, mechanism: Mechanism) -> None:
    """Draw a mechanism on given axes, which get equal scales and metres."""
    assembly = mechanism.assembly
    outlines = MovingOutlines.of(assembly, linear=mechanism.linear)
    settled = assembly.rest_pose() if mechanism.settled is None else mechanism.settled
    gone = np.zeros(assembly.n_bodies, np.bool_) if mechanism.gone is None else mechanism.gone
    present = np.where(gone[:, None], settled, mechanism.pose)
    pose = settled + (present - settled) * mechanism.magnification
    displacement = outlines.displacement(pose, settled)
    moving = moving_blocks(displacement, assembly.fixed)
    visible = VISIBLE * float(displacement.max(initial=0.0))

    _plot_blocks(axes, outlines, pose, moving, assembly.fixed, gone)
    if visible > 0.0:
        joints = Joints.of(assembly, linear=mechanism.linear)
        _plot_joints(axes, joints, pose, settled, visible, _line_width(assembly, 3.0))
    if mechanism.contacts is not None and mechanism.magnification == 1.0:
        _plot_contacts(axes, mechanism.contacts)
    if mechanism.control_point is not None:
        _plot_control_point(axes, outlines, mechanism.control_point, pose)
    _frame(axes, outlines, outlines.moved(pose))
    if mechanism.load_direction is not None:
        _plot_load(axes, outlines, mechanism.load_direction)


def _plot_blocks(
    axes: Axes,
    outlines: MovingOutlines,
    pose: Array,
    moving: NDArray[np.bool_],
    fixed: NDArray[np.bool_],
    gone: NDArray[np.bool_],
) -> None:
    from matplotlib.collections import PolyCollection

    designed = outlines.split(outlines.vertices)
    moved = outlines.split(outlines.moved(pose))
    width = float(np.clip(12.0 / np.sqrt(len(moved)), 0.15, 0.9))

    def add(which: NDArray[np.bool_], shapes: list[Array], **style: Any) -> None:
        rows = np.flatnonzero(which)
        if len(rows):
            axes.add_collection(PolyCollection([shapes[i] for i in rows], **style), autolim=False)

    add(
        moving | gone,
        designed,
        facecolors="none",
        edgecolors="#a8a8a8",
        linewidths=max(0.8 * width, 0.3),
        linestyles="--",
        label="as designed",
        zorder=1,
    )
    add(
        ~moving & ~fixed & ~gone,
        moved,
        facecolors=RESTING,
        edgecolors="#555555",
        linewidths=width,
        label="at rest",
        zorder=3,
    )
    add(
        moving,
        moved,
        facecolors=MOVING,
        edgecolors=canvas.INK,
        linewidths=width,
        label="moving",
        zorder=3,
    )
    add(
        fixed,
        moved,
        facecolors=SUPPORT,
        edgecolors="#555555",
        linewidths=width,
        hatch="////",
        label="support",
        zorder=3,
    )


def _plot_joints(
    axes: Axes, joints: Joints, pose: Array, settled: Array, visible: float, width: float
) -> None:
    """Open joints: both faces in red and the gap between them; slid ones: blue and dashed."""
    from matplotlib.collections import LineCollection, PolyCollection

    opening, slip = joints.opening_and_slip(pose, settled)
    face_a, face_b = joints.faces(pose)
    opened = opening > visible
    slid = (slip > visible) & ~opened
    if opened.any():
        gaping = opened & (opening < GAPING * float(np.ptp(face_a, axis=(0, 1)).max()))
        gap = np.concatenate((face_a, face_b[:, ::-1]), axis=1)[gaping]
        axes.add_collection(
            PolyCollection(list(gap), facecolors=OPEN_JOINT, alpha=0.15, linewidths=0.0, zorder=2),
            autolim=False,
        )
        faces = np.concatenate((face_a[opened], face_b[opened]))
        axes.add_collection(
            LineCollection(
                list(faces),
                colors=OPEN_JOINT,
                linewidths=width,
                capstyle="round",
                label="open joint",
                zorder=5,
            ),
            autolim=False,
        )
    if slid.any():
        middle = 0.5 * (face_a[slid] + face_b[slid])
        axes.add_collection(
            LineCollection(
                list(middle),
                colors=SLID_JOINT,
                linewidths=width,
                linestyles=(0, (1.6, 1.0)),
                label="slid joint",
                zorder=5,
            ),
            autolim=False,
        )


def _plot_contacts(axes: Axes, contacts: ContactForces) -> None:
    """Contact points under load, area in proportion to the normal reaction."""
    loaded = contacts.normal_reaction > 0.01 * contacts.normal_reaction.max(initial=0.0)
    if not 0 < np.count_nonzero(loaded) <= MOST_CONTACTS:
        return
    share = contacts.normal_reaction / contacts.normal_reaction.max()
    for which, colour, label in (
        (loaded & (contacts.status != SLIDING), canvas.INK, "contact (area: force)"),
        (loaded & (contacts.status == SLIDING), SLID_JOINT, "sliding contact"),
    ):
        if which.any():
            axes.scatter(
                contacts.position[which, 0],
                contacts.position[which, 1],
                s=3.0 + 60.0 * share[which],
                color=colour,
                linewidths=0.0,
                alpha=0.8,
                label=label,
                zorder=6,
            )


def _plot_control_point(
    axes: Axes, outlines: MovingOutlines, control_point: ControlPoint, pose: Array
) -> None:
    start = np.asarray(control_point.point)
    block = np.array([control_point.block])
    (end,) = moved_points(start[None], block, outlines.centroid, pose, linear=outlines.linear)
    axes.plot(*np.array([start, end]).T, color=canvas.INK, linewidth=1.0, linestyle=":", zorder=7)
    axes.plot(
        *end,
        "o",
        markersize=8,
        markerfacecolor="white",
        markeredgecolor=canvas.INK,
        markeredgewidth=1.6,
        linestyle="none",
        label="control point",
        zorder=8,
    )


def _plot_load(axes: Axes, outlines: MovingOutlines, direction: Array) -> None:
    """An arrow beside the structure, on the side the load comes from; the axes make room for it."""
    lower, upper = outlines.vertices.min(axis=0), outlines.vertices.max(axis=0)
    middle, half = 0.5 * (lower + upper), 0.5 * (upper - lower)
    length = 0.24 * float(half.max())
    reach = min(h / abs(d) for h, d in zip(half, direction, strict=True) if abs(d) > 1e-9)
    tip = middle - direction * (reach + 0.3 * length)
    tail = tip - direction * length
    axes.annotate(
        "",
        xy=tip,
        xytext=tail,
        arrowprops={
            "arrowstyle": "-|>,head_width=0.35,head_length=0.7",
            "linewidth": 2.2,
            "color": canvas.INK,
        },
        zorder=9,
    )
    axes.annotate(
        r"$λ\,W_i$", tail, xytext=(0, 7), textcoords="offset points", fontsize=11, zorder=9
    )
    (left, right), (bottom, top) = axes.get_xlim(), axes.get_ylim()
    room = 0.3 * length
    axes.set_xlim(min(left, tail[0] - room), max(right, tail[0] + room))
    axes.set_ylim(min(bottom, tail[1] - room), max(top, tail[1] + room))


def _box(outlines: MovingOutlines, moved: Array) -> tuple[Array, Array]:
    """Lower left and upper right corner of the picture [m]."""
    lower, upper = outlines.vertices.min(axis=0), outlines.vertices.max(axis=0)
    size = float((upper - lower).max())
    low = np.maximum(np.minimum(lower, moved.min(axis=0)), lower - MARGIN * size) - 0.04 * size
    high = np.minimum(np.maximum(upper, moved.max(axis=0)), upper + MARGIN * size) + 0.04 * size
    return low, high


def _frame(axes: Axes, outlines: MovingOutlines, moved: Array) -> None:
    low, high = _box(outlines, moved)
    axes.set_xlim(low[0], high[0])
    axes.set_ylim(low[1], high[1])
    axes.set_aspect("equal")
    axes.spines[["top", "right"]].set_visible(False)
    axes.tick_params(labelsize=9)
    axes.set_xlabel("x [m]")
    axes.set_ylabel("y [m]")


def _line_width(assembly: Assembly, widest: float) -> float:
    """Thick on a wall of some dozen blocks, thin on one of ten thousand [points]."""
    return float(np.clip(widest * np.sqrt(60.0 / assembly.n_bodies), 0.8, widest))
