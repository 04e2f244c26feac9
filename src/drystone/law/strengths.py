"""Stiffness and strengths of joints that soften, are crushed and close, by their history.

With the inelastic opening k_n and slip k_t [m] of a contact, its bond has softened by

    s = k_n f_t / G_I + k_t c / G_II

(Lourenco and Rots 1997: both are bridges of the same mortar, which opening and slip break alike),
and what is left of it, with the friction, is

    f = f_t exp(-s),    c = c_0 exp(-s),    mu = mu_r + (mu_0 - mu_r) exp(-s).

So opening alone takes G_I per area, and slip alone G_II over what friction takes.  Joints without a
bond may lose friction over their slip instead, by exp(-k_t / residual slip).  A joint that is
crushed by k_c [m] carries f_c exp(-f_c k_c / G_c).  One that closes hyperbolically by v carries
k_n v / (1 - v / v_m) (Bandis, Lumsden and Barton 1983); one that does so with the logarithm of the
pressure, as where faces do not match (likewise), k_n v_r (exp(v / v_r) - 1).

A contact that has been torn open pulls again where it is opened further than it was, and presses
where it is shut: between both nothing acts.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from drystone.common.arrays import Array, BoolArray, IntArray
from drystone.common.tolerances import FULLY_SOFTENED, LAST_DIGIT, NEARLY_SHUT, STRAIGHT_CLOSURE
from drystone.contact.contacts import (
    CRUSH,
    FRICTION,
    INTERCEPT,
    N_CURRENT,
    PULL,
    SHIFT,
    STIFF_N,
)
from drystone.law import softening
from drystone.law.columns import (
    BROKEN,
    DILATION,
    N_HISTORY,
    OPENED,
    SLID,
    SOFTENED,
)
from drystone.law.table import law_table, yielding_row
from drystone.model.assembly import Assembly

#: The share of its length by which a joint is closed, as far as the tangent goes; its pressure over
#: k_n times the length, and stiffness over k_n there.
_Closure = Callable[[Array], tuple[Array, Array, Array]]


def _hyperbolic(share: Array) -> tuple[Array, Array, Array]:
    at = np.minimum(share, NEARLY_SHUT)
    return at, at / (1.0 - at), 1.0 / (1.0 - at) ** 2


def _logarithmic(share: Array) -> tuple[Array, Array, Array]:
    at = np.minimum(share, STRAIGHT_CLOSURE)
    return at, np.expm1(at), np.exp(at)


class Reached(NamedTuple):
    """The state of softening of contacts (n_slots,) at the end of a step."""

    softened: Array  # s, -
    opened: Array  # m, inelastic
    slid: Array  # m
    crushed: Array  # m
    gap: Array  # m, less what was crushed

    def at(self, source: IntArray) -> Reached:
        """Those of other slots (n_slots,); what is new, -1, is as it was in the same slot."""
        return Reached(*(np.where(source >= 0, a[source], a) for a in self))


class Strengths:
    """Strengths of all joint laws of an assembly; per area."""

    def __init__(self, assembly: Assembly) -> None:
        self.any = any(law.yields for law in assembly.laws)
        columns = [yielding_row(law) for law in assembly.laws]
        (
            self.mu, self.residual, self.per_slip, self.kn, self.cohesion, self.tension,
            self.by_opening, self.by_slip, self.crush, self.by_crushing, self.closure,
            self.log_closure,
        ) = np.array(columns).T  # fmt: skip
        softens = [law.softens for law in assembly.laws]
        self.yields: BoolArray = np.array([law.yields for law in assembly.laws])
        #: Whether `law.softening` has all of what joints do.
        self.smooth = not np.isfinite([self.closure, self.log_closure]).any()
        self.softens: BoolArray = np.array(softens)
        self.bonded: BoolArray = self.softens & (self.cohesion + self.tension > 0.0)
        #: Laws whose bonds opening breaks at once: it has no energy to take.
        self.tears: BoolArray = self.bonded & (self.tension == 0.0)
        #: (n_laws, N_LAW), see `law.columns`.
        self.table = law_table(assembly)
        #: How far joints of each law close before they are crushed, (n_laws,) [m]; None where no
        #: joint is crushed.
        self.bears = self.crush / self.kn if np.isfinite(self.crush).any() else None
        #: Parameters of contacts that are made later, by law, (n_laws, N_CURRENT): without a bond.
        self.fresh = self._fresh()

    def _fresh(self) -> Array:
        n = len(self.mu)
        history = np.zeros((n, N_HISTORY))
        history[:, BROKEN] = 1.0
        return self.current(np.arange(n), history, self.first(history, np.zeros(n)))

    def first(self, history: Array, slots_gap: Array) -> Reached:
        """Where contacts begin, by their history (n_slots, N_HISTORY + dim - 2)."""
        return Reached(
            softened=history[:, SOFTENED].copy(),
            opened=history[:, OPENED].copy(),
            slid=history[:, SLID].copy(),
            crushed=np.maximum(-history[:, DILATION], 0.0),
            gap=slots_gap - history[:, DILATION],
        )

    def current(self, law: IntArray, history: Array, now: Reached) -> Array:
        """Parameters of contacts in the state ``now``, (n_slots, N_CURRENT); `contact.contacts`."""
        whole = (history[:, BROKEN] == 0.0) & self.bonded[law]
        left = np.where(whole, np.exp(-now.softened), 0.0)
        friction = np.where(self.softens[law], left, np.exp(-self.per_slip[law] * now.slid))
        current = np.zeros((len(law), N_CURRENT))
        mu = self.residual[law] + (self.mu - self.residual)[law] * friction
        pulls = (now.opened == 0.0) | (now.gap > now.opened)
        kn = self.kn[law]
        pull = np.where(pulls, self.tension[law] * left, 0.0)
        current[:, STIFF_N], current[:, FRICTION], current[:, PULL] = kn, mu, pull
        current[:, SHIFT] = pull + np.where(pulls & whole, kn * now.opened, 0.0)
        current[:, INTERCEPT] = np.maximum(self.cohesion[law] * left - mu * pull, 0.0)
        crush = np.exp(-np.minimum(self.by_crushing[law] * now.crushed, FULLY_SOFTENED))
        current[:, CRUSH] = self.crush[law] * crush + pull
        for length, carried in ((self.closure, _hyperbolic), (self.log_closure, _logarithmic)):
            curved = np.isfinite(length[law])
            if curved.any():
                self._tangent(now.gap[curved], length[law][curved], curved, carried, current)
        return current

    def _tangent(
        self, gap: Array, length: Array, curved: BoolArray, carried: _Closure, current: Array
    ) -> None:
        """Write the tangent at the ``gap`` [m] of joints that do not close linearly, ``curved``
        (n_slots,), with the ``length`` [m] of their law, into ``current``."""
        closed = np.maximum(np.nan_to_num(-gap, posinf=0.0, neginf=0.0), 0.0)
        kn = current[curved, STIFF_N]
        at, pressure, slope = carried(closed / length)
        current[curved, STIFF_N] = kn * slope
        current[curved, SHIFT] += kn * length * (pressure - slope * at)

    def points(
        self, law: IntArray, start: Array, committed: Array, gap: Array, shear: Array
    ) -> Array:
        """What follows of gaps and trial shears, (n, N_POINT); see `law.softening`.

        Parameters
        ----------
        law
            Of each contact, (n,).
        start, committed
            Their history where the step starts; and the same with the slip and the crushing of the
            step so far, (n, N_HISTORY + dim - 2).
        gap, shear
            Where the step ends, (n,) [m], and the size of the trial shear [Pa].
        """
        contact = np.empty((len(law), softening.N_CONTACT))
        whole = start[:, BROKEN] == 0.0
        slid = committed[:, SLID] - start[:, SLID]
        softened = start[:, SOFTENED] + np.where(whole, self.by_slip[law] * slid, 0.0)
        contact[:, softening.C_WHOLE], contact[:, softening.C_SOFTENED] = whole, softened
        contact[:, softening.C_OPENED] = start[:, OPENED]
        contact[:, softening.C_SLID] = committed[:, SLID]
        contact[:, softening.C_CRUSHED] = np.maximum(-committed[:, DILATION], 0.0)
        contact[:, softening.C_GAP] = gap - committed[:, DILATION]
        contact[:, softening.C_SHEAR] = shear
        point = np.empty((len(law), softening.N_POINT))
        softening.points(self.table, law, contact, point)
        return point

    def reached(self, law: IntArray, before: Array, after: Array, gap: Array) -> Reached:
        """The state of softening of contacts where a step ends.

        Parameters
        ----------
        law
            Of each slot, (n_slots,).
        before, after
            Their history where the step starts and where it ends, (n_slots, N_HISTORY + dim - 2).
        gap
            Where it ends, (n_slots,) [m].
        """
        bonded = self.bonded[law] & (before[:, BROKEN] == 0.0)
        slid = after[:, SLID]
        gap = gap - after[:, DILATION]
        by_opening, elastic = self.by_opening[law], self.tension[law] / self.kn[law]
        sheared = before[:, SOFTENED] + self.by_slip[law] * (slid - before[:, SLID])
        beyond = np.where(bonded & np.isfinite(gap), gap, 0.0) - before[:, OPENED]
        softened = sheared.copy()
        tears = bonded & (by_opening > 0.0) & (beyond > elastic * np.exp(-sheared))
        s, start, far = (a[tears] for a in (sheared, sheared, beyond))
        rate, give = by_opening[tears], elastic[tears]
        s = start + rate * far
        for _ in range(60):  # convex and rising, from above
            step = (s - start - rate * (far - give * np.exp(-s))) / (1.0 - rate * give * np.exp(-s))
            s = s - step
            if not (np.abs(step) > LAST_DIGIT * (1.0 + np.abs(s))).any():
                break
        softened[tears] = np.maximum(s, start)
        opened = before[:, OPENED].copy()
        opened[tears] += far - give * np.exp(-softened[tears])
        return Reached(
            softened=softened,
            opened=opened,
            slid=slid.copy(),
            crushed=np.maximum(-after[:, DILATION], 0.0),
            gap=gap,
        )

    def fill(self, law: IntArray, history: Array, gap: Array, size: Array, table: Array) -> None:
        """Write the parameters of contacts (n_contacts,), times the ``size`` of their joint, into
        their table."""
        now = self.first(history, gap)
        current = self.current(law, history, now)
        table[:, FRICTION] = current[:, FRICTION]
        own = slice(SHIFT, CRUSH + 1)
        table[:, own] = current[:, own] * size[:, None]

    def write(self, law: IntArray, now: Reached, history: Array) -> None:
        """Write the state of softening of contacts into their history."""
        history[:, SOFTENED], history[:, OPENED] = now.softened, now.opened
        history[self.bonded[law] & (now.softened > FULLY_SOFTENED), BROKEN] = 1.0


def difference(current: Array, other: Array, reaction: Array, area: Array) -> float:
    """Largest force [N] by which two sets of parameters (n_slots, N_CURRENT) differ.

    ``reaction`` (n_slots,) is normal [N], which friction and stiffness count with.
    """
    pressed = np.maximum(reaction, 0.0)
    force = np.abs(current[:, PULL] - other[:, PULL]) * area
    force = np.maximum(force, np.abs(current[:, INTERCEPT] - other[:, INTERCEPT]) * area)
    force = np.maximum(force, np.abs(current[:, FRICTION] - other[:, FRICTION]) * pressed)
    capped = np.isfinite(current[:, CRUSH])
    crush = np.abs(current[capped, CRUSH] - other[capped, CRUSH]) * area[capped]
    # Of a tangent that has moved on, to second order.
    curved = np.abs(current[:, STIFF_N] / other[:, STIFF_N] - 1.0) * pressed
    return float(max(force.max(initial=0.0), crush.max(initial=0.0), curved.max(initial=0.0)))
