"""What the viewer shows of a folder of results, or of a model at rest: a header and streams.

The header is JSON: names, weights, the curve, marks on it.  The streams are arrays, see `codec`:

    centroid            (n, dim) m from the header's origin
    initial             (n, n_pose) where the load begins, see `geometry.motion`
    vertices, owner     of all blocks, m from their centroids; triangles, edges: rows of these
    motion              (p, c, n) since then: m, and rad of a rotation vector about world axes
    joint_a, joint_b, joint_centre, joint_frame, joint_half, joint_friction
    joint_corners, joint_polygon, joint_owner       polygons of joints, m from block a's centroid
    force, arm, state   (p, c, k) of joints, see `joints.Resultants`
    contact_...         of single contact points, where these are few enough
    tie_force, tie_state                            (p, n_ties) of ties, where there are some

p are the points of the curve that are kept, ``rows`` of the header says which; components come
before blocks and joints, which then lie one after the other.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from drystone.common.arrays import Array, BoolArray, IntArray
from drystone.common.language import Saying, say
from drystone.common.version import package_version
from drystone.contact.forces import ContactForces
from drystone.geometry import motion
from drystone.geometry.interfaces import Interfaces
from drystone.geometry.motion import rotation_vectors
from drystone.geometry.plane.outlines import Outlines
from drystone.geometry.space.polyhedra import Polyhedra
from drystone.io.results.names import RESULTS
from drystone.io.results.results_reader import ResultsReader
from drystone.io.results.summary import plain
from drystone.model.model import Model
from drystone.report.folder.results import Results
from drystone.report.quantities import Quantities
from drystone.report.reaction_figure import marked_points
from drystone.report.viewer import carried
from drystone.report.viewer.bodies import Bodies
from drystone.report.viewer.codec import Pack
from drystone.report.viewer.joints import Assigned, Assigner, Joints, Resultants
from drystone.results.curve import DYNAMIC, CapacityCurve

FORMAT = 1
#: Numbers of a pack up to which they are floats; more are rounded to 16 bits.
MOST_FLOATS = 1_500_000
#: Numbers of a pack at most: of longer curves or larger structures points are left out.
MOST_NUMBERS = 6_500_000
#: Points below which none are left out.
FEWEST_POINTS = 60
#: Single contact points at most, over all points of the curve; with more there are resultants only.
MOST_CONTACTS = 250_000
#: Contact points that are worked on at once.
BATCH = 300_000
#: Sentences that name reactions of supports that move.
REACTIONS = {
    "first": "mark.first_reaction",
    "least": "mark.least_reaction",
    "greatest": "mark.greatest_reaction",
    "last": "mark.last_reaction",
}
#: Bits that are kept of a centre of pressure: 1/2000 of the largest arm.
BITS_OF_ARMS = 12


@dataclass(frozen=True, kw_only=True)
class Mark:
    """A place on the curve that has a name."""

    name: str
    control_displacement: float  # m
    load_multiplier: float
    kind: str  # "peak", "rest", "ultimate", "event" or "limit"


@dataclass(frozen=True, kw_only=True)
class Contents:
    """What a page shows."""

    header: dict[str, Any]
    pack: Pack


def contents_of_folder(
    results: Results,
    *,
    marks: Sequence[Mark] = (),
    macro_blocks: Mapping[str, Sequence[int]] | None = None,
) -> Contents:
    """What there is to show of a folder of results, of its ``results.h5`` alone.

    Parameters
    ----------
    results
        Of `load_results`; a run that goes on or was killed has the points that it reached.
    marks
        More of them than peak and end of the curve: limit states.
    macro_blocks
        Numbers of the macro-blocks that blocks belong to, -1 of those at rest, by the name of the
        state in which they were found.
    """
    with ResultsReader(results.path / RESULTS) as reader:
        curve = results.curve
        blocks = _Blocks.stored(reader.blocks(), results.model)
        own = marks_of(curve)
        joints = blocks.joints()
        rows = _kept(curve, [*own, *marks], blocks.n_numbers + 5 * len(joints))
        pack = Pack()
        header = {
            **_about(reader, results),
            **blocks.header(),
            "curve": _curve(curve, rows) if rows else None,
            "marks": [_mark(mark, curve, rows) for mark in (*own, *marks)],
            "left": _left(curve, blocks.names, rows),
            "macro_blocks": {k: list(map(int, v)) for k, v in (macro_blocks or {}).items()},
        }
        poses = results.poses
        initial = poses[rows[0]] if len(rows) else blocks.design_pose()
        blocks.put(pack, initial)
        if len(rows):
            counts = reader.n_contacts()
            _put_states(pack, reader, blocks, joints, poses[rows], np.array(rows), counts)
            carried.put_ties(pack, curve, rows)
            header["all_contacts"] = int(counts[rows].sum()) <= MOST_CONTACTS
        _put_joints(pack, joints, blocks, results.model)
    return Contents(header=plain(header), pack=pack)


def contents_of_model(model: Model) -> Contents:
    """A model at rest: blocks and joints as designed."""
    blocks, pack = _Blocks.designed(model), Pack()
    joints = blocks.joints()
    blocks.put(pack, blocks.design_pose())
    _put_joints(pack, joints, blocks, model)
    header = {
        "format": FORMAT,
        "title": model.title,
        "version": package_version(),
        "model_sha256": model.sha256,
        "status": "at rest",
        "reason": "the model as designed, before it is run",
        **_of_model(model, blocks.origin),
        **blocks.header(),
        "curve": None,
        "marks": [],
        "left": {},
        "macro_blocks": {},
    }
    return Contents(header=plain(header), pack=pack)


def marks_of(curve: CapacityCurve) -> list[Mark]:
    """Peak, first collapse of a part and ultimate displacement of a curve, those that it has."""
    if not curve.points:
        return []
    if curve.moves_supports:
        return [*_reactions(curve), *_first_collapse(curve)]
    peaks = [(curve.name_of_peak, curve.peak, "peak")]
    if curve.rises_after_collapse:
        peaks = [
            (say("mark.capacity"), curve.capacity, "peak"),
            (curve.name_of_peak, curve.peak, "rest"),
        ]
    found = [
        Mark(
            name=name,
            control_displacement=peak.control_displacement,
            load_multiplier=peak.load_multiplier,
            kind=kind,
        )
        for name, peak, kind in peaks
    ]
    found += _first_collapse(curve)
    if curve.ultimate_displacement is not None:
        found.append(
            Mark(
                name=say("mark.ultimate"),
                control_displacement=curve.ultimate_displacement,
                load_multiplier=curve.stop_multiplier,
                kind="ultimate",
            )
        )
    return found


def _reactions(curve: CapacityCurve) -> list[Mark]:
    """First, least, greatest and last reaction of supports that move."""
    return [
        Mark(
            name=_reaction(names),
            control_displacement=point.control_displacement,
            load_multiplier=point.load_multiplier,
            kind="rest",
        )
        for names, point in marked_points(curve)
    ]


def _reaction(names: Sequence[str]) -> Saying:
    """What a reaction is called that is the first, the least, and so on."""
    *others, last = (say(REACTIONS[name]) for name in names)
    for name in reversed(others):
        last = say("mark.and", first=name, second=last)
    return last


def _first_collapse(curve: CapacityCurve) -> list[Mark]:
    first = curve.first_collapse
    if first is None:
        return []
    return [
        Mark(
            name=first.what,
            control_displacement=first.control_displacement,
            load_multiplier=first.load_multiplier,
            kind="event",
        )
    ]


@dataclass(frozen=True, kw_only=True)
class _Blocks:
    """Blocks as designed, from a file of results or from a model."""

    dimension: int
    names: list[str]
    centroid: Array
    weight: Array
    support: BoolArray
    bodies: Bodies
    packed: Outlines | Polyhedra | None  # convex parts, of which joints are found
    origin: Array

    @classmethod
    def stored(cls, found: Mapping[str, Any], model: Model | None) -> _Blocks:
        centroid, vertices, offset = found["centroid"], found["vertices"], found["offset"]
        body = found.get("body", np.arange(len(centroid)))
        packed: Outlines | Polyhedra | None = None
        if centroid.shape[1] == 3:
            packed = Polyhedra(
                vertices=vertices,
                offset=offset,
                rows=found["rows"],
                face_offset=found["face_offset"],
                part_faces=found["part_faces"],
                body=body,
            )
            bodies = Bodies.of_solids(packed)
        else:
            bodies = Bodies.of_outlines(vertices, offset, body)
            packed = model.assembly.outlines if model is not None else None
        return cls(
            dimension=centroid.shape[1],
            names=[name.decode() for name in found["id"]],
            centroid=centroid,
            weight=found["weight"],
            support=found["support"],
            bodies=bodies,
            packed=packed,
            origin=_origin(vertices),
        )

    @classmethod
    def designed(cls, model: Model) -> _Blocks:
        assembly = model.assembly
        packed = assembly.packed
        if isinstance(packed, Polyhedra):
            bodies = Bodies.of_solids(packed)
        else:
            outlines = Outlines.pack(
                [[shape.vertices for shape in block.parts or (block,)] for block in assembly.blocks]
            )
            bodies = Bodies.of_outlines(outlines.vertices, outlines.offset, outlines.body)
        return cls(
            dimension=assembly.dimension,
            names=list(assembly.ids),
            centroid=assembly.centroid,
            weight=assembly.weight,
            support=assembly.fixed,
            bodies=bodies,
            packed=packed,
            origin=_origin(bodies.vertices),
        )

    @property
    def n_numbers(self) -> int:
        """Of the state of the blocks at one point."""
        return len(self.names) * motion.n_dof(self.dimension)

    def design_pose(self) -> Array:
        return motion.design_pose(len(self.names), self.dimension)

    def joints(self) -> Joints:
        return Joints.designed(Interfaces.of(self.packed)) if self.packed is not None else Joints()

    def header(self) -> dict[str, Any]:
        return {
            "dimension": self.dimension,
            "origin": self.origin,
            "blocks": {"name": self.names, "weight": _short(self.weight), "support": self.support},
        }

    def put(self, pack: Pack, initial: Array) -> None:
        bodies = self.bodies
        pack.put("centroid", self.centroid - self.origin, "f4")
        pack.put("initial", initial, "f4")
        pack.put("vertices", bodies.vertices - self.centroid[bodies.owner], "f4")
        pack.put("owner", bodies.owner, "u4")
        pack.put("triangles", bodies.triangles, "u4")
        pack.put("edges", bodies.edges, "u4")


def _origin(vertices: Array) -> Array:
    """Lower middle of the structure [m]: what is near it keeps its digits in a float."""
    low, high = vertices.min(axis=0), vertices.max(axis=0)
    middle = 0.5 * (low + high)
    middle[-1] = low[-1]
    return np.asarray(middle)


def _about(reader: ResultsReader, results: Results) -> dict[str, Any]:
    curve, model = results.curve, results.model
    about = {
        "format": FORMAT,
        "title": str(reader.attribute("title")),
        "engine": curve.engine,
        "strategy": curve.strategy,
        "status": curve.status,
        "reason": curve.reason,
        "version": str(reader.attribute("version")),
        "model_sha256": str(reader.attribute("model_sha256")),
    }
    if model is not None:
        about |= _of_model(model, _origin(_all_vertices(reader.blocks())))
    return about


def _all_vertices(found: Mapping[str, Any]) -> Array:
    return np.asarray(found["vertices"])


def _of_model(model: Model, origin: Array) -> dict[str, Any]:
    control = model.control_point
    return {
        **carried.header_of(model, origin),
        "load_direction": model.load_shown,
        "control": None
        if model.settlement is not None
        else {
            "block": control.block,
            "point": control.point - origin,
            "direction": control.direction,
        },
    }


def _kept(curve: CapacityCurve, marks: Iterable[Mark], n_numbers: int) -> list[int]:
    """Rows of the points that are shown: all, or evenly some, with marked ones and both ends."""
    n = len(curve.points)
    most = max(MOST_NUMBERS // max(n_numbers, 1), FEWEST_POINTS)
    if n <= most:
        return list(range(n))
    kept = {int(row) for row in np.linspace(0, n - 1, most - 8).round()}
    kept |= {nearest(curve, mark) for mark in marks}
    return sorted(kept)


def nearest(curve: CapacityCurve, mark: Mark) -> int:
    """Row of the point nearest to a mark, in shares of the curve's extent."""
    x, y = curve.control_displacement, curve.load_multiplier
    wide, high = max(float(np.ptp(x)), 1e-300), max(float(np.ptp(y)), 1e-300)
    apart = np.hypot((x - mark.control_displacement) / wide, (y - mark.load_multiplier) / high)
    return int(np.argmin(apart))


