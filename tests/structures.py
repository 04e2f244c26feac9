"""Random structures: walls, openings, portals, arches, leaning stacks.

One seed, one structure: the same on every machine, so that a seed in a message is enough to look
into it.  Every joint between two of three stones has a friction of its own, for where several bed
joints could slide at the same multiplier, nothing says which of them does.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import replace
from itertools import combinations_with_replacement

import numpy as np
from numpy.random import Generator

from builders import rectangle
from drystone.model.assembly import Block, Corner
from drystone.model.builders import circular_arch, make_model
from drystone.model.joint_law import JointLaw
from drystone.model.model import Model

Outlines = dict[str, np.ndarray]

STONES = ("grey", "red", "white")


def structure(seed: int) -> Model:
    """The random structure of a seed; its title says what it is."""
    rng = np.random.default_rng(seed)
    kind = KINDS[seed % len(KINDS)]
    outlines, supports = kind(rng)
    smallest = min(
        float(np.hypot(*(np.roll(outline, -1, axis=0) - outline).T).min())
        for name, outline in outlines.items()
        if name not in supports
    )
    corner = Corner(radius=round(0.05 * smallest, 4)) if rng.random() < 0.5 else Corner()
    stiffness = 10.0 ** rng.choice([8.0, 9.0, 10.0, 11.0])
    joint = JointLaw(
        friction_coefficient=round(float(rng.uniform(0.45, 0.9)), 2),
        normal_stiffness=stiffness,
        # The engine nscd has no shear stiffness: what is compared must not feel it.
        shear_stiffness=stiffness * float(rng.choice([10.0, 100.0, 1000.0])),
    )
    stone = {name: str(rng.choice(STONES)) for name in outlines}
    between = {
        frozenset(pair): replace(
            joint,
            friction_coefficient=round(
                joint.friction_coefficient * float(rng.uniform(0.85, 1.15)), 3
            ),
        )
        for pair in combinations_with_replacement(sorted(set(stone.values())), 2)
    }
    unit_weight = float(rng.uniform(15e3, 25e3))
    return make_model(
        [
            Block(
                id=name,
                vertices=outline,
                unit_weight=unit_weight,
                material=stone[name],
                support=name in supports,
            )
            for name, outline in outlines.items()
        ],
        joint=joint,
        joint_between=between,
        corner=corner,
        thickness=1.0,
        load_direction=(float(rng.choice([-1.0, 1.0])), 0.0),
        title=f"{kind.__name__} {seed}",
    )


def wall(rng: Generator) -> tuple[Outlines, set[str]]:
    """Courses of unequal units on a base, their joints staggered, with or without a step on top."""
    n, height = int(rng.integers(3, 8)), round(float(rng.uniform(0.15, 0.3)), 2)
    length = round(float(rng.uniform(0.5, 1.4)), 2)
    outlines = {"base": rectangle(-length, -0.5, 3.0 * length, 0.5)}
    for course in range(n):
        for i, (left, right) in enumerate(_units(rng, 0.0, length, course)):
            if course == n - 1 and i == 0 and rng.random() < 0.3:
                continue  # a stone of the top course is missing
            outlines[f"c{course + 1}u{i + 1}"] = rectangle(
                left, course * height, right - left, height
            )
    return outlines, {"base"}


def opening(rng: Generator) -> tuple[Outlines, set[str]]:
    """Two piers of courses, a lintel over the opening, courses above."""
    height = round(float(rng.uniform(0.2, 0.3)), 2)
    left = round(float(rng.uniform(0.4, 0.8)), 2)
    span = round(float(rng.uniform(0.5, 1.0)), 2)
    right = round(float(rng.uniform(0.4, 0.8)), 2)
    length, n = left + span + right, int(rng.integers(2, 5))
    bearing = round(float(rng.uniform(0.15, 0.3)), 2)
    outlines = {"base": rectangle(-length, -0.5, 3.0 * length, 0.5)}
    for course in range(n):
        for k, (begin, end) in enumerate(((0.0, left), (left + span, length))):
            for i, (a, b) in enumerate(_units(rng, begin, end, course)):
                outlines[f"p{k + 1}c{course + 1}u{i + 1}"] = rectangle(
                    a, course * height, b - a, height
                )
    y = n * height
    outlines["lintel"] = rectangle(left - bearing, y, span + 2.0 * bearing, height)
    if left - bearing > 0.1:
        outlines["left"] = rectangle(0.0, y, left - bearing, height)
    if right - bearing > 0.1:
        outlines["right"] = rectangle(left + span + bearing, y, right - bearing, height)
    for course in range(int(rng.integers(0, 3))):
        for i, (a, b) in enumerate(_units(rng, 0.0, length, course)):
            outlines[f"t{course + 1}u{i + 1}"] = rectangle(
                a, y + (course + 1) * height, b - a, height
            )
    return outlines, {"base"}


def portal(rng: Generator) -> tuple[Outlines, set[str]]:
    """Two piers of drums and a lintel, perhaps with a block upon it."""
    width, n = round(float(rng.uniform(0.35, 0.6)), 2), int(rng.integers(1, 5))
    drum = round(float(rng.uniform(0.3, 0.6)), 2)
    span = round(float(rng.uniform(0.8, 1.6)), 2)
    outlines = {"base": rectangle(-1.0, -0.5, 2.0 + 2.0 * width + span, 0.5)}
    for k, x in enumerate((0.0, width + span)):
        for i in range(n):
            outlines[f"p{k + 1}d{i + 1}"] = rectangle(x, i * drum, width, drum)
    deep = round(float(rng.uniform(0.2, 0.4)), 2)
    outlines["lintel"] = rectangle(0.0, n * drum, span + 2.0 * width, deep)
    if rng.random() < 0.5:
        wide = round(0.5 * span, 2)
        outlines["block"] = rectangle(width + 0.3 * span, n * drum + deep, wide, 0.3)
    return outlines, {"base"}


def arch(rng: Generator) -> tuple[Outlines, set[str]]:
    """A circular arch on abutments, thicker than the thinnest that stands."""
    embrace = float(rng.choice([120.0, 140.0, 160.0, 180.0]))
    least = {120.0: 0.022, 140.0: 0.042, 160.0: 0.073, 180.0: 0.1075}[embrace]
    radius = round(10.0 ** float(rng.uniform(-0.3, 0.8)), 2)
    blocks = circular_arch(
        radius=radius,
        thickness=round(radius * least * float(rng.uniform(1.3, 2.5)), 3),
        embrace=embrace,
        n_voussoirs=int(rng.integers(7, 20)),
        unit_weight=1.0,
    )
    return {b.id: b.vertices for b in blocks}, {b.id for b in blocks if b.support}


def leaning(rng: Generator) -> tuple[Outlines, set[str]]:
    """A stack of blocks, each a little further out, within what stands, some of them tapered."""
    outlines = {"base": rectangle(-3.0, -0.5, 6.0, 0.5)}
    n, y, x = int(rng.integers(2, 7)), 0.0, 0.0
    width = round(float(rng.uniform(0.5, 0.9)), 2)
    lean = float(rng.uniform(-0.5, 0.5)) * width / n**1.5
    for i in range(n):
        height, taper = round(float(rng.uniform(0.2, 0.5)), 2), 0.1 * width * float(rng.random())
        outlines[f"b{i + 1}"] = np.array(
            [[x, y], [x + width, y], [x + width - taper, y + height], [x + taper, y + height]]
        )
        x, y = x + lean, y + height
    return outlines, {"base"}


KINDS: tuple[Callable[[Generator], tuple[Outlines, set[str]]], ...] = (
    wall,
    opening,
    portal,
    arch,
    leaning,
)


def _units(rng: Generator, begin: float, end: float, course: int) -> list[tuple[float, float]]:
    """Cut a course into units of 0.2 to 0.5 m, beginning with a half one in every second course."""
    length = end - begin
    n = max(1, math.ceil(length / 0.5))
    if n == 1:
        return [(begin, end)]
    share = rng.uniform(0.7, 1.3, n)
    if course % 2:
        share = np.concatenate(([0.5 * share[0]], share[1:], [0.5 * share[0]]))
    cuts = begin + length * np.concatenate(([0.0], np.cumsum(share) / share.sum()))
    cuts = np.round(cuts, 2)
    cuts[0], cuts[-1] = begin, end
    return list(zip(cuts[:-1].tolist(), cuts[1:].tolist(), strict=True))
