"""The bias of the published strategy: applied over static multipliers after the peak."""

from __future__ import annotations

from collections.abc import Callable
from functools import cache, partial

import numpy as np

from drystone.analysis.driver import pushover
from drystone.common.arrays import Array
from drystone.model.builders.published import published_wall
from drystone.model.model import Model
from drystone.results.curve import CapacityCurve
from drystone.verification.blocks import on_base, rocking_branch
from drystone.verification.case import CLOSED_FORM, Case
from drystone.verification.plane import HEIGHT, STIFFNESS, WIDTH

SECTION = "The bias of the published strategy"

ENGINE = "nscd"
FACTORS = (1.005, 1.02, 1.05)
#: m; so small that the lag of the recursion behind the falling branch is little.
STEP = 2.5e-4
#: m, control displacement on wall 1: no block comes loose near it.
AT = 0.1

SECTIONS = {
    SECTION: "The published strategy applies more load than the structure carries, by the "
    "overshoot f. After the peak, the ratio of its multipliers to the static ones tends to a "
    "constant, which [theory](../explanation/theory.md) derives. The engine is `nscd`, with steps "
    "of 0.25 mm. The block with sharp corners is evaluated between 0.1 and 0.2 m, against its "
    "closed form. Wall 1 is evaluated at 0.1 m, against the curve of the strategy `displacement`. "
    "The factor c of the formula is computed from the motion of the run itself.",
}


def fixed_bias(f: float, c: Array | float) -> Array | float:
    """Applied over static multiplier that the published recursion tends to (theory.md)."""
    return 1.0 / (1.0 - (f - 1.0) / f / c)


def _published(model: Model, f: float, end: float) -> CapacityCurve:
    """A curve by the published strategy with an overshoot f, up to a displacement [m]."""
    return pushover(
        model,
        engine=ENGINE,
        strategy="published",
        overshoot=f,
        displacement_step=STEP,
        max_displacement=end,
        keep_poses=True,
    )


@cache
def of_block(f: float) -> tuple[float, float]:
    """Applied over closed-form multiplier of the block that rocks, measured and by the formula."""
    model = on_base(WIDTH, (HEIGHT,), friction=0.8, stiffness=STIFFNESS)
    curve = _published(model, f, 0.25)
    displacement, multiplier, theta = rocking_branch(WIDTH, HEIGHT, 0.0)
    x = curve.control_displacement
    chosen = (x > 0.1) & (x < 0.2)
    exact = np.interp(x, displacement, multiplier)
    turned = np.interp(x, displacement, theta)
    height = 0.5 * (HEIGHT * np.cos(turned) + WIDTH * np.sin(turned))
    c = height**2 / ((WIDTH**2 + HEIGHT**2) / 3.0)
    measured = np.median((curve.applied_multiplier / exact)[chosen])
    return float(measured), float(np.median(np.asarray(fixed_bias(f, c))[chosen]))


def _near(curve: CapacityCurve, values: Array) -> float:
    """Median of a column near `AT`."""
    return float(np.median(values[np.abs(curve.control_displacement - AT) < 0.01]))


def mass_factor(model: Model, curve: CapacityCurve) -> float:
    """The factor c of theory.md from a curve's motion near `AT`."""
    assert curve.poses is not None
    assembly = model.assembly
    mass = np.where(assembly.fixed[:, None], 0.0, assembly.mass)
    v = curve.poses[curve.nearest(AT + 0.01)] - curve.poses[curve.nearest(AT - 0.01)]
    momentum = float(np.sum(mass[:, 0] * v[:, 0]))
    return momentum**2 / float(mass[:, 0].sum() * np.sum(mass * v * v))


@cache
def _reference() -> float:
    options = {"displacement_step": STEP, "max_displacement": AT + 0.02}
    free = pushover(published_wall(1), engine=ENGINE, **options)  # type: ignore[arg-type]
    return _near(free, free.load_multiplier)


@cache
def of_wall(f: float) -> tuple[float, float]:
    """Applied over static multiplier of wall 1, measured and by the formula."""
    model = published_wall(1)
    curve = _published(model, f, AT + 0.02)
    measured = _near(curve, curve.applied_multiplier) / _reference()
    return measured, float(fixed_bias(f, mass_factor(model, curve)))


def _over(of: Callable[[float], tuple[float, float]], f: float) -> float:
    measured, formula = of(f)
    return measured / formula


def cases() -> list[Case]:
    """Of this part."""
    return [
        Case(
            name=f"{what}, overshoot {f:g}: measured over formula",
            section=SECTION,
            kind=CLOSED_FORM,
            source="the recursion's fixed point",
            expected=1.0,
            compute=partial(_over, of, f),
            bound=bound,
            reason=reason,
            quick=False,
        )
        for what, of, bound, reason in (
            (
                "block that rocks",
                of_block,
                5e-3,
                "the lag of the recursion behind the falling branch, in steps of 0.25 mm",
            ),
            ("wall 1", of_wall, 2e-2, "this lag, and c computed from poses 20 mm apart"),
        )
        for f in FACTORS
    ]
