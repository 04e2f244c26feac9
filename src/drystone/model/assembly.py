"""Blocks and joints: what is designed, as plain arrays that kernels can take.

Axes: in the plane x to the right, y up; in space z up.  Gravity acts against the last one.  How
blocks move, and what a pose is, see `geometry.motion`.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Any, cast

import numpy as np

from drystone.common.arrays import Array, BoolArray, IntArray
from drystone.common.language import say
from drystone.common.names import Named
from drystone.geometry import GeometryError, motion
from drystone.geometry.cores import SolidCore
from drystone.geometry.dimension import Dimension, dimension_of
from drystone.geometry.figure import Figure
from drystone.geometry.interfaces import Interfaces
from drystone.geometry.plane.outlines import Outlines
from drystone.geometry.plane.polygon import Core
from drystone.geometry.space.polyhedra import Polyhedra
from drystone.geometry.space.solid import Faces, Part
from drystone.model.joint_law import JointLaw, Yielding

#: Standard acceleration of gravity in this project [m/s2], the value the published runs used.
GRAVITY = 9.81


#: Who is in the first group of a pair, (n,), who in the second, and the number of the law.
_OfGroups = tuple[BoolArray, BoolArray, int]


@dataclass(frozen=True, kw_only=True)
class Corner:
    """Treatment of the corners of every block for contact. The mass of a block does not depend
    on it."""

    radius: float | None = None  # m, rounded
    chamfer: float | None = None  # m, cut off at 45 degrees in a right corner

    @property
    def words(self) -> str:
        """How they are, in a word or two."""
        if self.radius:
            return say("corner.rounded", size=self.radius)
        return say("corner.chamfered", size=self.chamfer) if self.chamfer else say("corner.sharp")

    def cores(self, figure: Figure) -> tuple[Core, ...] | tuple[SolidCore, ...]:
        """Contact shapes of a block's parts; raises `GeometryError` where nothing is left."""
        return figure.cores(radius=self.radius, chamfer=self.chamfer)


#: Mass of what is held over the block's own: a step of 30 s moves it by 1e-14 m under a hundred
#: weights.
RESTRAINED_MASS = 1e20


def crushes(laws: Sequence[JointLaw]) -> bool:
    """Whether joints of any law are crushed."""
    return any(Yielding.CRUSH.of(law) for law in laws)


def usual_points(dimension: int, laws: Sequence[JointLaw]) -> int:
    """Contact points of an interface where nothing is said, of structures with these joints."""
    kind = dimension_of(dimension)
    crushed = crushes(laws)
    return kind.points_if_crushed if crushed else kind.points


def _restrained(blocks: Sequence[Block], dimension: Dimension) -> BoolArray:
    """What rollers hold, (n, n_dof)."""
    restrained = np.zeros((len(blocks), motion.n_dof(dimension.number)), np.bool_)
    for row, block in zip(restrained, blocks, strict=True):
        for name in () if block.support else block.held:
            at = dimension.motions.index(name)
            row[at : None if name == "turn" else at + 1] = True
    return restrained


