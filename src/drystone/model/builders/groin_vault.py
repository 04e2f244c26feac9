"""Groin vaults: two semicircular barrels that cross over a square."""

from __future__ import annotations

from itertools import pairwise
from typing import Annotated

import numpy as np

from drystone.common.arrays import Array
from drystone.model.assembly import Block
from drystone.model.builders.base import Builder, Count, Length, Metres, YesOrNo
from drystone.model.builders.coursing import Bond, Line
from drystone.model.builders.profile import Joints, ring
from drystone.model.builders.stones import Mason, positive
from drystone.model.construction.errors import ModelError

WEBS = ("east", "north", "west", "south")  # turned by a quarter from one to the next
CORNERS = ("northeast", "northwest", "southwest", "southeast")


# Long by its keys, each with its words: they are those of model files.
def groin_vault(
    *,
    span: Metres,
    thickness: Metres,
    voussoirs: Annotated[Count, "of a barrel, an odd number"],
    unit: Annotated[Length, "length of a stone along a web, in m"],
    unit_weight: float,
    edge: Length | None = None,
    mitred: YesOrNo = False,
    material: str = "",
) -> list[Block]:
    """Two semicircular barrels of one span over a square, its middle at the origin.

    Each of the four webs is a part of a barrel in running bond, cut along the diagonals.  The two
    stones that meet there are one, of two convex parts, unless they are mitred; in the middle four
    rows of keystones hold a boss.  Stones are cut to fit along the webs.

    Parameters
    ----------
    span
        Of the intrados, both ways [m].
    thickness
        Of the shell [m].
    voussoirs
        Of a barrel's arch: odd, so that it has a keystone.
    unit
        Length of a stone along a web [m].
    unit_weight
        N/m3.
    edge
        By how much the webs reach over the square of the span [m]; at least the thickness, which is
        the default.
    mitred
        Whether there is a joint along the diagonals.

    Returns
    -------
    list of Block
        ``{web}/v{voussoir}u{number}`` from the groin outwards, ``{corner}/g{course}`` along the
        groins, ``boss``.  Groups are "web east", "groin northeast", "course 1" from the springing.

    Raises
    ------
    ModelError
        The measures make no vault.
    """
    edge = thickness if edge is None else edge
    problems = positive(span=span, thickness=thickness, unit=unit)
    if voussoirs < 3 or voussoirs % 2 == 0:
        low = max(3, voussoirs - 1 + voussoirs % 2)
        problems.append(
            f"voussoirs: must be odd and at least 3, it is {voussoirs}: the nearest that fit are "
            f"{low} and {low + 2}"
        )
    if edge < thickness:
        problems.append(f"edge: must be at least the thickness of {thickness:g} m")
    if problems:
        raise ModelError(problems)
    joints = ring(span=span, thickness=thickness, voussoirs=voussoirs)
    vault = _Vault(joints, 0.5 * span + edge, Bond(name="running", unit=unit))
    mason = Mason(unit_weight=unit_weight, material=material)
    made: list[Block] = []
    for course in range(voussoirs // 2 + 1):
        made += vault.course(mason, course, mitred)
    top = vault.joints.outline(voussoirs // 2)
    corners = [(sx * abs(y), sy * abs(y), z) for y, z in top for sx in (-1, 1) for sy in (-1, 1)]
    made.append(mason.hull("boss", np.array(corners), "boss"))
    return made


GROIN_VAULT = Builder(make=groin_vault, dimensions=(3,))


class _Vault:
    """Joints of a barrel's arch, how far its webs reach, and their bond."""

    def __init__(self, joints: Joints, reach: float, bond: Bond) -> None:
        self.joints, self.reach, self.bond = joints, reach, bond

    def course(self, mason: Mason, course: int, mitred: bool) -> list[Block]:
        """The stones of all webs in a course, counted from 0 at the springing."""
        n = self.joints.n_voussoirs
        group = f"course {course + 1}"
        made: list[Block] = []
        groins: list[list[Block]] = [[], [], [], []]
        for web, name in enumerate(WEBS):
            for i in dict.fromkeys((course, n - 1 - course)):  # on either side of the crown
                stones = [
                    mason.hull(f"{name}/v{i + 1}u{k}", _turned(vertices, web), f"web {name}", group)
                    for k, vertices in enumerate(self.row(i, course), start=1)
                ]
                if 2 * i + 1 != n and not mitred:  # the groin on the left of the web, or its right
                    corner = web if 2 * i + 1 > n else (web - 1) % 4
                    groins[corner].append(stones.pop(0))
                made += stones
        for where, pair in zip(CORNERS, groins, strict=True):
            if pair:
                name = f"{where}/g{course + 1}"
                made.append(mason.joined(name, pair, f"groin {where}", group))
        return made

    def row(self, i: int, course: int) -> list[Array]:
        """Vertices (8, 3) [m] of the stones of a voussoir's row in the eastern web."""
        outline = self.joints.outline(i)
        away = np.abs(outline[:, 0])
        breadth = float(away.min()), float(away.max())
        diagonal = Line(0.0, 1.0)  # x = |y|
        pieces = self.bond.pieces(course, diagonal, Line(self.reach), breadth, self.reach)
        lines = [piece.begin for piece in pieces] + [pieces[-1].end]
        return [
            np.array(
                [
                    (line(v), y, z)
                    for line in pair
                    for v, (y, z) in zip(away.tolist(), outline.tolist(), strict=True)
                ]
            )
            for pair in pairwise(lines)
        ]


def _turned(vertices: Array, quarters: int) -> Array:
    """Vertices after so many quarter turns about z."""
    x, y, z = vertices.T
    for _ in range(quarters):
        x, y = -y, x
    return np.column_stack((x, y, z))