def _curve(curve: CapacityCurve, rows: list[int]) -> dict[str, Any]:
    points = [curve.points[row] for row in rows]
    shown = Quantities.of(curve)
    return {
        "axes": {
            "motion": shown.motion,
            "motion_unit": shown.motion_unit,
            "force": shown.force,
            "force_unit": shown.force_unit,
        },
        "n_points": len(curve.points),
        "step": [point.step for point in points],
        "displacement": _short(shown.x(curve)[rows]),
        "multiplier": _short(shown.y(curve)[rows]),
        "dynamic": [point.status == DYNAMIC for point in points],
        "unstable": [point.unstable for point in points],
        "residual": _short([point.residual for point in points]),
        "stop_multiplier": curve.stop_multiplier,
    }


def _mark(mark: Mark, curve: CapacityCurve, rows: list[int]) -> dict[str, Any]:
    row = nearest(curve, mark)
    shown, height = Quantities.of(curve), mark.load_multiplier
    return {
        "name": mark.name,
        "kind": mark.kind,
        "displacement": shown.per_unit * mark.control_displacement,
        "multiplier": float(shown.y(curve)[row]) if shown.moves_supports else height,
        "point": int(np.argmin(np.abs(np.array(rows) - row))),
    }


def _left(curve: CapacityCurve, names: Sequence[str], rows: list[int]) -> dict[str, int]:
    """By the row of a block that has left, the first point that is without it."""
    steps = [curve.points[row].step for row in rows]
    row_of = {name: i for i, name in enumerate(names)}
    return {
        str(row_of[block.block]): int(np.searchsorted(steps, block.step, side="left"))
        for block in curve.blocks_left
        if block.block in row_of
    }


