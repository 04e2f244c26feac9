"""Cyclic displacements, against closed forms."""

from __future__ import annotations

from functools import partial

import numpy as np

from drystone.analysis.driver import pushover
from drystone.verification.blocks import UNIT_WEIGHT, exact_rocking, exact_stack, on_base
from drystone.verification.case import CLOSED_FORM, ENGINES, Case

SECTION = "There and back"

WIDTH, HEIGHT, FRICTION = 0.6, 0.4, 0.3  # m, of the block that slides
AMPLITUDE = 0.01  # m
SOFT, STIFF = 1e9, 1e12  # Pa/m
#: Of the blocks that rock: width and height [m], and how far they go.
SLENDER, TALL, FAR = 0.2, 0.4, 0.03
STEP_IN_TIME = 5e-4  # m, displacement step of `nscd` there
#: Joints of those [Pa/m], and the displacement from which on they stand on a corner [m].
OF_ROCKING, ON_A_CORNER = 1e10, 1e-3

SECTIONS = {
    SECTION: "`[control] history` moves the control point to a displacement, to the other side, "
    "and back. A block of weight W that slides to and fro by the amplitude a dissipates 4 mu W (a "
    "- u) in a cycle, where u is the elastic displacement of its joint before it slides. On stiff "
    "joints this is 4 mu W a. A block that rocks, and a stack of two, return on the same curve. "
    "The number is then the largest difference of the multiplier, in both senses.",
}


def energy(engine: str, stiffness: float) -> float:
    """Of the second cycle of a block that slides [J]."""
    model = on_base(WIDTH, (HEIGHT,), friction=FRICTION, stiffness=stiffness, point="centre")
    curve = pushover(model.with_history(amplitudes=[AMPLITUDE], cycles=2), engine=engine)
    return curve.cycles[1].energy


def gives_way(engine: str, stiffness: float) -> float:
    """Slip and tilt of the joint under the centroid at the friction limit [m]; `nscd` has no
    stiffness along joints."""
    push = FRICTION * UNIT_WEIGHT * WIDTH * HEIGHT
    tilt = push * (0.5 * HEIGHT) ** 2 / (stiffness * WIDTH * (0.5 * WIDTH) ** 2)
    return tilt if engine == "nscd" else tilt + push / (stiffness * WIDTH)


def rocking(engine: str, heights: tuple[float, ...]) -> float:
    """Largest difference of the multiplier from the closed form, there and back."""
    model = on_base(SLENDER, heights, friction=0.7, stiffness=OF_ROCKING)
    model = model.with_history([FAR, -FAR, 0.0])
    options = {"displacement_step": STEP_IN_TIME} if engine == "nscd" else {}
    curve = pushover(model, engine=engine, keep_poses=True, **options)  # type: ignore[arg-type]
    assert curve.poses is not None
    tilted = np.abs(curve.control_displacement) > ON_A_CORNER
    angle, load = curve.poses[tilted, 1, 2], curve.load_multiplier[tilted]
    if len(heights) == 1:
        exact = exact_rocking(angle, SLENDER, heights[0])
    else:
        exact = exact_stack(angle, SLENDER, heights[0], OF_ROCKING)
    return float(np.abs(load + np.sign(angle) * exact).max())


def cases() -> list[Case]:
    """Of this part."""
    found = []
    weight = UNIT_WEIGHT * WIDTH * HEIGHT
    for engine in ENGINES:
        for stiffness, formula in ((SOFT, "4 mu W (a - u)"), (STIFF, "4 mu W a")):
            soft = gives_way(engine, stiffness) if stiffness == SOFT else 0.0
            found.append(
                Case(
                    name=f"sliding, joints of {stiffness:.0e} Pa/m: energy of a cycle [J], "
                    f"{engine}",
                    section=SECTION,
                    kind=CLOSED_FORM,
                    source=formula,
                    expected=4.0 * FRICTION * weight * (AMPLITUDE - soft),
                    compute=partial(energy, engine, stiffness),
                    bound=1e-6,
                    reason="the block tilts by 3e-6 rad on its soft joint, and the energy of this "
                    "is of second order; on the stiff joint u is 2e-7 of a",
                )
            )
        for heights, what in (((2.0 * TALL,), "one block"), ((TALL, TALL), "a stack of two")):
            found.append(
                Case(
                    name=f"{what} rocks: largest difference, {engine}",
                    section=SECTION,
                    kind=CLOSED_FORM,
                    source="arms of the weights over heights of the centroids",
                    expected=0.0,
                    compute=partial(rocking, engine, heights),
                    bound=1e-6,
                    reason=(
                        "the error of virtual work is of second order in the angle of a step, "
                        "0.5 mm over 0.8 m: twice its square is 8e-7"
                        if engine == "nscd"
                        else "ten times the inertia that static steps leave, 1e-7 of a weight"
                    ),
                )
            )
    return found
