"""Results of a wall of a thousand blocks and hundreds of points, made up without any engine.

A leaf of boxes in running bond leans out, its upper courses more; every block trembles on its own,
and so do the forces in its joints: smooth where analyses are smooth, rough in the last digits where
they are.
"""

from __future__ import annotations

import math
from itertools import pairwise
from pathlib import Path

import numpy as np

from drystone.contact.forces import OPEN, SLIDING, STICKING, ContactForces
from drystone.geometry.motion import moved_points, rotated
from drystone.io.results.names import RESULTS
from drystone.io.results.results_writer import ResultsWriter
from drystone.model.model import Model
from drystone.results.curve import CapacityCurve, CurvePoint
from solids import box, joint, model_of

UNIT, DEPTH, COURSE = 0.4, 0.2, 0.175  # m
WALL_TIME = 60.0


def large_wall(units: int, courses: int) -> Model:
    """A leaf of ``units`` a course, every second course with a half unit at both ends."""
    length = units * UNIT
    blocks = [box("base", (-0.3, -0.3, -0.2), (length + 0.3, DEPTH + 0.3, 0.0), support=True)]
    for row in range(courses):
        inner = np.arange(units + 1) * UNIT
        ends = inner if row % 2 == 0 else np.concatenate(([0.0], inner[:-1] + UNIT / 2, [length]))
        low, high = row * COURSE, (row + 1) * COURSE
        blocks += [
            box(f"{row + 1}.{column + 1}", (a, 0.0, low), (b, DEPTH, high))
            for column, (a, b) in enumerate(pairwise(ends))
        ]
    return model_of(blocks, joint(0.6), push=(0.0, -1.0, 0.0))


def write_large_folder(path: Path, *, units=25, courses=40, n_points=300, seed=1) -> Model:
    """Write ``results.h5`` into the folder, which is made; the model of it."""
    model = large_wall(units, courses)
    assembly = model.assembly
    rng = np.random.default_rng(seed)
    path.mkdir(parents=True, exist_ok=True)
    made = _Made(model, rng)
    points = []
    with np.errstate(all="ignore"):
        writer = ResultsWriter(path / RESULTS, model, "equilibrium", "displacement")
        for k in range(n_points):
            share = k / max(n_points - 1, 1)
            point = _point(k, share)
            pose = made.pose(share)
            writer.append(point, pose, made.contacts(share, pose))
            points.append(point)
    writer.close(
        CapacityCurve(
            engine="equilibrium", strategy="displacement", points=tuple(points),
            status="finished", reason="made up", stop_multiplier=0.01, wall_time=WALL_TIME,
        )
    )  # fmt: skip
    assert assembly.n_bodies > 0
    return model


class _Made:
    """States between rest (0) and collapse (1)."""

    def __init__(self, model: Model, rng: np.random.Generator) -> None:
        self.assembly = model.assembly
        self.rng = rng
        n = self.assembly.n_bodies
        self.phase = rng.uniform(0.0, 2.0 * math.pi, (n, 6))
        self.rate = rng.uniform(1.0, 6.0, (n, 6))
        self.faces = self.assembly.interfaces
        k = len(self.faces.block_a)
        self.force_phase = rng.uniform(0.0, 2.0 * math.pi, k)

    def pose(self, share: float) -> np.ndarray:
        a = self.assembly
        high = a.centroid[:, 2] / a.centroid[:, 2].max()
        wave = np.sin(self.rate * share * math.pi + self.phase) - np.sin(self.phase)
        tremble = 2e-3 * share * wave + 1e-7 * self.rng.standard_normal(wave.shape)
        lean = 0.35 * share**2 * high
        vector = np.column_stack((lean, 0.02 * share * high, 0.0 * high)) + tremble[:, 3:]
        angle = np.linalg.norm(vector, axis=1, keepdims=True)
        pose = a.design_pose()
        pose[:, :3] = tremble[:, :3]
        pose[:, 1] -= 0.8 * share**2 * high**2
        pose[:, 3:4] = np.cos(0.5 * angle)
        pose[:, 4:] = 0.5 * np.sinc(0.5 * angle / math.pi) * vector
        pose[a.fixed] = a.design_pose()[a.fixed]
        return pose

    def contacts(self, share: float, pose: np.ndarray) -> ContactForces:
        faces, a = self.faces, self.assembly
        joint = faces.joint
        block = faces.block_a[joint]
        place = moved_points(faces.corners, block, a.centroid, pose)
        normal = rotated(faces.normal[joint], pose[block])
        tangent = rotated(faces.tangent[joint], pose[block])
        above = 1.0 - a.centroid[block, 2] / (1.1 * a.centroid[:, 2].max())
        wave = np.sin(5.0 * share + self.force_phase[joint] + np.arange(len(joint)) % 4)
        rough = 1.0 + 1e-6 * self.rng.standard_normal(len(joint))
        size = 2e4 * np.maximum(above + 0.3 * wave - 0.3 * share, 0.0) * rough
        shear = np.column_stack((0.3 * size * wave, 0.5 * size * share)) * rough[:, None]
        mobilised = np.linalg.norm(shear, axis=1) / np.maximum(size, 1e-9)
        status = np.where(size <= 0.0, OPEN, np.where(mobilised > 0.55, SLIDING, STICKING))
        return ContactForces(
            block_a=block, block_b=faces.block_b[joint], position=place, normal=normal,
            gap=np.where(size > 0.0, 0.0, 1e-3), area=np.full(len(joint), 0.01),
            normal_reaction=size, tangential_reaction=shear, status=status, tangent=tangent,
        )  # fmt: skip


def _point(step: int, share: float) -> CurvePoint:
    multiplier = 0.4 * min(20.0 * share, 1.0) * (1.0 - share)
    return CurvePoint(
        step=step, control_displacement=0.8 * share**2, load_multiplier=multiplier,
        applied_multiplier=multiplier, carried_multiplier=multiplier, residual=1e-10,
        penetration=1e-5, friction_violation=0.0, energy_ratio=0.0, inertia_ratio=0.0,
        n_open=0, n_sticking=0, n_sliding=0, motion=1e-3, time_step=0.0, n_iterations=3,
    )  # fmt: skip
