"""What every engine reports of a step, computed in one place from poses, forces and contacts."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from drystone.assembly import GRAVITY
from drystone.contact.forces import OPEN, SLIDING, STICKING
from drystone.engines.base import Problem, StepReport
from drystone.kernels import narrow
from drystone.kernels.narrow import Slots

Array = NDArray[np.float64]
IntArray = NDArray[np.int64]

#: Acceleration of a block, over gravity, above which a point counts as passed dynamically.
ACCELERATION_LIMIT = 0.3


@dataclass(frozen=True, kw_only=True)
class StepOutcome:
    """A solved step, in arrays over all bodies and slots."""

    multiplier: float  # applied
    pose: Array  # (n, n_dof) at the end
    increment: Array  # (n, n_dof) m, rad
    acceleration: Array  # (n, n_dof) m/s2, rad/s2
    velocity: Array  # (n, n_dof) m/s, rad/s, at the end
    contact_force: Array  # (n, n_dof) N, N m, of all contacts, on fixed bodies too
    slots: Slots  # contacts in the poses at the end
    reaction: Array  # (n_slots, dim) N
    status: IntArray  # (n_slots,)
    residual: float  # N
    motion: float  # m, of the fastest block
    n_iterations: int


@dataclass(frozen=True, kw_only=True)
class LoadArrays:
    """Loads and masses of a problem as arrays, (n, n_dof); zero on supports."""

    dead: Array  # N, N m
    pattern: Array  # N, N m, at multiplier one
    mass: Array  # kg, kg m2
    total: float  # N, sum of the pattern along its direction


def report(problem: Problem, loads: LoadArrays, outcome: StepOutcome) -> StepReport:
    """The figures of a converged step; see `CurvePoint` for their meaning."""
    assembly = problem.assembly
    dim = assembly.dimension
    direction = problem.load.direction
    inertia = loads.mass * outcome.acceleration
    static = outcome.multiplier - _unbalanced_multiplier(loads, inertia, outcome)
    # What the blocks hand to the supports, less the dead load; the reaction is its opposite.
    carried = float((outcome.contact_force[assembly.fixed, :dim] @ direction).sum())
    carried -= float((loads.dead[:, :dim] @ direction).sum())
    applied = max(abs(outcome.multiplier), 1e-3) * loads.total
    inertia_ratio = float(np.linalg.norm(inertia[:, :dim], axis=1).sum()) / applied
    fastest = float(np.linalg.norm(outcome.acceleration[:, :dim], axis=1).max())
    kinetic = 0.5 * float(np.sum(loads.mass * outcome.velocity**2))
    work = abs(float(np.sum((loads.dead + outcome.multiplier * loads.pattern) * outcome.increment)))
    used = outcome.slots.kind != narrow.NONE
    status = outcome.status[used]
    return StepReport(
        converged=True,
        applied_multiplier=outcome.multiplier,
        carried_multiplier=carried / loads.total,
        static_multiplier=static,
        control_displacement=problem.control_point.displacement(assembly, outcome.pose),
        residual=outcome.residual / assembly.heaviest_weight,
        penetration=float(max(0.0, -outcome.slots.gap.min(initial=0.0))),
        friction_violation=0.0,
        energy_ratio=kinetic / work if work > 0.0 else 0.0,
        inertia_ratio=inertia_ratio,
        n_open=int(np.count_nonzero(status == OPEN)),
        n_sticking=int(np.count_nonzero(status == STICKING)),
        n_sliding=int(np.count_nonzero(status == SLIDING)),
        motion=outcome.motion,
        n_iterations=outcome.n_iterations,
        dynamic=fastest > ACCELERATION_LIMIT * GRAVITY,
    )


def _unbalanced_multiplier(loads: LoadArrays, inertia: Array, outcome: StepOutcome) -> float:
    """By how much the applied multiplier exceeds the static one, from the step's virtual work.

    On its own motion x the structure would rest under lambda_s with F.x lambda_s = F.x lambda -
    x.M a.  Blocks that no contact holds obey this whatever the multiplier and say nothing of it.
    Without motion along the load there is nothing to tell the two multipliers apart.
    """
    held = np.abs(outcome.contact_force).max(axis=1) > 0.0
    x = outcome.increment[held]
    push = float(np.sum(loads.pattern[held] * x))
    if abs(push) <= 1e-2 * float(np.sum(np.abs(loads.pattern[held] * x))):
        return 0.0
    return float(np.sum(inertia[held] * x)) / push


def cone_excess(reaction: Array, friction: Array) -> float:
    """Largest excess of tangential over limiting reaction [N]."""
    excess = np.abs(reaction[:, 1]) - friction * np.maximum(reaction[:, 0], 0.0)
    return float(max(0.0, excess.max(initial=0.0)))


def unstable_sentence(ids: tuple[str, ...], motion: Array) -> str:
    """Which blocks move under the dead load, the farthest first."""
    order = np.argsort(-motion, kind="stable")
    moving = [i for i in order if motion[i] > 0.1 * motion[order[0]]]
    named = ", ".join(f'"{ids[i]}" ({1e3 * motion[i]:.0f} mm)' for i in moving[:5])
    more = f" and {len(moving) - 5} more" if len(moving) > 5 else ""
    return f"the structure does not stand under its own weight: {named}{more} keep moving"