@dataclass(frozen=True, kw_only=True, eq=False)
class Block:
    """One block as designed: a shape of one material, movable or a support.

    A concave block is cut into convex parts that move as one. If the parts are given, `vertices`
    are those of all parts, one after the other.
    """

    id: str
    vertices: Array  # (n, dim) m; in the plane around the outline, counter-clockwise
    unit_weight: float  # N/m3
    material: str = ""
    support: bool = False
    faces: Faces = ()  # of space: rows of vertices, counter-clockwise from outside; none: the hull
    parts: tuple[Part, ...] = ()  # convex, where they are given
    groups: tuple[str, ...] = ()  # names of what it belongs to: a wall, a storey, a layer
    held: tuple[
        str, ...
    ] = ()  # of a movable block: what of its motion rollers hold: `Dimension.motions`

    def __post_init__(self) -> None:
        if not isinstance(self.vertices, np.ndarray):
            object.__setattr__(self, "vertices", np.array(self.vertices, np.float64))
        rows = self.faces
        if not (isinstance(rows, tuple) and all(isinstance(face, tuple) for face in rows)):
            object.__setattr__(self, "faces", tuple(tuple(map(int, face)) for face in rows))

    @classmethod
    def of_parts(cls, parts: Sequence[Part], **values: Any) -> Block:
        """A block of convex parts that move as one."""
        return cls(vertices=np.vstack([p.vertices for p in parts]), parts=tuple(parts), **values)

    @property
    def dimension(self) -> int:
        """2 or 3."""
        return int(self.vertices.shape[-1])

    def with_vertices(self, vertices: Array) -> Block:
        """The block with its vertices elsewhere, (n, dim) [m]."""
        if not self.parts:
            return replace(self, vertices=vertices)
        last = np.cumsum([len(part.vertices) for part in self.parts])[:-1]
        parts = zip(self.parts, np.split(vertices, last), strict=True)
        moved = tuple(Part(own, part.faces) for part, own in parts)
        return replace(self, vertices=vertices, parts=moved)

    @property
    def shape_key(self) -> str:
        """What its shape is called in model files."""
        return "parts" if self.parts else "vertices"

    def figure(self) -> Figure:
        """Parts and mass; raises `GeometryError`."""
        return Figure.of(self.vertices, self.faces, self.parts)


@dataclass(frozen=True, kw_only=True, eq=False)
class Shapes:
    """Contact shapes of all blocks, packed: part ``p`` owns rows ``offset[p]:offset[p + 1]``.

    A block is one convex part, or several that move as one; those of a block follow each other, in
    the order of the blocks.
    """

    body: IntArray  # (n_parts,) row of the block that each part belongs to
    offset: IntArray  # (n_parts + 1,)
    vertices: Array  # (n_vertices, dim) m, core vertices relative to the block's centroid
    radius: Array  # (n_parts,) m
    setback: Array  # m, see `polygon.Core` (n_vertices, 2), `cores.SolidCore` (n_corners,)
    faces: Polyhedra | None  # of space: the cores, relative to their block's centroid

    @classmethod
    def pack(cls, cores: Sequence[Sequence[Any]], centroid: Array) -> Shapes:
        """Pack the cores of the parts of every block: `Core` in the plane, `SolidCore` in space."""
        parts = [core for own in cores for core in own]
        body = np.repeat(np.arange(len(cores)), [len(own) for own in cores])
        vertices = [core.vertices - centroid[i] for core, i in zip(parts, body, strict=True)]
        faces = None
        setback = np.concatenate([core.setback for core in parts])
        if centroid.shape[1] == 3:
            rows = iter(vertices)
            faces = Polyhedra.pack([[(next(rows), core.faces) for core in own] for own in cores])
        return cls(
            body=body,
            offset=np.cumsum([0] + [len(core.vertices) for core in parts]).astype(np.int64),
            vertices=np.vstack(vertices),
            radius=np.array([core.radius for core in parts]),
            setback=setback,
            faces=faces,
        )

    def of(self, i: int) -> Array:
        """Core vertices of block ``i`` relative to its centroid, (m, dim) [m]."""
        first, last = np.searchsorted(self.body, (i, i + 1))
        return self.vertices[self.offset[first] : self.offset[last]]


