"""Elevations of irregular convex stones, and the same as they would be drawn: off, and rounded.

The clean drawings fit to rounding; what is drawn has every vertex of every stone off by itself.
"""

from __future__ import annotations

import numpy as np
from scipy.spatial import Voronoi

from drystone.geometry.interfaces import Interfaces
from drystone.geometry.plane.outlines import Outlines
from drystone.io.drawings.drawing import Shape
from drystone.model.assembly import Block

KINDS = ("courses", "rubble", "mixed", "waves")
LENGTH, HEIGHT = 4.0, 3.0  # m, of all elevations


def clean(seed):
    """Outlines (n, 2) [m] of 30 to 100 stones and of the support under them, which is the last, as
    they fit; and of each those of its vertices that are drawn."""
    rng = np.random.default_rng(seed)
    n = int(rng.integers(30, 101))
    kind = KINDS[seed // 2 % len(KINDS)]
    makers = {"courses": _courses, "rubble": _rubble, "mixed": _mixed, "waves": _waves}
    stones = makers[kind](rng, n)
    low, high = -0.3, LENGTH + 0.3
    base = np.array([(low, -0.3), (high, -0.3), (high, 0.0), (low, 0.0)])
    fits = [stone[0] if kind == "waves" else stone for stone in stones]
    own = [stone[1] if kind == "waves" else stone for stone in stones]
    return [*fits, base], [*own, base]


def drawn(outlines, noise, seed, decimals=3):
    """Outlines with every coordinate off by up to ``noise`` [m], but for those of the support,
    the last; all of them rounded."""
    rng = np.random.default_rng([seed, 1])
    moved = [o + rng.uniform(-noise, noise, o.shape) for o in outlines[:-1]]
    return [np.round(o, decimals) for o in (*moved, outlines[-1])]


def shapes(outlines):
    """As a reader of drawings gives them."""
    last = len(outlines) - 1
    return [
        Shape(name=str(i), vertices=o, layer="support" if i == last else "stone", support=i == last)
        for i, o in enumerate(outlines)
    ]


def joint_lengths(blocks):
    """What each two blocks share [m], by their rows; of blocks or of outlines."""
    parts = [
        [part.vertices for part in b.figure().parts] if isinstance(b, Block) else [b]
        for b in blocks
    ]
    joints = Interfaces.of(Outlines.pack(parts))
    found = {}
    for a, b, size in zip(joints.block_a, joints.block_b, joints.size, strict=True):
        found[int(a), int(b)] = found.get((int(a), int(b)), 0.0) + float(size)
    return found


def area(vertices):
    """By the shoelace formula [m2]."""
    x, y = vertices.T
    return 0.5 * float(np.sum(x * np.roll(y, -1) - np.roll(x, -1) * y))


def _courses(rng, n):
    """Quadrilaterals with slanted heads between beds that slope."""
    rows = max(3, round(np.sqrt(0.75 * n)))
    many = max(3, round(n / rows))
    beds = [np.zeros(2)]
    for k in range(1, rows):
        beds.append(HEIGHT * k / rows + rng.uniform(-0.06, 0.06, 2) * HEIGHT / rows)
    beds.append(np.full(2, HEIGHT))
    stones = []
    for k in range(rows):
        shift = 0.5 * (k % 2)
        at = (np.arange(1, many) - 0.5 + shift + rng.uniform(-0.2, 0.2, many - 1)) * LENGTH / many
        lean = rng.uniform(-0.04, 0.04, many - 1) * LENGTH / many
        low = np.concatenate(([0.0], at - lean, [LENGTH]))
        high = np.concatenate(([0.0], at + lean, [LENGTH]))
        for i in range(many):
            corners = [(low[i], 0), (low[i + 1], 0), (high[i + 1], 1), (high[i], 1)]
            stones.append(np.array([(x, _bed(beds[k + up], x)) for x, up in corners]))
    return stones


def _bed(ends, x):
    return ends[0] + (ends[1] - ends[0]) * x / LENGTH


def _waves(rng, n):
    """Courses between curved beds: stones drawn with the middle of either bed, where they fit with
    their neighbours' points as well."""
    rows = max(3, round(np.sqrt(0.75 * n)))
    many = max(3, round(n / rows))
    heads = []
    for k in range(rows):
        shift = 0.5 * (k % 2)
        inner = (np.arange(1, many) - 0.5 + shift + rng.uniform(-0.2, 0.2, many - 1)) / many
        heads.append(LENGTH * np.concatenate(([0.0], inner, [1.0])))
    phase, height = rng.uniform(0.0, 2.0 * np.pi, rows + 1), np.full(rows + 1, 0.025)
    height[[0, -1]] = 0.0
    drawn = [np.sort(np.concatenate((x, 0.5 * (x[1:] + x[:-1])))) for x in heads]

    def bed(k, x):
        wave = height[k] * np.sin(2.0 * np.pi * x / LENGTH + phase[k])
        return np.column_stack((x, HEIGHT * k / rows + wave))

    stones = []
    for k in range(rows):
        low = np.union1d(drawn[k], drawn[k - 1] if k else [])
        high = np.union1d(drawn[k], drawn[k + 1] if k + 1 < rows else [])
        for a, b in zip(heads[k][:-1], heads[k][1:], strict=True):

            def between(points, a=a, b=b):
                return points[(points >= a) & (points <= b)]

            stones.append(
                tuple(
                    np.vstack((bed(k, between(x)), bed(k + 1, between(y))[::-1]))
                    for x, y in ((low, high), (drawn[k], drawn[k]))
                )
            )
    return stones


def _rubble(rng, n):
    """Cells of Voronoi about points in a jittered grid, within a rectangle."""
    rows = max(3, round(np.sqrt(0.75 * n)))
    many = max(3, round(n / rows))
    grid = np.array(
        [(i + 0.5 + 0.25 * (k % 2) * (-1) ** i, k + 0.5) for k in range(rows) for i in range(many)]
    )
    points = grid + rng.uniform(-0.28, 0.28, grid.shape)
    points *= (LENGTH / many, HEIGHT / rows)
    mirrored = [points]
    for axis, side in ((0, 0.0), (0, LENGTH), (1, 0.0), (1, HEIGHT)):
        other = points.copy()
        other[:, axis] = 2.0 * side - other[:, axis]
        mirrored.append(other)
    cells = Voronoi(np.vstack(mirrored))
    stones = []
    for k in range(len(points)):
        outline = cells.vertices[cells.regions[cells.point_region[k]]]
        outline = outline.copy()
        for axis, side in ((0, 0.0), (0, LENGTH), (1, 0.0), (1, HEIGHT)):
            near = np.abs(outline[:, axis] - side) < 1e-9
            outline[near, axis] = side
        stones.append(outline if area(outline) > 0.0 else outline[::-1].copy())
    return stones


def _mixed(rng, n):
    """Courses of which every third stone or so is two, above or beside each other."""
    stones = []
    for stone in _courses(rng, max(24, round(n / 1.35))):
        if rng.random() > 0.35:
            stones.append(stone)
            continue
        a, b, c, d = stone
        s, t = rng.uniform(0.35, 0.65, 2)
        if rng.random() < 0.5:
            left, right = a + s * (d - a), b + t * (c - b)
            stones += [np.array([a, b, right, left]), np.array([left, right, c, d])]
        else:
            low, high = a + s * (b - a), d + t * (c - d)
            stones += [np.array([a, low, high, d]), np.array([low, b, c, high])]
    return stones
