"""Random structures in space: stacks, tables, rubble, walls with returns, arches and vaults.

One seed, one structure, the same on every machine; what would not stand under its own weight, or
only just, by limit analysis, is drawn again.  Loads come from any side, joints have any friction.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import replace
from itertools import pairwise

import numpy as np
from numpy.random import Generator

from buildings import directions, stone_of
from drystone.geometry import GeometryError
from drystone.geometry.space import solid
from drystone.limit import ASSOCIATIVE, collapse_load, stands
from drystone.model.assembly import Block, Corner
from drystone.model.builders import circular_arch
from drystone.model.joint_law import JointLaw
from drystone.model.loading import MassPattern
from drystone.model.model import Model
from solids import box, model_of

#: Draws of one seed.  One in twenty falls, so that hundreds in a row are a fault of the tests.
MOST_DRAWS = 200
#: Multiplier that is carried at least to either side along x and y.
MARGIN = 0.03
#: Pieces of rubble are thicker than this [m]: slivers carry loads of many times their weight.
THINNEST = 0.06


def random_solids(seed: int) -> Model:
    """The random structure of a seed; its title says what it is."""
    rng = np.random.default_rng(seed)
    kind = KINDS[seed % len(KINDS)]
    for _ in range(MOST_DRAWS):
        try:
            model = _drawn(rng, kind(rng), SOFTEST.get(kind, 1e8))
        except GeometryError:  # treated edges that leave nothing of a block
            continue
        if 2 <= model.assembly.n_blocks <= 40 and stands_with_margin(model):
            return replace(model, title=f"{kind.__name__} {seed}")
    raise AssertionError(f"{kind.__name__} {seed}: none of {MOST_DRAWS} stands")


def stands_with_margin(model: Model) -> bool:
    """Whether it stands with a margin to any side, which joints that close must not use up; in the
    plane to either."""
    if not stands(model.assembly):
        return False
    sides = directions(4) if model.assembly.dimension == 3 else [(1.0, 0.0), (-1.0, 0.0)]
    return all(
        collapse_load(
            replace(model, load=MassPattern(direction=np.array(side))), flow=ASSOCIATIVE
        ).load_multiplier
        > MARGIN
        for side in sides
    )


def _drawn(rng: Generator, blocks: list[Block], softest: float) -> Model:
    """Blocks with joints, edges, weight and load at random."""
    unit_weight = float(rng.uniform(15e3, 25e3))
    blocks = [replace(block, unit_weight=unit_weight) for block in blocks]
    top = max(float(block.vertices[:, 2].max()) for block in blocks)
    # Joints close by some 1e-6 to 1e-4 of the height under the weight.
    stiffness = 10.0 ** float(rng.uniform(np.log10(softest), 10.0)) * max(top, 1.0)
    law = JointLaw(
        friction_coefficient=round(float(rng.uniform(0.3, 0.9)), 3),
        normal_stiffness=stiffness,
        shear_stiffness=stiffness * float(rng.choice([0.4, 1.0, 10.0])),
    )
    small = 0.03 * min(solid.size_of(block.vertices) for block in blocks if not block.support)
    corner = {0: Corner(radius=round(small, 4)), 1: Corner(chamfer=round(small, 4))}
    angle = float(rng.uniform(0.0, 2.0 * np.pi))
    return model_of(
        blocks,
        law,
        push=(np.cos(angle), np.sin(angle), 0.0),
        corner=corner.get(int(rng.integers(8))),
        points=int(rng.choice([4, 4, 4, 9])),
    )


# --- stacks ----------------------------------------------------------------------------------


def stack(rng: Generator) -> list[Block]:
    """One to three stacks side by side, of boxes and of prisms that lean, taper and are turned."""
    blocks = [_base(6.0)]
    for k in range(int(rng.integers(1, 4))):
        middle, z = np.array([1.5 * k, 0.0]), 0.0
        size = float(rng.uniform(0.3, 0.6))
        for i in range(int(rng.integers(2, 7))):
            height = float(rng.uniform(0.15, 0.5))
            middle = middle + rng.uniform(-0.2, 0.2, 2) * size
            blocks.append(_prism(rng, f"s{k}b{i}", middle, size, (z, z + height)))
            z += height
            size *= float(rng.uniform(0.85, 1.05))
    return blocks


def table(rng: Generator) -> list[Block]:
    """Slabs upon three or four columns of drums, perhaps a stone on top."""
    n, drums = int(rng.integers(3, 5)), int(rng.integers(1, 4))
    size, drum = float(rng.uniform(0.25, 0.4)), float(rng.uniform(0.2, 0.5))
    wide, deep = rng.uniform(0.9, 1.6, 2)
    corners = [(0.0, 0.0), (wide, 0.0), (wide, deep), (0.0, deep)]
    if n == 3:
        corners = [(0.0, 0.0), (wide, 0.0), (0.5 * wide, deep)]
    blocks = [_base(6.0)]
    for k, corner in enumerate(corners):
        for i in range(drums):
            z = (i * drum, (i + 1) * drum)
            blocks.append(_prism(rng, f"c{k}d{i}", np.array(corner), size, z, lean=0.02))
    z, thick, out = drums * drum, float(rng.uniform(0.1, 0.25)), 0.4 * size
    low = np.array([-out, -out, z])
    blocks.append(box("slab", low, (wide + out, deep + out, z + thick)))
    if rng.random() < 0.5:
        middle = np.array([wide, deep]) * rng.uniform(0.3, 0.7, 2)
        blocks.append(_prism(rng, "stone", middle, 0.5, (z + thick, z + thick + 0.3)))
    return blocks


def _prism(
    rng: Generator,
    name: str,
    middle: np.ndarray,
    size: float,
    z: tuple[float, float],
    lean: float = 0.08,
) -> Block:
    """A block about ``middle`` (2,) [m], its outline and top at random, turned about z."""
    turn = float(rng.uniform(0.0, 2.0 * np.pi)) * float(rng.random() < 0.4)
    if rng.random() < 0.6:  # a rectangle
        half = 0.5 * size * rng.uniform(0.7, 1.2, 2)
        ring = np.array([(-1, -1), (1, -1), (1, 1), (-1, 1)]) * half
    else:
        n = int(rng.integers(3, 8))
        angle = 2.0 * np.pi * (np.arange(n) + rng.uniform(-0.2, 0.2, n)) / n
        ring = 0.55 * size * np.column_stack((np.cos(angle), np.sin(angle)))
    c, s = np.cos(turn), np.sin(turn)
    low = ring @ np.array([[c, s], [-s, c]])
    high = low
    if rng.random() < 0.5:  # sides that lean or taper stay flat
        high = float(rng.uniform(0.8, 1.1)) * low + size * rng.uniform(-lean, lean, 2)
    vertices = np.vstack(
        [
            np.column_stack((ring + middle, np.full(len(ring), height)))
            for ring, height in ((low, z[0]), (high, z[1]))
        ]
    )
    return stone_of(name, vertices)


# --- rubble ----------------------------------------------------------------------------------


def rubble(rng: Generator) -> list[Block]:
    """A pillar or a piece of wall cut into polyhedra: beds that slope, joints that lean."""
    size = np.array([rng.uniform(0.5, 1.6), rng.uniform(0.4, 0.7), rng.uniform(0.6, 1.6)])
    layers = [solid.box([np.zeros(3), size])[0]]
    n = int(rng.integers(2, 6))
    for k in range(1, n):
        middle = np.array([0.5, 0.5, k / n]) * size
        slope = rng.uniform(-0.12, 0.12, 2)
        layers = list(_cut(layers, middle, np.array([*slope, 1.0])))
    pieces = []
    for layer in layers:
        cut = [layer]
        for _ in range(int(rng.integers(0, 4))):
            angle = float(rng.choice([0.0, 0.0, 0.5 * np.pi])) + float(rng.uniform(-0.4, 0.4))
            normal = np.array([np.cos(angle), np.sin(angle), rng.uniform(-0.15, 0.15)])
            cut = list(_cut(cut, rng.uniform(0.15, 0.85, 3) * size, normal))
        pieces += cut
    return [_base(4.0), *(stone_of(f"r{i}", piece) for i, piece in enumerate(pieces))]


def _cut(
    pieces: Iterable[np.ndarray], point: np.ndarray, normal: np.ndarray
) -> Iterable[np.ndarray]:
    """Convex pieces (n, 3) cut by a plane; those that it would leave too thin stay whole."""
    normal = normal / np.linalg.norm(normal)
    for piece in pieces:
        off = (piece - point) @ normal
        if min(off.max(), -off.min()) < THINNEST:
            yield piece
            continue
        _, faces = solid.hull(piece)
        edges = {tuple(sorted(e)) for f in faces for e in zip(f, (*f[1:], f[0]), strict=True)}
        crossing = [
            piece[a] + off[a] / (off[a] - off[b]) * (piece[b] - piece[a])
            for a, b in sorted(edges)
            if off[a] * off[b] < 0.0
        ]
        halves = [np.vstack((piece[side * off > 0.0], crossing)) for side in (1.0, -1.0)]
        if all(_thickness(half) > THINNEST for half in halves):
            yield from halves
        else:
            yield piece


def _thickness(vertices: np.ndarray) -> float:
    """Least distance of a face of a hull from what lies farthest behind it [m]."""
    try:
        corners, faces = solid.hull(vertices)
    except GeometryError:  # corners nearly on each other
        return 0.0
    if len(corners) < len(vertices):
        return 0.0
    a, b, c = (corners[[face[k] for face in faces]] for k in range(3))
    normal = np.cross(b - a, c - a)
    normal /= np.linalg.norm(normal, axis=1)[:, None]
    short = min(
        float(np.linalg.norm(corners[i] - corners[j]))
        for face in faces
        for i, j in zip(face, (*face[1:], face[0]), strict=True)
    )
    depth = ((a * normal).sum(axis=1)[:, None] - normal @ corners.T).max(axis=1)
    return min(float(depth.min()), 2.0 * short)


# --- walls -----------------------------------------------------------------------------------


def returned_wall(rng: Generator) -> list[Block]:
    """A wall with one, two or no returns, in bond around its corners, of unequal units."""
    thickness, height = float(rng.uniform(0.15, 0.3)), float(rng.uniform(0.15, 0.3))
    length = rng.uniform([0.8, 0.4, 0.4], [1.6, 1.0, 1.0])
    returns = int(rng.integers(0, 3))
    blocks = [_base(6.0)]
    for course in range(int(rng.integers(2, 6))):
        z = course * height
        odd = course % 2  # the returns have the corners in every second course
        wall = (thickness * (odd and returns > 0), length[0] - thickness * (odd and returns > 1))
        strips = [(wall, (0.0, thickness), 0)]
        for k in range(returns):
            across = (0.0, thickness) if k == 0 else (length[0] - thickness, length[0])
            strips.append(((thickness * (1 - odd), length[k + 1]), across, 1))
        for s, (along, across, axis) in enumerate(strips):
            for i, (a, b) in enumerate(_units(rng, *along, odd)):
                u, v = ((a, b), across) if axis == 0 else (across, (a, b))
                low, high = (u[0], v[0], z), (u[1], v[1], z + height)
                blocks.append(box(f"c{course}w{s}u{i}", low, high))
    return blocks


def _units(rng: Generator, begin: float, end: float, odd: int) -> list[tuple[float, float]]:
    """A course cut into units of some 0.3 to 0.6 m, every second one half a unit further on."""
    n = max(1, round((end - begin) / float(rng.uniform(0.3, 0.6))))
    share = rng.uniform(0.7, 1.3, n + odd)
    if odd and n > 1:
        share[[0, -1]] *= 0.5
    cuts = begin + (end - begin) * np.concatenate(([0.0], np.cumsum(share) / share.sum()))
    cuts[[0, -1]] = begin, end
    return list(zip(cuts[:-1].tolist(), cuts[1:].tolist(), strict=True))


# --- arches ----------------------------------------------------------------------------------


def vault(rng: Generator) -> list[Block]:
    """An arch, or a strip of a barrel vault: one to three rings, their joints staggered or not."""
    embrace = float(rng.choice([120.0, 140.0, 160.0, 180.0]))
    least = {120.0: 0.022, 140.0: 0.042, 160.0: 0.073, 180.0: 0.1075}[embrace]
    radius = float(rng.uniform(0.6, 3.0))
    rings = int(rng.integers(1, 4))
    stones = circular_arch(
        radius=radius,
        thickness=radius * least * float(rng.uniform(1.3, 3.5)),
        embrace=embrace,
        n_voussoirs=int(rng.integers(5, {1: 16, 2: 14, 3: 11}[rings])),
        unit_weight=1.0,
    )
    width = radius * float(rng.uniform(0.2, 0.5))
    staggered = rings > 1 and rng.random() < 0.6
    blocks = []
    for i, stone in enumerate(stones):
        cuts = np.arange(rings + 1.0)
        if staggered and i % 2:
            cuts = np.concatenate(([0.0], cuts[:-1] + 0.5, [cuts[-1]]))
        if stone.support:
            cuts = np.array([-1.0, rings + 1.0])
        for k, (a, b) in enumerate(pairwise(cuts)):
            vertices, faces = solid.extruded(stone.vertices, (a * width, b * width))
            blocks.append(stone_of(f"{stone.id}k{k}", vertices, faces, support=stone.support))
    return blocks


def _base(reach: float) -> Block:
    return box("base", (-reach, -reach, -0.3), (reach, reach, 0.0), support=True)


KINDS: tuple[Callable[[Generator], list[Block]], ...] = (
    stack,
    rubble,
    returned_wall,
    vault,
    table,
)
#: Softest joints [Pa/m] of kinds whose few corners carry most of the weight: softer ones would be
#: pressed by more than `Analysis.max_penetration` allows, which ends a curve.
SOFTEST = {rubble: 1e9, table: 1e9}
