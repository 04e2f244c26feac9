"""Whether an equilibrium is stable, from the stiffness there.

The sign of the determinant of the bordered system shows whether the number of unstable modes is
odd.  An even number shows in the Rayleigh quotients of the lowest modes, which are calculated too.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from drystone.common import tolerances
from drystone.common.arrays import Array
from drystone.linear import numeric as lu_numeric
from drystone.statics.balance import solve_bordered
from drystone.statics.static_step import StaticStep

#: Number of modes that are looked for; the most that are looked for if only neutral ones are found;
#: number of inverse iterations.
MODES, MOST_MODES, ITERATIONS = 4, 32, 4


def _lowest(step: StaticStep) -> tuple[Array, Array] | None:
    """A basis (k, n, n_dof) of the lowest modes at the equilibrium whose stiffness is factorised,
    and the inverse of the stiffness in this basis, (k, k) [s2]; None if the stiffness is singular.

    The prescribed displacement is fixed.  Each body that spins on one point and each joint that
    slides as a whole has a neutral mode.  If only neutral modes are found, more modes are looked
    for, because a growing one may hide behind them.
    """
    # There are no more modes than motions: further vectors would be rounding.
    motions = int(np.count_nonzero(~step.loads.fixed)) * step.loads.mass.shape[1]
    motions -= step.prescribed is not None
    most = min(MOST_MODES, motions)
    n = min(MODES, most)
    while True:
        found = _inverse_iterated(step, n)
        if found is None or n == most:
            return found
        ritz = np.abs(np.linalg.eigvals(found[1]))
        if not (ritz * tolerances.NEUTRAL > 1.0).all():
            return found
        n = min(2 * n, most)


def _inverse_iterated(step: StaticStep, n: int) -> tuple[Array, Array] | None:
    """The same with a basis of ``n`` fields, by inverse iteration; see `_lowest`."""
    bordered, mass = step.bordered, step.loads.mass
    rng = np.random.default_rng(1)
    free = ~step.loads.fixed[:, None]
    x = np.where(free, rng.normal(size=(n, *mass.shape)), 0.0)
    y = x
    for _ in range(ITERATIONS):
        x = _orthonormal(y, mass)
        y = mass * x
        lu_numeric.solve(step.structure, step.factors, y)
        if step.prescribed is not None:
            for column in y:
                solve_bordered(bordered, column, 0.0)
        if not np.isfinite(y).all():
            return None
    return y, (x * mass).reshape(n, -1) @ y.reshape(n, -1).T


def quotients(step: StaticStep) -> Array | None:
    """Rayleigh quotients (k,) [1/s2] of the lowest real modes, see `_lowest`; None if the stiffness
    is singular.

    Complex pairs are left out.  Such a mode moves to and fro, but a joint that slides has another
    stiffness on the way back than the one that was linearised.
    """
    found = _lowest(step)
    if found is None:
        return None
    ritz = np.linalg.eigvals(found[1])
    with np.errstate(divide="ignore"):
        return np.asarray(1.0 / ritz.real[ritz.imag == 0.0])


def growing(step: StaticStep) -> Array | None:
    """The real mode (n, n_dof) that grows fastest, scaled to a farthest motion of 1 m; None if no
    mode grows."""
    found = _lowest(step)
    if found is None:
        return None
    ritz, shares = np.linalg.eig(found[1])
    rows = np.flatnonzero((ritz.imag == 0.0) & (ritz.real < 0.0))
    if not len(rows):
        return None
    # The quotients are the reciprocals of the eigenvalues.
    fastest = rows[np.argmax(ritz.real[rows])]
    mode: Array = np.tensordot(shares[:, fastest].real, found[0], axes=1)
    return mode / step.detector.farthest(mode)


def grows(step: StaticStep) -> bool:
    """Whether one of the lowest modes grows, or the stiffness is singular.

    The stiffness must have been factorised, and a direction solved for with it.
    """
    found = quotients(step)
    return found is None or bool((found < -tolerances.NEUTRAL).any())


class Judged(NamedTuple):
    """An equilibrium that has been found, and whether it is stable."""

    stable: bool
    slope: float = math.nan  # 1/m, of the curve
    tangent: Array | None = None  # (n, n_dof) per m of the prescribed displacement


def judge(step: StaticStep) -> Judged:
    """Judge the equilibrium at which the equations were last evaluated."""
    step.respond()
    slope = step.slope()
    if slope is None:
        return Judged(stable=False)
    tangent = step.bordered.columns[0].copy() if step.prescribed is not None else None
    found = quotients(step)
    if found is None:
        found = np.zeros(0)
    # The determinant tells whether the number of unstable modes is odd.  If the modes found say
    # otherwise, one more mode grows, which is none of the lowest.
    odd = np.count_nonzero(found < 0.0) % 2 == 1
    stable = not (found < -tolerances.NEUTRAL).any() and step.stable != odd
    return Judged(stable, math.nan if tangent is None else slope, tangent)


def _orthonormal(x: Array, mass: Array) -> Array:
    """Fields (k, n, n_dof) made orthonormal by the mass (n, n_dof)."""
    k = len(x)
    root = np.sqrt(mass).ravel()
    q, _ = np.linalg.qr((x.reshape(k, -1) * root).T)
    back = np.divide(1.0, root, out=np.zeros_like(root), where=root > 0.0)
    return np.ascontiguousarray((q * back[:, None]).T).reshape(x.shape)