def _short(values: Any) -> list[float]:
    """Numbers with seven digits, which is what a float holds."""
    return [float(f"{value:.7g}") for value in np.asarray(values, np.float64).tolist()]


# Many: what is written, of what, and of which points.
def _put_states(
    pack: Pack,
    reader: ResultsReader,
    blocks: _Blocks,
    joints: Joints,
    poses: Array,
    rows: IntArray,
    counts: IntArray,
) -> None:
    """Motions of the blocks, forces in the joints, and the contact points one by one if few."""
    assigner = Assigner(joints, blocks.centroid)
    parts: list[Assigned] = []
    for batch in _batches(counts[rows]):
        contacts = (
            _joined([reader.contacts_between(k, k + 1) for k in rows[batch]])
            if (np.any(np.diff(rows[batch]) != 1))
            else reader.contacts_between(int(rows[batch][0]), int(rows[batch][-1]) + 1)
        )
        parts.append(assigner.assign(contacts, counts[rows[batch]], poses[batch]))
    carried = Resultants.of(parts, len(rows), len(joints), blocks.dimension)
    motion = _since(poses, poses[0])
    many = motion.size + carried.force.size + carried.arm.size > MOST_FLOATS
    pack.put_varying("motion", motion, rounded=many)
    pack.put_varying("force", carried.force, rounded=many)
    pack.put_varying("arm", carried.arm, rounded=many, bits=BITS_OF_ARMS)
    pack.put("state", carried.state, "u1", varying=True)
    if int(counts[rows].sum()) <= MOST_CONTACTS:
        pack.put("contact_count", counts[rows], "u4")
        pack.put("contact_joint", np.concatenate([part.joint for part in parts]), "u4")
        pack.put("contact_arm", np.vstack([part.arm for part in parts]), "f4")
        pack.put("contact_force", np.vstack([part.force for part in parts]), "f4")


