"""What a contact can carry, |t| <= c + mu n and n >= -f, as a sum of cones.

The region of one contact is the sum of what it has at its least normal force and of a cone, taken
any number of times from nothing upwards:

    mu > 0 and f >= c / mu    one point, the cone's own tip (-c / mu, 0)
    otherwise                 a disc (-f, t) with |t| <= d, d = c - mu f >= 0
    cone                      (n, t) with |t| <= mu n; without friction the ray (1, 0)

A tensile strength beyond c / mu is therefore never reached.  In the plane a disc is a pair of
corners and a cone a pair of rays.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.sparse import csc_array

from drystone.common.arrays import Array
from drystone.limit.equilibrium import Equilibrium


def least_normal(equilibrium: Equilibrium) -> Array:
    """Normal force [units of force] at which each contact opens in tension, (n_contacts,)."""
    friction = equilibrium.points.friction
    tip = np.divide(
        equilibrium.cohesion, friction, out=np.full(len(friction), np.inf), where=friction > 0.0
    )
    return -np.minimum(equilibrium.tension, tip)


def least_of_growth(equilibrium: Equilibrium) -> Array:
    """The same of forces that grow with the load beyond all strength, (n_contacts,): only rollers
    pull then, and push."""
    least, n = np.zeros(equilibrium.n_contacts), equilibrium.n_joined
    first = np.arange(n + equilibrium.n_drawn, n + equilibrium.n_ties)
    second = first + equilibrium.n_ties
    least[first] = least[second] = -equilibrium.tension[first]
    return least


def shear_strength(equilibrium: Equilibrium, normal: Array) -> Array:
    """Largest tangential force [units of force] under the given normal forces, (n_contacts,)."""
    return equilibrium.cohesion + equilibrium.points.friction * normal


@dataclass(frozen=True, kw_only=True)
class Regions:
    """Forces as f = fixed + combination @ amounts, with amounts in a product of cones."""

    fixed: Array  # (dim n_contacts,)
    combination: csc_array  # (dim n_contacts, n_amounts)
    sharing: csc_array  # (n_discs, n_amounts): the first amount of a disc is one
    cones: tuple[tuple[int, int], ...]  # how many of which size, in the order of the amounts

    @classmethod
    def of(cls, equilibrium: Equilibrium, *, recession: bool = False) -> Regions:
        """The regions of all contacts; with ``recession`` without their strengths but those of
        rollers."""
        friction, dim = equilibrium.points.friction, equilibrium.points.dimension
        if recession:
            nothing = np.zeros_like(friction)
            return cls.within(dim, friction, nothing, least_of_growth(equilibrium))
        return cls.within(dim, friction, equilibrium.cohesion, least_normal(equilibrium))

    @classmethod
    def within(cls, dim: int, slope: Array, intercept: Array, low: Array) -> Regions:
        """Of |t| <= intercept + slope n and n >= low, (n_contacts,) each."""
        n = len(slope)
        width = intercept + slope * low
        width[width <= 1e-12 * np.maximum(intercept, 1e-12)] = 0.0
        disc, rough = np.flatnonzero(width > 0.0), np.flatnonzero(slope > 0.0)
        smooth = np.flatnonzero(slope <= 0.0)
        fixed = np.zeros(dim * n)
        fixed[::dim] = low
        first = np.ones((len(rough), dim))
        first[:, 0] /= slope[rough]
        second = np.tile(width[disc, None], dim)
        second[:, 0] = 0.0
        entries = np.concatenate((first.ravel(), second.ravel(), np.ones(len(smooth))))
        component = np.arange(dim)
        rows = np.concatenate(
            (
                (dim * rough[:, None] + component).ravel(),
                (dim * disc[:, None] + component).ravel(),
                dim * smooth,
            )
        )
        n_amounts = len(entries)
        combination = csc_array((entries, (rows, np.arange(n_amounts))), shape=(dim * n, n_amounts))
        combination.eliminate_zeros()
        share = np.arange(len(disc))
        sharing = csc_array(
            (np.ones(len(disc)), (share, dim * (len(rough) + share))), shape=(len(disc), n_amounts)
        )
        groups = ((len(rough), dim), (len(disc), dim), (len(smooth), 1))
        return cls(fixed=fixed, combination=combination, sharing=sharing, cones=groups)
