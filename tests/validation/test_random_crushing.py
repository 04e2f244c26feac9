"""Random structures whose joints are crushed come to rest after each jump."""

from __future__ import annotations

from dataclasses import replace

import drystone as ds
from random_kinds import KINDS


def test_a_tower_that_jumps_is_traced_to_its_end():
    """Its path of equilibria turns back where a joint is crushed.  It crept on in time steps that
    could not grow, and had not come to rest after 5,000 of them."""
    model = KINDS["tower-plane"](2005).with_joint(compressive_strength=336867.38744713087)
    model = replace(model, analysis=ds.Analysis(options={"max_displacement": 0.81}))
    curve = ds.pushover(model, engine="equilibrium")
    assert curve.status == "finished"
    assert len(curve.points) < 2000
