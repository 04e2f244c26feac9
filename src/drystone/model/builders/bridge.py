"""Bridges: arches on piers, side by side, with spandrels up to a level deck."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Annotated

import numpy as np

from drystone.common.arrays import Array
from drystone.model.assembly import Block
from drystone.model.builders.arch import voussoirs_of
from drystone.model.builders.base import AlongY, Builder, Count, Length, Lengths, Metres, WholeUnit
from drystone.model.builders.coursing import Bond, Line
from drystone.model.builders.piers import pier, skewback, springing
from drystone.model.builders.profile import CurveName, Joints, ring
from drystone.model.builders.spandrel import Spandrel
from drystone.model.builders.stones import Mason, positive, unit_problems
from drystone.model.builders.strip import Strip
from drystone.model.construction.errors import ModelError


# Many, each a key of model files.
def bridge(
    *,
    spans: Annotated[Lengths, "of each arch, in m, as in spans = [4.0, 4.0]"],
    thickness: Annotated[Length, "of the arch, in m"],
    pier_width: Metres,
    pier_height: Metres,
    abutment_width: Metres,
    cover: Annotated[Length, "of masonry over the highest crown, in m"],
    unit: WholeUnit,
    unit_weight: float,
    rise: Length | None = None,
    shape: CurveName = "circular",
    voussoirs: Count | None = None,
    size: Length | None = None,
    depth: AlongY = None,
    material: str = "",
) -> list[Block]:
    """Arches from left to right over piers and two abutments, with spandrels up to the deck.

    The origin is at the ground, at the left springing of the first arch.  Spandrels are coursed
    between the arches; where these are flatter than 45 degrees stones stand on one voussoir each.
    Stones are cut to fit, those beside arches along their backs; courses are the nearest whole
    number of equal ones.  Piers too narrow for the springings are refused with the nearest width
    that fits.

    Parameters
    ----------
    spans
        Clear, of each arch [m].
    thickness
        Of the arches [m].
    pier_width, pier_height, abutment_width
        Of the piers, up to the springing, and of the abutments at both ends [m].
    cover
        Of masonry over the highest crown [m].
    unit
        Length and height of a whole unit of piers and spandrels [m].
    unit_weight
        N/m3.
    rise, shape, voussoirs, size
        Of every arch, as of an `arch`.
    depth
        Along y, from 0 [m]; none in the plane.

    Returns
    -------
    list of Block
        ``pier{k}/c{course}u{number}`` from left to right, the abutments ``left/...`` and
        ``right/...``, ``arch{k}/v{number}``, ``spandrel{k}/...`` in which ``c{course}u{number}``
        are courses and ``d{number}`` the stones over the backs of arches; ``arch{k}/cover`` over
        a keystone; ``deck/c{course}u{number}`` where the cover is high enough for whole courses.
        Groups are "pier 1", "arch 1", "spandrel 1", "left abutment", "deck".

    Raises
    ------
    ModelError
        The measures make no bridge.
    """
    problems = [
        *positive(
            thickness=thickness, pier_width=pier_width, pier_height=pier_height,
            abutment_width=abutment_width, cover=cover, depth=depth,
        ),
        *unit_problems(unit),
    ]  # fmt: skip
    if not spans:
        problems.append("spans: give the span of at least one arch")
    if problems:
        raise ModelError(problems)
    arches, at = [], 0.0
    for span in spans:
        arches.append(
            ring(
                span=span,
                rise=rise,
                shape=shape,
                thickness=thickness,
                voussoirs=voussoirs,
                size=size,
            ).moved(at + 0.5 * span, pier_height)
        )
        at += span + pier_width
    whole = _Bridge(
        mason=Mason(unit_weight=unit_weight, material=material),
        arches=arches,
        unit=unit,
        ends=(-abutment_width, at - pier_width + abutment_width),
        level=pier_height,
        depth=depth,
    )
    whole.check()
    deck = max(float(joints.outer[:, 1].max()) for joints in arches) + cover
    return whole.blocks(deck, cover)


BRIDGE = Builder(make=bridge)


@dataclass(frozen=True, kw_only=True)
class _Bridge:
    """Arches in their places and what they stand on."""

    mason: Mason
    arches: list[Joints]
    unit: Sequence[float]
    ends: tuple[float, float]  # m, x of both faces
    level: float  # m, of the springings
    depth: float | None

    @property
    def supports(self) -> list[tuple[str, str, tuple[float, float]]]:
        """Name, group and sides [m] of abutments and piers, from left to right."""
        first, last = self.arches[0].inner[0, 0], self.arches[-1].inner[-1, 0]
        between = zip(self.arches, self.arches[1:], strict=False)
        piers = [
            (f"pier{k}", f"pier {k}", (float(a.inner[-1, 0]), float(b.inner[0, 0])))
            for k, (a, b) in enumerate(between, start=1)
        ]
        left = ("left", "left abutment", (self.ends[0], float(first)))
        return [left, *piers, ("right", "right abutment", (float(last), self.ends[1]))]

    def sides(self, k: int) -> tuple[Joints | None, Joints | None]:
        """The arches on the left and on the right of a support."""
        return self.arches[k - 1] if k else None, self.arches[k] if k < len(self.arches) else None

    def check(self) -> None:
        """Raise `ModelError` where springings overlap, or lie on two levels."""
        problems = []
        heights = [float(joints.outer[0, 1]) for joints in self.arches]
        if max(heights) - min(heights) > 1e-9 * (self.ends[1] - self.ends[0]):
            problems.append(
                "rise: springing joints of arches of unlike spans slope unlike: take equal spans, "
                'or level springings, as those of shape = "elliptic"'
            )
        for k, (name, _, (low, high)) in enumerate(self.supports):
            left, right = self.sides(k)
            needed = sum(springing(j.outer[0], j.inner[0]) for j in (left, right) if j is not None)
            if high - low < needed * (1.0 - 1e-9):
                key = "pier_width" if name.startswith("pier") else "abutment_width"
                problems.append(
                    f"{key}: {high - low:g} m is less than the springings need: the nearest that "
                    f"fits is {needed:.6g} m"
                )
        if problems:
            raise ModelError(dict.fromkeys(problems))

    def blocks(self, deck: float, cover: float) -> list[Block]:
        """Piers, arches, spandrels and, under a deck so far over the crowns [m], courses over
        all."""
        across = None if self.depth is None else (0.0, self.depth)
        made: list[Block] = []
        for k, (name, group, sides) in enumerate(self.supports):
            made += pier(self.mason, self.unit, sides, self.level, self.depth, f"{name}/", group)
            left, right = self.sides(k)
            made += skewback(
                self.mason, sides, self.level, None if left is None else left.outer[-1],
                None if right is None else right.outer[0], self.depth, f"{name}/skewback", group,
            )  # fmt: skip
        for k, joints in enumerate(self.arches, start=1):
            made += voussoirs_of(self.mason, joints, across, f"arch{k}/", f"arch {k}")
        base = float(self.arches[0].outer[0, 1])
        steep = max(base, min(_flattening(joints) for joints in self.arches))
        n_top = max(0, int(cover / self.unit[1] - 0.5))  # courses over the whole bridge
        under = deck - n_top * self.unit[1]
        for k in range(len(self.arches) + 1):
            left, right = self.sides(k)
            made += Spandrel(
                mason=self.mason, unit=self.unit, depth=across,
                left=None if left is None else _halves(left)[1],
                right=None if right is None else _halves(right)[0],
                ends=self.ends, prefix=f"spandrel{k + 1}/", group=f"spandrel {k + 1}",
            ).blocks(base, steep, under)  # fmt: skip
        for k, joints in enumerate(self.arches, start=1):
            n = joints.n_voussoirs
            if n % 2:  # over the keystone
                p, q = joints.outer[n // 2], joints.outer[n // 2 + 1]
                crown = np.array([p, q, [q[0], under], [p[0], under]])
                made.append(self.mason.upright(f"arch{k}/cover", crown, across, f"arch {k}"))
        top = Strip(
            mason=self.mason, bond=Bond(name="running", unit=self.unit[0]), thickness=self.depth,
            prefix="deck/", groups=("deck",), anchor=self.ends[0],
        )  # fmt: skip
        for course in range(n_top):
            levels = under + course * self.unit[1], under + (course + 1) * self.unit[1]
            made += top.course(course, levels, Line(self.ends[0]), Line(self.ends[1]))
        return made


def _halves(joints: Joints) -> tuple[Array, Array]:
    """The back of an arch from its left and from its right springing up to the crown, or to the
    keystone."""
    n = joints.n_voussoirs
    return joints.outer[: n // 2 + 1], joints.outer[n - n // 2 :][::-1]


def _flattening(joints: Joints) -> float:
    """Height of the joint from which on the back of an arch is flatter than 45 degrees [m]."""
    back = _halves(joints)[0]
    run, up = np.diff(back, axis=0).T
    flat = np.flatnonzero(up < np.abs(run))
    return float(back[flat[0] if len(flat) else -1, 1])
