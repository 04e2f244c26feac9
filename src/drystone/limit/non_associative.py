"""Limit analysis with joints that slide without opening: a sequence of linear programs.

With friction but no dilatancy the limit theorems do not hold.  What is sought is a state: forces
that balance the loads within the joints' strength, and a mechanism in which open contacts carry
nothing and sliding ones slide against a force at its limit, without opening.

The scheme is that of M. Gilbert, C. Casapulla & H. M. Ahmed, *Limit analysis of masonry block
structures with non-associative frictional joints using linear programming*, Computers and
Structures 84 (2006) 873-887.  In every pass each contact's friction is replaced by a fictitious
strength that the normal force of the pass before gives, n0, and a slope that is the dilatancy:

    |t| <= c + mu n0 + m (n - n0),       m = max(tan psi, alpha mu)
    n0  <- beta n + (1 - beta) n0

so that the flow of that linear program, which is associative, is the wanted one.  Where it comes
to rest (n = n0 where contacts slide) friction is Coulomb's.

What came to rest is then certified.  For its mechanism u, the *compatible* forces are those that

    are on the limit t = -+ (c + mu n), against the slip, where a contact slides,
    are at the tip of the region where it opens, and within the region elsewhere;

all of them that balance dead load and lambda times the pattern make a convex set.  Its lowest and
highest lambda come from two programs, and every lambda between them is a collapse
multiplier of that mechanism.  It need not be one number where a mechanism leaves forces open.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from drystone.limit.cone_program import ConeProgram, force_program
from drystone.limit.cones import Regions, least_normal, shear_strength
from drystone.limit.equilibrium import Equilibrium
from drystone.limit.inside import from_inside
from drystone.limit.program import FAILED, OPTIMAL, UNBOUNDED, Answer, ForceProgram

Array = NDArray[np.float64]

#: Relative velocities below this share of the largest are none, in the plane and in space: where
#: cones are round, the power of a mechanism differs by the square of what its velocities do.
STILL = {2: 1e-7, 3: 1e-5}
#: Excess over Coulomb's friction [units of force] with which a path in space may come to rest.
#: There forces lie amid all equally good ones, and change when the multiplier no longer does.
COULOMB = 1e-5
#: How often a path is looked at on the way there.
LOOKS = 3
#: Weights of the newest normal forces on paths besides the first two.
BETAS = (1.0, 0.3)


@dataclass(frozen=True, kw_only=True)
class NonAssociativeSettings:
    """Parameters of the scheme, and how many paths it is followed along."""

    alpha: float = 0.0
    """Slope left to a joint's failure surface, a share of its friction coefficient.  0 makes
    sliding joints keep exactly their own dilatancy; Gilbert et al. give 0.01 for their surface."""
    beta: float = 0.6
    """Weight of the newest normal forces in the mean, between 0 and 1."""
    tolerance: float = 1e-6
    """The scheme has come to rest when the multiplier changes by less than this, relatively."""
    max_iterations: int = 100
    """Passes of one path."""
    n_paths: int = 8
    """Starts and averages that are tried."""
    seed: int = 0
    """Of the random starts."""

    def __post_init__(self) -> None:
        if not 0.0 <= self.alpha < 1.0:
            raise ValueError(f"alpha must be from 0 to less than 1, it is {self.alpha:g}")
        if not 0.0 < self.beta <= 1.0:
            raise ValueError(f"beta must be greater than 0 and at most 1, it is {self.beta:g}")
        if not self.tolerance > 0.0:
            raise ValueError(f"tolerance must be greater than 0, it is {self.tolerance:g}")
        if self.max_iterations < 1 or self.n_paths < 1:
            raise ValueError("max_iterations and n_paths must be at least 1")


@dataclass(frozen=True, kw_only=True)
class State:
    """A certified collapse state: forces and mechanism that belong together."""

    multiplier: float  # the lowest that the mechanism leaves open
    highest: float
    forces: Array  # (n_contacts, dim) in units of force, at the lowest
    velocity: Array  # (n_rows,) scaled, F.u = 1
    n_iterations: int


@dataclass(frozen=True, kw_only=True)
class Paths:
    """What all paths came to."""

    states: tuple[State, ...]  # of the paths that were certified, in their order
    n_unbounded: int  # paths on which no multiplier was large enough
    n_failed: int  # paths that did not come to rest, or not at a certified state
    n_iterations: int  # of all paths


def follow_paths(
    equilibrium: Equilibrium,
    *,
    associative: Array | None,
    resting: Array,
    settings: NonAssociativeSettings,
) -> Paths:
    """Follow the scheme along several paths.

    Parameters
    ----------
    associative
        Normal forces (n_contacts,) of associative collapse; None where there is none.
    resting
        Normal forces under the dead load alone.
    """
    slope = flow_tangent(equilibrium, settings.alpha)
    states: list[State] = []
    unbounded = failed = iterations = 0
    for start, beta in _starts(associative, resting, settings):
        program = force_program(
            equilibrium,
            column=equilibrium.live,
            right=-equilibrium.dead,
            slope=slope,
            least=least_normal(equilibrium),
        )
        last, passes, at_rest = _follow(equilibrium, program, slope, start, beta, settings)
        iterations += passes
        state = _certify(equilibrium, last, slope, passes) if at_rest else None
        if state is not None:
            states.append(state)
        elif last.status == UNBOUNDED:
            unbounded += 1
        else:
            failed += 1
    return Paths(
        states=tuple(states), n_unbounded=unbounded, n_failed=failed, n_iterations=iterations
    )


def flow_tangent(equilibrium: Equilibrium, alpha: float) -> Array:
    """Opening over slip of every contact, (n_contacts,)."""
    points = equilibrium.points
    return np.maximum(points.dilatancy, alpha * points.friction)


def _starts(
    associative: Array | None, resting: Array, settings: NonAssociativeSettings
) -> Iterator[tuple[Array, float]]:
    """Normal forces to begin with and the weight of the newest, path by path."""
    first = resting if associative is None else associative
    fixed = [(first, settings.beta), (resting, settings.beta)]
    fixed += [(first, beta) for beta in BETAS if beta != settings.beta]
    random = np.random.default_rng(settings.seed)
    for k in range(settings.n_paths):
        if k < len(fixed):
            yield fixed[k]
        else:
            yield first * random.uniform(0.5, 1.5, len(first)), settings.beta


def _follow(
    equilibrium: Equilibrium,
    program: ForceProgram | ConeProgram,
    slope: Array,
    start: Array,
    beta: float,
    settings: NonAssociativeSettings,
) -> tuple[Answer, int, bool]:
    """One path: its last answer, the passes it took, whether it came to rest."""
    friction = equilibrium.points.friction
    normal = np.maximum(start, least_normal(equilibrium))
    before, plane, looks = np.inf, equilibrium.points.dimension == 2, LOOKS
    for k in range(1, settings.max_iterations + 1):
        intercept = equilibrium.cohesion + (friction - slope) * normal
        answer = _strongest(equilibrium, program, slope, intercept)
        if answer.status != OPTIMAL:
            return answer, k, False
        settled = abs(answer.factor - before) <= settings.tolerance * max(abs(answer.factor), 1e-3)
        if settled and (plane or strength_violation(equilibrium, answer.forces) <= COULOMB):
            return answer, k, True
        if settled and looks > 0:  # the mechanism may be that of a state already
            looks -= 1
            if _certify(equilibrium, answer, slope, k) is not None:
                return answer, k, True
        before = answer.factor
        normal = beta * answer.forces[:, 0] + (1.0 - beta) * normal
    return answer, k, False


def _strongest(
    equilibrium: Equilibrium,
    program: ForceProgram | ConeProgram,
    slope: Array,
    intercept: Array,
) -> Answer:
    """The largest multiplier with that strength; in the plane from the last basis."""
    program.limit_shear(intercept)
    if isinstance(program, ForceProgram):
        return program.solve()
    answer = program.solve(at_once=True)
    if answer.status == FAILED:
        regions = Regions.within(3, slope, intercept, least_normal(equilibrium))
        inside = from_inside(equilibrium, regions, equilibrium.live, -equilibrium.dead)
        answer = inside or program.solve()
    return answer


def _certify(
    equilibrium: Equilibrium, answer: Answer, slope: Array, n_iterations: int
) -> State | None:
    """The mechanism with the least forces that belong to it; None where there are none."""
    program = compatible_forces(equilibrium, answer.velocity, slope)
    program.bound_factor(0.0, np.inf)  # a load that grows from nothing
    program.aim(1.0)
    high = program.solve()
    if high.status not in (OPTIMAL, UNBOUNDED):
        return None
    program.aim(-1.0)
    low = program.solve()
    if low.status != OPTIMAL:
        return None
    return State(
        multiplier=low.factor,
        highest=high.factor if high.status == OPTIMAL else np.inf,
        forces=low.forces,
        velocity=answer.velocity,
        n_iterations=n_iterations,
    )


def compatible_forces(
    equilibrium: Equilibrium, velocity: Array, slope: Array
) -> ForceProgram | ConeProgram:
    """The program of the forces that belong to a mechanism, in balance at any multiplier."""
    relative = equilibrium.relative(velocity)
    still = STILL[equilibrium.points.dimension] * float(np.abs(relative).max(initial=0.0))
    low = least_normal(equilibrium)
    slip = equilibrium.slip(relative)
    slides = slip > still
    opens = relative[:, 0] > slope * slip + still
    program = force_program(
        equilibrium,
        column=equilibrium.live,
        right=-equilibrium.dead,
        slope=equilibrium.points.friction,
        least=low,
    )
    program.limit_shear(equilibrium.cohesion)
    contact = np.flatnonzero(slides)
    # The force on b is against the velocity of b.
    way = -relative[contact, 1:] / slip[contact, None]
    program.slide(contact, way, equilibrium.cohesion[contact])
    contact = np.flatnonzero(opens)
    program.hold_normal(contact, low[contact])
    return program


def strength_violation(equilibrium: Equilibrium, forces: Array) -> float:
    """Largest excess of contact forces over tension and friction, in units of force."""
    normal, tangential = forces[:, 0], equilibrium.slip(forces)
    tension = least_normal(equilibrium) - normal
    shear = tangential - shear_strength(equilibrium, normal)
    return float(max(tension.max(initial=0.0), shear.max(initial=0.0)))
