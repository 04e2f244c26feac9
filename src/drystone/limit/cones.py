"""What a contact can carry, |t| <= c + mu n and n >= -f, as corners and rays of the region.

The region of one contact is the sum of a corner (or of a share of two corners) and of rays, each
taken any number of times from nothing upwards:

    mu > 0 and f >= c / mu    one corner, the cone's own tip (-c / mu, 0)
    otherwise                 two corners (-f, -d) and (-f, d), d = c - mu f >= 0, sharing one unit
    rays                      (1, mu) and (1, -mu), or (1, 0) without friction

A tensile strength beyond c / mu is therefore never reached.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import coo_array, csc_array

from drystone.limit.equilibrium import Equilibrium

Array = NDArray[np.float64]


def least_normal(equilibrium: Equilibrium) -> Array:
    """Normal force [units of force] at which each contact gives way in tension, (n_contacts,)."""
    friction = equilibrium.points.friction
    tip = np.divide(
        equilibrium.cohesion, friction, out=np.full(len(friction), np.inf), where=friction > 0.0
    )
    return -np.minimum(equilibrium.tension, tip)


def shear_strength(equilibrium: Equilibrium, normal: Array) -> Array:
    """Largest tangential force [units of force] under the given normal forces, (n_contacts,)."""
    return equilibrium.cohesion + equilibrium.points.friction * normal


@dataclass(frozen=True, kw_only=True)
class Rays:
    """Forces as f = fixed + combination @ amounts, all amounts from nothing upwards."""

    fixed: Array  # (2 n_contacts,)
    combination: csc_array  # (2 n_contacts, n_amounts)
    sharing: csc_array  # (n_shared, n_amounts): the amounts of a pair of corners add up to one

    @classmethod
    def of(cls, equilibrium: Equilibrium, *, recession: bool = False) -> Rays:
        """The regions of all contacts in a plane; with ``recession`` without their strengths."""
        mu = equilibrium.points.friction
        n = len(mu)
        low = np.zeros(n) if recession else least_normal(equilibrium)
        width = np.zeros(n) if recession else shear_strength(equilibrium, low)
        width[width <= 1e-12 * np.maximum(equilibrium.cohesion, 1e-12)] = 0.0
        pair = np.flatnonzero(width > 0.0)
        fixed = np.zeros(2 * n)
        fixed[0::2] = low  # both corners of a pair have it, too
        rows, columns, values = [], [], []
        n_amounts = 0

        def add(contact: NDArray[np.int64], normal: float, tangential: Array) -> None:
            nonlocal n_amounts
            column = n_amounts + np.arange(len(contact))
            for row, value in ((0, np.full(len(contact), normal)), (1, tangential)):
                rows.append(2 * contact + row)
                columns.append(column)
                values.append(value)
            n_amounts += len(contact)

        rough = np.flatnonzero(mu > 0.0)
        smooth = np.flatnonzero(mu <= 0.0)
        add(rough, 1.0, mu[rough])
        add(rough, 1.0, -mu[rough])
        add(smooth, 1.0, np.zeros(len(smooth)))
        corners = n_amounts
        add(pair, 0.0, width[pair])
        add(pair, 0.0, -width[pair])
        entries = np.concatenate(values)
        combination = coo_array(
            (entries, (np.concatenate(rows), np.concatenate(columns))), shape=(2 * n, n_amounts)
        )
        share = np.tile(np.arange(len(pair)), 2)
        sharing = coo_array(
            (np.ones(2 * len(pair)), (share, corners + np.arange(2 * len(pair)))),
            shape=(len(pair), n_amounts),
        )
        combination = csc_array(combination)
        combination.eliminate_zeros()
        return cls(fixed=fixed, combination=combination, sharing=csc_array(sharing))
