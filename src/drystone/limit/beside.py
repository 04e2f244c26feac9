"""Limit analysis beside a pushover curve: two multipliers, found quickly, or why there are none."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from drystone.common.importing import importing
from drystone.common.ranges import most_blocks
from drystone.limit.flows import ASSOCIATIVE, FLOWS, NON_ASSOCIATIVE

if TYPE_CHECKING:
    from drystone.limit.collapse import Collapse
    from drystone.model.model import Model
    from drystone.model.monitor import ControlPoint
    from drystone.results.curve import CapacityCurve

# Limit analysis takes long to import, and a run may leave it to another process: what needs it here
# imports it when it is called.

#: Structures of more blocks than these are left out of the non-associative flow, which takes up to
#: thirty times as long as the associative; those of more than `MOST_BLOCKS` altogether.
MOST_NON_ASSOCIATIVE = {2: 120, 3: 150}
#: The same of contact points.  Structures that may be crushed reach these numbers first: in space
#: with some 35 joints that of the non-associative flow, with 140 that of both.  36,000 points take
#: 10 s, 44,000 up to 90 s.
MOST_POINTS, MOST_POINTS_NON_ASSOCIATIVE = 40_000, 10_000
#: A multiplier may lie above by this share of the bound, or by this much where the bound is next to
#: nothing: without friction, where it is zero, engines leave up to 4e-7.
MARGIN, LEAST = 1e-4, 1e-5


@dataclass(frozen=True, kw_only=True)
class Beside:
    """Collapse multipliers of a model with the corners that its curve has."""

    associative: float | None = None
    non_associative: float | None = None
    """The lowest collapse state found."""
    collapse_range: tuple[float, float] | None = None
    """Lowest and highest non-associative multiplier found."""
    upper_bound: float | None = None
    """What blocks carry at most in their designed shape, see `Collapse.upper_bound`."""
    control_still: bool = False
    """Whether the associative mechanism leaves the control point where it is."""
    fastest: ControlPoint | None = None
    """Then the point that this mechanism moves fastest, if it moves any along that direction."""
    note: str = ""
    """Why a value is missing, as a sentence."""

    @property
    def limits(self) -> dict[str, float]:
        """Label and multiplier of what was found."""
        found = {
            "limit analysis, associative": self.associative,
            "limit analysis, non-associative": self.non_associative,
        }
        return {label: value for label, value in found.items() if value is not None}

    def is_exceeded(self, curve: CapacityCurve) -> bool:
        """Whether the capacity of a curve lies above the associative multiplier."""
        capacity = curve.capacity.load_multiplier
        return self.associative is not None and exceeds(capacity, self.associative)

    def warning(self, curve: CapacityCurve, model: Model) -> str | None:
        """A sentence where a capacity lies above the associative multiplier, and why it does.

        The cause is looked for in what the curve has kept of contacts and poses, see `excess`.
        """
        if self.associative is None or not self.is_exceeded(curve):
            return None
        from drystone.limit.excess import why_above

        return why_above(curve, model, self.associative)


def exceeds(multiplier: float, bound: float) -> bool:
    """Whether a multiplier lies above a bound by more than what is left open of both."""
    return multiplier > bound + max(MARGIN * abs(bound), LEAST)


def limits_beside(model: Model) -> Beside:
    """Both multipliers."""
    n_blocks, dimension = model.assembly.n_blocks, model.assembly.dimension
    if model.settlement is not None:
        return Beside(note="supports move, and no load grows")
    if n_blocks > most_blocks(dimension):
        return Beside(note=f"{n_blocks} blocks are left to the command `limit`")
    from drystone.limit.collapse import collapse_loads
    from drystone.limit.crushing import n_points

    points = n_points(model.assembly)
    if points > MOST_POINTS:
        still, fastest = _by_mechanism(model)
        note = f"{points} contact points are left to the command `limit`"
        return Beside(control_still=still, fastest=fastest, note=note)
    few = n_blocks <= MOST_NON_ASSOCIATIVE[dimension] and points <= MOST_POINTS_NON_ASSOCIATIVE
    flows = FLOWS if few else (ASSOCIATIVE,)
    results = collapse_loads(model, flows=flows)  # as `drystone limit` has them
    found = {
        result.flow: result
        for result in results
        if result.status == "finished" and np.isfinite(result.load_multiplier)
    }
    ranges = {
        result.flow: result.collapse_range
        for result in results
        if result.flow in found or result.status == "bracketed"
    }
    values = {flow: result.load_multiplier for flow, result in found.items()}
    missing = [result.reason for result in results if result.flow not in values]
    if len(flows) == 1 and not missing:
        missing = [
            f"the non-associative flow of {n_blocks} blocks and {points} contact points is left to "
            "the command `limit`"
        ]
    still, fastest = _mechanism(model, found.get(ASSOCIATIVE))
    return Beside(
        control_still=still,
        fastest=fastest,
        associative=values.get(ASSOCIATIVE),
        upper_bound=found[ASSOCIATIVE].upper_bound if ASSOCIATIVE in found else None,
        non_associative=values.get(NON_ASSOCIATIVE),
        collapse_range=ranges.get(NON_ASSOCIATIVE),
        note=missing[0] if missing else "",
    )


def _mechanism(model: Model, collapse: Collapse | None) -> tuple[bool, ControlPoint | None]:
    """Whether it leaves the control point still, and then which point it moves fastest."""
    from drystone.limit.watch import fastest_point, leaves_still

    if collapse is None or collapse.status != "finished":
        return False, None
    if not leaves_still(model, collapse.velocities):
        return False, None
    fastest = fastest_point(model, collapse.velocities)
    return True, None if fastest is model.control_point else fastest


def on_what_moves(model: Model, beside: Beside | None = None) -> Model:
    """The model; with its control point on the part that moves, where nobody has named one.

    ``beside`` is what limit analysis has found, where that is known.
    """
    if not model.control_point.default or model.settlement is not None:
        return model
    fastest = _fastest(model) if beside is None else beside.fastest
    return model if fastest is None else replace(model, control_point=fastest)


def made_ready() -> None:
    """Import what limit analysis needs, in a process that is going to be asked for it."""
    with importing():
        import highspy  # noqa: F401

        import drystone.limit.watch  # noqa: F401


def moving_control(model: Model) -> ControlPoint | None:
    """The control point that `on_what_moves` puts in place of a model's, if it does."""
    moved = on_what_moves(model)
    return None if moved is model else moved.control_point


def _fastest(model: Model) -> ControlPoint | None:
    """As `Beside.fastest`, by the associative mechanism alone."""
    if model.assembly.n_blocks > most_blocks(model.assembly.dimension):
        return None
    return _by_mechanism(model)[1]


def _by_mechanism(model: Model) -> tuple[bool, ControlPoint | None]:
    """As `_mechanism`, by the associative mechanism alone; of large programs without crushing."""
    from drystone.limit.collapse import collapse_load, uncrushed
    from drystone.limit.crushing import n_points

    if n_points(model.assembly) > MOST_POINTS:
        return _mechanism(model, uncrushed(model))
    return _mechanism(model, collapse_load(model, flow=ASSOCIATIVE))


def multiplier_text(multiplier: float, digits: int) -> str:
    """A multiplier with so many decimals, which is never minus zero."""
    return f"{round(multiplier, digits) + 0.0:.{digits}f}"


def range_text(collapse_range: tuple[float, float], digits: int) -> str:
    """One number, or two where they differ in print."""
    low, high = (multiplier_text(value, digits) for value in collapse_range)
    return low if low == high else f"{low} to {high}"
