"""The residual that judges the steps of all engines: the error of a step's equations, in newtons.

An engine passes its result: the forces on the blocks, the gaps, slips and reactions of the
contacts, and the remaining strengths of their joints.  How it found them does not matter here.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from drystone.common.arrays import Array, BoolArray
from drystone.contact.contacts import BOND, TENSILE, Contacts
from drystone.contact.rows import contact_velocities, dof_of
from drystone.law.columns import BROKEN, DILATION
from drystone.law.residual import mark_touched, unbalanced_force
from drystone.law.violation import joint_law_violation


class JudgedContacts(NamedTuple):
    """Contacts at the end of a step, as the formulation of an engine has them; see `law.return_map`
    for their law."""

    contacts: Contacts  # bodies, stiffness, friction and strengths, (n_contacts,)
    gap: Array  # (n_contacts,) m, at the end of the step, less dilation
    slip: Array  # (n_contacts, dim - 1) m, in the step; zero if ``shear_before`` contains it
    reaction: Array  # (n_contacts, dim) N
    shear_before: Array  # (n_contacts, dim - 1) N, at the start, or trial shear if slip is zero
    whole: Array  # (n_contacts,) 1 if a bond has not broken, else 0
    slack: Array  # (n_contacts,) N, accuracy of reactions: a smaller excess breaks no bond

    @classmethod
    def with_history(
        cls,
        contacts: Contacts,
        gap: Array,
        history: Array,
        reaction: Array,
        shear_before: Array,
        slack: Array | None = None,
    ) -> JudgedContacts:
        """Contacts with a ``history`` (n_contacts, N_HISTORY or more), whose ``shear_before`` is
        the trial shear, which contains the slip."""
        return cls(
            contacts=contacts,
            gap=gap - history[:, DILATION],
            slip=np.zeros(shear_before.shape),
            reaction=reaction,
            shear_before=shear_before,
            whole=(history[:, BROKEN] == 0.0).astype(float),
            slack=np.zeros(len(gap)) if slack is None else slack,
        )

    @classmethod
    def of_impulses(
        cls, contacts: Contacts, gap: Array, velocity: Array, reaction: Array, h: float
    ) -> JudgedContacts:
        """Contacts of a step of ``h`` [s] that ends with a velocity (n, n_dof).

        Gaps are extrapolated from those at the start.  Friction has no shear stiffness; that in
        ``contacts`` is the one of the natural map, see `law.violation`.
        """
        relative = np.zeros_like(reaction)
        contact_velocities(dof_of(velocity), contacts, velocity, relative)
        return cls(
            contacts=contacts,
            gap=gap + h * relative[:, 0],
            slip=h * relative[:, 1:],
            reaction=reaction,
            shear_before=reaction[:, 1:],
            whole=np.zeros(len(gap)),
            slack=np.zeros(len(gap)),
        )

    @property
    def strength(self) -> tuple[Array, Array]:
        """Remaining cohesion and tensile strength [N] of the contacts, (n_contacts,) each."""
        table = self.contacts.table
        return table[:, BOND] * self.whole, table[:, TENSILE] * self.whole


class Forces(NamedTuple):
    """Forces on the blocks at the end of a step, (n, n_dof) [N, N m] each."""

    contact: Array  # of all contacts, on supports too
    load: Array  # dead load, load pattern, and other forces of the formulation
    inertia: Array  # mass times acceleration


class Certificate(NamedTuple):
    """The errors of a step's equations [N], and the blocks on which contacts act.

    The errors are NaN if a force is NaN.
    """

    balance: float  # largest unbalanced force, or moment over block size
    normal: float  # largest difference of a normal reaction from that of the joint law
    tangential: float  # largest difference of a tangential reaction
    cone: float  # largest excess over friction and cohesion
    touched: BoolArray  # (n,)

    @property
    def residual(self) -> float:
        """The largest of `balance`, `normal` and `tangential` [N]."""
        parts = self.balance, self.normal, self.tangential
        return math.nan if any(map(math.isnan, parts)) else max(parts)


def certify(
    contacts: JudgedContacts, forces: Forces, extent: Array, fixed: BoolArray
) -> Certificate:
    """Judge a step.

    Parameters
    ----------
    contacts, forces
        Result of the step.
    extent
        (n,) m, by which moments are divided.
    fixed
        (n,) supports, whose balance does not count.
    """
    c = contacts
    normal, tangential, cone = joint_law_violation(
        c.contacts.table, c.gap, c.slip, c.reaction, c.shear_before, c.whole, c.slack
    )
    touched = np.zeros(len(fixed), np.bool_)
    mark_touched(c.contacts, c.reaction, touched)
    return Certificate(
        balance=float(
            unbalanced_force(forces.contact + forces.load, forces.inertia, extent, fixed)
        ),
        normal=float(normal),
        tangential=float(tangential),
        cone=float(cone),
        touched=touched,
    )
