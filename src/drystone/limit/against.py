"""What the contact forces at a point of a curve carry against a mechanism.

On a mechanism u of rates, contact forces r, the dead load G and the load pattern F do the powers
r.u, G.u and F.u.  At rest r + G + lambda F = 0 on every block, so that for any u

    lambda = -(G.u + r.u) / F.u.

At a point in motion under an applied multiplier lambda_b, r + G + lambda_b F = M a, and the
quotient is lambda_b - u.M a / F.u, which depends on u.  The static multiplier of an engine in
motion is that of the step's own motion.  That need not be a mechanism that the structure has at
rest, as what is applied beyond may set more blocks in motion.  On the mechanism of limit analysis
the quotient is no more than its multiplier, (D(u) - G.u) / F.u with the power D(u) of its
dissipation, as long as blocks are where they were designed: forces within the cones of friction do
no less than -D(u).
"""

from __future__ import annotations

import numpy as np

from drystone.common.arrays import Array, IntArray
from drystone.contact.forces import ContactForces
from drystone.geometry.motion import moved_points, places
from drystone.limit.equilibrium import Equilibrium
from drystone.model.loading import Acting
from drystone.model.model import Model


def carried_against(
    model: Model, mechanism: Array, contacts: ContactForces, pose: Array | None
) -> float | None:
    """The multiplier that contact forces carry on a mechanism; None where that says nothing.

    Parameters
    ----------
    model
        Without ties, rollers and loads that tilt, which contacts know nothing of.
    mechanism
        Rates of all blocks (n, n_dof) [m, rad], in space about the axes of the world.
    contacts
        Of the point.
    pose
        Where blocks are then, (n, n_pose) [m, rad]; as designed where it is None.
    """
    assembly = model.assembly
    tilts = Acting.of(assembly, model.load, model.dead_loads, model.ties).tilted is not None
    if model.ties or assembly.on_rollers or tilts:
        return None
    balance = Equilibrium.of(assembly, model.load, model.dead_loads)
    moving = mechanism[~assembly.fixed]
    moving = np.hstack(
        (moving[:, : assembly.dimension], balance.length * moving[:, assembly.dimension :])
    ).ravel()
    dead = balance.force * float(balance.dead[: len(moving)] @ moving)
    live = balance.force * float(balance.live[: len(moving)] @ moving)
    if live <= 0.0:
        return None
    centroid = assembly.centroid if pose is None else places(assembly.centroid, pose)

    def rate(block: IntArray) -> Array:
        return moved_points(contacts.position, block, centroid, mechanism, linear=True)

    power = float(np.sum(contacts.vectors() * (rate(contacts.block_b) - rate(contacts.block_a))))
    return -(dead + power) / live
