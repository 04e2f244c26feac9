"""The one residual that judges every engine: what a step leaves of its equations, in newtons.

An engine hands over what it found, in the terms of its formulation: the forces on the blocks, the
contacts' gaps, slips and reactions, and what their joints still have of strength.  How it came by
them does not matter here.
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
    """Contacts of a step as its formulation has them; see `law.return_map` for their law."""

    contacts: Contacts  # bodies, stiffnesses, friction and strengths, (n_contacts,)
    gap: Array  # (n_contacts,) m, at the end of the step, less dilation
    slip: Array  # (n_contacts, dim - 1) m, since the shear before; zero where it has entered that
    reaction: Array  # (n_contacts, dim) N
    shear_before: Array  # (n_contacts, dim - 1) N
    whole: Array  # (n_contacts,) 1 where a bond has not broken, else 0
    slack: Array  # (n_contacts,) N, how well reactions are known: no bond breaks for less

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
        """Of joints with a past (n_contacts, N_HISTORY), whose slips have entered the shear."""
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
        """Of a step of size ``h`` [s] that ends with a velocity (n, n_dof).

        Gaps are mapped from where it starts, and friction has no shear stiffness but that of the
        natural map, which is in ``contacts``.
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
        """Cohesion and tensile strength [N] that contacts still have, (n_contacts,) each."""
        table = self.contacts.table
        return table[:, BOND] * self.whole, table[:, TENSILE] * self.whole


class Forces(NamedTuple):
    """What acts on the blocks at the end of a step, (n, n_dof) [N, N m] each."""

    contact: Array  # of all contacts, on supports too
    load: Array  # dead load, pattern and whatever else the formulation adds
    inertia: Array  # mass times acceleration


class Certificate(NamedTuple):
    """How far a step is from its equations [N], and which blocks a contact acts on.

    NaN where something is not a number.
    """

    balance: float  # largest unbalanced force, or moment over block size
    normal: float  # largest distance of a normal reaction from the law's
    tangential: float  # and of a tangential one
    cone: float  # largest excess over friction and cohesion
    touched: BoolArray  # (n,)

    @property
    def residual(self) -> float:
        """The largest of the three [N]."""
        parts = self.balance, self.normal, self.tangential
        return math.nan if any(map(math.isnan, parts)) else max(parts)


def certify(
    contacts: JudgedContacts, forces: Forces, extent: Array, fixed: BoolArray
) -> Certificate:
    """Judge a step.

    Parameters
    ----------
    contacts, forces
        What was found.
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
