"""A block that falls over one corner, against an independent integration of its motion.

The corner stays where it is, as friction holds it.  About it the block turns by

    I_P dw/dt + w x I_P w = r x m g,        dR/dt = R [w],

in axes of its own, r from the corner to the centroid: integrated by scipy to 1e-10.
"""

from __future__ import annotations

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.spatial.transform import Rotation

from drystone.dynamics.distinct.engine import DistinctEngine
from drystone.dynamics.distinct.state import DistinctSettings
from drystone.engines.base import Demand, Problem
from drystone.model.assembly import GRAVITY
from solids import one_block

TIME = 0.25  # s, in which the centroid falls by some centimetres
SIZE = np.array([0.4, 0.6, 1.5])  # m


def tilted() -> tuple[np.ndarray, Rotation]:
    """Pose (7,) of the block on its corner (0.4, 0.6, 0), leaning over it askew, and its turn."""
    axis = np.array([-0.7, 0.6, 0.0])
    turn = Rotation.from_rotvec(0.35 * axis / np.linalg.norm(axis))
    arm = 0.5 * SIZE * (-1.0, -1.0, 1.0)
    centroid = np.array([0.4, 0.6, 0.0]) + turn.apply(arm)
    return np.concatenate((centroid - 0.5 * SIZE, turn.as_quat(scalar_first=True))), turn


def integrated(turn: Rotation) -> np.ndarray:
    """Where the centroid is after the time, from the corner (3,) [m]."""
    arm = 0.5 * SIZE * (-1.0, -1.0, 1.0)
    moments = (np.sum(SIZE**2) - SIZE**2) / 12.0  # of unit mass, about the centroid
    inertia = np.diag(moments) + arm @ arm * np.eye(3) - np.outer(arm, arm)

    def rate(_: float, state: np.ndarray) -> np.ndarray:
        now = Rotation.from_quat(state[:4] / np.linalg.norm(state[:4]), scalar_first=True)
        w = state[4:]
        weight = now.inv().apply([0.0, 0.0, -GRAVITY])
        moment = np.cross(arm, weight) - np.cross(w, inertia @ w)
        q0, q = state[0], state[1:4]
        turning = 0.5 * np.concatenate(([-q @ w], q0 * w + np.cross(q, w)))
        return np.concatenate((turning, np.linalg.solve(inertia, moment)))

    start = np.concatenate((turn.as_quat(scalar_first=True), np.zeros(3)))
    end = solve_ivp(rate, (0.0, TIME), start, rtol=1e-10, atol=1e-12).y[:, -1]
    return Rotation.from_quat(end[:4], scalar_first=True).apply(arm)


def test_distinct_falls_over_a_corner_as_integrated():
    """1e-3 of the way: the corner gives way by 1e-5 m under the weight, and trembles."""
    model = one_block(friction=5.0, stiffness=1e11)
    pose, turn = tilted()
    engine = DistinctEngine(DistinctSettings(local_damping=0.0, safety=0.5))
    problem = Problem(assembly=model.assembly, load=model.load, control_point=model.control_point)
    poses = model.assembly.design_pose()
    poses[1] = pose
    state = engine.release(problem, pose=poses)
    for _ in range(5):
        demand = Demand(multiplier=0.0, time_step=TIME / 5.0, stop_blocks=False)
        state, report = engine.step(state, demand)
        assert report.converged, report.reason
    corner = np.array([0.4, 0.6, 0.0])
    found = 0.5 * SIZE + state.pose[1, :3] - corner
    expected = integrated(turn)
    way = np.linalg.norm(expected - (0.5 * SIZE + pose[:3] - corner))
    assert way > 0.02
    assert found == pytest.approx(expected, abs=1e-3 * way + 2e-5)