@dataclass(frozen=True, kw_only=True, eq=False, repr=False)
class Assembly:
    """Blocks, supports and joint laws.  Constant during an analysis.

    The rows of every array are all blocks in the order given, supports included;
    ``n_blocks`` counts the movable ones, as the literature does.
    """

    dimension: int
    thickness: float  # m, out of plane; 1 in three dimensions
    blocks: tuple[Block, ...]
    joint: JointLaw
    corner: Corner
    joint_between: Mapping[frozenset[str], JointLaw] = field(default_factory=dict)
    points: int  # contact points on an interface, in space on one of four corners
    up: Array  # (dim,) unit vector against gravity

    # Derived from the above, also in a copy by `dataclasses.replace`.
    figures: tuple[Figure, ...] = field(init=False)
    shapes: Shapes = field(init=False)
    centroid: Array = field(init=False)  # (n, dim) m
    volume: Array = field(init=False)  # (n,) m3
    weight: Array = field(init=False)  # (n,) N
    mass: Array = field(init=False)  # (n, n_dof) kg and kg m2, per degree of freedom
    axes: Array = field(init=False)  # (n, dim, dim) columns: what rotations are about in space
    fixed: BoolArray = field(init=False)  # (n,)
    restrained: BoolArray = field(init=False)  # (n, n_dof) what rollers hold of movable blocks
    laws: tuple[JointLaw, ...] = field(init=False)  # laws[0] is `joint`

    @classmethod
    def build(
        cls,
        blocks: Sequence[Block],
        *,
        joint: JointLaw,
        corner: Corner | None = None,
        thickness: float = 1.0,
        joint_between: Mapping[frozenset[str], JointLaw] | None = None,
        points: int | None = None,
        up: Sequence[float] | Array | None = None,
    ) -> Assembly:
        """Of the blocks' dimension; sharp corners and no exceptions where nothing is said.

        Raises
        ------
        GeometryError
            A block's shape or corner is impossible, or not of the first one's dimension; the
            message names the block.
        """
        dimension = blocks[0].dimension
        for block in blocks:
            if block.dimension != dimension:
                raise GeometryError(
                    f'block "{block.id}": has {block.dimension} coordinates a vertex, the first '
                    f"block {dimension}"
                )
        along = np.eye(dimension)[-1] if up is None else np.asarray(up, np.float64)
        laws = joint, *(joint_between or {}).values()
        return cls(
            dimension=dimension,
            points=usual_points(dimension, laws) if points is None else points,
            up=along,
            thickness=thickness,
            blocks=tuple(blocks),
            joint=joint,
            corner=corner or Corner(),
            joint_between=dict(joint_between or {}),
        )

    def __post_init__(self) -> None:
        """Compute mass properties and contact shapes; raises `GeometryError`."""
        figures, cores = [], []
        for block in self.blocks:
            try:
                figures.append(block.figure())
                cores.append(self.corner.cores(figures[-1]))
            except GeometryError as error:
                raise GeometryError(f'block "{block.id}": {error}') from None
        centroid = np.array([figure.centroid for figure in figures])
        volume = np.array([figure.volume * self.thickness for figure in figures])
        moments = np.array([figure.moments * self.thickness for figure in figures])
        unit_weight = np.array([block.unit_weight for block in self.blocks])
        weight = unit_weight * volume
        along = [weight] * self.dimension
        self._derive(
            figures=tuple(figures),
            shapes=Shapes.pack(cores, centroid),
            centroid=centroid,
            volume=volume,
            weight=weight,
            mass=np.column_stack((*along, unit_weight[:, None] * moments)) / GRAVITY,
            axes=np.array([figure.axes for figure in figures]),
            fixed=np.array([block.support for block in self.blocks], dtype=bool),
            restrained=_restrained(self.blocks, self.kind),
            laws=(self.joint, *dict.fromkeys(self.joint_between.values())),
        )

    @cached_property
    def inertia(self) -> Array:
        """Masses (n, n_dof) with which blocks resist motion: so much of what rollers hold that no
        force moves it by more than rounding."""
        return np.where(self.restrained, RESTRAINED_MASS * self.mass, self.mass)

    def _derive(self, **values: Any) -> None:
        """Set derived fields, which are frozen for everyone else."""
        for name, value in values.items():
            object.__setattr__(self, name, value)

    def __repr__(self) -> str:
        law = f"friction {self.joint.friction_coefficient:g}"
        others = f" and {len(self.joint_between)} exceptions" * bool(self.joint_between)
        return (
            f"<Assembly: {self.n_blocks} blocks, {self.n_supports} supports, "
            f"{law}{others}, {self.corner.words} corners>"
        )

    # Asked for at every step: the assembly does not change, and is read once.

    @property
    def n_bodies(self) -> int:
        """Blocks and supports together."""
        return len(self.blocks)

    @cached_property
    def n_blocks(self) -> int:
        """Movable blocks."""
        return int(np.count_nonzero(~self.fixed))

    @property
    def n_supports(self) -> int:
        """Blocks that never move."""
        return int(np.count_nonzero(self.fixed))

    @cached_property
    def on_rollers(self) -> bool:
        """Whether rollers hold anything."""
        return bool(self.restrained.any())

    @property
    def kind(self) -> Dimension:
        """What goes with its dimension: words, units, numbers."""
        return dimension_of(self.dimension)

    @property
    def usual_points(self) -> int:
        """Contact points of an interface where nothing is said."""
        return usual_points(self.dimension, self.laws)

    @property
    def depth(self) -> float | None:
        """Thickness out of plane [m]; None of solids."""
        return self.kind.thickness(self.thickness)

    @property
    def n_dof(self) -> int:
        """Degrees of freedom of one block."""
        return motion.n_dof(self.dimension)

    @cached_property
    def heaviest_weight(self) -> float:
        """Weight of the heaviest movable block [N], the measure of every residual."""
        return float(self.weight[~self.fixed].max())

    @cached_property
    def extents(self) -> Array:
        """Least thickness of each block [m], (n,), however it is turned: from an edge, in space a
        face, to what lies farthest behind it."""
        return np.array([figure.least_depth for figure in self.figures])

    @cached_property
    def smallest_extent(self) -> float:
        """The least of `extents` among movable blocks [m]."""
        return float(self.extents[~self.fixed].min())

    @cached_property
    def largest_extent(self) -> float:
        """Of the whole structure along an axis, supports included [m]."""
        vertices = np.concatenate([block.vertices for block in self.blocks])
        return float(np.ptp(vertices, axis=0).max())

    @cached_property
    def longest_slide(self) -> float:
        """The length of the longest movable block [m], twice the way from its centroid to its
        farthest vertex: by convention, joints dilate no more after such a slide."""
        moving = np.flatnonzero(~self.fixed)
        offsets = (self.blocks[i].vertices - self.centroid[i] for i in moving)
        return 2.0 * max(float(np.linalg.norm(offset, axis=1).max()) for offset in offsets)

    @property
    def bonds_at_corners(self) -> bool:
        """Whether joints with tensile strength have contact points at their corners alone."""
        pulls = any(law.tensile_strength > 0.0 for law in self.laws)
        return pulls and self.points == self.kind.points

    def dilatancy_end(self, law: JointLaw) -> float:
        """Slip after which joints of a law dilate no more [m]."""
        return min(law.dilatancy_end, self.longest_slide)

    @cached_property
    def ids(self) -> tuple[str, ...]:
        """Names of the blocks, in the order of the arrays."""
        return tuple(block.id for block in self.blocks)

    @cached_property
    def groups(self) -> dict[str, IntArray]:
        """Rows of the blocks of each group, ascending; groups in the order of appearance."""
        rows: dict[str, list[int]] = {}
        for i, block in enumerate(self.blocks):
            for name in dict.fromkeys(block.groups):
                rows.setdefault(name, []).append(i)
        return Named("group", {name: np.array(own, np.int64) for name, own in rows.items()})

    @cached_property
    def _row(self) -> dict[str, int]:
        """Row of each block by its name."""
        return Named("block", {name: i for i, name in enumerate(self.ids)})

    def index(self, block_id: str) -> int:
        """Row of the block with that name; raises `UnknownNameError`, a `KeyError`."""
        return self._row[block_id]

    def design_pose(self) -> Array:
        """Poses of the blocks as designed, (n, n_pose); see `geometry.motion`."""
        return motion.design_pose(self.n_bodies, self.dimension)

    def no_motion(self) -> Array:
        """Increments, velocities or forces that are none: zeros, (n, n_dof)."""
        return np.zeros((self.n_bodies, self.n_dof))

    def moved(self, pose: Array, increment: Array) -> Array:
        """Poses (n, n_pose) after increments (n, n_dof)."""
        return motion.moved(pose, increment, self.axes)

    def difference(self, pose: Array, before: Array) -> Array:
        """Increments (n, n_dof) that lead from the poses ``before`` to ``pose``."""
        return motion.difference(pose, before, self.axes)

    def law_index(self, a: IntArray, b: IntArray) -> IntArray:
        """Index into `laws` of the joint between the blocks ``a[k]`` and ``b[k]``.

        A pair of two block ids overrides a pair with a group, which overrides a pair of materials.
        """
        if not self.joint_between:
            return np.zeros(len(a), dtype=np.int64)
        of_materials, of_groups, pair, of_pair = self._exceptions
        index = of_materials[self._material[a], self._material[b]]
        for first, last, law in of_groups:
            index = np.where((first[a] & last[b]) | (first[b] & last[a]), law, index)
        if len(pair):
            wanted = np.minimum(a, b) * self.n_bodies + np.maximum(a, b)
            place = np.minimum(np.searchsorted(pair, wanted), len(pair) - 1)
            index = np.where(pair[place] == wanted, of_pair[place], index)
        return index

    @cached_property
    def _material(self) -> IntArray:
        """Number of each block's material in the order of appearance, (n,)."""
        number: dict[str, int] = {}
        numbers = [number.setdefault(block.material, len(number)) for block in self.blocks]
        return np.array(numbers, dtype=np.int64)

    @cached_property
    def _exceptions(self) -> tuple[IntArray, list[_OfGroups], IntArray, IntArray]:
        """`joint_between` by number: a table over two materials; who is in the two groups of a pair
        and its law; pairs of blocks and their laws.

        A pair of rows i < j is i n + j; the pairs are sorted.
        """
        material = {block.material: k for block, k in zip(self.blocks, self._material, strict=True)}
        of_materials = np.zeros((len(material), len(material)), dtype=np.int64)
        pairs = {}
        of_groups: list[_OfGroups] = []
        for names, law in self.joint_between.items():
            first, last = min(names), max(names)
            index = self.laws.index(law)
            if names <= material.keys():
                i, j = material[first], material[last]
                of_materials[i, j] = of_materials[j, i] = index
            if len(names) == 2 and names <= self._row.keys():
                i, j = sorted((self._row[first], self._row[last]))
                pairs[i * self.n_bodies + j] = index
            elif names <= self.groups.keys() | self._row.keys():
                of_groups.append((self._is_in(first), self._is_in(last), index))
        order = sorted(pairs)
        return (
            of_materials,
            of_groups,
            np.array(order, dtype=np.int64),
            np.array([pairs[k] for k in order], dtype=np.int64),
        )

    def _is_in(self, name: str) -> BoolArray:
        """Whether each block has the name, or is in the group of that name, (n,)."""
        found = np.zeros(self.n_bodies, dtype=bool)
        found[self.groups[name] if name in self.groups else self._row[name]] = True
        return found

    @property
    def outlines(self) -> Outlines:
        """Outlines of the parts of plane blocks as designed."""
        return cast(Outlines, self.packed)

    @property
    def polyhedra(self) -> Polyhedra:
        """Parts of blocks in space as designed."""
        return cast(Polyhedra, self.packed)

    @cached_property
    def packed(self) -> Outlines | Polyhedra:
        """Parts of all blocks as designed, of either dimension."""
        return self.kind.packed(self.figures)

    @cached_property
    def interfaces(self) -> Interfaces:
        """Joints as designed, those between two supports included."""
        return Interfaces.of(self.packed)

    def outline(self, i: int, pose: Array | None = None) -> Array:
        """Outline of block ``i`` [m] as designed, or moved to ``pose`` (n, n_dof)."""
        vertices = self.blocks[i].vertices
        if pose is None:
            return vertices
        owner = np.full(len(vertices), i)
        return motion.moved_points(vertices, owner, self.centroid, pose)

    def displacement_at(self, i: int, point: Array, pose: Array) -> Array:
        """Displacement (dim,) [m] of the material ``point`` (as designed) of block ``i``."""
        return motion.displacement(np.asarray(point) - self.centroid[i], pose[i])
