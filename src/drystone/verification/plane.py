"""Closed forms in the plane: blocks that rock and that slide, and how errors fall with the step."""

from __future__ import annotations

from functools import cache, partial

import numpy as np

from drystone.analysis.driver import pushover
from drystone.common.arrays import BoolArray
from drystone.results.curve import STATIC, CapacityCurve
from drystone.verification.blocks import UNIT_WEIGHT, on_base, rocking_branch
from drystone.verification.case import CLOSED_FORM, ENGINES, Case

ROCKING, SLIDING, STEPS = "A block that rocks", "A block that slides", "Step size"

WIDTH, HEIGHT = 0.4, 0.9  # m, of the block that rocks
STIFFNESS = 1e11  # Pa/m
#: Displacement steps [m], and the one of a single curve.
LENGTHS = (1e-3, 5e-4, 2.5e-4)
STEP = LENGTHS[0]

SECTIONS = {
    ROCKING: "One block 0.4 m wide and 0.9 m high stands on a fixed base, with joints of 1e11 "
    "Pa/m. It turns over its toe. The multiplier is the arm of the weight about the contact over "
    "the height of the centroid. With a rounded corner the contact moves, because the disc rolls. "
    "The number is the largest difference of the multiplier from this value, at static points, "
    "from 1 % to 95 % of the displacement at which the multiplier vanishes.",
    SLIDING: "A flat block is pushed down an inclined plane. It slides at the multiplier tan(phi "
    "- alpha), where tan phi is the friction coefficient and alpha the slope. The number is the "
    "median multiplier of a curve of 5 cm.",
    STEPS: "The block that rocks, with a corner radius of 0.02 m. For `nscd` the number is the "
    "order of convergence: how the median difference from the closed form falls with the "
    "displacement step, from 1 mm to 0.25 mm. For the other engines the number is the median "
    "difference itself, with steps of 0.25 mm.",
}


def static(curve: CapacityCurve) -> BoolArray:
    """Which points (n,) inertia does not help to carry."""
    return np.asarray(curve.column("status") == STATIC)


@cache
def rocking(engine: str, radius: float, step: float) -> tuple[float, float]:
    """Largest and median difference from the closed form over the branch below the peak."""
    model = on_base(
        WIDTH, (HEIGHT,), friction=0.8, stiffness=STIFFNESS, radius=radius or None
    )  # the friction at which it does not slide
    curve = pushover(model, engine=engine, displacement_step=step)
    displacement, multiplier, _ = rocking_branch(WIDTH, HEIGHT, radius)
    x, y = curve.control_displacement, curve.load_multiplier
    chosen = static(curve) & (x > 0.01 * displacement[-1]) & (x < 0.95 * displacement[-1])
    difference = np.abs(y - np.interp(x, displacement, multiplier))[chosen]
    return float(difference.max()), float(np.median(difference))


def sliding(engine: str, friction: float, slope: float) -> float:
    """Median multiplier of a flat block that slides by 5 cm."""
    model = on_base(0.6, (0.2,), friction=friction, stiffness=STIFFNESS, slope=slope).with_analysis(
        max_displacement=0.05
    )
    curve = pushover(model, engine=engine)
    chosen = static(curve) & (curve.control_displacement > 0.005)
    return float(np.median(curve.load_multiplier[chosen]))


def order_of(engine: str) -> float:
    """Order of the error of the block that rocks in the length of a step."""
    first, last = (rocking(engine, 0.02, step)[1] for step in (LENGTHS[0], LENGTHS[-1]))
    return float(np.log(first / last) / np.log(LENGTHS[0] / LENGTHS[-1]))


def _of_rocking() -> list[Case]:
    found = []
    # The toe takes the weight on the half of the bed that is its contact's.
    tilt = UNIT_WEIGHT * WIDTH * HEIGHT / (0.5 * STIFFNESS * WIDTH) / WIDTH
    slope = (1.0 + (WIDTH / HEIGHT) ** 2) / HEIGHT  # of the multiplier, at rest, 1/m
    for engine in ENGINES:
        for radius in (0.0, 0.02):
            bound = 10.0 * tilt
            reason = f"ten times the tilt of the joint before the block turns, {tilt:.1e} rad"
            if engine == "nscd":
                # A turn by the step's angle a, along the tangent where it starts, shifts the toe by
                # half of a^2 of the level distance to the centroid: over the branch in all by half
                # of a of what the centroid rises by.
                rise = 0.5 * (float(np.hypot(WIDTH, HEIGHT)) - HEIGHT)
                bound += slope * 0.5 * STEP / HEIGHT * rise
                reason += (
                    "; in addition, each step follows its tangent, so that the toe drifts by half "
                    "of the step's angle times the rise of the centroid"
                )
            found.append(
                Case(
                    name=f"corner radius {radius:g} m: largest difference, {engine}",
                    section=ROCKING,
                    kind=CLOSED_FORM,
                    source="arm of the weight over height of the centroid",
                    expected=0.0,
                    compute=lambda e=engine, r=radius: rocking(e, r, STEP)[0],  # type: ignore[misc]
                    bound=bound,
                    reason=reason,
                )
            )
    return found


def _of_sliding() -> list[Case]:
    found = []
    for engine in ENGINES:
        for degrees, friction in ((0.0, 0.3), (10.0, 0.5)):
            alpha = float(np.radians(degrees))
            exact = float(np.tan(np.arctan(friction) - alpha))
            found.append(
                Case(
                    name=f"friction {friction:g}, plane at {degrees:g}°: multiplier, {engine}",
                    section=SLIDING,
                    kind=CLOSED_FORM,
                    source="tan(phi - alpha)",
                    expected=exact,
                    compute=partial(sliding, engine, friction, alpha),
                    bound=1e-5,
                    reason="points at rest are computed to 1e-5 of a weight",
                )
            )
    return found


def _of_steps() -> list[Case]:
    found = []
    for engine in ENGINES:
        of_first_order = engine == "nscd"
        median = "median difference, steps of 0.25 mm"
        found.append(
            Case(
                name=f"{'order of the error' if of_first_order else median}, {engine}",
                section=STEPS,
                kind=CLOSED_FORM,
                source="backward Euler" if of_first_order else "as above",
                expected=1.0 if of_first_order else 0.0,
                compute=(
                    partial(order_of, engine)
                    if of_first_order
                    else lambda e=engine: rocking(e, 0.02, LENGTHS[-1])[1]  # type: ignore[misc]
                ),
                bound=0.05 if of_first_order else 1e-6,
                reason=(
                    "terms of second order, for steps of a thousandth of the height"
                    if of_first_order
                    else "the error does not depend on the step: twice the tilt of the joint"
                ),
                quick=False,
            )
        )
    return found


def cases() -> list[Case]:
    """Of this part."""
    return [*_of_rocking(), *_of_sliding(), *_of_steps()]