def _batches(counts: IntArray) -> list[slice]:
    """Points whose contacts are worked on together."""
    found, first, waiting = [], 0, 0
    for k, count in enumerate(counts.tolist()):
        waiting += count
        if waiting > BATCH or k == len(counts) - 1:
            found.append(slice(first, k + 1))
            first, waiting = k + 1, 0
    return found


def _joined(parts: Sequence[ContactForces]) -> ContactForces:
    names = tuple(ContactForces.__dataclass_fields__)
    return ContactForces(**{n: np.concatenate([getattr(p, n) for p in parts]) for n in names})


def _since(poses: Array, initial: Array) -> Array:
    """Motions (p, n, n_dof) since the poses ``initial`` (n, n_pose): translations, rotations."""
    if poses.shape[2] == 3:
        return poses - initial
    moved = np.zeros((*poses.shape[:2], 6))
    moved[..., :3] = poses[..., :3] - initial[:, :3]
    w, v = initial[:, 3], -initial[:, 4:]  # the inverse rotation
    p, q = poses[..., 3], poses[..., 4:]
    relative = np.zeros_like(poses)
    relative[..., 3] = p * w - np.einsum("pni,ni->pn", q, v)
    relative[..., 4:] = p[..., None] * v + w[:, None] * q + np.cross(q, v)
    moved[..., 3:] = rotation_vectors(relative.reshape(-1, 7)).reshape(*poses.shape[:2], 3)
    return moved


