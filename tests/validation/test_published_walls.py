"""The three walls of Bouckaert, Godio & de Almeida (2022) against what has been published of them.

Sources: Table 1 of the paper (peaks and control displacements at the multiplier 0.01, by LMGC90 and
UDEC); the recorded UDEC runs with an overshoot of 1.01 that its first author published with
HybriDFEM (wall1_udec.csv, wall3_udec.csv); and static multipliers by virtual work from runs of
LMGC90 2025.rc1 on the same walls with chamfered corners (the table below).
"""

from __future__ import annotations

from functools import cache
from pathlib import Path

import numpy as np
import pytest

from builders import with_corner
from drystone.analysis.driver import pushover
from drystone.model.assembly import Corner
from drystone.model.builders import PUBLISHED_WALLS, published_wall

REFERENCE = Path(__file__).resolve().parents[3] / "shared" / "reference"

needs_reference = pytest.mark.skipif(
    not REFERENCE.is_dir(), reason=f"the recorded curves are not there: {REFERENCE}"
)

ENGINES = ["nscd", "equilibrium"]

#: Control displacement at the multiplier 0.01 [m] of LMGC90 2025.rc1 on these walls, chamfers of
#: 0.02 m, velocities stopped at every step, overshoot 1.01.
END_LMGC90 = {1: 0.449, 2: 0.529, 3: 0.599}

CORNERS = {"rounded": Corner(radius=0.02), "chamfered": Corner(chamfer=0.02)}


@cache
def _traced(engine, wall, corner, strategy, options):
    model = with_corner(published_wall(wall), CORNERS[corner])
    return pushover(model, engine=engine, strategy=strategy, **dict(options))


def traced(engine, wall, corner="rounded", strategy="displacement", **options):
    """One analysis, once, whatever is asked of it: some take seconds."""
    return _traced(engine, wall, corner, strategy, tuple(sorted(options.items())))


@pytest.fixture(params=ENGINES)
def engine(request):
    """A name from `ENGINES`."""
    return request.param


class TestTable1:
    @pytest.mark.parametrize(("wall", "peak"), [(1, 0.575), (2, 0.500), (3, 0.325)])
    def test_peaks(self, engine, wall, peak):
        """Between LMGC90 and UDEC of Table 1, less the bias that an overshoot leaves at the peak.

        2 %: they differ among themselves by 1 to 3 %, with 0.579 / 0.512 / 0.331 and
        0.574 / 0.497 / 0.323.
        """
        curve = traced(engine, wall)
        assert curve.status == "finished", curve.reason
        assert curve.peak.load_multiplier == pytest.approx(peak, rel=0.02)

    @pytest.mark.parametrize("wall", [1, 2, 3])
    def test_peaks_lie_below_limit_analysis(self, engine, wall):
        """Non-associative limit analysis with contact points 0.02 m inside the corners: 0.5856,
        0.5244, 0.3374, by an independent linear program.  Elastic joints lower it a little.
        """
        limit = {1: 0.5856, 2: 0.5244, 3: 0.3374}[wall]
        assert 0.94 * limit < traced(engine, wall).peak.load_multiplier < limit

    @pytest.mark.parametrize(
        ("wall", "corner"), [(1, "chamfered"), (2, "rounded"), (2, "chamfered"), (3, "rounded"),
                             (3, "chamfered")],
    )  # fmt: skip
    def test_displacement_at_a_hundredth(self, engine, wall, corner):
        """As far as two runs of LMGC90, which differ by up to 5 %, +-7 %; blocks were chamfered.

        Near the end single blocks come loose, each of which shortens the rest of the curve: 0.449,
        0.556 and 0.591 m in the paper, 0.449, 0.529 and 0.599 m by LMGC90 2025.rc1.
        """
        runs = PUBLISHED_WALLS[wall].ultimate_displacement_lmgc90, END_LMGC90[wall]
        curve = traced(engine, wall, corner)
        assert 0.93 * min(runs) <= curve.ultimate_displacement <= 1.07 * max(runs)

    def test_displacement_at_a_hundredth_of_wall_1_with_rounded_corners(self, engine):
        """Not the published 0.449 m but 10 % less, for which the corners are the reason.

        Near 0.4 m the toe gives way under the wall with rounded corners.  Chamfered as LMGC90's
        blocks were, the same wall goes on and ends within 7 % (see above).  The band of 3 % about
        0.402 m holds for steps of half and of twice the size, 0.400 and 0.406 m.
        """
        curve = traced(engine, 1)
        assert curve.ultimate_displacement == pytest.approx(0.402, rel=0.03)


