"""Stiffness and strengths of joints that soften, are crushed or close, as functions of history.

With the inelastic opening k_n and the slip k_t [m] of a contact, its bond has softened by

    s = k_n f_t / G_I + k_t c / G_II

(Lourenco and Rots 1997: opening and slip break the same bridges of mortar).  The remaining
strengths and the friction are

    f = f_t exp(-s),    c = c_0 exp(-s),    mu = mu_r + (mu_0 - mu_r) exp(-s).

So opening alone takes the energy G_I per area, and slip alone takes G_II beside the work of
friction.  Joints without a bond may lose friction over their slip instead, by exp(-k_t / residual
slip).  A joint that is crushed by k_c [m] carries f_c exp(-f_c k_c / G_c).  A joint that closes
hyperbolically by v carries k_n v / (1 - v / v_m) (Bandis, Lumsden and Barton 1983).  A joint whose
closure goes with the logarithm of the pressure, as between faces that do not match (same source),
carries k_n v_r (exp(v / v_r) - 1).

A contact that has been torn open pulls only if it opens further than before, and presses only if it
is closed.  In between, it carries nothing.
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

#: A law of closure.  Argument: the closure of joints over the length of their law.  Results at the
#: point of the tangent: this ratio, limited; the pressure over k_n times the length; the stiffness
#: over k_n.
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


class Strengths:
    """Strengths of all joint laws of an assembly, per area."""

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
        #: Whether `law.softening` covers all joint laws: it has no nonlinear closure.
        self.smooth = not np.isfinite([self.closure, self.log_closure]).any()
        self.softens: BoolArray = np.array(softens)
        self.bonded: BoolArray = self.softens & (self.cohesion + self.tension > 0.0)
        #: Laws whose bonds break at once by opening, because opening takes no energy.
        self.tears: BoolArray = self.bonded & (self.tension == 0.0)
        #: (n_laws, N_LAW), see `law.columns`.
        self.table = law_table(assembly)
        #: Closure at which joints of each law begin to be crushed, (n_laws,) [m]; None if no joint
        #: is crushed.
        self.bears = self.crush / self.kn if np.isfinite(self.crush).any() else None
        #: Parameters of contacts that are made later, (n_laws, N_CURRENT); they have no bond.
        self.fresh = self._fresh()

    def _fresh(self) -> Array:
        n = len(self.mu)
        history = np.zeros((n, N_HISTORY))
        history[:, BROKEN] = 1.0
        return self.current(np.arange(n), history, self.first(history, np.zeros(n)))

    def first(self, history: Array, slots_gap: Array) -> Reached:
        """The state of contacts at the start of a step, from their history (n_slots, N_HISTORY +
        dim - 2) and gaps (n_slots,) [m]."""
        return Reached(
            softened=history[:, SOFTENED].copy(),
            opened=history[:, OPENED].copy(),
            slid=history[:, SLID].copy(),
            crushed=np.maximum(-history[:, DILATION], 0.0),
            gap=slots_gap - history[:, DILATION],
        )

    def current(self, law: IntArray, history: Array, now: Reached) -> Array:
        """Parameters (n_slots, N_CURRENT) of contacts in the state ``now``; see
        `contact.contacts`."""
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
        """Write the tangent of joints with nonlinear closure, ``curved`` (n_slots,), into
        ``current``.  ``gap`` and ``length`` [m] are their gaps and the lengths of their laws."""
        closed = np.maximum(np.nan_to_num(-gap, posinf=0.0, neginf=0.0), 0.0)
        kn = current[curved, STIFF_N]
        at, pressure, slope = carried(closed / length)
        current[curved, STIFF_N] = kn * slope
        current[curved, SHIFT] += kn * length * (pressure - slope * at)

    def points(
        self, law: IntArray, start: Array, committed: Array, gap: Array, shear: Array
    ) -> Array:
        """Reactions, tangents and softening (n, N_POINT) for gaps and trial shears; see
        `law.softening`.

        Parameters
        ----------
        law
            Law of each contact, (n,).
        start, committed
            History at the start of the step; and the same with the slip and crushing of the step so
            far, (n, N_HISTORY + dim - 2).
        gap, shear
            Gap at the end of the step, (n,) [m], and size of the trial shear, (n,) [Pa].
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
        """The state of softening of contacts at the end of a step.

        Parameters
        ----------
        law
            Law of each slot, (n_slots,).
        before, after
            History at the start and at the end of the step, (n_slots, N_HISTORY + dim - 2).
        gap
            Gap at the end, (n_slots,) [m].
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
        for _ in range(60):  # Newton's method, which converges from above
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
        """Write the parameters of contacts, times the ``size`` (n_contacts,) [m2] of their joints,
        into their table (n_contacts, N_TABLE)."""
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

    ``reaction`` (n_slots,) [N] is the normal reaction, by which differences of friction and
    stiffness are multiplied.  ``area`` (n_slots,) [m2].
    """
    pressed = np.maximum(reaction, 0.0)
    force = np.abs(current[:, PULL] - other[:, PULL]) * area
    force = np.maximum(force, np.abs(current[:, INTERCEPT] - other[:, INTERCEPT]) * area)
    force = np.maximum(force, np.abs(current[:, FRICTION] - other[:, FRICTION]) * pressed)
    capped = np.isfinite(current[:, CRUSH])
    crush = np.abs(current[capped, CRUSH] - other[capped, CRUSH]) * area[capped]
    # A change of the tangent stiffness, as a force.
    curved = np.abs(current[:, STIFF_N] / other[:, STIFF_N] - 1.0) * pressed
    return float(max(force.max(initial=0.0), crush.max(initial=0.0), curved.max(initial=0.0)))