def _put_joints(pack: Pack, joints: Joints, blocks: _Blocks, model: Model | None) -> None:
    k, dim = len(joints), blocks.dimension
    a, b = np.array(joints.block_a, np.int64), np.array(joints.block_b, np.int64)
    friction = np.full(k, np.nan)
    if model is not None and k:
        laws = np.array([law.friction_coefficient for law in model.assembly.laws])
        friction = laws[model.assembly.law_index(a, b)]
    centre = np.array(joints.centre).reshape(k, dim) - blocks.centroid[a]
    polygons = [(j, polygon) for j, own in enumerate(joints.polygons) for polygon in own]
    corners = [polygon - blocks.centroid[a[j]] for j, polygon in polygons]
    pack.put("joint_a", a, "u4")
    pack.put("joint_b", b, "u4")
    pack.put("joint_centre", centre, "f4")
    pack.put("joint_frame", np.array(joints.frame).reshape(k, dim * dim), "f4")
    pack.put("joint_half", np.array(joints.half).reshape(k, dim - 1), "f4")
    pack.put("joint_friction", friction, "f4")
    pack.put("joint_corners", np.vstack([np.zeros((0, dim)), *corners]), "f4")
    pack.put("joint_polygon", np.cumsum([0, *(len(own) for own in corners)]), "u4")
    pack.put("joint_owner", np.array([j for j, _ in polygons], np.int64), "u4")