class TestCertificates:
    @pytest.mark.parametrize("strategy", ["displacement", "published"])
    @pytest.mark.parametrize("wall", [1, 2, 3])
    def test_every_point(self, engine, wall, strategy):
        options = {} if strategy == "displacement" else {"overshoot": 1.01}
        curve = traced(engine, wall, strategy=strategy, **options)
        # The project's promise: 1e-6 of the heaviest block's weight.
        assert curve.residual.max() <= 1e-6
        assert curve.column("friction_violation").max() <= 1e-6
        # k_n A = 1e7 N/m at a corner's 0.1 m2 carries the 23 kN of wall 1 on 2.3 mm.
        assert curve.column("penetration").max() < 2.5e-3


@needs_reference
class TestRecordedCurves:
    @pytest.mark.parametrize("wall", [1, 3])
    def test_published_strategy_against_udec(self, engine, wall):
        """With the overshoot that the UDEC runs had, against their carried multiplier.

        A median of 0.008: 1 to 3 % of what is carried on the way.  The tolerance is a median
        because the two fall by a few per cent where a block comes loose, a few mm apart.
        """
        recorded = np.genfromtxt(REFERENCE / f"wall{wall}_udec.csv", delimiter=",", names=True)
        curve = traced(engine, wall, strategy="published", overshoot=1.01)
        d = np.linspace(0.0, 0.4, 401)
        ours = np.interp(d, curve.control_displacement, curve.carried_multiplier)
        theirs = np.interp(d, recorded["control_displacement_m"], recorded["carried_multiplier"])
        assert np.median(np.abs(ours - theirs)) <= 0.008

    @pytest.mark.parametrize("wall", [1, 3])
    def test_the_peak_of_the_recorded_run_is_that_of_table_1(self, wall):
        """0.574 and 0.323: the file and the table speak of the same run."""
        recorded = np.genfromtxt(REFERENCE / f"wall{wall}_udec.csv", delimiter=",", names=True)
        peak = recorded["applied_multiplier"].max()
        assert peak == pytest.approx(PUBLISHED_WALLS[wall].peak_udec, abs=5e-4)


#: Static multipliers after the peak, from LMGC90 2025.rc1 on the same walls with chamfers of
#: 0.02 m, by virtual work over steps from rest; running medians, good to about 0.01.
STATIC_AT = (0.05, 0.10, 0.15, 0.20, 0.30, 0.35, 0.39)  # m
STATIC = {
    1: (0.518, 0.461, 0.399, 0.332, 0.220, 0.150, 0.095),
    3: (0.311, 0.283, 0.255, 0.227, 0.172, 0.145, 0.124),
}


class TestStaticMultipliers:
    @pytest.mark.parametrize("corner", CORNERS)
    @pytest.mark.parametrize("wall", [1, 3])
    def test_against_virtual_work_in_lmgc90(self, engine, wall, corner):
        """Within 0.012 in the median, of which 0.01 is the table's own."""
        curve = traced(engine, wall, corner)
        ours = np.interp(STATIC_AT, curve.control_displacement, curve.load_multiplier)
        assert np.median(np.abs(ours - STATIC[wall])) <= 0.012

    @pytest.mark.parametrize("wall", [1, 3])
    def test_with_the_same_corners_nearer_still(self, engine, wall):
        """Chamfered as in those runs, nothing but the step is left: no point is off by 0.015."""
        curve = traced(engine, wall, "chamfered")
        ours = np.interp(STATIC_AT, curve.control_displacement, curve.load_multiplier)
        assert np.abs(ours - STATIC[wall]).max() <= 0.015


class TestStepSize:
    @pytest.mark.parametrize("wall", [1, 3])
    def test_the_curve_does_not_depend_on_the_step(self, engine, wall):
        """Half the displacement per step: the same curve up to 0.2 m, to the error of a step.

        The multiplier is read up to 0.9 mm late at a slope of 1.5 / m, 1.3e-3; half of that for the
        finer steps.  The median leaves out the drops where a block comes loose.
        """
        one = traced(engine, wall)
        two = traced(engine, wall, displacement_step=4.4e-4, max_displacement=0.22)
        d = np.linspace(0.02, 0.2, 181)
        difference = np.abs(
            np.interp(d, one.control_displacement, one.load_multiplier)
            - np.interp(d, two.control_displacement, two.load_multiplier)
        )
        assert np.median(difference) <= 2e-3
        assert two.peak.load_multiplier == pytest.approx(one.peak.load_multiplier, rel=2e-3)
