"""Limit analysis with joints that slide without opening.

With friction but no dilatancy the limit theorems do not hold.  What is sought is a state: forces
that balance the loads within the joints' strength, and a mechanism in which open contacts carry
nothing and sliding ones slide against a force at its limit, without opening.

Two methods find one.  In the plane it is the scheme of M. Gilbert, C. Casapulla & H. M. Ahmed,
*Limit analysis of masonry block structures with non-associative frictional joints using linear
programming*, Computers and Structures 84 (2006) 873-887.  In every pass each contact's friction is
replaced by a fictitious strength that the normal force of the pass before gives, n0, and a slope
that is the dilatancy:

    |t| <= c + mu n0 + m (n - n0),       m = max(tan psi, alpha mu)
    n0  <- beta n + (1 - beta) n0

so that the flow of that linear program, which is associative, is the wanted one.  Where the scheme
converges (n = n0 where contacts slide) friction is Coulomb's.  In space it often does not.  There,
for large structures in the plane, and wherever it converges on no path, the conditions themselves
are solved, see `coulomb_path`.  One path of the scheme is then followed as well, because it tends
to low multipliers.

What came of either is then certified.  For its mechanism u, the *compatible* forces are those that

    are on the limit t = -+ (c + mu n), against the slip, where a contact slides,
    are at the tip of the region where it opens, and within the region elsewhere;

all of them that balance dead load and lambda times the pattern make a convex set.  Its lowest and
highest lambda come from two programs, and every lambda between them is a collapse
multiplier of that mechanism.  It need not be one number where a mechanism leaves forces open.

Where there is no state, the multiplier of any is at least that of joints whose friction is their
dilatancy (Radenkovic's second theorem, see `lower_bound`), and at most the associative.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass, replace

import numpy as np

from drystone.common.arrays import Array
from drystone.limit.associative import is_large
from drystone.limit.cone_program import ConeProgram, force_program
from drystone.limit.cones import Regions, least_normal, shear_strength
from drystone.limit.equilibrium import Equilibrium
from drystone.limit.inside import from_inside
from drystone.limit.program import FAILED, OPTIMAL, UNBOUNDED, Answer, ForceProgram, Given

#: Relative velocities below this share of the largest are none, in the plane and in space: where
#: cones are round, the power of a mechanism differs by the square of what its velocities do.
STILL = {2: 1e-7, 3: 1e-5}
#: Factorisations that one curve of `coulomb_path` may take, all together, and from where on no
#: further one is begun.  Random structures of up to 40 blocks took 35 to 180, facades of 125 from
#: 120 to more than 700.
MOST_OF_ONE, MOST_OF_ALL, ENOUGH = 450, 900, 250
#: Number of curves that may fail, in addition to the number of those that are asked for.
MORE = 2
#: Passes of the scheme of programs in space, each of which is as much as the associative program.
FEW_PASSES = 12
#: Weights of the newest normal forces on paths besides the first two.
BETAS = (1.0, 0.3)


@dataclass(frozen=True, kw_only=True)
class NonAssociativeSettings:
    """Parameters of the scheme, and how many paths it is followed along."""

    alpha: float = 0.0
    """Slope left to a joint's failure surface, a share of its friction coefficient.  0 makes
    sliding joints keep exactly their own dilatancy; Gilbert et al. give 0.01 for their surface."""
    beta: float = 0.6
    """Weight of the newest normal forces in the mean, between 0 and 1; of the scheme of Gilbert et
    al."""
    tolerance: float = 1e-6
    """That scheme has converged when the multiplier changes by less than this, relatively."""
    max_iterations: int = 100
    """Passes of one of its paths."""
    n_paths: int = 8
    """Starts, averages or weights that are tried."""
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
    n_failed: int  # paths that did not converge, or not to a certified state
    n_iterations: int  # programs and factorisations of all paths


def follow_paths(
    equilibrium: Equilibrium,
    *,
    associative: Array | None,
    resting: Array,
    settings: NonAssociativeSettings,
) -> Paths:
    """Look for collapse states along several paths.

    Parameters
    ----------
    associative
        Normal forces (n_contacts,) of associative collapse; None where there is none.
    resting
        Normal forces under the dead load alone.
    """
    slope = flow_tangent(equilibrium, settings.alpha)
    n_paths = settings.n_paths
    if not is_large(equilibrium):
        starts = _starts(associative, resting, settings)
        paths = _by_programs(equilibrium, slope, starts, settings)
        found = paths.states or paths.n_unbounded
        return paths if found else _from_smooth(equilibrium, slope, settings, n_paths)
    curves = _from_smooth(equilibrium, slope, settings, max(n_paths - 1, 1))
    if n_paths == 1:
        return curves
    few = replace(settings, max_iterations=min(settings.max_iterations, FEW_PASSES))
    scheme = _by_programs(equilibrium, slope, [(resting, settings.beta)], few)
    return Paths(
        states=curves.states + scheme.states,
        n_unbounded=curves.n_unbounded + scheme.n_unbounded,
        n_failed=curves.n_failed + scheme.n_failed,
        n_iterations=curves.n_iterations + scheme.n_iterations,
    )


def _by_programs(
    equilibrium: Equilibrium,
    slope: Array,
    starts: Iterable[tuple[Array, float]],
    settings: NonAssociativeSettings,
) -> Paths:
    """The scheme of programs from several starts: normal forces and the weight of the newest."""
    states: list[State] = []
    unbounded = failed = iterations = 0
    for start, beta in starts:
        last, passes = _follow(equilibrium, slope, start, beta, settings)
        iterations += passes
        at_rest = last.status == OPTIMAL
        state = _certify(equilibrium, last.velocity, slope, passes) if at_rest else None
        if state is not None:
            states.append(state)
        elif last.status == UNBOUNDED:
            unbounded += 1
        else:
            failed += 1
    return Paths(
        states=tuple(states), n_unbounded=unbounded, n_failed=failed, n_iterations=iterations
    )


def _from_smooth(
    equilibrium: Equilibrium, slope: Array, settings: NonAssociativeSettings, n_paths: int
) -> Paths:
    """From smoothed problems of several weights to collapse states, until there are enough."""
    from drystone.limit.coulomb_path import follow  # takes long; small structures do without

    flowing = replace(equilibrium, points=replace(equilibrium.points, dilatancy=slope))
    states: list[State] = []
    unbounded = failed = work = 0
    for seed in range(n_paths + MORE):
        most = min(MOST_OF_ONE, MOST_OF_ALL - work)
        if len(states) >= n_paths or most <= 0 or (states and work > ENOUGH):
            break
        end = follow(flowing, seed=settings.seed + seed, most=most)
        work += end.n_factorisations
        if not end.finished or end.factor < 0.0:
            unbounded, failed = unbounded + end.locked, failed + (not end.locked)
            continue
        own = State(
            multiplier=end.factor,
            highest=end.factor,
            forces=end.forces,
            velocity=end.velocity,
            n_iterations=end.n_factorisations,
        )
        states.append(_certify(equilibrium, end.velocity, slope, end.n_factorisations) or own)
    return Paths(states=tuple(states), n_unbounded=unbounded, n_failed=failed, n_iterations=work)


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
    slope: Array,
    start: Array,
    beta: float,
    settings: NonAssociativeSettings,
) -> tuple[Answer, int]:
    """One path of the scheme: its last answer, failed where it is not at rest, and the passes."""
    friction, low = equilibrium.points.friction, least_normal(equilibrium)
    column, right = equilibrium.live, -equilibrium.dead
    normal, before, program = np.maximum(start, low), np.inf, None
    if equilibrium.points.dimension == 2:
        given = Given(column=column, right=right, slope=slope, least=low)
        program = ForceProgram(equilibrium, given)
    for k in range(1, settings.max_iterations + 1):
        intercept = equilibrium.cohesion + (friction - slope) * normal
        if program is None:
            regions = Regions.within(3, slope, intercept, low)
            answer = from_inside(equilibrium, regions, column, right)
        else:
            program.limit_shear(intercept)
            answer = program.solve()
        if answer is None:
            break
        if answer.status != OPTIMAL:
            return answer, k
        if abs(answer.factor - before) <= settings.tolerance * max(abs(answer.factor), 1e-3):
            return answer, k
        before = answer.factor
        normal = beta * answer.forces[:, 0] + (1.0 - beta) * normal
    # In space forces lie amid all equally good ones: a mechanism may be a state's before they rest.
    if answer is None or program is not None:
        nothing = np.zeros(0)
        return Answer(
            status=FAILED, factor=before, forces=nothing, velocity=nothing, n_iterations=0
        ), k
    return answer, k


def _certify(
    equilibrium: Equilibrium, velocity: Array, slope: Array, n_iterations: int
) -> State | None:
    """The mechanism with the least forces that belong to it; None where there are none."""
    program = compatible_forces(equilibrium, velocity, slope)
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
        velocity=velocity,
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
    given = Given(
        column=equilibrium.live,
        right=-equilibrium.dead,
        slope=equilibrium.points.friction,
        least=low,
    )
    program = (ConeProgram if is_large(equilibrium) else ForceProgram)(equilibrium, given)
    program.limit_shear(equilibrium.cohesion)
    contact = np.flatnonzero(slides)
    # The force on b is against the velocity of b.
    way = -relative[contact, 1:] / slip[contact, None]
    program.slide(contact, way, equilibrium.cohesion[contact])
    contact = np.flatnonzero(opens)
    program.fix_normal(contact, low[contact])
    return program


def lower_bound(equilibrium: Equilibrium, slope: Array) -> float:
    """What no collapse state lies below, by Radenkovic's second theorem; 0 at least.

    Let v be the mechanism of a state, so that v_n >= m |v_t|, and f its forces: with l the least
    normal force, (v_n - m |v_t|) (n - l) = 0 and friction against the slip make

        f.v = l (v_n - m |v_t|) - (c + (mu - m) n) |v_t|

    Forces f' with n' >= l and |t'| <= c + (mu - m) l + m n' have f'.v >= f.v, as n >= l.  If they
    balance lambda', then f'.v - f.v = (lambda - lambda') F.u: lambda is no less than lambda'.
    """
    low, friction = least_normal(equilibrium), equilibrium.points.friction
    intercept = equilibrium.cohesion + (friction - slope) * low
    column, right = equilibrium.live, -equilibrium.dead
    regions = Regions.within(equilibrium.points.dimension, slope, intercept, low)
    answer = from_inside(equilibrium, regions, column, right)
    if answer is None:
        given = Given(column=column, right=right, slope=slope, least=low)
        program = force_program(equilibrium, given)
        program.limit_shear(intercept)
        answer = program.solve()
    return max(answer.factor, 0.0) if answer.status == OPTIMAL else 0.0


def strength_violation(equilibrium: Equilibrium, forces: Array) -> float:
    """Largest excess of contact forces over tension and friction, in units of force."""
    normal, tangential = forces[:, 0], equilibrium.slip(forces)
    tension = least_normal(equilibrium) - normal
    shear = tangential - shear_strength(equilibrium, normal)
    return float(max(tension.max(initial=0.0), shear.max(initial=0.0)))
