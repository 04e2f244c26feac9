"""A façade of 92 blocks with interlocked returns, pushed outwards: engines beside each other."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import drystone as ds
from drystone.results.curve import STATIC
from lmgc90_here import needs_lmgc90
from solids import from_boxes

pytestmark = pytest.mark.slow

CASE = Path(__file__).parents[1] / "cases" / "solids" / "facade_5x3x8.toml"
OUTWARDS = (0.0, -1.0, 0.0)
STIFFNESS = 1e8  # Pa/m: LMGC90's time step is bound by stiffer joints


@pytest.mark.long
@needs_lmgc90
def test_lmgc90_beside_nscd():
    """Over the peak, to 50 mm: its peak to 3 %, the branch to a median of 3 % of the peak."""
    model = from_boxes(CASE, push=OUTWARDS)
    law = replace(model.assembly.joint, normal_stiffness=STIFFNESS, shear_stiffness=STIFFNESS)
    model = replace(model, assembly=replace(model.assembly, joint=law))
    found = {}
    for engine in ("nscd", "lmgc90"):
        curve = ds.pushover(model, engine=engine, max_displacement=0.05)
        kept = np.array([point.status == STATIC for point in curve.points])
        moved, multiplier = curve.control_displacement[kept], curve.load_multiplier[kept]
        assert moved.max() > 1.5 * curve.peak.control_displacement
        found[engine] = curve.peak.load_multiplier, moved, multiplier
    (peak, x, y), (other, other_x, other_y) = found["nscd"], found["lmgc90"]
    assert other == pytest.approx(peak, rel=0.03)
    places = np.linspace(2e-3, min(x.max(), other_x.max()), 200)
    off = np.abs(np.interp(places, x, y) - np.interp(places, other_x, other_y))
    assert np.median(off) <= 0.03 * peak
