"""A rounded solid that rocks on the rim of another, against a closed form, by every engine.

The block is as wide as its support and stands right above it or to one side.  To one side, the
support goes on past one end of the rim, and the block past the other end.

Two discs of the radius r roll on each other.  When the upper one has turned by theta, the line
from centre to centre has turned by phi = theta / 2.  With a = B/2 - r and e = H/2 - r, moments
about the point of contact give

    lambda = (a cos theta - e sin theta - r sin phi) / (a sin theta + e cos theta + r cos phi)

and the upper corner moves by

    delta = 2 r sin phi + r cos theta + (H - r) sin theta - r
"""

from __future__ import annotations

import numpy as np
import pytest

import drystone as ds
from drystone.results.curve import FINISHED
from solids import box, joint, model_of

WIDTH, HEIGHT, RADIUS = 0.4, 1.0, 0.02
STEP = 2e-3  # m
#: The block is rigid in the closed form.  Here it leans by its closure over its width, 1e-5 at
#: 1e10 Pa/m.  In a step of `equilibrium` the point of contact stays where it is on the blocks,
#: which is off by half of the radius times the rotation, over the height; `nscd` tells the
#: multiplier where a step begins, off by a step times the slope of the curve, 1.1 per metre.
EXACT = {"equilibrium": 5e-5, "distinct": 5e-5, "nscd": 1.2 * STEP}


def closed_form(moved: np.ndarray) -> np.ndarray:
    """Multipliers at displacements (n,) [m]."""
    theta = np.linspace(0.0, 0.3, 20_001)
    phi = 0.5 * theta
    a, e = 0.5 * WIDTH - RADIUS, 0.5 * HEIGHT - RADIUS
    arm = a * np.cos(theta) - e * np.sin(theta) - RADIUS * np.sin(phi)
    height = a * np.sin(theta) + e * np.cos(theta) + RADIUS * np.cos(phi)
    delta = RADIUS * (2.0 * np.sin(phi) + np.cos(theta) - 1.0) + (HEIGHT - RADIUS) * np.sin(theta)
    return np.interp(moved, delta, arm / height)


@pytest.mark.parametrize("engine", EXACT)
@pytest.mark.parametrize("sideways", [(-0.25, 0.25), (-0.2, 0.35)], ids=["above", "beside"])
def test_a_block_beside_the_end_of_its_support(engine, sideways):
    half, (low, high) = 0.5 * WIDTH, sideways
    blocks = [
        box("base", (-half, -0.25, -0.5), (half, 0.25, 0.0), support=True),
        box("b", (-half, low, 0.0), (half, high, HEIGHT)),
    ]
    model = model_of(
        blocks, joint(5.0, 1e10), push=(1.0, 0.0, 0.0), corner=ds.Corner(radius=RADIUS)
    )
    curve = ds.pushover(
        model, engine=engine, progress=False, displacement_step=STEP, max_displacement=0.1
    )
    assert curve.status == FINISHED
    moved, carried = curve.control_displacement, curve.load_multiplier
    here = moved > 0.01
    assert moved.max() > 0.09
    assert carried[here] == pytest.approx(closed_form(moved[here]), abs=EXACT[engine])
    assert np.count_nonzero(here) < 3 * 0.1 / STEP
