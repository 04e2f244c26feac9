"""The mechanism of a structure in space as a picture: hidden surfaces right, drawn to one scale.

The blocks are pixels of a depth buffer, with lines where what is seen changes from one surface to
another; marks and letters are drawn over them as in the plane.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from drystone.common.arrays import Array, BoolArray, IntArray
from drystone.geometry.space.polyhedra import Polyhedra
from drystone.model.assembly import Assembly
from drystone.report import canvas, marks, raster
from drystone.report.camera import Camera
from drystone.report.load_arrows import DEAD, plot_arrows
from drystone.report.mechanism import (
    MOVING,
    OPEN_JOINT,
    RESTING,
    SLID_JOINT,
    SUPPORT,
    Drawn,
    Mechanism,
)
from drystone.report.raster import NOTHING, Frame, Seen
from drystone.report.solid_joints import SolidJoints

if TYPE_CHECKING:
    from matplotlib.axes import Axes

Colours = NDArray[np.float32]

#: Pixels of the longer side of the picture, and by how many times finer it is drawn first.
PIXELS, FINER = 1000, 2
#: Brightness of a face by its direction: what looks away from the light has the darkest.
DARKEST = 0.78
GHOST, CREASE = "#8c8c8c", 0.72
#: Structures of fewer blocks than these have bolder lines.
FEW, MANY = 150, 800
#: Faces of one block in one plane are one surface: steps of directions and of lengths over the
#: structure's size.
SAME = 1e-4
#: Pieces of a line, four fine pixels each, that may show at the rim of what hides it.
HEM = 2
#: Spacing of the hatch on supports, and of the dashes of designed outlines [fine pixels].
HATCH, DASH = 22, 14


@dataclass(frozen=True, kw_only=True, eq=False)
class _View:
    """A camera, its frame and the faces of a structure."""

    camera: Camera
    frame: Frame
    polyhedra: Polyhedra

    def look(self, vertices: Array, bodies: BoolArray) -> Seen:
        """What is seen of ``bodies`` (n,) with their ``vertices`` (n_vertices, 3) [m] there."""
        solids = self.polyhedra
        faces = np.flatnonzero(bodies[self.body])
        places = self.camera.seen(vertices)
        return raster.look(places, solids.rows, solids.face_offset, self.frame, faces)

    @property
    def body(self) -> IntArray:
        """Row of the block that each face belongs to, (n_faces,)."""
        return np.repeat(self.polyhedra.body, np.diff(self.polyhedra.part_faces))


def plot_solids(axes: Axes, mechanism: Mechanism, drawn: Drawn) -> None:
    """Draw a mechanism in space on given axes, which get equal scales and no ticks."""
    from matplotlib.colors import to_rgb

    assembly, shapes = mechanism.assembly, drawn.shapes
    vertices = shapes.moved(drawn.pose)
    sides = np.ptp(shapes.vertices[~assembly.fixed[shapes.owner]], axis=0)
    camera = Camera.before(sides, mechanism.load_direction)
    low, high = drawn.extent(camera.seen)
    pixel = float((high - low).max()) / (PIXELS * FINER)
    columns, rows = (np.ceil((high - low) / (pixel * FINER)).astype(int) * FINER).tolist()
    frame = Frame(low=low, pixel=pixel, shape=(rows, columns))
    view = _View(camera=camera, frame=frame, polyhedra=assembly.polyhedra)

    seen = view.look(vertices, ~drawn.departed)
    of_block = np.array([to_rgb(name) for name in mechanism.colours(drawn)], np.float32)
    colours = _coloured(view, seen, vertices, of_block, assembly.fixed)
    _add_ghost(view, seen, colours, shapes.vertices, drawn.moving | drawn.departed)
    extent = (low[0], low[0] + columns * pixel, low[1], low[1] + rows * pixel)
    picture = raster.reduced(colours, FINER).clip(0.0, 1.0)
    axes.imshow(picture, extent=extent, origin="lower", interpolation="antialiased", zorder=1)
    _label_blocks(axes, drawn, assembly)
    if drawn.visible > 0.0:
        _plot_joints(axes, view, seen, SolidJoints.of(assembly, linear=shapes.linear), drawn)
    flat = camera.seen(drawn.ties)[..., :2]
    marks.plot_ties(axes, flat, mechanism.tie_branch)
    plot_arrows(axes, drawn.loads, camera.seen, DEAD, "dead load")
    if mechanism.control_point is not None:
        path = drawn.path_of(mechanism.control_point)
        marks.plot_control_point(axes, camera.seen(path)[:, :2])
    axes.set_xlim(extent[:2])
    axes.set_ylim(extent[2:])
    axes.set_aspect("equal")
    axes.set_axis_off()
    if mechanism.load_direction is not None:
        _plot_load(axes, camera, shapes.vertices[~assembly.fixed[shapes.owner]], mechanism)
    _plot_scale(axes, camera, float(sides.max()), seen)


def _coloured(
    view: _View, seen: Seen, vertices: Array, of_block: Colours, fixed: BoolArray
) -> Colours:
    """Shaded faces, hatched supports, dark lines between blocks and lighter ones within them."""
    from matplotlib.colors import to_rgb

    body, normals = view.body, _normals(view.polyhedra, vertices)
    light = 0.9 * view.camera.towards + 0.75 * view.camera.up - 0.3 * view.camera.right
    shade = DARKEST + (1.0 - DARKEST) * np.clip(normals @ light / np.linalg.norm(light), 0.0, 1.0)
    # Row -1 is the paper.
    of_face = np.vstack((of_block[body] * shade[:, None].astype(np.float32), np.ones(3)))
    colours = of_face.astype(np.float32)[seen.face]

    hatched = np.append(fixed[body], False)[seen.face]
    x, y = np.arange(seen.face.shape[1]), np.arange(seen.face.shape[0])
    hatched &= (x + y[:, None]) % HATCH < HATCH // 6
    colours[hatched] *= np.float32(0.82)

    surface = np.append(_surfaces(view.polyhedra, body), NOTHING)[seen.face]
    whole = np.append(body, NOTHING)[seen.face]
    ink = np.array(to_rgb(canvas.INK), np.float32)
    crease = np.logical_or(*raster.rims(surface))
    colours[crease] *= np.float32(CREASE)
    right, below = raster.rims(whole)
    outline = right | below
    if len(of_block) < MANY:
        outline[:, 1:] |= right[:, :-1]
        outline[:-1] |= below[1:]
    if len(of_block) < FEW:
        outline[:, 1:] |= outline[:, :-1]
        outline[:-1] |= outline[1:]
    colours[outline] = ink
    return colours


def _normals(solids: Polyhedra, vertices: Array) -> Array:
    """Unit normals of the moved faces, (n_faces, 3)."""
    start, end = vertices[solids.rows], vertices[solids.following]
    first = vertices[solids.rows[solids.face_offset[:-1]]][solids.face_of_edge]
    area = np.add.reduceat(np.cross(start - first, end - first), solids.face_offset[:-1])
    return np.asarray(area / np.linalg.norm(area, axis=1)[:, None])


def _surfaces(solids: Polyhedra, body: IntArray | None) -> IntArray:
    """Numbers of the surfaces that faces belong to, (n_faces,): one for all faces of a block in one
    plane, or, without blocks, of all faces in one plane."""
    size = float(np.ptp(solids.vertices, axis=0).max())
    offset = np.sum(solids.normals * solids.discs[:, :3], axis=1) / size
    key = np.rint(np.column_stack((solids.normals, offset)) / SAME)
    if body is not None:
        key = np.column_stack((key, body))
    return np.unique(key, axis=0, return_inverse=True)[1].ravel().astype(np.int64)


def _add_ghost(
    view: _View, seen: Seen, colours: Colours, designed: Array, bodies: BoolArray
) -> None:
    """Dashed lines around the designed places of what has moved, where nothing is before them.

    The bodies count as one, so that their joints are not drawn.
    """
    from matplotlib.colors import to_rgb

    if not bodies.any():
        return
    ghost = view.look(designed, bodies)
    surface = np.append(_surfaces(view.polyhedra, None), NOTHING)[ghost.face]
    right, below = raster.rims(surface)
    line = right | below
    line[:, 1:] |= right[:, :-1]
    line[:-1] |= below[1:]
    # Of two pixels at a rim the nearer surface's counts.
    near = ghost.nearness.copy()
    for _ in range(2):
        near[:, 1:] = np.maximum(near[:, 1:], near[:, :-1])
        near[:, :-1] = np.maximum(near[:, :-1], near[:, 1:])
        near[1:] = np.maximum(near[1:], near[:-1])
        near[:-1] = np.maximum(near[:-1], near[1:])
    line &= near >= seen.nearness - np.float32(2.0 * view.frame.pixel)
    line &= _dashes(view)
    colours[line] = np.array(to_rgb(GHOST), np.float32)


def _dashes(view: _View) -> BoolArray:
    """Where dashed lines have ink: stripes across which no edge along x, y or z runs."""
    rows, columns = view.frame.shape
    edges = view.camera.seen(np.eye(3))[:, :2]
    edges /= np.maximum(np.linalg.norm(edges, axis=1), 1e-9)[:, None]
    angle = np.radians(np.arange(0.0, 180.0, 5.0))
    across = np.column_stack((np.cos(angle), np.sin(angle)))
    cx, cy = across[int(np.argmax(np.abs(across @ edges.T).min(axis=1)))].tolist()
    place = cx * np.arange(columns) + (cy * np.arange(rows))[:, None]
    return np.asarray(np.mod(place, 2.0 * DASH) < 1.2 * DASH)


def _label_blocks(axes: Axes, drawn: Drawn, assembly: Assembly) -> None:
    """Entries of the legend, as in the plane."""
    from matplotlib.collections import PolyCollection

    resting = ~drawn.moving & ~assembly.fixed & ~drawn.departed
    for shown, label, face, edge, more in (
        (drawn.moving | drawn.departed, "as designed", "none", GHOST, {"linestyles": "--"}),
        (resting, "at rest", RESTING, "#555555", {}),
        (drawn.moving, "moving", MOVING, canvas.INK, {}),
        (assembly.fixed, "support", SUPPORT, "#555555", {"hatch": "////"}),
    ):
        if shown.any():
            style: dict[str, Any] = {
                "facecolors": face,
                "edgecolors": edge,
                "linewidths": 0.9,
                **more,
            }
            axes.add_collection(PolyCollection([], label=label, **style), autolim=False)


def _plot_joints(axes: Axes, view: _View, seen: Seen, joints: SolidJoints, drawn: Drawn) -> None:
    """Rims of opened joints on both blocks in red, those of slid ones in blue, where seen."""
    from matplotlib.collections import LineCollection

    opened, slid = drawn.changed(joints)
    width = float(np.clip(2.2 * np.sqrt(60.0 / len(drawn.departed)), 0.7, 2.2))
    for which, colour, label, style in (
        (opened, OPEN_JOINT, "open joint", "solid"),
        (slid, SLID_JOINT, "slid joint", (0, (1.6, 1.0))),
    ):
        segments = joints.rims(which, drawn.pose)
        lines = _visible(view, seen, segments) if len(segments) else []
        if lines:
            axes.add_collection(
                LineCollection(
                    lines,
                    colors=colour,
                    linewidths=width,
                    linestyles=[style],
                    capstyle="round",
                    label=label,
                    zorder=5,
                ),
                autolim=False,
            )


def _visible(view: _View, seen: Seen, segments: Array) -> list[Array]:
    """The parts of segments (k, 2, 3) [m] that nothing covers, each (2, 2) in the picture [m]."""
    step = 4.0 * view.frame.pixel
    places = view.camera.seen(segments)
    length = np.linalg.norm(places[:, 1, :2] - places[:, 0, :2], axis=1)
    count = np.maximum(np.ceil(length / step), 1.0).astype(np.int64)
    owner = np.repeat(np.arange(len(segments)), count)
    first = np.cumsum(count) - count
    share = (np.arange(len(owner)) - first[owner] + 0.5) / count[owner]
    way = places[:, 1] - places[:, 0]
    shown = seen.before(places[owner, 0] + share[:, None] * way[owner], 2.0 * view.frame.pixel)
    # Runs of shown pieces: where one begins, and where it ends.
    before = np.append(False, shown[:-1] & (owner[1:] == owner[:-1]))
    after = np.append(shown[1:] & (owner[1:] == owner[:-1]), False)
    begins, ends = np.flatnonzero(shown & ~before), np.flatnonzero(shown & ~after)
    # What shows at an end of a hidden segment is the rim of what hides it.
    kept = (ends - begins + 1 > HEM) | (count[owner[begins]] <= 2 * HEM)
    begins, ends = begins[kept], ends[kept]
    row = owner[begins]
    start, stop = (begins - first[row]) / count[row], (ends - first[row] + 1) / count[row]
    lines = places[row, 0][:, None] + np.stack((start, stop), axis=1)[..., None] * way[row, None]
    return list(lines[..., :2])


def _plot_load(axes: Axes, camera: Camera, free: Array, mechanism: Mechanism) -> None:
    """An arrow over the structure, where no block hides it; the axes are extended."""
    direction = np.asarray(mechanism.load_direction)
    lower, upper = free.min(axis=0), free.max(axis=0)
    size = float((upper - lower).max())
    length = 0.24 * size
    middle = 0.5 * (lower + upper)
    middle[2] = upper[2] + 0.14 * size + 0.5 * length * abs(float(direction[2]))
    ends = np.array([middle - 0.5 * length * direction, middle + 0.5 * length * direction])
    tail, tip = camera.seen(ends)[:, :2]
    marks.plot_load(axes, tail, tip)
    (left, right), (bottom, top) = axes.get_xlim(), axes.get_ylim()
    margin = 0.4 * length
    axes.set_xlim(
        min(left, tail[0] - margin, tip[0] - margin), max(right, tail[0] + margin, tip[0])
    )
    axes.set_ylim(bottom, max(top, tail[1] + margin, tip[1] + margin))


def _plot_scale(axes: Axes, camera: Camera, size: float, seen: Seen) -> None:
    """The directions of x, y and z, each as long as is written below; where blocks are in the
    corner the axes are extended under it."""
    length = _round_length(0.16 * size)
    arms: Any = camera.seen(length * np.eye(3))[:, :2]
    left, (bottom, top) = axes.get_xlim()[0], axes.get_ylim()
    margin = 0.25 * length
    low, high = np.minimum(arms.min(axis=0), 0.0), np.maximum(arms.max(axis=0), 0.0)
    wide, tall = high - low + (3.0 * margin, 2.0 * margin + 0.06 * (top - bottom))
    if _is_taken(seen, np.array([left, bottom]), np.array([left + wide, bottom + tall])):
        bottom -= tall
        axes.set_ylim(bottom, top)
    origin: Any = np.array([left + 1.5 * margin, bottom]) - low
    origin[1] += 0.06 * (top - bottom)
    for name, arm in zip("xyz", arms, strict=True):
        arrow = {"arrowstyle": "-|>", "linewidth": 1.2, "color": canvas.INK, "shrinkA": 0}
        axes.annotate("", origin + arm, origin, arrowprops={**arrow, "shrinkB": 0}, zorder=9)
        away = arm / max(float(np.linalg.norm(arm)), 1e-9)
        axes.annotate(
            name, origin + arm, xytext=8.0 * away, textcoords="offset points",
            ha="center", va="center", fontsize=9, zorder=9,
        )  # fmt: skip
    axes.annotate(
        f"{length:g} m each", (left, bottom), xytext=(3, 3), textcoords="offset points",
        fontsize=9, bbox=canvas.BACKING, zorder=9,
    )  # fmt: skip


def _is_taken(seen: Seen, low: Array, high: Array) -> bool:
    """Whether something is drawn between two corners (2,) of the picture [m]."""
    corners = np.column_stack((np.array([low, high]), np.zeros(2)))
    (left, bottom), (right, top) = seen.frame.at(corners).clip(0.0).astype(int).tolist()
    return bool((seen.face[bottom : top + 1, left : right + 1] != NOTHING).any())


def _round_length(wanted: float) -> float:
    """1, 2 or 5 times a power of ten, not above ``wanted`` [m]."""
    power = 10.0 ** np.floor(np.log10(wanted))
    return float(max(step * power for step in (1.0, 2.0, 5.0) if step * power <= wanted))
