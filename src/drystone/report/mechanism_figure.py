"""The mechanism as a picture: blocks where they are, those that move, the joints that opened.

One entry for both dimensions; what is drawn here itself is the plane, `solids_figure` has space.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from drystone.common.arrays import Array, BoolArray
from drystone.contact.forces import SLIDING, ContactForces
from drystone.model.assembly import Assembly
from drystone.report import canvas, marks
from drystone.report.joints import Joints
from drystone.report.load_arrows import DEAD, plot_arrows
from drystone.report.mechanism import (
    OPEN_JOINT,
    SLID_JOINT,
    Drawn,
    Mechanism,
)
from drystone.report.solids_figure import plot_solids
from drystone.results.shapes import MovingShapes

if TYPE_CHECKING:
    from matplotlib.axes import Axes


#: Width of a picture in a page [inches]: half of the page, so that letters keep their size; and of
#: one without letters, whose lines are made finer as it is made smaller.
HALF_PAGE, WITHOUT_LETTERS = 3.6, 8.0
#: Joints that opened by more than this share of the structure's size are not filled: a block fell.
GAPING = 0.25
#: Contact points are drawn up to this many: more would hide the blocks.
MOST_CONTACTS = 3000


def draw_mechanism(
    mechanism: Mechanism,
    path: Path | str,
    *,
    title: str = "",
    scale: str = "",
    format: str = "png",
    width: float = 8.0,
) -> None:
    """Write a picture: joints that opened in red, those that slid in blue.

    Parameters
    ----------
    path
        File to write.
    title
        Above the picture; the magnification is added where it is not 1.
    scale
        What to say of the displacements' scale, where it is neither true nor a magnification.
    format
        Of the file: "png", "svg" or "pdf".
    width
        Of the picture [inches].
    """
    figure = canvas.new_figure(width, width)
    axes = figure.subplots()
    plot_mechanism(axes, mechanism)
    (left, right), (bottom, top) = axes.get_xlim(), axes.get_ylim()
    shape = (top - bottom) / (right - left)
    magnification = mechanism.magnification
    if not scale:
        scale = (
            "true to scale"
            if magnification == 1.0
            else f"displacements magnified {magnification:g} times"
        )
    figure.suptitle(f"{title}\n{scale}" if title else scale, fontsize=11)
    handles, labels = axes.get_legend_handles_labels()
    figure.legend(handles, labels, loc="outside lower center", ncols=4, fontsize=9, frameon=False)
    beside, around = 0.7, 1.9  # inches for the y axis, and for title, scale, x axis and legend
    height = (width - beside) * shape + around
    figure.set_size_inches(width, float(np.clip(height, 0.5 * width, 1.5 * width)))
    canvas.save(figure, path, format)


def mechanism_element(mechanism: Mechanism, label: str) -> str:
    """The picture alone, for a page that has title, legend and scale in words, as an element of it:
    lines in the plane, pixels in space."""
    flat = mechanism.assembly.dimension == 2
    if flat:
        mechanism = replace(mechanism, load_direction=None)  # its letters would be too small
    width = WITHOUT_LETTERS if flat else HALF_PAGE
    figure = canvas.new_figure(width, width)
    axes = figure.subplots()
    plot_mechanism(axes, mechanism)
    axes.set_axis_off()
    (left, right), (bottom, top) = axes.get_xlim(), axes.get_ylim()
    height = width * (top - bottom) / (right - left)
    lowest = 0.0 if flat else 0.5 * width  # letters in space need a margin
    figure.set_size_inches(width, float(np.clip(height, lowest, 1.5 * width)))
    return canvas.element(figure, label, "svg" if flat else "png", 2 * canvas.RESOLUTION)


def plot_mechanism(axes: Axes, mechanism: Mechanism) -> None:
    """Draw a mechanism on given axes, which get equal scales: of the plane in metres, of space as
    it is seen from where its motion shows."""
    drawn = Drawn.of(mechanism)
    if mechanism.assembly.dimension == 3:
        plot_solids(axes, mechanism, drawn)
    else:
        _plot_plane(axes, mechanism, drawn)


def _plot_plane(axes: Axes, mechanism: Mechanism, drawn: Drawn) -> None:
    assembly, shapes = mechanism.assembly, drawn.shapes
    _plot_blocks(axes, drawn, assembly.fixed, mechanism.colours(drawn))
    if drawn.visible > 0.0:
        joints = Joints.of(assembly, linear=mechanism.linear)
        _plot_joints(axes, joints, drawn, _line_width(assembly, 3.0))
    if mechanism.contacts is not None and mechanism.magnification == 1.0:
        _plot_contacts(axes, mechanism.contacts)
    marks.plot_ties(axes, drawn.ties, mechanism.tie_branch)
    plot_arrows(axes, drawn.loads, np.asarray, DEAD, "dead load")
    if mechanism.control_point is not None:
        marks.plot_control_point(axes, drawn.path_of(mechanism.control_point))
    _frame(axes, *drawn.extent())
    if mechanism.load_direction is not None:
        _plot_load(axes, shapes, mechanism.load_direction)


def _plot_blocks(axes: Axes, drawn: Drawn, fixed: BoolArray, colours: Sequence[str]) -> None:
    from matplotlib.collections import PolyCollection

    shapes, moving, departed = drawn.shapes, drawn.moving, drawn.departed
    designed = shapes.split(shapes.vertices)
    moved = shapes.split(shapes.moved(drawn.pose))
    width = float(np.clip(12.0 / np.sqrt(len(moved)), 0.15, 0.9))

    def add(which: BoolArray, outlines: list[Array], **style: Any) -> None:
        rows = np.flatnonzero(which[shapes.body])
        if len(rows):
            if outlines is moved:
                style["facecolors"] = [colours[i] for i in shapes.body[rows].tolist()]
            axes.add_collection(PolyCollection([outlines[i] for i in rows], **style), autolim=False)

    add(
        moving | departed,
        designed,
        facecolors="none",
        edgecolors="#a8a8a8",
        linewidths=max(0.8 * width, 0.3),
        linestyles="--",
        label="as designed",
        zorder=1,
    )
    add(
        ~moving & ~fixed & ~departed,
        moved,
        edgecolors="#555555",
        linewidths=width,
        label="at rest",
        zorder=3,
    )
    add(
        moving,
        moved,
        edgecolors=canvas.INK,
        linewidths=width,
        label="moving",
        zorder=3,
    )
    add(
        fixed,
        moved,
        edgecolors="#555555",
        linewidths=width,
        hatch="////",
        label="support",
        zorder=3,
    )


def _plot_joints(axes: Axes, joints: Joints, drawn: Drawn, width: float) -> None:
    """Open joints: both faces in red and the gap between them; slid ones: blue and dashed."""
    from matplotlib.collections import LineCollection, PolyCollection

    opened, slid = drawn.changed(joints)
    face_a, face_b = joints.faces(drawn.pose)
    if opened.any():
        opening, _ = joints.opening_and_slip(drawn.pose, drawn.initial)
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


def _plot_load(axes: Axes, shapes: MovingShapes, direction: Array) -> None:
    """An arrow beside the structure, on the side the load comes from; the axes are extended."""
    lower, upper = shapes.vertices.min(axis=0), shapes.vertices.max(axis=0)
    middle, half = 0.5 * (lower + upper), 0.5 * (upper - lower)
    length = 0.24 * float(half.max())
    reach = min(h / abs(d) for h, d in zip(half, direction, strict=True) if abs(d) > 1e-9)
    tip = middle - direction * (reach + 0.3 * length)
    tail = tip - direction * length
    marks.plot_load(axes, tail, tip)
    (left, right), (bottom, top) = axes.get_xlim(), axes.get_ylim()
    margin = 0.3 * length
    axes.set_xlim(min(left, tail[0] - margin), max(right, tail[0] + margin))
    axes.set_ylim(min(bottom, tail[1] - margin), max(top, tail[1] + margin))


def _frame(axes: Axes, low: Array, high: Array) -> None:
    axes.set_xlim(low[0], high[0])
    axes.set_ylim(low[1], high[1])
    axes.set_aspect("equal")
    axes.spines[["top", "right"]].set_visible(False)
    axes.tick_params(labelsize=9)
    axes.set_xlabel("x [m]")
    axes.set_ylabel("y [m]")
    canvas.speak_ticks(axes)


def _line_width(assembly: Assembly, widest: float) -> float:
    """Thick on a wall of some dozen blocks, thin on one of ten thousand [points]."""
    return float(np.clip(widest * np.sqrt(60.0 / assembly.n_bodies), 0.8, widest))
