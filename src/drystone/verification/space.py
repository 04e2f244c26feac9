"""Solids: a block pushed at an angle, and walls of the plane as solids."""

from __future__ import annotations

from functools import cache, partial

import numpy as np

from drystone.analysis.driver import pushover
from drystone.limit import collapse_load
from drystone.model.builders.published import PUBLISHED_WALLS, published_wall
from drystone.model.construction.extrude import extruded
from drystone.results.curve import CapacityCurve
from drystone.verification.blocks import UNIT_WEIGHT, solid_on_base
from drystone.verification.case import CLOSED_FORM, ENGINES, PROGRAM, Case

BLOCK, WALLS = "Three dimensions", "Walls as solids"

SIZES, FRICTION = (0.4, 0.6, 1.5), 0.7  # m, of the block; its friction
STIFFNESS = 1e11  # Pa/m
ANGLES = (0.0, 30.0, 45.0, 90.0)  # degrees
LIMIT = "limit analysis"

SECTIONS = {
    BLOCK: "One block of 0.4 x 0.6 x 1.5 m, with friction 0.7 and joints of 1e11 Pa/m, is pushed "
    "at an angle to its width. The peak is min(mu, b / (h cos), d / (h sin)). More cases (random "
    "solids, twisting, flight, arches, domes and façades) are in the folders `tests/verification` "
    "and `tests/validation`.",
    WALLS: "The published walls, extruded to solids, are compared with the same walls in the "
    "plane, which are analysed by other code. The numbers are the differences of the collapse "
    "multiplier of associative limit analysis, of the peak by `equilibrium`, and of the branches "
    "by `equilibrium` (the median, over the peak). After a jump, wall and solids may follow "
    "different branches.",
}


def exact_peak(degrees: float) -> float:
    """Of the block, pushed at an angle."""
    b, d, h = SIZES
    c, s = np.cos(np.radians(degrees)), np.sin(np.radians(degrees))
    across = b / (h * c) if c > 1e-9 else np.inf
    return float(min(FRICTION, across, d / (h * s) if s > 1e-9 else np.inf))


def peak(method: str, degrees: float) -> float:
    """Of the block, by an engine or limit analysis."""
    model = solid_on_base(SIZES, float(np.radians(degrees)), friction=FRICTION, stiffness=STIFFNESS)
    if method == LIMIT:
        return collapse_load(model, flow="associative").load_multiplier
    return pushover(model, engine=method).peak.load_multiplier


@cache
def _curve(number: int, *, solids: bool) -> CapacityCurve:
    model = published_wall(number)
    return pushover(extruded(model) if solids else model, engine="equilibrium")


def branches_apart(number: int) -> float:
    """Median difference of a wall's branches, in the plane and as solids, over the peak."""
    plane, solids = _curve(number, solids=False), _curve(number, solids=True)
    both = min(plane.control_displacement.max(), solids.control_displacement.max())
    known = np.argsort(plane.control_displacement, kind="stable")
    on_plane = np.interp(
        solids.control_displacement,
        plane.control_displacement[known],
        plane.load_multiplier[known],
    )
    apart = np.abs(solids.load_multiplier - on_plane)[solids.control_displacement <= both]
    return float(np.median(apart)) / plane.peak.load_multiplier


def _limit(number: int) -> float:
    """Collapse multiplier of a wall as solids over that in the plane, less one."""
    plane = published_wall(number)
    in_plane = collapse_load(plane, flow="associative").load_multiplier
    return collapse_load(extruded(plane), flow="associative").load_multiplier / in_plane - 1.0


def _peaks(number: int) -> float:
    plane, solids = (_curve(number, solids=s).peak.load_multiplier for s in (False, True))
    return solids / plane - 1.0


def cases() -> list[Case]:
    """Of this part."""
    found = []
    b, d, h = SIZES
    # A corner takes the weight on the quarter of the bed that is its contact's.
    tilt = UNIT_WEIGHT * b * d * h / (0.25 * STIFFNESS * b * d) / b
    for degrees in ANGLES:
        for method in (LIMIT, *ENGINES):
            exact = exact_peak(degrees)
            found.append(
                Case(
                    name=f"block, {degrees:g}°: {method}",
                    section=BLOCK,
                    kind=CLOSED_FORM,
                    source="min(mu, b / (h cos), d / (h sin))",
                    expected=exact,
                    compute=partial(peak, method, degrees),
                    bound=1e-9 if method == LIMIT else 4.0 * tilt / exact,
                    reason=(
                        "the tolerance of the cone program"
                        if method == LIMIT
                        else f"four times the tilt of the joint about both axes before the block "
                        f"turns, up to {tilt:.1e} rad"
                    ),
                    quick=degrees == 30.0,
                )
            )
    for number in PUBLISHED_WALLS:
        for what, compute, bound, reason in (
            ("collapse multiplier", _limit, 1e-8, "the tolerance of both programs"),
            ("peak", _peaks, 1e-3, "the distance of points near the peak"),
            ("median of branches", branches_apart, 5e-3, "after a jump branches may differ"),
        ):
            found.append(
                Case(
                    name=f"wall {number} as solids: {what}",
                    section=WALLS,
                    kind=PROGRAM,
                    source="the same in the plane",
                    expected=0.0,
                    compute=partial(compute, number),
                    bound=bound,
                    reason=reason,
                    quick=False,
                )
            )
    return found
