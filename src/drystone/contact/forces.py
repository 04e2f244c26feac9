"""The contacts of one state, as results: what is drawn, written and judged."""

from __future__ import annotations

from dataclasses import dataclass, field, fields

import numpy as np

from drystone.common.arrays import Array, IntArray
from drystone.contact.contacts import Pairs, Slots
from drystone.geometry.motion import tangents, tangents_kept

OPEN, STICKING, SLIDING = 0, 1, 2


def _of_none() -> Array:
    return np.zeros((0, 0))


@dataclass(frozen=True, kw_only=True, eq=False)
class ContactForces:
    """One row per contact point, closed or with a small gap.

    The normal points from block ``a`` to block ``b``; the reaction acts on ``b``.

    If two rounded corners of the plane press each other, slip is the arc that they roll on their
    undeformed radii, and the joint law holds for the force along this arc.  The tangential reaction
    here is the force that balances the loads.  It is the force of the joint law times the sum of
    the radii over the distance of the centres.
    """

    block_a: IntArray  # (n_contacts,) row in the assembly
    block_b: IntArray  # (n_contacts,)
    position: Array  # (n_contacts, dim) m
    normal: Array  # (n_contacts, dim)
    gap: Array  # (n_contacts,) m, positive open
    area: Array  # (n_contacts,) m2, tributary
    normal_reaction: Array  # (n_contacts,) N, compression positive
    tangential_reaction: Array  # (n_contacts, dim - 1) N, along the tangents
    status: IntArray  # (n_contacts,) OPEN, STICKING or SLIDING
    # First tangent: (n_contacts, 3) in space; (n_contacts, 0) in the plane, where it is the normal
    # turned clockwise.
    tangent: Array = field(default_factory=_of_none)

    def __post_init__(self) -> None:
        """Drop tangents that follow from the normals, to save memory."""
        object.__setattr__(self, "tangent", tangents_kept(self.normal, self.tangent))

    @property
    def n_contacts(self) -> int:
        """Number of contact points, open ones included."""
        return len(self.gap)

    def rows(self, rows: slice) -> ContactForces:
        """Some of the contact points."""
        return ContactForces(**{f.name: getattr(self, f.name)[rows] for f in fields(self)})

    @property
    def tangents(self) -> Array:
        """Directions of the tangential reactions, (n_contacts, dim - 1, dim); in space the second
        tangent is normal x first."""
        return tangents(self.normal, self.tangent)

    def vectors(self) -> Array:
        """Reaction on block ``b`` as vectors, (n_contacts, dim) [N]."""
        total = self.normal_reaction[:, None] * self.normal
        tangents = self.tangents
        for i in range(tangents.shape[1]):
            total = total + self.tangential_reaction[:, [i]] * tangents[:, i]
        return total


@dataclass(frozen=True, kw_only=True)
class ActedContacts:
    """Contacts that a step was solved with, in the pose at its end.

    The contacts that are found anew in this pose may have other features.  They are those of the
    next step.
    """

    pairs: Pairs
    slots: Slots
    reaction: Array  # (n_slots, dim) N
    status: IntArray  # (n_slots,)
