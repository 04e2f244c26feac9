"""Concave blocks, whose convex parts move as one: closed forms as of the same body in one piece."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import pytest

import drystone as ds
from drystone.analysis.driver import pushover
from drystone.engines import make_engine
from drystone.engines.base import Demand, Problem
from drystone.model.assembly import Assembly, Block
from drystone.model.joint_law import JointLaw
from drystone.model.loading import MassPattern
from drystone.model.model import Model
from drystone.model.monitor import ControlPoint
from drystone.results.curve import STATIC

STIFF = 1e11  # Pa/m
L = np.array([[0, 0], [0.5, 0], [0.5, 0.2], [0.2, 0.2], [0.2, 0.9], [0, 0.9]], float)
U = np.array([[0, 0], [0.2, 0], [0.2, 0.5], [0.6, 0.5], [0.6, 0], [0.8, 0], [0.8, 0.8], [0, 0.8]])

#: Of the rocking branch, over the peak: what compliance leaves; of steps in time, which are of the
#: first order, also the size of the first ones after the peak.  In the mean it is half of that.
ACCURACY = {"equilibrium": 1e-4, "nscd": 1.5e-2, "distinct": 1e-3}

CASES = [(n, engine) for n in (2, 3) for engine in ("equilibrium", "nscd", "distinct")]


def on_base(outline: np.ndarray, dimension: int, *, friction: float = 1.5, **more) -> Model:
    """A block on a wide base, pushed to the right and read at its highest, rightmost vertex."""
    base = np.array([[-2.0, -0.3], [3.0, -0.3], [3.0, 0.0], [-2.0, 0.0]])
    return standing({"base": base, "b": outline}, dimension, friction=friction, **more)


def standing(
    outlines: dict[str, np.ndarray],
    dimension: int,
    *,
    friction: float,
    push: tuple[float, float] = (1.0, 0.0),
) -> Model:
    """Blocks of which all but the last are supports."""
    *_, last = outlines
    blocks = [
        Block(id=name, vertices=np.asarray(v, float), unit_weight=10e3, support=name != last)
        for name, v in outlines.items()
    ]
    law = JointLaw(friction_coefficient=friction, normal_stiffness=STIFF, shear_stiffness=STIFF)
    top = outlines[last]
    model = Model(
        title=last,
        assembly=Assembly.build(blocks, joint=law),
        load=MassPattern(direction=np.array(push)),
        control_point=ControlPoint(
            block=len(blocks) - 1,
            point=np.asarray(top[np.lexsort((top[:, 0], top[:, 1]))[-1]], float),
            direction=np.array(push),
        ),
    )
    return ds.extruded(model) if dimension == 3 else model


@dataclass(frozen=True)
class Rocking:
    """A rigid body that turns by theta about its toe (b, 0), its centroid p behind and q above it:

    lambda = (p cos theta - q sin theta) / (p sin theta + q cos theta)
    """

    p: float
    q: float

    def multiplier(self, theta: np.ndarray) -> np.ndarray:
        c, s = np.cos(theta), np.sin(theta)
        return (self.p * c - self.q * s) / (self.p * s + self.q * c)

    def multiplier_at(self, displacement: np.ndarray, behind: float, above: float) -> np.ndarray:
        """By the displacement of a point, which grows with the rotation."""
        theta = np.linspace(0.0, np.arctan2(self.p, self.q), 20_001)
        moved = behind * (1.0 - np.cos(theta)) + above * np.sin(theta)
        return np.interp(displacement, moved, self.multiplier(theta))


@pytest.mark.parametrize(("dimension", "engine"), CASES)
@pytest.mark.parametrize(("outline", "toe", "parts"), [(L, 0.5, 2), (U, 0.8, 3)])
def test_a_concave_block_rocks_as_one_body(outline, toe, parts, dimension, engine):
    model = on_base(outline, dimension)
    assembly = model.assembly
    assert np.count_nonzero(assembly.shapes.body == 1) == parts
    x, y = assembly.centroid[1, [0, -1]]
    form = Rocking(p=toe - x, q=y)
    curve = pushover(model, engine=engine)
    point = model.control_point.point
    static = np.array([p.status == STATIC for p in curve.points])
    moved = curve.control_displacement[static]
    end = form.multiplier_at(moved, toe - point[0], point[-1])
    branch = (moved > 0.01 * moved.max()) & (end > 0.05)
    assert np.count_nonzero(branch) > 20
    off = np.abs(curve.load_multiplier[static] - end)[branch]
    allowed = ACCURACY[engine] * form.multiplier(np.zeros(1))[0]
    assert off.max() <= allowed
    assert np.median(off) <= 0.5 * allowed


#: A tail that widens upwards, from 0.2 to 0.4 m, in a socket that fits; and a straight one.
TAIL = np.array([[-0.1, 0], [0.1, 0], [0.2, 0.3], [0.2, 0.5], [-0.2, 0.5], [-0.2, 0.3]], float)
TENON = np.array([[-0.1, 0], [0.1, 0], [0.1, 0.5], [-0.1, 0.5]], float)


def hung(tail: np.ndarray, dimension: int) -> Model:
    """A block that hangs by its tail between two lips of a support, pulled down by the load."""
    lip = tail[(tail[:, 0] > 0.0) & (tail[:, 1] <= 0.3)]
    right = np.vstack(([[0.6, 0.0]], [[0.6, 0.3]], lip[::-1]))
    left = right[::-1] * (-1.0, 1.0)
    body = np.vstack(([[-0.3, -0.4]], [[0.3, -0.4]], [[0.3, -0.1]], [[0.1, -0.1]], tail[1:]))
    body = np.vstack((body, tail[:1], [[-0.1, -0.1]], [[-0.3, -0.1]]))
    outlines = {"left": left, "right": right, "b": body}
    return standing(outlines, dimension, friction=0.1, push=(0.0, -1.0))


@pytest.mark.parametrize(("dimension", "engine"), CASES)
def test_a_dovetail_holds(dimension, engine):
    """What is pulled out of a socket narrower than its tail stays, at ten times its weight too."""
    model = hung(TAIL, dimension)
    assembly = model.assembly
    assert np.count_nonzero(assembly.shapes.body == 2) > 1
    problem = Problem(assembly=assembly, load=model.load, control_point=model.control_point)
    made = make_engine(engine)
    state, report = made.start(problem)
    for multiplier in (3.0, 9.0):
        for _ in range(3):
            state, report = made.step(state, Demand(multiplier=multiplier, time_step=0.05))
            assert report.converged, report.reason
    made.close()
    assert np.abs(state.pose[2, : assembly.dimension]).max() < 1e-5


@pytest.mark.parametrize("dimension", [2, 3])
def test_a_straight_tenon_falls_out(dimension):
    with pytest.raises(ds.UnstableError):
        make_engine("nscd").start(
            Problem(
                assembly=(model := hung(TENON, dimension)).assembly,
                load=model.load,
                control_point=model.control_point,
            )
        )
