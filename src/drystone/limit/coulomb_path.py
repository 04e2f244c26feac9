"""Collapse with Coulomb's friction, followed from a smoothed problem to the sharp one.

Forces f = (n, t), multiplier lambda and velocities u, with the relative velocities v = B^T u, make
a collapse state when blocks balance, B f + G + lambda F = 0, the load does work, F.u = 1, and at
every contact, l being its least normal force, m the tangent of its dilatancy angle and s its slip,

    n - l >= 0,   v_n - m s >= 0,   (n - l) (v_n - m s) = 0
    (c + mu n, t) o (s, v_t) = 0,   both in the cone, see `cone_algebra` for the product

The second line is friction: within the limit nothing slides, at the limit t is against v_t and
s = |v_t|.  There is no function that a solution minimises.  With e > 0 on the right of both,

    (n - l) (v_n - m s + e) = e w,      (c + mu n, t) o (s, v_t) = e (w', 0)

all is smooth: with a large e every contact presses and slides a little, and also overlaps by e, so
that blocks can move that have contacts all around.  For e of order one there is
one solution, which Newton's method finds.  With weights w, w' at random the solutions make one
smooth curve from there, for almost all weights (S. N. Chow, J. Mallet-Paret, J. A. Yorke,
Mathematics of Computation 32, 1978).  It is followed by its length, because e may have to grow
again within it: the curve has folds where contacts change from sticking to sliding.  Where e ends
at nothing, there is a collapse state, whatever the weights were.  Other weights may lead to another
one.

Contacts are eliminated one by one, df = q - D dv; what remains for the blocks is

    B D B^T du - F dlambda = h,      F.du = g

as sparse as in the associative program, but not symmetric.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from scipy.sparse import csc_matrix, csr_array, diags_array
from scipy.sparse.csgraph import connected_components
from scipy.sparse.linalg import splu

from drystone.common.arrays import Array, IntArray
from drystone.limit.cone_algebra import Cones, dot
from drystone.limit.cones import least_normal
from drystone.limit.equilibrium import Equilibrium
from drystone.limit.interior_point import sparse_order

#: Smoothing at the start, at the end, and where rounding may end a curve: forces and velocities are
#: of order one, and a multiplier is known to some ten times as much.
FIRST, LAST, ENOUGH = 1.0, 1e-10, 1e-8
#: Largest weight of a contact over its middle one, in powers of e.  From 0.2 to 1 the same
#: structures came to their states; with 2 curves grew three times as long.
SPREAD = 0.5
#: A point is on the curve where no product is off by more than this share of e.
NEAR = 0.3
#: What blocks may be out of balance, as a share of e, and what rounding leaves.
BALANCED, ROUNDING = 0.1, 1e-11
#: Corrections of one point, and of the first.
MOST_CORRECTIONS, MOST_FIRST = 5, 80
#: Share of the distance to the boundary of the cones that a step takes, along the curve and towards
#: it.
ALONG, TOWARDS = 0.8, 0.95
#: First step along the curve; the length is the root mean square of relative changes.
STEP, LEAST_STEP = 0.3, 1e-7
#: Largest change of log e in a step.
MOST_CHANGE = 3.0
#: Longest step that is believed where the curve seems to have a fold.
LONGEST_AT_FOLD = 1e-3
#: Added to each diagonal entry, as a share of it; pivots off the diagonal are larger by this.
REGULARISATION, PIVOT = 1e-14, 1e-3
#: Refinements of a solution, and what is unbalanced, over numbers of order one, that needs none.
MOST_REFINEMENTS, SMALL_RESIDUAL = 1, 1e-12
#: Multipliers beyond this are those of a load that locks.
GIVE_UP = 1e7


class Point(NamedTuple):
    """A point of the curve, or a change of one; velocities are scaled to F.u = number of blocks."""

    velocity: Array  # u (n_rows,)
    factor: float  # lambda
    normal: Array  # n (n_contacts,)
    shear: Array  # t (n_contacts, dim - 1)
    opening: Array  # v_n - m s + e (n_contacts,)
    slip: Array  # s (n_contacts,)

    def moved(self, step: Point, share: float) -> Point:
        """The point with a share of a step added."""
        more = step.times(share)
        return Point(
            velocity=self.velocity + more.velocity,
            factor=self.factor + more.factor,
            normal=self.normal + more.normal,
            shear=self.shear + more.shear,
            opening=self.opening + more.opening,
            slip=self.slip + more.slip,
        )

    def times(self, share: float) -> Point:
        """A share of it."""
        return Point(
            velocity=share * self.velocity,
            factor=share * self.factor,
            normal=share * self.normal,
            shear=share * self.shear,
            opening=share * self.opening,
            slip=share * self.slip,
        )


class _Residual(NamedTuple):
    """What is missing at a point: right sides of a correction."""

    opening: Array  # (n_contacts,)
    pressing: Array  # (n - l) z (n_contacts,)
    sliding: Array  # first component of the product (n_contacts,)
    across: Array  # the others (n_contacts, dim - 1)
    rows: Array  # balance (n_rows,)
    work: float  # F.u


@dataclass(frozen=True, kw_only=True)
class Ending:
    """Where a curve was left."""

    finished: bool  # at the end, where nothing is smoothed
    locked: bool  # at a multiplier beyond all bounds
    factor: float
    forces: Array  # (n_contacts, dim) in units of force
    velocity: Array  # (n_rows,) scaled, F.u = 1
    smoothing: float
    n_factorisations: int


def follow(equilibrium: Equilibrium, *, seed: int, most: int) -> Ending:
    """Follow the curve of one set of weights with at most so many factorisations."""
    system = _System(equilibrium, np.random.default_rng(seed))
    point, found = _first(system, most)
    smoothing, finished = FIRST, False
    if found:
        point, smoothing, finished = _along(system, point, most)
    return Ending(
        finished=finished,
        locked=found and abs(point.factor) > GIVE_UP,
        factor=point.factor,
        forces=np.column_stack((point.normal, point.shear)),
        velocity=point.velocity / system.scale,
        smoothing=smoothing,
        n_factorisations=system.n_factorisations,
    )


def _first(system: _System, most: int) -> tuple[Point, bool]:
    """The point of the curve at the largest smoothing, and whether it was found."""
    point = system.begin()
    for _ in range(MOST_FIRST):
        residual = system.residual(point, FIRST)
        if system.is_on(residual, FIRST):
            return point, system.factorise(point)
        if system.n_factorisations >= most or not system.factorise(point):
            break
        step = system.solve(point, residual)
        share = min(1.0, TOWARDS * system.reach(point, step, 1.0 / TOWARDS))
        size = system.size(residual)
        while share > 1e-4:
            tried = point.moved(step, share)
            if system.size(system.residual(tried, FIRST)) < size:
                break
            share *= 0.5
        else:
            break
        point = tried
    return point, False


def _along(system: _System, point: Point, most: int) -> tuple[Point, float, bool]:
    """From the first point to the last: where the curve was left, its smoothing, whether at the
    end."""
    smoothing, step = FIRST, STEP
    begun = system.sign()
    ahead, faster = system.unit(point, system.solve(point, system.growth(smoothing)))
    ahead, faster = ahead.times(-1.0), -faster
    while smoothing > LAST and system.n_factorisations < most:
        reach = ALONG * system.reach(point, ahead, np.inf)
        taken = min(step, reach, MOST_CHANGE / max(abs(faster), 1e-12))
        found = _corrected(system, point, np.log(smoothing), (ahead, faster), taken)
        if found is None:
            step = 0.5 * taken
            if step < LEAST_STEP or smoothing <= ENOUGH:
                break
            continue
        there, log_smoothing, tangent, corrections = found
        # The curve keeps its sense: e falls while the sign of the determinant is the first one.
        along, quicker = system.unit(there, tangent)
        same = system.inner(there, along, ahead) + quicker * faster > 0.0
        falls = system.sign() == begun
        if same == falls and taken > LONGEST_AT_FOLD:
            step = 0.5 * taken
            continue
        if falls:
            along, quicker = along.times(-1.0), -quicker
        point, smoothing = there, float(np.exp(log_smoothing))
        ahead, faster = along, quicker
        if abs(point.factor) > GIVE_UP:
            break
        if corrections <= 2:
            step = max(step, 2.0 * taken)
        elif corrections >= MOST_CORRECTIONS:
            step = 0.7 * taken
    return point, smoothing, smoothing <= ENOUGH


def _corrected(
    system: _System, point: Point, log_smoothing: float, tangent: tuple[Point, float], step: float
) -> tuple[Point, float, Point, int] | None:
    """A point of the curve a step ahead, log e there, the change by log e, and corrections taken.

    Corrections are at right angles to the step.
    """
    ahead, faster = tangent
    there, log_there = point.moved(ahead, step), log_smoothing + step * faster
    change, last = None, np.inf
    for k in range(MOST_CORRECTIONS + 1):
        smoothing = float(np.exp(log_there))
        residual = system.residual(there, smoothing)
        on, off = system.is_on(residual, smoothing), system.off(residual, smoothing)
        if on and change is not None:
            return there, log_there, change, k
        if not on and (k == MOST_CORRECTIONS or not off < 1e4 or (k > 1 and off > 0.7 * last)):
            return None
        last = off
        if not system.factorise(there):
            return None
        change = system.solve(there, system.growth(smoothing))
        if on:
            return there, log_there, change, k
        straight = system.solve(there, residual)
        more = -system.inner(point, ahead, straight)
        more /= system.inner(point, ahead, change) + faster
        correction = straight.moved(change, more)
        share = min(1.0, TOWARDS * system.reach(there, correction, 1.0 / TOWARDS))
        share = min(share, 2.0 / max(abs(more), 1e-12))
        there, log_there = there.moved(correction, share), log_there + share * more
    return None


class _System:
    """The equations at one point, and their solution by elimination of the contacts."""

    def __init__(self, equilibrium: Equilibrium, random: np.random.Generator) -> None:
        points = equilibrium.points
        self._dim, self._n = points.dimension, points.n_contacts
        self._friction, self._dilatancy = points.friction, points.dilatancy
        self._cohesion, self._least = equilibrium.cohesion, least_normal(equilibrium)
        self._rough = (points.friction > 0.0) | (equilibrium.cohesion > 0.0)
        self._cones = Cones([(int(self._rough.sum()), points.dimension)])
        self._dead, self._live = equilibrium.dead, equilibrium.live
        self.scale = equilibrium.assembly.n_blocks
        self._b = csr_array(equilibrium.matrix)
        self._b_t = csr_array(self._b.T)
        self._order = sparse_order(self._b, self._blocks(np.ones((self._n, self._dim, self._dim))))
        self._ordered = csr_array(self._b[self._order])
        self._ordered_t = csr_array(self._ordered.T)
        self._weight = np.exp(SPREAD * random.uniform(-1.0, 1.0, (2, self._n)))
        self.n_factorisations = 0

    def _blocks(self, values: Array) -> csr_array:
        """A matrix with the blocks (n_contacts, dim, dim) on its diagonal."""
        size = self._n * self._dim
        column = np.arange(size).reshape(self._n, 1, self._dim)
        columns = np.broadcast_to(column, values.shape).ravel()
        starts = self._dim * np.arange(size + 1)
        return csr_array((values.ravel(), columns, starts), shape=(size, size))

    def begin(self) -> Point:
        """Forces and openings of one, velocities along the load."""
        velocity = self.scale * self._live / (self._live @ self._live)
        across = self._relative(velocity)[:, 1:]
        return Point(
            velocity=velocity,
            factor=0.0,
            normal=self._least + 1.0,
            shear=np.zeros((self._n, self._dim - 1)),
            opening=np.ones(self._n),
            slip=np.sqrt(1.0 + dot(across, across)),
        )

    def _relative(self, velocity: Array) -> Array:
        return np.asarray((self._b_t @ velocity).reshape(self._n, self._dim))

    def _limit(self, normal: Array) -> Array:
        """c + mu n; one where there is no friction at all."""
        return np.where(self._rough, self._cohesion + self._friction * normal, 1.0)

    def residual(self, point: Point, smoothing: float) -> _Residual:
        """What is missing at a point."""
        relative = self._relative(point.velocity)
        across, limit = relative[:, 1:], self._limit(point.normal)
        product = limit * point.slip + dot(point.shear, across)
        turned = -(limit[:, None] * across + point.slip[:, None] * point.shear)
        forces = np.column_stack((point.normal, point.shear)).ravel()
        return _Residual(
            opening=relative[:, 0] - self._dilatancy * point.slip + smoothing - point.opening,
            pressing=smoothing * self._weight[0] - (point.normal - self._least) * point.opening,
            sliding=np.where(self._rough, smoothing * self._weight[1] - product, 0.0),
            across=np.where(self._rough[:, None], turned, 0.0),
            rows=-(self._b @ forces + self._dead + point.factor * self._live),
            work=float(self.scale - self._live @ point.velocity),
        )

    def growth(self, smoothing: float) -> _Residual:
        """What a change of log e adds to what is missing."""
        return _Residual(
            opening=np.full(self._n, smoothing),
            pressing=smoothing * self._weight[0],
            sliding=np.where(self._rough, smoothing * self._weight[1], 0.0),
            across=np.zeros((self._n, self._dim - 1)),
            rows=np.zeros_like(self._dead),
            work=0.0,
        )

    def off(self, residual: _Residual, smoothing: float) -> float:
        """Largest deviation of a product over e."""
        parts = residual.pressing, residual.sliding, residual.across
        return max(float(np.abs(part).max(initial=0.0)) for part in parts) / smoothing

    def is_on(self, residual: _Residual, smoothing: float) -> bool:
        """Whether a point with that rest is near the curve."""
        missing = float(np.abs(residual.rows).max(initial=0.0))
        apart = (
            max(float(np.abs(residual.opening).max(initial=0.0)), abs(residual.work)) / self.scale
        )
        balanced = max(missing, apart) < max(BALANCED * smoothing, ROUNDING)
        return balanced and self.off(residual, smoothing) < NEAR

    def size(self, residual: _Residual) -> float:
        """Sum of squares of what is missing."""
        parts = (
            residual.pressing,
            residual.sliding,
            residual.across,
            residual.rows,
            residual.opening / self.scale,
        )
        return float(sum(np.sum(part * part) for part in parts))

    def factorise(self, point: Point) -> bool:
        """Prepare solutions at a point; whether that was possible.

        With dv the change of relative velocities, a dot for the product of tangential vectors,

            ds = .. + g.dv_t + h dn,      dn = .. + a dv_n + b.dv_t
            dt = .. - ((c + mu n) dv_t + mu dn v_t + ds t) / s
        """
        across = self._relative(point.velocity)[:, 1:]
        limit, slip, shear = self._limit(point.normal), point.slip, point.shear
        friction, press = self._friction, point.normal - self._least
        self._across = across
        self._pivot = limit - dot(across, shear) / slip
        self._g = (limit[:, None] * across / slip[:, None] - shear) / self._pivot[:, None]
        self._h = -(slip - dot(across, across) / slip) * friction / self._pivot
        self._press = point.opening - press * self._dilatancy * self._h
        a = -press / self._press
        b = (press * self._dilatancy / self._press)[:, None] * self._g
        slip_n, slip_t = self._h * a, self._g + self._h[:, None] * b
        d = np.zeros((self._n, self._dim, self._dim))
        d[:, 0, 0], d[:, 0, 1:] = -a, -b
        d[:, 1:, 0] = ((friction * a / slip)[:, None] * across) + (slip_n / slip)[:, None] * shear
        d[:, 1:, 1:] = (limit / slip)[:, None, None] * np.eye(self._dim - 1)
        d[:, 1:, 1:] += (friction / slip)[:, None, None] * across[:, :, None] * b[:, None, :]
        d[:, 1:, 1:] += shear[:, :, None] * slip_t[:, None, :] / slip[:, None, None]
        d[~self._rough, 1:] = 0.0
        self._d = d
        matrix = csr_array(self._ordered @ (self._blocks(d) @ self._ordered_t))
        diagonal = np.abs(matrix.diagonal())
        least = float(diagonal[diagonal > 0.0].min(initial=1.0))
        matrix = matrix + diags_array(REGULARISATION * np.maximum(diagonal, least))
        self.n_factorisations += 1
        try:
            self._lu = splu(csc_matrix(matrix), permc_spec="NATURAL", diag_pivot_thresh=PIVOT)
        except RuntimeError:  # exactly singular
            return False
        self._column = self._solved(self._live)
        self._small = float(self._live @ self._column)
        return bool(np.isfinite(self._small) and self._small != 0.0)

    def _solved(self, right: Array) -> Array:
        out = np.empty_like(right)
        out[self._order] = self._lu.solve(right[self._order])
        return out

    def sign(self) -> float:
        """Sign of the determinant of the last factorisation, times that of all it stands for."""
        lower, column = self._lu.perm_r, self._lu.perm_c
        sign = float(np.prod(np.sign(self._lu.U.diagonal()))) * float(np.sign(self._small))
        return sign if np.array_equal(lower, column) else sign * _parity(lower) * _parity(column)

    def solve(self, point: Point, residual: _Residual) -> Point:
        """The change of a point that takes away what is missing."""
        press, slip = point.normal - self._least, point.slip
        c = (residual.sliding - dot(self._across, residual.across) / slip) / self._pivot
        q_n = residual.pressing - press * (residual.opening - self._dilatancy * c)
        q_n = q_n / self._press
        q_s = c + self._h * q_n
        q_t = residual.across - (self._friction * q_n)[:, None] * self._across
        q_t = (q_t - q_s[:, None] * point.shear) / slip[:, None]
        q_t[~self._rough] = 0.0
        q = np.column_stack((q_n, q_t))
        velocity, factor = np.zeros_like(self._dead), 0.0
        rows, work = residual.rows - self._b @ q.ravel(), residual.work
        for _ in range(1 + MOST_REFINEMENTS):
            down = self._solved(-rows)
            more = (work - float(self._live @ down)) / self._small
            velocity, factor = velocity + down + more * self._column, factor + more
            relative = self._relative(velocity)
            forces = q - np.einsum("kij,kj->ki", self._d, relative)
            rows = residual.rows - self._b @ forces.ravel() - factor * self._live
            work = residual.work - float(self._live @ velocity)
            if max(float(np.abs(rows).max(initial=0.0)), abs(work)) < SMALL_RESIDUAL:
                break
        more_slip = c + dot(self._g, relative[:, 1:]) + self._h * forces[:, 0]
        return Point(
            velocity=velocity,
            factor=factor,
            normal=forces[:, 0],
            shear=forces[:, 1:],
            opening=residual.opening + relative[:, 0] - self._dilatancy * more_slip,
            slip=more_slip,
        )

    def inner(self, point: Point, one: Point, other: Point) -> float:
        """Product of two changes, relative to a point's forces and velocities, per contact."""
        limit, rough = self._limit(point.normal), self._rough
        total = one.normal * other.normal / (point.normal - self._least) ** 2
        total = total + one.opening * other.opening / point.opening**2
        slides = one.slip * other.slip / point.slip**2 + dot(one.shear, other.shear) / limit**2
        return float(np.sum(total + np.where(rough, slides, 0.0))) / self._n

    def unit(self, point: Point, change: Point) -> tuple[Point, float]:
        """The direction of a change by log e, and log e in it, of length one."""
        length = float(np.sqrt(1.0 + self.inner(point, change, change)))
        return change.times(1.0 / length), 1.0 / length

    def reach(self, point: Point, step: Point, most: float) -> float:
        """Largest share of a step, at most ``most``, that keeps all within their cones."""
        reach = most
        for value, change in (
            (point.normal - self._least, step.normal),
            (point.opening, step.opening),
        ):
            falls = change < 0.0
            reach = float(np.min(-value[falls] / change[falls], initial=reach))
        across, faster = (self._relative(u)[:, 1:] for u in (point.velocity, step.velocity))
        limit, wider = self._limit(point.normal), self._friction * step.normal
        for first, more, others, change in (
            (limit, wider, point.shear, step.shear),
            (point.slip, step.slip, across, faster),
        ):
            vector = np.column_stack((first, others))[self._rough]
            along = np.column_stack((more, change))[self._rough]
            reach = self._cones.reach(vector.ravel(), along.ravel(), reach)
        return reach


def _parity(order: IntArray) -> float:
    """Sign of a permutation, by the number of its cycles."""
    n = len(order)
    arrows = csr_array((np.ones(n), (np.arange(n), order)), shape=(n, n))
    return 1.0 if (n - connected_components(arrows, return_labels=False)) % 2 == 0 else -1.0
