"""Curves of arches, vaults and domes: joints normal to the intrados, from springing to springing.

The springings are at z = 0, the crown over x = 0; joints run from left to right.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Annotated

import numpy as np

from drystone.common.arrays import Array
from drystone.common.keys import Choice
from drystone.model.builders.stones import at_least, check_count, positive
from drystone.model.construction.errors import ModelError
from drystone.model.construction.words import suggestion

#: Point and outward normal at a share of the length of a curve, each (2,).
Curve = Callable[[float], tuple[Array, Array]]

SHAPES = ("circular", "pointed", "elliptic")
CurveName = Annotated[str, Choice(SHAPES)]
#: Pieces by which the length of a curve without a formula is measured.
FINE = 4096


@dataclass(frozen=True)
class Joints:
    """Joints of a ring of voussoirs, by their ends."""

    inner: Array  # (n + 1, 2) m, on the intrados
    outer: Array  # (n + 1, 2) m, on the extrados

    @property
    def n_voussoirs(self) -> int:
        """Voussoirs between them."""
        return len(self.inner) - 1

    def outline(self, i: int) -> Array:
        """Voussoir i, counter-clockwise, (4, 2) [m]: its intrados first."""
        return np.array([self.inner[i], self.inner[i + 1], self.outer[i + 1], self.outer[i]])

    def moved(self, x: float, z: float) -> Joints:
        """The same elsewhere [m]."""
        return Joints(self.inner + (x, z), self.outer + (x, z))


def shape_problems(shape: str, span: float, rise: float | None) -> list[str]:
    """Sentences on a shape, a span and a rise [m] that make no curve."""
    found = positive(span=span, rise=rise)
    if shape not in SHAPES:
        found.append(f'shape: there is no shape "{shape}": {suggestion(shape, SHAPES)}')
    half = 0.5 * span
    if not found and rise is not None:
        if shape == "circular" and rise > half * (1.0 + 1e-9):
            found.append(
                f"rise: {rise:g} m is more than half the span, which no arc of a circle has: the "
                f'nearest that fits is {half:.6g} m, or take shape = "pointed" or "elliptic"'
            )
        if shape == "pointed" and rise < half * (1.0 - 1e-9):
            found.append(
                f"rise: {rise:g} m is less than half the span, and the arcs would not point "
                f'upwards: the nearest that fits is {half:.6g} m, or take shape = "circular"'
            )
    return found


def half_curve(shape: str, span: float, rise: float | None, opening: float = 0.0) -> Curve:
    """The left half of an intrados, from its springing to the crown, or to where an ``opening``
    [m] around the crown begins."""
    half = 0.5 * span
    rise = half if rise is None else rise
    if shape == "elliptic":
        return _elliptic(half, rise, opening)
    radius = (half**2 + rise**2) / (2.0 * (rise if shape == "circular" else half))
    centre = np.array([0.0, rise - radius] if shape == "circular" else [radius - half, 0.0])
    # Angles are counted from the vertical, to the left.
    first = math.atan2(half + centre[0], -centre[1])
    last = math.asin((0.5 * opening + centre[0]) / radius)

    def at(share: float) -> tuple[Array, Array]:
        angle = first + share * (last - first)
        normal = np.array([-math.sin(angle), math.cos(angle)])
        return centre + radius * normal, normal

    return at


def _elliptic(half: float, rise: float, opening: float) -> Curve:
    angle = np.linspace(0.5 * np.pi, math.asin(0.5 * opening / half), FINE + 1)
    points = np.column_stack((-half * np.sin(angle), rise * np.cos(angle)))
    length = np.append(0.0, np.cumsum(np.linalg.norm(np.diff(points, axis=0), axis=1)))

    def at(share: float) -> tuple[Array, Array]:
        t = float(np.interp(share * length[-1], length, angle))
        normal = np.array([-math.sin(t) / half, math.cos(t) / rise])
        point = np.array([-half * math.sin(t), rise * math.cos(t)])
        return point, normal / np.linalg.norm(normal)

    return at


def through(points: Sequence[Sequence[float]]) -> Curve:
    """The smooth curve through points from left to right: a cubic spline over their distances."""
    from scipy.interpolate import CubicSpline  # takes long to import; other arches do without

    given = np.asarray(points, float)
    if given.ndim != 2 or given.shape[1] != 2 or len(given) < 3:
        raise ModelError(["intrados: must be a list of at least three points [x, z]"])
    chords = np.linalg.norm(np.diff(given, axis=0), axis=1)
    if not chords.min() > 0.0 or not given[-1, 0] > given[0, 0]:
        raise ModelError(["intrados: its points must lead from left to right, none of them twice"])
    spline = CubicSpline(np.append(0.0, np.cumsum(chords)), given)
    t = np.linspace(0.0, chords.sum(), FINE + 1)
    length = np.append(0.0, np.cumsum(np.linalg.norm(np.diff(spline(t), axis=0), axis=1)))

    def at(share: float) -> tuple[Array, Array]:
        own = float(np.interp(share * length[-1], length, t))
        dx, dz = spline(own, 1)
        return spline(own), np.array([-dz, dx]) / math.hypot(dx, dz)

    return at


def length_of(curve: Curve) -> float:
    """Length of a curve [m]."""
    points = np.array([curve(share)[0] for share in np.linspace(0.0, 1.0, 257)])
    return float(np.linalg.norm(np.diff(points, axis=0), axis=1).sum())


# Many, each a key of model files.
def ring(
    *,
    thickness: float,
    span: float | None = None,
    rise: float | None = None,
    shape: str = "circular",
    intrados: Sequence[Sequence[float]] | None = None,
    voussoirs: int | None = None,
    size: float | None = None,
) -> Joints:
    """Joints of an arch; its measures as in `arch`.  Raises `ModelError`."""
    problems = positive(thickness=thickness, size=size)
    if (span is None) == (intrados is None):
        problems.append("span: give either the span or an intrados")
    elif span is not None:
        problems += shape_problems(shape, span, rise)
    if (voussoirs is None) == (size is None):
        problems.append("voussoirs: give either their number or their size")
    if problems:
        raise ModelError(problems)
    if intrados is not None:
        curve = through(intrados)
        n = _number(voussoirs, size, length_of(curve), 1)
        found = np.array([curve(k / n) for k in range(n + 1)])
        joints = Joints(found[:, 0], found[:, 0] + thickness * found[:, 1])
    else:
        joints = _symmetric(
            half_curve(shape, span or 0.0, rise), shape == "pointed", thickness, voussoirs, size
        )
    _check_turns(joints)
    return joints


def _number(voussoirs: int | None, size: float | None, length: float, step: int) -> int:
    """Voussoirs: as given, or the nearest number to a size [m]: odd, or even for ``step`` 2."""
    check_count(voussoirs if voussoirs is not None else length / float(size or length))
    if voussoirs is None:
        n = length / float(size or length)
        return max(2, 2 * round(0.5 * n)) if step == 2 else max(3, 2 * round(0.5 * (n - 1)) + 1)
    if problems := at_least(2, voussoirs=voussoirs):
        raise ModelError(problems)
    if step == 2 and voussoirs % 2:
        raise ModelError(
            [
                f"voussoirs: a pointed arch has a joint at its point, and {voussoirs} is odd: the "
                f"nearest that fit are {voussoirs - 1} and {voussoirs + 1}"
            ]
        )
    return voussoirs


def _symmetric(
    curve: Curve, pointed: bool, thickness: float, voussoirs: int | None, size: float | None
) -> Joints:
    """The joints of a half and their mirror images; a point has an upright joint."""
    n = _number(voussoirs, size, 2.0 * length_of(curve), 2 if pointed else 1)
    found = [curve(2.0 * k / n) for k in range(n // 2 + 1)]
    inner = np.array([point for point, _ in found])
    outer = np.array([point + thickness * normal for point, normal in found])
    if n % 2 == 0:  # the joint at the crown is upright, from the point up to that of the extrados
        inner[-1, 0] = 0.0
        if pointed:
            (x, z), normal = found[-1]
            centre = np.array([x, z]) - normal * _radius(curve)
            reach = _radius(curve) + thickness
            outer[-1] = 0.0, math.sqrt(reach**2 - centre[0] ** 2)
        else:
            outer[-1, 0] = 0.0
    inner[np.abs(inner) < 1e-15], outer[np.abs(outer) < 1e-15] = 0.0, 0.0
    rest = slice(None, None, -1) if n % 2 else slice(-2, None, -1)
    mirror = np.array([-1.0, 1.0])
    return Joints(
        np.vstack((inner, inner[rest] * mirror)), np.vstack((outer, outer[rest] * mirror))
    )


def _radius(curve: Curve) -> float:
    """Radius of an arc of a circle [m]."""
    (p, n), (q, m) = curve(0.0), curve(1.0)
    return float(np.linalg.norm(q - p) / np.linalg.norm(m - n))


def _check_turns(joints: Joints) -> None:
    """Raise `ModelError` where joints cross within the ring."""
    for i in range(joints.n_voussoirs):
        edges = np.roll(joints.outline(i), -1, axis=0) - joints.outline(i)
        after = np.roll(edges, -1, axis=0)
        if not (edges[:, 0] * after[:, 1] - edges[:, 1] * after[:, 0] > 0.0).all():
            raise ModelError(
                [
                    f"thickness: joints cross within voussoir {i + 1}: make the arch thinner, the "
                    "curve smoother, or take fewer voussoirs"
                ]
            )
