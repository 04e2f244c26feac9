"""An arch on spreading supports, against the drawing of the Block Research Group, ETH Zurich:

eQUILIBRIUM, drawing 17, "Masonry arch on spreading supports",
https://block.arch.ethz.ch/eq/drawing/view/17.

A semicircular arch of 19 voussoirs between the radii 13 and 16, whose crown voussoir cracks in the
middle; its centre is at x = 35.  Its right support is dragged outwards; hinges are at the extrados
of the crown and at the intrados of the third joint from either springing.  By graphic statics the
line of thrust leaves the right springing within it for a spread of 4, and for one of 5 at x = 56.62
(as reckoned again from the coordinates of the drawing), 0.62 outside: the arch falls in between.
A drawing, not a paper: it tells no more digits of where.
"""

from __future__ import annotations

import math
from itertools import pairwise

import numpy as np
import pytest
from scipy.optimize import brentq

import drystone as ds

INNER, OUTER, CENTRE, N = 13.0, 16.0, 35.0, 19


def at(radius, angle):
    return radius * np.array([math.cos(angle), math.sin(angle)])


def voussoirs():
    """Between joints (n + 1,), from the right springing to the left one."""
    joints = np.pi / N * np.array([*range(10), 9.5, *range(10, 20)])
    return [
        np.array([at(INNER, a), at(OUTER, a), at(OUTER, b), at(INNER, b)])
        for a, b in pairwise(joints)
    ]


def model_of(largest):
    joint = ds.JointLaw(friction_coefficient=1.0, normal_stiffness=1e11, shear_stiffness=1e11)
    halved = math.cos(0.5 * np.pi / N)  # the halves weigh as much as the others, chord or not
    blocks = [
        ds.Block(id=f"v{k}", vertices=corners, unit_weight=2e4 * (halved if k in (9, 10) else 1.0))
        for k, corners in enumerate(voussoirs())
    ]
    for name, x in (("right", INNER - 1.0), ("left", -OUTER - 1.0)):
        width = OUTER - INNER + 2.0
        corners = np.array([[x, -1.0], [x + width, -1.0], [x + width, 0.0], [x, 0.0]])
        blocks.append(ds.Block(id=name, vertices=corners, unit_weight=2e4, support=True))
    return ds.make_model(
        blocks,
        joint=joint,
        thickness=1.0,
        settlement=ds.Settlement(blocks=("right",), direction=np.array([1.0, 0.0]), max=largest),
    )


def leaves_at(model, spread):
    """Where the line of thrust meets the springings' level on the right, with the centre at 35.

    Half the mechanism is turned about its haunch, as both move apart; hinges by the drawing.
    """
    half, below = [model.assembly.index(f"v{k}") for k in range(10)], 3
    weight, centre = model.assembly.weight[half], model.assembly.centroid[half]
    haunch, crown = at(INNER, below * np.pi / N), np.array([0.0, OUTER])
    before = crown - haunch
    rise = math.sqrt(before @ before - (haunch[0] + 0.5 * spread) ** 2)
    after = np.array([-haunch[0] - 0.5 * spread, rise])
    angle = math.atan2(after[1], after[0]) - math.atan2(before[1], before[0])
    c, s = math.cos(angle), math.sin(angle)
    arm = (centre[below:] - haunch) @ np.array([[c, s], [-s, c]])
    x = arm[:, 0] + haunch[0] + spread  # the left support stays
    middle = float(weight[below:] @ x) / weight[below:].sum()
    upper = weight[below:].sum()
    force = upper * (haunch[0] + spread - middle) / rise
    whole = upper * middle + float(weight[:below] @ (centre[:below, 0] + spread))
    return CENTRE + (force * (haunch[1] + rise) + whole) / weight.sum()


def test_it_falls_where_the_drawing_says():
    model = model_of(5.0)
    # By moments of the parts about their hinges 56.59.
    assert leaves_at(model, 5.0) == pytest.approx(56.62, abs=0.05)
    assert leaves_at(model, 4.0) < CENTRE + OUTER + 4.0
    end = brentq(lambda spread: leaves_at(model, spread) - CENTRE - OUTER - spread, 1.0, 5.0)
    assert 4.0 < end < 5.0
    curve = ds.pushover(model, keep_poses=True)
    assert curve.status == "finished"
    assert "falls where its supports go on" in curve.reason
    assert curve.control_displacement[-1] == pytest.approx(end, rel=1e-3)
    pose = curve.poses[-1]
    turn = np.abs(np.diff([pose[model.assembly.index(f"v{k}"), 2] for k in range(20)]))
    hinges = np.flatnonzero(turn > 0.3 * turn.max()) + 1
    assert hinges.tolist() == [3, 10, 17]
