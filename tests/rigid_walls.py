"""A wall that turns about its toe as one, cut into courses: what it does in closed form."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise

import numpy as np

import drystone as ds
from drystone.results.curve import CapacityCurve, CurvePoint

HEIGHT, WIDTH, WEIGHT = 4.0, 0.5, 18e3  # m, m, N/m3


def wall_in_courses(heights: Sequence[float], **options: float) -> ds.Model:
    """A wall on a base, cut at heights [m] that end with its own; the first course is "c0"."""
    levels = [0.0, *heights]
    base = np.array([[-1.0, -0.3], [1.5, -0.3], [1.5, 0.0], [-1.0, 0.0]])
    blocks = [ds.Block(id="base", vertices=base, unit_weight=WEIGHT, support=True)]
    for i, (low, high) in enumerate(pairwise(levels)):
        course = np.array([[0.0, low], [WIDTH, low], [WIDTH, high], [0.0, high]])
        blocks.append(ds.Block(id=f"c{i}", vertices=course, unit_weight=WEIGHT))
    return ds.make_model(
        blocks,
        joint=ds.JointLaw(friction_coefficient=0.7, normal_stiffness=1e13, shear_stiffness=1e13),
        load_direction=[1.0, 0.0],
        thickness=1.0,
        control_block=f"c{len(heights) - 1}",
        control_point=[WIDTH, levels[-1]],
        analysis=ds.Analysis(stop_multiplier=1e-3, options=options),
    )


def evenly(n: int) -> list[float]:
    """Heights of ``n`` equal courses [m]."""
    return [HEIGHT * (i + 1) / n for i in range(n)]


def point_at(step: int, displacement: float, multiplier: float, **changes: object) -> CurvePoint:
    """A point of a curve, without a blemish."""
    values = {
        "applied_multiplier": multiplier,
        "carried_multiplier": multiplier,
        "residual": 0.0,
        "penetration": 0.0,
        "friction_violation": 0.0,
        "energy_ratio": 0.0,
        "inertia_ratio": 0.0,
        "n_open": 0,
        "n_sticking": 0,
        "n_sliding": 0,
        "motion": 0.0,
        "time_step": 0.0,
        "n_iterations": 1,
    }
    return CurvePoint(
        step=step,
        control_displacement=displacement,
        load_multiplier=multiplier,
        **{**values, **changes},  # type: ignore[arg-type]
    )


def curve_of(points: Sequence[CurvePoint], poses: np.ndarray | None = None) -> CapacityCurve:
    """A complete curve of these points."""
    return CapacityCurve(
        engine="equilibrium",
        strategy="displacement",
        points=tuple(points),
        status="finished",
        reason="the multiplier fell below the stop value",
        stop_multiplier=1e-3,
        wall_time=0.0,
        poses=poses,
    )


def turning(model: ds.Model, angles: Sequence[float]) -> CapacityCurve:
    """The wall's curve where it turns as one about its toe (WIDTH, 0) by angles [rad]: it bears
    lambda = tan(alpha - theta), alpha = atan(WIDTH/HEIGHT), in any of these positions."""
    assembly = model.assembly
    alpha = np.arctan(WIDTH / HEIGHT)
    toe = np.array([WIDTH, 0.0])
    poses = np.zeros((len(angles) + 1, assembly.n_bodies, 3))
    points = [point_at(0, 0.0, 0.0)]
    for k, angle in enumerate(angles, start=1):
        c, s = np.cos(angle), np.sin(angle)
        turned = np.array([[c, s], [-s, c]])  # clockwise, to the right
        move = (assembly.centroid - toe) @ turned.T + toe - assembly.centroid
        poses[k, 1:, :2], poses[k, 1:, 2] = move[1:], -angle
        displacement = model.control_point.displacement(assembly, poses[k])
        points.append(point_at(k, displacement, float(np.tan(alpha - angle))))
    return curve_of(points, poses)
