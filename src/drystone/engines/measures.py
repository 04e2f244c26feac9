"""What every engine reports of a step, computed in one place from poses, forces and contacts."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from drystone.assembly import GRAVITY
from drystone.contact.certificate import Certificate
from drystone.engines.base import Problem, StepReport
from drystone.geometry.motion import translations
from drystone.kernels import measures as kernels
from drystone.kernels.contacts import Slots
from drystone.loading import dead_load

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
    status: IntArray  # (n_slots,)
    certificate: Certificate
    motion: float  # m, of the fastest block
    n_iterations: int


@dataclass(frozen=True, kw_only=True)
class LoadArrays:
    """Loads and masses of a problem as arrays, (n, n_dof); zero on what is fixed."""

    dead: Array  # N, N m
    pattern: Array  # N, N m, at multiplier one
    mass: Array  # kg, kg m2
    total: float  # N, sum of the pattern along its direction
    fixed: NDArray[np.bool_]  # (n,) supports, and blocks that have left

    @classmethod
    def of(cls, problem: Problem, gone: NDArray[np.bool_] | None = None) -> LoadArrays:
        """Those of a problem, without the blocks that are ``gone`` (n,)."""
        assembly, load = problem.assembly, problem.load
        lost = np.zeros(assembly.n_bodies, np.bool_) if gone is None else gone
        fixed = assembly.fixed | lost
        dead, pattern = dead_load(assembly), load.forces(assembly)
        taken = float((translations(pattern)[lost] @ load.direction).sum())
        dead[lost], pattern[lost] = 0.0, 0.0
        return cls(
            dead=dead,
            pattern=pattern,
            mass=np.where(fixed[:, None], 0.0, assembly.mass),
            total=load.total(assembly) - taken,
            fixed=fixed,
        )


def report(problem: Problem, loads: LoadArrays, outcome: StepOutcome) -> StepReport:
    """The figures of a converged step; see `CurvePoint` for their meaning."""
    assembly, multiplier, slots = problem.assembly, outcome.multiplier, outcome.slots
    carried, inertia, fastest, kinetic, work, push, strokes, resistance = kernels.sum_blocks(
        outcome.increment, outcome.acceleration, outcome.velocity, outcome.contact_force,
        outcome.certificate.held, loads.dead, loads.pattern, loads.mass, loads.fixed,
        problem.load.direction, multiplier,
    )  # fmt: skip
    counts = np.zeros(3, np.int64)
    penetration = kernels.count_contacts(slots, outcome.status, counts)
    n_open, n_sticking, n_sliding = counts.tolist()  # OPEN, STICKING, SLIDING
    # By how much the applied multiplier exceeds the static one, from the step's virtual work: on
    # its own motion x the structure would rest under lambda_s with F.x lambda_s = F.x lambda -
    # x.M a.  Blocks that no contact holds obey this whatever the multiplier and say nothing of it.
    # Without motion along the load there is nothing to tell the two multipliers apart.
    excess = resistance / push if abs(push) > 1e-2 * strokes else 0.0
    return StepReport(
        converged=True,
        applied_multiplier=multiplier,
        carried_multiplier=carried / loads.total,
        static_multiplier=multiplier - excess,
        control_displacement=problem.control_point.displacement(assembly, outcome.pose),
        residual=outcome.certificate.residual / assembly.heaviest_weight,
        penetration=penetration,
        friction_violation=outcome.certificate.cone / assembly.heaviest_weight,
        energy_ratio=kinetic / work if work > 0.0 else 0.0,
        inertia_ratio=inertia / (max(abs(multiplier), 1e-3) * loads.total),
        n_open=n_open,
        n_sticking=n_sticking,
        n_sliding=n_sliding,
        motion=outcome.motion,
        n_iterations=outcome.n_iterations,
        dynamic=fastest > ACCELERATION_LIMIT * GRAVITY,
    )


def unstable_sentence(ids: tuple[str, ...], motion: Array) -> str:
    """Which blocks move under the dead load, the farthest first."""
    if not motion.any():
        return "no equilibrium under the structure's own weight was found"
    order = np.argsort(-motion, kind="stable")
    moving = [i for i in order if motion[i] > 0.1 * motion[order[0]]]
    named = ", ".join(f'"{ids[i]}" ({1e3 * motion[i]:.0f} mm)' for i in moving[:5])
    more = f" and {len(moving) - 5} more" if len(moving) > 5 else ""
    return f"the structure does not stand under its own weight: {named}{more} keep moving"
