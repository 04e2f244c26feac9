"""Small assemblies with known answers, and what else several test files need."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from hypothesis import strategies as st

from drystone.contact.contacts import Pairs, Slots
from drystone.contact.detection import Detector
from drystone.engines.base import Problem
from drystone.model.assembly import Assembly, Block, Corner
from drystone.model.builders import make_model
from drystone.model.joint_law import JointLaw
from drystone.model.model import Model

UNIT_WEIGHT = 10e3  # N/m3
#: The joints of Bouckaert, Godio & de Almeida (2022).
PUBLISHED_JOINT = JointLaw(friction_coefficient=0.65, normal_stiffness=1e8, shear_stiffness=1e11)
#: The joints of the published walls with a bond, and as soft along the joint as across it.
BONDED_JOINT = replace(PUBLISHED_JOINT, shear_stiffness=1e8, cohesion=1e4)
#: So stiff that a block of a few kN closes the joint by a micrometre only.
STIFF = 1e10  # Pa/m


def rectangle(x: float, y: float, width: float, height: float) -> np.ndarray:
    """Counter-clockwise, from its lower left corner."""
    return np.array([[x, y], [x + width, y], [x + width, y + height], [x, y + height]])


def turned(vertices: np.ndarray, angle: float, about: Sequence[float] = (0.0, 0.0)) -> np.ndarray:
    """Vertices turned counter-clockwise by an angle [rad]."""
    c, s = np.cos(angle), np.sin(angle)
    return (vertices - about) @ np.array([[c, -s], [s, c]]).T + about


def stiff_joint(friction: float, shear_stiffness: float = STIFF) -> JointLaw:
    """A joint law whose elasticity is not felt."""
    return JointLaw(
        friction_coefficient=friction, normal_stiffness=STIFF, shear_stiffness=shear_stiffness
    )


def stack(
    *sizes: tuple[float, float],
    joint: JointLaw = PUBLISHED_JOINT,
    corner: Corner | None = None,
    tilt: float = 0.0,
    direction: Sequence[float] = (1.0, 0.0),
    **options,
) -> Model:
    """Blocks "b1", "b2", ... of given widths and heights [m] one upon the other on a fixed "base".

    All is turned about the middle of the base's top by ``tilt`` [rad]; ``options`` are those of
    `make_model`.
    """
    outlines = {"base": rectangle(-3.0, -1.0, 6.0, 1.0)}
    y = 0.0
    for i, (width, height) in enumerate(sizes):
        outlines[f"b{i + 1}"] = rectangle(-width / 2, y, width, height)
        y += height
    blocks = [
        Block(id=name, vertices=turned(v, tilt), unit_weight=UNIT_WEIGHT, support=name == "base")
        for name, v in outlines.items()
    ]
    return make_model(
        blocks, joint=joint, corner=corner, thickness=1.0, load_direction=direction, **options
    )


def small_wall() -> Model:
    """Three courses of two and a half units of the published walls, with their joints."""
    unit_width, height = 0.4, 0.175
    blocks = [
        Block(
            id="base",
            vertices=rectangle(-0.4, -0.2, 1.8, 0.2),
            unit_weight=UNIT_WEIGHT,
            support=True,
        )
    ]
    for course, widths in enumerate(([2, 2, 1], [1, 2, 2], [2, 2, 1])):
        x = 0.0
        for unit, halves in enumerate(widths):
            width = 0.5 * halves * unit_width
            blocks.append(
                Block(
                    id=f"c{course + 1}u{unit + 1}",
                    vertices=rectangle(x, course * height, width, height),
                    unit_weight=UNIT_WEIGHT,
                )
            )
            x += width
    return make_model(
        blocks,
        joint=PUBLISHED_JOINT,
        corner=Corner(radius=0.02),
        thickness=1.0,
        load_direction=(1.0, 0.0),
    )


def with_corner(model: Model, corner: Corner) -> Model:
    """The same model with other corners."""
    a = model.assembly
    assembly = Assembly.build(
        a.blocks,
        joint=a.joint,
        corner=corner,
        thickness=a.thickness,
        joint_between=a.joint_between,
    )
    return replace(model, assembly=assembly)


def with_joint(model: Model, joint: JointLaw) -> Model:
    """The same model with another law of every joint."""
    a = model.assembly
    assembly = Assembly.build(a.blocks, joint=joint, corner=a.corner, thickness=a.thickness)
    return replace(model, assembly=assembly)


def problem_of(model: Model) -> Problem:
    """What an engine is given of a model."""
    return Problem(assembly=model.assembly, load=model.load, control_point=model.control_point)


@dataclass(frozen=True)
class RockingBlock:
    """A rigid block that rocks on a rounded toe, pushed to the right in proportion to its weight.

    The toe's disc has radius r and its centre stays at height r while it rolls.  With width B and
    height H, a = B/2 - r and e = H/2 - r, the centroid lies from the disc's centre at the rotation
    theta

        x = -(a cos theta - e sin theta),      y = a sin theta + e cos theta

    and the contact right below the centre, so that moments about the contact give

        lambda_s = (a cos theta - e sin theta) / (a sin theta + e cos theta + r)

    The upper right corner of the outline starts at (r, H - r) from the disc's centre, and the
    centre itself rolls by r theta:

        delta = r theta + r cos theta + (H - r) sin theta - r

    About the contact the block turns with m(|v|^2 + I/m w^2) = m w^2 (x^2 + (y + r)^2 + I/m) and
    v_x = w (y + r), which gives c of the published strategy's bias.
    """

    width: float  # m
    height: float  # m
    radius: float = 0.0  # m

    @property
    def last(self) -> float:
        """Rotation at which nothing is carried any more [rad]."""
        return float(np.arctan2(self.width / 2 - self.radius, self.height / 2 - self.radius))

    def _arms(self, theta):
        a, e = self.width / 2 - self.radius, self.height / 2 - self.radius
        return (
            a * np.cos(theta) - e * np.sin(theta),
            a * np.sin(theta) + e * np.cos(theta) + self.radius,
        )

    def multiplier(self, theta):
        """Static multiplier."""
        x, y = self._arms(theta)
        return x / y

    def displacement(self, theta):
        """Of the upper right corner, horizontally [m]."""
        r = self.radius
        return r * theta + r * np.cos(theta) + (self.height - r) * np.sin(theta) - r

    def share(self, theta):
        """c = (sum m v_x)^2 / (M sum(m |v|^2 + I w^2))."""
        x, y = self._arms(theta)
        return y**2 / (x**2 + y**2 + (self.width**2 + self.height**2) / 12.0)

    def rotation(self, displacement):
        """Inverse of `displacement`, by a table of 2e4 intervals: good to 1e-9 of the whole."""
        theta = np.linspace(0.0, 1.2 * self.last, 20_001)
        return np.interp(displacement, self.displacement(theta), theta)

    @property
    def ultimate_displacement(self) -> float:
        """Displacement at the multiplier 0.01 [m]."""
        theta = np.linspace(0.0, self.last, 20_001)
        return float(np.interp(-0.01, -self.multiplier(theta), self.displacement(theta)))


@st.composite
def convex_polygons(draw) -> np.ndarray:
    """Points of a turned ellipse, at least 10 degrees apart: always convex, about the origin."""
    steps = draw(st.lists(st.integers(0, 35), min_size=3, max_size=8, unique=True))
    angle = np.radians(10.0 * np.sort(steps))
    half_axes = draw(st.tuples(st.floats(0.2, 0.6), st.floats(0.2, 0.6)))
    vertices = np.column_stack((np.cos(angle), np.sin(angle))) * half_axes
    return turned(vertices - vertices.mean(axis=0), draw(st.floats(-np.pi, np.pi)))


def distance(p: np.ndarray, q: np.ndarray) -> tuple[float, bool]:
    """Distance of two separated polygons, and whether it is between two vertices.

    Every vertex of one against every edge of the other: nothing is shared with the library.
    """
    best, vertices = np.inf, False
    for points, polygon in ((p, q), (q, p)):
        start, edge = polygon, np.roll(polygon, -1, axis=0) - polygon
        along = np.einsum("ijk,jk->ij", points[:, None] - start, edge) / np.sum(edge**2, axis=1)
        clipped = np.clip(along, 0.0, 1.0)
        gap = np.linalg.norm(points[:, None] - start - clipped[..., None] * edge, axis=2)
        k = np.unravel_index(np.argmin(gap), gap.shape)
        if gap[k] < best:
            best, vertices = float(gap[k]), bool(clipped[k] in (0.0, 1.0))
    return best, vertices


def core_of(assembly: Assembly, i: int, pose: np.ndarray) -> np.ndarray:
    """Core vertices of block ``i`` where they are in the given poses."""
    return turned(assembly.shapes.of(i), pose[i, 2]) + assembly.centroid[i] + pose[i, :2]


def approach(
    assembly: Assembly, direction: np.ndarray, wanted: float, angle: float = 0.0
) -> tuple[np.ndarray, float, bool]:
    """Poses of two blocks of which the second comes along a direction, turned by ``angle``.

    It stops where the cores are ``wanted`` [m] apart, to 1e-9 where it hits squarely.  Returns the
    poses and the distance of the cores, as `distance` does.
    """
    pose = np.zeros((2, 3))
    pose[1, 2] = angle
    for _ in range(200):
        apart, vertices = distance(core_of(assembly, 0, pose), core_of(assembly, 1, pose))
        if apart - wanted < 1e-9:
            break
        pose[1, :2] += (apart - wanted) * direction  # no nearer than wanted, wherever it touches
    return pose, apart, vertices


def contacts_of(assembly: Assembly, pose: np.ndarray) -> tuple[Detector, Pairs, Slots]:
    """Pairs and contacts found from nothing in the given poses."""
    detector = Detector(assembly)
    pairs = detector.pairs(pose)
    slots = Slots.empty(pairs.n_slots, 2)
    detector.fill(pairs, pose, slots)
    return detector, pairs, slots
