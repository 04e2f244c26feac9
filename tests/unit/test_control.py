"""Controls, driven by a structure of one degree of freedom whose curve is known.

The structure is rigid up to lambda_s(delta) and slides on where more is applied: a step of size h
from rest moves it by

    d delta = h^2 g kappa (lambda - lambda_s(delta))

and, c being the share of (physics of the published strategy) Newton's second law, its supports
carry

    lambda_x = lambda - c (lambda - lambda_s)

With lambda_s falling in a straight line to zero at DELTA_END this is a rigid rocking block at small
rotations.
"""

from __future__ import annotations

import json
from dataclasses import dataclass, field, replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from builders import stack
from drystone.analysis.driver import pushover
from drystone.common.tolerances import ALL_BUT, FLOOR_SHARE
from drystone.control import (
    ControlError,
    DisplacementSettings,
    ExcessControl,
    ExcessSettings,
    PublishedControl,
    PublishedSettings,
)
from drystone.control.ends import COLLAPSED, Progress, end_of_curve
from drystone.control.stops import stops_of
from drystone.engines.base import (
    Capabilities,
    Demand,
    Engine,
    EngineError,
    StepPath,
    StepReport,
    UnstableError,
)
from drystone.io.modelfile import read_model
from drystone.model.builders import ModelError, model_to_dict, published_wall
from drystone.results.curve import DYNAMIC, STATIC

PEAK, DELTA_END = 0.4, 0.3  # -, m
STEP = 1e-3  # m
# A few rounding errors of numbers of order one.
ROUNDING = 1e-12

#: The step that suits it is `STEP`: a two-hundredth of its smallest extent.
MODEL = stack((0.2, 0.9))


def falling(delta):
    """Static multiplier at a displacement [m]."""
    return PEAK * (1.0 - delta / DELTA_END)


@dataclass(frozen=True)
class SlidingState:
    delta: float  # m
    pose: np.ndarray = field(default_factory=lambda: np.zeros((2, 3)))


class SlidingStructure(Engine):
    """See the module's text; an engine as the loop and the controls see it."""

    name = "sliding structure"

    def __init__(self, *, c=0.5, static=falling, mobility=9.81, fails=None, prescribes=False):
        self.c, self.static, self.mobility = c, static, mobility
        self.fails = fails or (lambda delta, motion: False)
        self.capabilities = Capabilities(prescribes_displacement=prescribes)
        self.demands = []
        self.closed = False

    def start(self, problem):
        state = SlidingState(0.0)
        return state, self.report(state, 0.0, 0.0)

    def report(self, state, multiplier, motion, static=None):
        static = multiplier if static is None else static
        return StepReport(
            converged=True,
            applied_multiplier=multiplier,
            carried_multiplier=multiplier - self.c * (multiplier - static),
            static_multiplier=static,
            control_displacement=state.delta,
            residual=0.0,
            inertia_ratio=0.0,
            motion=motion,
            n_iterations=3,
        )

    def step(self, state, demand):
        self.demands.append(demand)
        if demand.increment is not None:
            motion = demand.increment
            multiplier = resisted = self.static(state.delta + motion)
        else:
            multiplier, resisted = demand.multiplier, self.static(state.delta)
            excess = max(multiplier - resisted, 0.0)
            motion = demand.time_step**2 * self.mobility * excess
        if self.fails(state.delta, motion):
            return state, StepReport(converged=False, reason="nothing was found")
        new = SlidingState(state.delta + motion)
        moved = motion > 0.0
        return new, self.report(new, multiplier, motion, resisted if moved else None)

    def contacts(self, state):
        raise AssertionError("contacts of the structure were asked for without need")

    def close(self):
        self.closed = True


class FallingFreely(SlidingStructure):
    """From 0.1 m on it goes on by itself, a step of the settings at a time, and would have to be
    held back; ``said`` are the figures by which its engine reports that."""

    def __init__(self, **said):
        super().__init__()
        self.said = said

    def step(self, state, demand):
        new, report = super().step(state, demand)
        if new.delta < 0.1:
            return new, report
        new = SlidingState(state.delta + STEP)
        report = replace(report, control_displacement=new.delta, motion=STEP)
        return new, replace(report, carried_multiplier=-0.05, **self.said)


def trace(engine, strategy, **options):
    return pushover(
        MODEL,
        engine=engine,
        strategy=strategy,
        keep_contacts=False,
        **{"displacement_step": STEP, **options},
    )


def started_from(curve):
    """Displacement where each step began, (n_points,) [m]."""
    return np.concatenate(([0.0], curve.control_displacement[:-1]))


class TestExcess:
    """The bias-free strategy reads lambda_s where a step begins, whatever was applied."""

    # Longer time steps than h^2 g kappa = DELTA_END / PEAK run down the branch by themselves.
    @given(st.floats(0.05, 1.0), st.floats(5e-3, 0.02), st.floats(0.06, 0.15))
    @settings(max_examples=30)
    def test_the_curve_is_the_static_one(self, c, increment, time_step):
        curve = trace(
            SlidingStructure(c=c), "displacement", increment=increment, time_step=time_step
        )
        assert curve.status == "finished"
        moved = np.flatnonzero((curve.column("motion") > 0.0) & (curve.column("status") == STATIC))
        expected = falling(started_from(curve))[moved]
        assert curve.load_multiplier[moved] == pytest.approx(expected, abs=ROUNDING)
        # All but the first steps from nothing to the peak, and no point passed dynamically.
        assert not np.any(curve.column("status") == DYNAMIC)
        assert curve.peak.load_multiplier == pytest.approx(PEAK, abs=increment)

    @pytest.mark.parametrize("increment", [0.02, 0.01, 0.005])
    def test_the_curve_does_not_depend_on_the_excess(self, increment):
        curve = trace(SlidingStructure(), "displacement", increment=increment)
        # Read at the end of a step, the multiplier of its beginning is off by slope times step.
        slope = PEAK / DELTA_END
        late = np.abs(curve.load_multiplier - falling(curve.control_displacement))
        moved = curve.column("motion") > 0.0
        assert late[moved].max() <= slope * 2.0 * STEP * (1.0 + 1e-9)
        # Where it ends: lambda_s = 0.01.
        end = DELTA_END * (1.0 - 0.01 / PEAK)
        assert curve.ultimate_displacement == pytest.approx(end, abs=2.0 * STEP)

    @pytest.mark.parametrize("step", [2e-4, 5e-4, 1e-3])
    @pytest.mark.parametrize("mobility", [2.0, 10.0, 40.0])
    def test_steps_move_by_what_is_asked_for(self, step, mobility):
        structure = SlidingStructure(mobility=mobility)
        options = {"displacement_step": step, "time_step": 0.1, "max_displacement": 0.2}
        curve = trace(structure, "displacement", **options)
        motion = curve.column("motion")
        assert motion.max() <= 2.0 * step
        # The largest excess of 0.01 moves h^2 kappa 0.01 in a step of 0.1 s, on a level branch.
        expected = min(step, 0.1**2 * mobility * 0.01)
        assert np.median(motion[motion > 0.0]) == pytest.approx(expected, rel=0.2)

    def test_every_step_starts_from_rest_under_a_multiplier(self):
        structure = SlidingStructure()
        trace(structure, "displacement", max_displacement=0.1)
        for demand in structure.demands:
            assert demand.stop_blocks and demand.increment is None and demand.time_step > 0.0

    def test_a_step_that_fails_is_tried_with_less(self):
        # Steps of over half the size asked for are not found anywhere.
        structure = SlidingStructure(fails=lambda delta, motion: motion > 0.5 * STEP)
        curve = trace(structure, "displacement")
        assert curve.status == "finished"
        assert curve.column("motion").max() <= 0.5 * STEP
        assert len(structure.demands) > curve.n_steps

    def test_no_multiplier_above_the_applied_one_is_static(self):
        """A spike of 3 % by virtual work on next to no work of the pattern, as on a random wall."""

        class Spiking(SlidingStructure):
            def step(self, state, demand):
                new, report = super().step(state, demand)
                if 0.1 < new.delta < 0.11:
                    spike = 1.03 * report.applied_multiplier
                    carried = report.applied_multiplier - 2e-4
                    report = replace(report, static_multiplier=spike, carried_multiplier=carried)
                return new, report

        curve = trace(Spiking(), "displacement", max_displacement=0.15)
        assert np.all(curve.load_multiplier <= curve.applied_multiplier)

    def test_a_point_that_inertia_carries_is_not_static(self):
        """A block in free fall, a fifth of what is loaded, whose fall says nothing of the rest."""

        class Falling(SlidingStructure):
            def step(self, state, demand):
                new, report = super().step(state, demand)
                falls = 0.1 < new.delta < 0.11
                return new, replace(report, inertia_ratio=0.2 / demand.multiplier * falls)

        curve = trace(Falling(), "displacement", max_displacement=0.15)
        d, dynamic = curve.control_displacement, curve.column("status") == DYNAMIC
        np.testing.assert_array_equal(dynamic, (d > 0.1) & (d < 0.11))

    def test_what_falls_on_without_load_has_collapsed_in_motion(self):
        """In the words of the strategy for engines that prescribe displacements."""
        curve = trace(FallingFreely(static_multiplier=-0.05), "displacement")
        assert curve.status == "finished" and curve.points[-1].status == DYNAMIC
        assert "or a part of it, collapsed in motion: it falls without any load" in curve.reason

    @pytest.mark.parametrize("most", [1e-5, 0.0107, 0.1])
    def test_a_curve_ends_at_the_largest_displacement_asked_for(self, most):
        """It ended at the end of the step that passed it: by up to a step farther."""
        curve = trace(SlidingStructure(prescribes=True), "displacement", max_displacement=most)
        assert curve.status == "finished" and "reached" in curve.reason
        assert curve.control_displacement[-1] == pytest.approx(most, rel=1e-9)
        assert (np.diff(curve.control_displacement) > 0.0).all()

    def test_no_largest_displacement_is_reached_in_motion(self):
        class Falling(SlidingStructure):
            def step(self, state, demand):
                new, report = super().step(state, demand)
                if new.delta < 0.1:
                    return new, report
                half = 0.5 * report.applied_multiplier
                return new, replace(report, inertia_ratio=0.5, carried_multiplier=half)

        for strategy in ("displacement", "published"):
            curve = trace(Falling(), strategy, max_displacement=0.1)
            assert curve.status == "stopped" and "0.1 m in motion" in curve.reason

    def test_a_structure_that_cannot_go_on_keeps_what_was_reached(self):
        structure = SlidingStructure(fails=lambda delta, motion: delta > 0.1 and motion > 0.0)
        curve = trace(structure, "displacement")
        assert curve.status == "stopped" and curve.reason == "nothing was found"
        assert 0.1 < curve.control_displacement[-1] < 0.1 + 2.0 * STEP
        assert curve.ultimate_displacement is None
        assert structure.closed

    def test_a_block_that_falls_off_is_passed_dynamically(self):
        # Between 0.1 and 0.11 m something takes half of the resistance away and gives it back.
        def static(delta):
            return falling(delta) * (0.5 if 0.1 < delta < 0.11 else 1.0)

        curve = trace(SlidingStructure(static=static), "displacement")
        assert curve.status == "finished"
        dynamic = curve.column("status") == DYNAMIC
        assert dynamic.any() and not dynamic.all()
        d = curve.control_displacement
        assert d[dynamic].min() > 0.1 and d[dynamic].max() < 0.14
        # Static again after it.
        late = d > 0.14
        assert curve.load_multiplier[late] == pytest.approx(
            falling(started_from(curve))[late], abs=ROUNDING
        )

    def test_what_goes_on_steadily_after_a_fall_is_static_again(self):
        """Carried multipliers kept pushing with too much: points stayed dynamic to the end."""

        # From 0.1 m on a tenth of the resistance is travelled for good; supports carry nearly all.
        def static(delta):
            return falling(delta) * (0.9 if delta > 0.1 else 1.0)

        curve = trace(SlidingStructure(c=0.02, static=static), "displacement")
        assert curve.status == "finished"
        dynamic = curve.column("status") == DYNAMIC
        assert dynamic.any()
        # One step to see that something is loose, the next to see that the motion is steady.
        assert curve.control_displacement[dynamic].max() < 0.1 + 4.0 * STEP
        last = curve.points[-1]
        assert last.status == STATIC and last.load_multiplier <= curve.stop_multiplier

    def test_no_excess_hides_a_low_peak(self):
        """Of what carries a fiftieth of its weight the default excess is half: small arches were
        as coarse, and their peaks and branches wrong by more than 1 %."""
        peak = 0.02
        structure = SlidingStructure(static=lambda delta: peak * (1.0 - delta / DELTA_END))
        curve = trace(structure, "displacement", stop_multiplier=0.002)
        assert curve.status == "finished"
        # Where it slides it is pushed with a tenth of the default excess, 0.01; read late.
        slides = curve.column("motion") > 0.0
        excess = (curve.applied_multiplier - curve.load_multiplier)[slides]
        assert excess.max() <= 0.1 * 0.01 + 2.0 * STEP * peak / DELTA_END

    def test_rest_without_load_after_a_fall_is_no_end(self):
        """A block fell for seconds, the load went with it, and its rest was taken for the end."""
        curve = trace(Toppling(0.0), "displacement", increment=0.005)
        assert curve.status == "finished" and curve.points[-1].status == STATIC
        # Where the static curve ends, a step late and with the next one seen.
        end = DELTA_END * (1.0 - curve.stop_multiplier / PEAK)
        assert curve.ultimate_displacement == pytest.approx(end, abs=2.0 * STEP)
        # The load begins again on the way to where the structure stood: no point of its curve.
        static = curve.column("status") == STATIC
        risen = static & (curve.control_displacement > STEP) & (curve.load_multiplier < 0.02)
        assert curve.control_displacement[risen].min() > end - 20.0 * STEP

    @pytest.mark.parametrize("moved", [-10.0, 30.0])
    def test_what_rests_without_load_elsewhere_has_collapsed(self, moved):
        """The curve ended at rest, half way between where it stood and where it lay."""
        curve = trace(Toppling(moved * STEP), "displacement", increment=0.005)
        assert curve.status == "finished" and curve.points[-1].status == DYNAMIC
        assert "collapsed in motion: it rests without any load" in curve.reason
        # It stood to within two steps of where it began to fall.
        assert curve.ultimate_displacement == pytest.approx(0.1, abs=2.0 * STEP)

    def test_a_control_point_that_goes_on_in_motion_for_long_has_collapsed(self):
        """Inertia of what fell and the rest carried the load kept up, to the largest number of
        steps."""

        class Falling(SlidingStructure):
            def step(self, state, demand):
                new, report = super().step(state, demand)
                if new.delta < 0.1:
                    return new, report
                new = SlidingState(state.delta + STEP)
                report = replace(report, control_displacement=new.delta, motion=STEP)
                carried = {"carried_multiplier": 0.25, "static_multiplier": 0.25}
                return new, replace(report, inertia_ratio=0.4, **carried)

        curve = trace(Falling(), "displacement", max_steps=1000)
        assert curve.status == "finished" and curve.points[-1].status == DYNAMIC
        assert "collapsed in motion: it goes on in motion" in curve.reason
        # Its last point at rest, before the step to 0.1 m.
        assert 0.1 - 2.0 * STEP < curve.ultimate_displacement < 0.1


class RunningAway(SlidingStructure):
    """Beyond 0.1 m its steps follow its blocks in motion until they are far away."""

    def __init__(self):
        super().__init__(prescribes=True)
        self.n_lost = 0

    def step(self, state, demand):
        new, report = super().step(state, demand)
        if new.delta < 0.1:
            return new, report
        self.n_lost += 1
        reason = "blocks run away"
        way = ((new, replace(report, dynamic=True)),)
        return state, StepReport(
            converged=False, reason=reason, path=StepPath(dynamic_states=way), dynamic=True
        )


def test_what_a_step_has_followed_to_where_blocks_run_away_is_not_crept_through():
    """Halved down to the smallest step, and one across: then the structure has collapsed."""
    engine = RunningAway()
    curve = trace(engine, "displacement", displacement_step=STEP)
    assert curve.status == "finished" and "collapsed" in curve.reason
    assert engine.n_lost <= 20
    assert curve.control_displacement[-1] > 0.09


class Toppling(SlidingStructure):
    """A block falls at 0.1 m, in twenty steps, with which the control point moves so far.

    The excess must be less than the stop value, for the rest to be one without load.
    """

    def __init__(self, moved):
        super().__init__()
        self.moved, self.to_fall = moved, 20

    def step(self, state, demand):
        new, report = super().step(state, demand)
        if new.delta < 0.1 or self.to_fall == 0:
            return new, report
        self.to_fall -= 1
        new = SlidingState(state.delta + (self.moved if self.to_fall == 0 else 0.0))
        report = replace(report, control_displacement=new.delta, motion=STEP)
        carried = {"carried_multiplier": -0.03, "static_multiplier": -0.03}
        return new, replace(report, inertia_ratio=50.0, **carried)


class TestPublished:
    @staticmethod
    def ratio(c, overshoot, static=falling, **options):
        """A curve, and applied over static multiplier from 0.05 m on."""
        chosen = {"displacement_step": 2e-5, "max_displacement": 0.15, **options}
        structure = SlidingStructure(c=c, static=static)
        curve = trace(structure, "published", overshoot=overshoot, **chosen)
        ratio = curve.applied_multiplier / static(started_from(curve))
        return curve, ratio[curve.control_displacement > 0.05]

    @pytest.mark.parametrize("overshoot", [1.05, 1.02, 1.005])
    @pytest.mark.parametrize("c", [0.173, 0.320, 0.75])
    def test_the_bias(self, c, overshoot):
        """After the peak the recursion converges to lambda_b / lambda_s = 1 / (1 - (f-1)/f / c).

        The lag behind a falling branch is what one step changes lambda_s by, relatively, over c:
        2e-5 m of some 0.2 m, twice at most (a step may be twice as long), over c = 0.173.
        """
        curve, ratio = self.ratio(c, overshoot)
        assert ratio == pytest.approx(1.0 / (1.0 - (overshoot - 1.0) / overshoot / c), rel=2e-3)
        # Its curve is the applied multiplier, and the carried one is 1/f of it.
        assert np.array_equal(curve.load_multiplier, curve.applied_multiplier)

    def test_the_bias_grows_without_end_for_a_light_mechanism(self):
        """For c < (f-1)/f there is no steady branch: with f = 1.05 below 0.0476."""
        _, ratio = self.ratio(
            0.04, 1.05, static=lambda delta: PEAK, displacement_step=1e-4, balance_tolerance=1e-5
        )
        assert np.all(np.diff(ratio) > 0.0)
        assert ratio[-1] > 10.0

    def test_the_ascending_branch(self):
        # Steps of the size of those after the peak: longer ones slide through 0.01 m at once.
        options = {"increment": 0.01, "time_step": 0.05, "max_displacement": 0.01}
        curve = trace(SlidingStructure(), "published", **options)
        up = np.round(PEAK / 0.01).astype(int)
        assert curve.applied_multiplier[: up + 1] == pytest.approx(
            0.01 * np.arange(up + 1), abs=ROUNDING
        )
        # One increment too far, where it waits for balance; the descent begins with f lambda_x.
        assert curve.applied_multiplier[up + 1] == pytest.approx(PEAK + 0.01, abs=ROUNDING)
        after = np.flatnonzero(curve.applied_multiplier > PEAK + 0.0101)[0]
        carried = curve.carried_multiplier[after - 1]
        assert curve.applied_multiplier[after] == pytest.approx(1.05 * carried, abs=ROUNDING)

    @pytest.mark.parametrize("patience", [0, 3, 20])
    def test_patience_at_the_peak(self, patience):
        """A multiplier out of balance is applied again, `patience` times after the first."""
        structure = SlidingStructure(mobility=1e-6)  # so slow that it waits in vain
        curve = trace(structure, "published", patience=patience, max_steps=200)
        held = np.count_nonzero(np.isclose(curve.applied_multiplier, PEAK + 0.005))
        assert held == patience + 1

    def test_a_lag_that_is_made_up_for_is_no_peak(self):
        """The flowchart taken literally would stop at the first step that lags."""
        lags = {0.1: 3}  # three steps that carry less, at a quarter of the peak

        class Lagging(SlidingStructure):
            def step(self, state, demand):
                new, report = super().step(state, demand)
                at = round(demand.multiplier, 9)
                if lags.get(at, 0) > 0:
                    lags[at] -= 1
                    report = replace(report, carried_multiplier=0.9 * at)
                return new, report

        curve = trace(Lagging(), "published", increment=0.01, max_displacement=0.01)
        assert np.count_nonzero(np.isclose(curve.applied_multiplier, 0.1)) == 4
        assert np.any(np.isclose(curve.applied_multiplier, PEAK + 0.01))

    @pytest.mark.parametrize("shrinking", [0.95, 0.97])
    def test_a_carried_multiplier_that_still_rises_is_no_peak(self, shrinking):
        """What is missing shrinks by 5 % or 3 % a step, from a hundredth to a thousandth: in 45 or
        76 steps, far beyond a patience of 20."""

        class Creeping(SlidingStructure):
            missing = 0.01

            def step(self, state, demand):
                new, report = super().step(state, demand)
                if round(demand.multiplier, 9) == 0.1:
                    self.missing *= shrinking
                    report = replace(report, carried_multiplier=0.1 - self.missing)
                return new, report

        curve = trace(Creeping(), "published", increment=0.01, max_displacement=0.01)
        held = np.count_nonzero(np.isclose(curve.applied_multiplier, 0.1))
        assert held == np.ceil(np.log(0.1) / np.log(shrinking))
        assert np.any(np.isclose(curve.applied_multiplier, PEAK + 0.01))

    def test_a_structure_that_falls_is_not_waited_for(self):
        """Whatever the patience: from where it carries a tenth less than the peak."""
        curve = trace(SlidingStructure(), "published", patience=100_000)
        held = np.isclose(curve.applied_multiplier, PEAK + 0.005)
        assert curve.status == "finished"
        assert curve.carried_multiplier[held].min() > 0.8 * PEAK

    def test_the_stop_value_counts_only_after_the_peak(self):
        # The first increments lie below it.
        curve = trace(SlidingStructure(), "published", increment=0.002)
        assert curve.applied_multiplier[1] < 0.01 < curve.peak.load_multiplier
        assert curve.status == "finished" and "0.01" in curve.reason
        assert curve.applied_multiplier[-1] < 0.01 <= curve.applied_multiplier[-2]

    @pytest.mark.parametrize("overshoot", [1.01, 1.05])
    def test_the_bias_of_the_descent_is_no_peak(self, overshoot):
        """The highest multiplier that was carried in balance is.

        Increments are 0.005; what exceeds the static multiplier by x is carried but for c x, and
        counts as balanced up to 1e-3.  The descent, of 6 % or 38 % more, begins above it.
        """
        curve = trace(
            SlidingStructure(c=0.173), "published", overshoot=overshoot, displacement_step=2e-5,
            max_displacement=0.05,
        )  # fmt: skip
        assert curve.load_multiplier.max() > 1.02 * PEAK
        assert PEAK - 0.005 <= curve.peak.load_multiplier <= PEAK + 1e-3 / 0.173
        assert curve.peak.carried_multiplier == pytest.approx(curve.peak.load_multiplier, abs=1e-3)

    @pytest.mark.parametrize("yielding", [0.0, 0.01])
    def test_a_structure_that_stands_under_less_is_loaded_again(self, yielding):
        """It carries nothing for a moment, by inertia, and the curve was "finished".

        Its joints yield by a share of a step under a multiplier of one: as it is loaded again, it
        moves on, but by no more than they do.
        """

        class Losing(SlidingStructure):
            def step(self, state, demand):
                new, report = super().step(state, demand)
                if state.delta < 0.1 <= new.delta:
                    report = replace(report, carried_multiplier=-0.05, dynamic=True)
                closed = yielding * STEP * demand.multiplier
                return new, replace(
                    report,
                    control_displacement=new.delta + closed,
                    motion=max(report.motion, closed),
                )

        curve = trace(Losing(), "published")
        assert curve.status == "finished" and "fell below" in curve.reason
        assert curve.points[-1].status == STATIC
        assert curve.applied_multiplier.min() >= 0.0
        # The branch goes on to its end, and so does the ultimate displacement.
        assert curve.control_displacement[-1] > 0.9 * DELTA_END
        assert curve.ultimate_displacement > 0.9 * DELTA_END

    def test_what_falls_for_long_has_collapsed_in_motion(self):
        curve = trace(FallingFreely(dynamic=True), "published")
        assert curve.status == "finished" and "collapsed in motion" in curve.reason
        # Of one step each, 25 to `FALL_MOTION`, one beyond it, and one before less is applied.
        late = curve.control_displacement > 0.1
        assert 25 <= (curve.column("status") == DYNAMIC)[late].sum() <= 27

    def test_whether_it_has_collapsed_does_not_depend_on_the_step(self):
        """With steps of half the length it had collapsed after half of the way."""
        curve = trace(FallingFreely(dynamic=True), "published", displacement_step=0.5 * STEP)
        late = curve.control_displacement > 0.1
        assert 25 <= (curve.column("status") == DYNAMIC)[late].sum() <= 27

    def test_it_halves_the_step_where_none_is_found(self):
        structure = SlidingStructure(fails=lambda delta, motion: motion > 0.5 * STEP)
        curve = trace(structure, "published")
        assert curve.status == "finished"
        assert curve.column("motion").max() <= 0.5 * STEP

    def test_an_overshoot_below_one_makes_no_sense(self):
        with pytest.raises(ControlError, match="overshoot"):
            PublishedSettings(displacement_step=STEP, overshoot=0.99)
        with pytest.raises(EngineError, match="overshoot"):
            trace(SlidingStructure(), "published", overshoot=0.99)


class TestPrescribedDisplacement:
    """Engines that solve for the multiplier of an increment."""

    def test_the_curve_is_the_static_one(self):
        structure = SlidingStructure(prescribes=True)
        curve = trace(structure, "displacement")
        assert curve.status == "finished"
        d = curve.control_displacement[1:]
        assert curve.load_multiplier[1:] == pytest.approx(falling(d), abs=ROUNDING)
        assert curve.ultimate_displacement == pytest.approx(
            DELTA_END * (1.0 - 0.01 / PEAK), abs=ROUNDING
        )
        assert np.diff(curve.control_displacement).max() <= STEP * (1.0 + ROUNDING)
        for demand in structure.demands:
            assert demand.multiplier is None

    @given(st.floats(0.02, 0.1))
    def test_the_peak_is_found_wherever_it_is(self, at):
        """A parabola with its peak somewhere: missed by half a step at most, squared."""

        def static(delta):
            return PEAK * (1.0 - ((delta - at) / 0.15) ** 2)

        curve = trace(SlidingStructure(prescribes=True, static=static), "displacement")
        assert curve.peak.load_multiplier <= PEAK
        assert PEAK - curve.peak.load_multiplier <= PEAK * (0.5 * STEP / 0.15) ** 2

    def test_a_step_that_fails_is_tried_with_less(self):
        structure = SlidingStructure(
            prescribes=True, fails=lambda delta, motion: motion > 0.3 * STEP
        )
        curve = trace(structure, "displacement")
        assert curve.status == "finished"
        assert np.diff(curve.control_displacement).max() <= 0.3 * STEP * (1.0 + ROUNDING)

    def test_a_structure_that_cannot_go_on_keeps_what_was_reached(self):
        structure = SlidingStructure(prescribes=True, fails=lambda delta, motion: delta > 0.1)
        curve = trace(structure, "displacement")
        assert curve.status == "stopped" and "nothing was found" in curve.reason
        assert curve.control_displacement[-1] > 0.1


class JumpingStructure(SlidingStructure):
    """It has no equilibrium within 1 mm of 0.1 m.

    ``instants`` are the multipliers there, in motion, one step after the other; the last one stays,
    or is None where the structure comes to rest.
    """

    def __init__(self, instants):
        super().__init__(prescribes=True)
        self.instants, self.passed = instants, 0

    def step(self, state, demand):
        if demand.time_step == 0.0 and abs(state.delta + demand.increment - 0.1) < STEP:
            return state, StepReport(converged=False, reason="nothing was found")
        new, report = super().step(state, demand)
        multiplier = self.instants[min(self.passed, len(self.instants) - 1)]
        if demand.time_step == 0.0 or multiplier is None:
            return new, report
        self.passed += 1
        moving = {"inertia_ratio": 1.0, "dynamic": True, "motion": STEP}
        return new, replace(report, static_multiplier=multiplier, **moving)


class TestJumps:
    def test_a_multiplier_in_motion_ends_no_curve(self):
        """It was the end of the curve, "finished", where the structure stands an instant later."""
        curve = trace(JumpingStructure([-0.05, 0.002, None]), "displacement")
        dynamic = curve.column("status") == DYNAMIC
        assert curve.load_multiplier[dynamic].tolist() == [-0.05, 0.002]
        assert curve.status == "finished" and "fell below" in curve.reason
        assert curve.points[-1].status == STATIC
        # Nor is it where the multiplier falls below the stop value for good.
        ends = DELTA_END * (1.0 - 0.01 / PEAK)
        assert curve.ultimate_displacement == pytest.approx(ends, abs=ROUNDING)

    def test_what_falls_without_load_has_collapsed_in_motion(self):
        curve = trace(JumpingStructure([-0.2]), "displacement")
        assert curve.status == "finished" and "collapsed in motion" in curve.reason
        # Steps of one largest increment each, 25 of them to `FALL_MOTION`, and one beyond it.
        assert (curve.column("status") == DYNAMIC).sum() in (25, 26)
        rest = curve.column("status") == STATIC
        at_rest = curve.control_displacement[rest].max()
        assert 0.0 <= curve.ultimate_displacement - at_rest <= STEP

    @pytest.mark.parametrize("step", [1.0, 0.1])
    def test_how_far_a_jump_goes_in_a_step_does_not_depend_on_the_step_asked_for(self, step):
        """With short increments, as those to near targets of a history, time steps never grew, and
        a block fell in thousands of steps."""

        class Falling(JumpingStructure):
            def step(self, state, demand):
                new, report = super().step(state, demand)
                motion = min(1e-3 * demand.time_step**2, 0.5 * STEP)
                return new, replace(report, motion=motion) if demand.time_step else report

        structure = Falling([-0.2])
        trace(structure, "displacement", displacement_step=step * STEP)
        taken = [demand.time_step for demand in structure.demands if demand.time_step]
        assert max(taken) > 100.0 * taken[0]

    @pytest.mark.parametrize(
        ("growth", "looked_for"),
        [
            (0.5, True),
            (1.0, True),
            (1.02, False),  # inertia is small, too, where a jump begins
        ],
    )
    def test_rest_is_looked_for_where_blocks_do_not_go_faster_and_faster(self, growth, looked_for):
        """Where it is not found, it is looked for again after twice as long a time of the jump.

        It was after twice as many steps.  Time steps grow meanwhile, so that a structure at rest
        was followed in motion through steps of years.
        """

        class Creeping(JumpingStructure):
            def __init__(self):
                super().__init__([None])
                self.taken = []  # s, time steps

            def step(self, state, demand):
                self.taken.append(demand.time_step)
                new, report = super().step(state, demand)
                if demand.time_step == 0.0:
                    return new, report
                motion = 1e-6 * STEP * demand.time_step**2 * growth ** np.count_nonzero(self.taken)
                return SlidingState(0.1), replace(report, motion=motion, control_displacement=0.1)

        structure = Creeping()
        trace(structure, "displacement", max_steps=150)
        taken = np.array(structure.taken)
        lasted = np.cumsum(taken)
        ends = np.flatnonzero((taken[:-1] > 0.0) & (taken[1:] == 0.0))  # a static step follows
        assert len(ends) > 5 if looked_for else len(ends) == 0
        rounding = 1e-12
        assert (lasted[ends[1:]] >= (2.0 - rounding) * lasted[ends[:-1]]).all()
        assert (lasted[ends[1:] - 1] < 2.0 * lasted[ends[:-1]]).all()
        if looked_for:
            assert np.count_nonzero(taken[: ends[0] + 1]) == 2

    @pytest.mark.parametrize(
        ("travelled", "multiplier", "ends"),
        [
            (26.0, -0.1, True),  # steps, of the control point, beyond `FALL_MOTION`
            (24.0, -0.1, False),
            (26.0, 0.1, False),  # what carries on the way is no free fall
        ],
    )
    def test_a_control_point_that_falls_within_a_step_ends_the_curve(
        self, travelled, multiplier, ends
    ):
        """The structure falls at 0.1 m, and its engine follows it to where it would carry again.

        Points in motion are shown, and only what was at rest before them counts.
        """

        class Falling(SlidingStructure):
            def step(self, state, demand):
                new, report = super().step(state, demand)
                if new.delta < 0.1 or state.delta >= 0.1:
                    return new, report
                places = new.delta + STEP * np.linspace(0.0, travelled, 5)
                way = tuple(
                    (
                        SlidingState(delta),
                        replace(
                            report,
                            static_multiplier=multiplier,
                            control_displacement=delta,
                            dynamic=True,
                        ),
                    )
                    for delta in places
                )
                landed = SlidingState(places[-1])
                rest = replace(
                    report,
                    control_displacement=landed.delta,
                    static_multiplier=0.2,
                    motion=2.0 * travelled * STEP,
                    path=StepPath(overshoot=0.0, dynamic_states=way),
                )
                return landed, rest

        curve = trace(Falling(prescribes=True), "displacement")
        dynamic = curve.column("status") == DYNAMIC
        assert curve.load_multiplier[dynamic][:5].tolist() == [multiplier] * 5
        assert curve.status == "finished" and ("collapsed in motion" in curve.reason) == ends
        if ends:
            assert dynamic.sum() == 6  # where it has landed is none of rest
            rest = curve.control_displacement[~dynamic].max()
            assert curve.ultimate_displacement == rest and rest < 0.1
        else:
            assert curve.control_displacement[-1] > 0.1 + STEP * travelled

    @pytest.mark.parametrize("runs_away", [True, False])
    def test_what_finds_no_rest_is_shown_to_the_end(self, runs_away):
        """The points in motion of the last step that was tried, each further on.

        It has collapsed where blocks run away; where they only move on, nobody knows.
        """

        class Lost(SlidingStructure):
            def step(self, state, demand):
                new, report = super().step(state, demand)
                if new.delta < 0.1:
                    return new, report
                moved = [replace(report, control_displacement=0.1 + x) for x in (0.1, 0.2)]
                way = tuple((SlidingState(found.control_displacement), found) for found in moved)
                failed = StepReport(
                    converged=False, reason="it moves on", path=StepPath(dynamic_states=way)
                )
                return state, replace(failed, dynamic=runs_away)

        curve = trace(Lost(prescribes=True), "displacement")
        assert curve.status == ("finished" if runs_away else "stopped")
        assert ("collapsed in motion" in curve.reason) == runs_away
        assert "it moves on" in curve.reason
        assert (curve.column("status") == DYNAMIC).tolist()[-3:] == [False, True, True]
        assert curve.control_displacement[-2:].tolist() == pytest.approx([0.2, 0.3])
        ends = curve.control_displacement[-3] if runs_away else None
        assert curve.ultimate_displacement == ends

    def test_a_jump_below_the_stop_value_is_not_searched_for_it(self):
        """No multiplier between its ends is at rest: to a hundredth of a step is near enough.

        Each try has a quarter of the increment, which afterwards grows to twice as much at most:
        five jumps from a step to less than a hundredth, and one or two more on the way.
        """

        class Falling(SlidingStructure):
            jumps = 0

            def step(self, state, demand):
                new, report = super().step(state, demand)
                if new.delta < 0.1:
                    return new, report
                self.jumps += 1  # which its engine has followed in motion
                return new, replace(
                    report,
                    static_multiplier=-0.05,
                    motion=30.0 * STEP,
                    path=StepPath(overshoot=0.0),
                )

        structure = Falling(prescribes=True)
        curve = trace(structure, "displacement")
        assert curve.status == "finished" and "fell below" in curve.reason
        assert structure.jumps <= 8
        assert np.diff(curve.control_displacement)[-1] <= 0.04 * STEP

    def test_a_curve_ends_where_its_last_jump_takes_the_control_point_back(self):
        """Not on the chord to where the control point comes to rest after it.

        The jump begins at 0.1 m, to the increment down to which it is looked for: 0.04 of a step.
        """

        class Falling(SlidingStructure):
            def step(self, state, demand):
                new, report = super().step(state, demand)
                if new.delta < 0.1:
                    return new, report
                return new, replace(
                    report,
                    static_multiplier=-0.05,
                    motion=30.0 * STEP,
                    control_displacement=report.control_displacement - 20.0 * STEP,
                    path=StepPath(overshoot=0.0),
                )

        curve = trace(Falling(prescribes=True), "displacement")
        assert [p.jumped for p in curve.points[-2:]] == [False, True]
        assert curve.points[-1].status == STATIC
        assert curve.ultimate_displacement == pytest.approx(0.1, abs=0.04 * STEP)

    def test_a_jump_without_rest_is_not_followed_for_ever(self):
        curve = trace(JumpingStructure([0.1]), "displacement", jump_steps=50)
        assert curve.status == "stopped" and "collapsed in motion: it did not" in curve.reason
        assert curve.ultimate_displacement is None
        assert (curve.column("status") == DYNAMIC).sum() == 50


class TestFallsInOneStep:
    def test_rest_behind_where_the_load_began_is_a_collapse(self):
        """An engine that relaxes to rest may find it in the ruins, where much can be carried."""

        class Falling(SlidingStructure):
            def step(self, state, demand):
                new, report = super().step(state, demand)
                if new.delta < 0.1:
                    return new, report
                new = SlidingState(-1.0)
                return new, self.report(new, 2.0 * PEAK, 1.0)

        curve = trace(Falling(prescribes=True), "displacement")
        assert curve.status == "finished" and COLLAPSED in curve.reason
        assert curve.points[-1].status == "dynamic"
        assert curve.peak.load_multiplier <= PEAK
        assert curve.ultimate_displacement == curve.control_displacement[-2]


class FollowingStructure(SlidingStructure):
    """Its multiplier is piecewise linear, and it says what the corners within a step hide."""

    def __init__(self, at, multiplier, **options):
        def static(delta):
            return float(np.interp(delta, at, multiplier))

        super().__init__(static=static, prescribes=True, **options)
        self.at, self.multiplier = np.array(at), np.array(multiplier)

    def step(self, state, demand):
        new, report = super().step(state, demand)
        start, end = self.static(state.delta), self.static(new.delta)
        share = (self.at - state.delta) / demand.increment
        inside = (share > 0.0) & (share < 1.0)
        if not inside.any():
            return new, replace(report, path=StepPath(excess=(0.0, 0.0), bend=(0.0, 0.0)))
        share, corners = share[inside], self.multiplier[inside]
        off = np.abs(corners - start - share * (end - start))
        return new, replace(
            report,
            path=StepPath(
                excess=(corners.max() - max(start, end), share[corners.argmax()]),
                bend=(off.max(), share[off.argmax()]),
            ),
        )


class TestWhatAStepHides:
    @given(st.floats(0.02, 0.1), st.floats(0.005, 0.1))
    def test_corners_of_the_curve_become_points(self, peak_at, corner_after):
        at = [0.0, 0.4 * peak_at, peak_at, peak_at + corner_after, 0.4]
        multiplier = [0.0, 0.7 * PEAK, PEAK, 0.5 * PEAK, 0.0]
        structure = FollowingStructure(at, multiplier)
        curve = trace(structure, "displacement", displacement_step=4.0 * STEP)
        assert curve.status == "finished"
        d = curve.control_displacement
        hidden = np.abs(np.interp(at, d, curve.load_multiplier) - multiplier)
        # Bends of 2 per mille of the peak, the peak itself to 0.2 per mille; or whatever there is
        # between points as near as the finest step, 0.5 % of the largest, or within the last share
        # of a step, which is not taken again for it.
        steepest = np.abs(np.diff(multiplier) / np.diff(at)).max()
        least = max(0.005, 1.0 - ALL_BUT) * 4.0 * STEP * steepest
        assert hidden[1:4].max() <= max(2e-3 * PEAK, least)
        assert PEAK - curve.peak.load_multiplier <= max(2e-4 * PEAK, least)
        assert len(structure.demands) <= 2 * len(curve.points)

    def test_a_peak_within_a_step_is_found(self):
        """A spike half a step wide, behind a lower peak, of which no end of a step tells."""
        spike = 0.0625 + 0.25 * STEP * np.array([-1.0, 0.0, 1.0])
        at, multiplier = [0.0, 0.03, *spike, 0.3], [0.0, 0.8, 0.6, 1.0, 0.6, 0.0]

        class Driven(SlidingStructure):
            def step(self, state, demand):
                new, report = super().step(state, demand)
                way = self.static(np.linspace(state.delta, new.delta, 101))
                return new, replace(
                    report, path=StepPath(overshoot=way.max() - max(way[0], way[-1]))
                )

        structure = Driven(prescribes=True, static=lambda d: PEAK * np.interp(d, at, multiplier))
        curve = trace(structure, "displacement")
        assert curve.status == "finished"
        assert curve.peak.load_multiplier == pytest.approx(PEAK, rel=5e-3)  # `OVERSHOOT_SHARE`
        assert len(structure.demands) <= 1.5 * len(curve.points)

    def test_an_engine_whose_way_is_rough_takes_smaller_steps(self):
        """What inertia adds on the way fades with the step: by ten per cent of the peak in a whole
        one, 2 % of the peak (`DRIVE_SHARE`) are left in a fifth of it."""

        class Rough(SlidingStructure):
            def step(self, state, demand):
                new, report = super().step(state, demand)
                rough = 0.1 * PEAK * demand.increment / STEP if state.delta > 0.1 else 0.0
                return new, replace(report, path=StepPath(overshoot=rough))

        curve = trace(Rough(prescribes=True), "displacement")
        assert curve.status == "finished"
        d = curve.control_displacement
        assert np.diff(d)[d[:-1] > 0.1].max() <= 0.2 * STEP * (1.0 + ROUNDING)

    @pytest.mark.parametrize("deviation, bend", [(0.5, 3e-4), (0.5, 3e-5), (0.05, 3e-4)])
    def test_a_step_in_which_blocks_change_their_way_is_short(self, deviation, bend):
        """Of one that leaves its way by a tenth or less, or bends the curve by less than 1e-4 of
        the peak, little is to be had (`DEVIATION_SHARE`, `DEVIATION_BEND`); the shortest has 0.06
        of the largest."""
        place = 0.1537

        class Deviating(SlidingStructure):
            def step(self, state, demand):
                new, report = super().step(state, demand)
                there = state.delta < place <= new.delta
                off = (bend * PEAK, 0.5) if there else (0.0, 0.0)
                way = deviation if there else 0.0
                return new, replace(
                    report, path=StepPath(excess=(0.0, 0.0), bend=off, deviation=way)
                )

        structure = Deviating(prescribes=True)
        curve = trace(structure, "displacement")
        assert curve.status == "finished"
        d = curve.control_displacement
        (across,) = np.diff(d)[(d[:-1] < place) & (place <= d[1:])]
        if deviation > 0.1 and bend > 1e-4:
            assert across <= 0.0601 * STEP
            assert len(structure.demands) <= len(curve.points) + 10
        else:
            assert across == pytest.approx(STEP)

    def test_a_bend_at_the_end_of_a_step_does_not_make_it_creep(self):
        class Bending(SlidingStructure):
            def step(self, state, demand):
                new, report = super().step(state, demand)
                hidden = 0.1 * PEAK * (demand.increment > 0.9 * STEP)
                return new, replace(
                    report, path=StepPath(excess=(0.0, 0.0), bend=(hidden, 0.99999))
                )

        structure = Bending(prescribes=True)
        trace(structure, "displacement", max_steps=12)
        assert len(structure.demands) <= 50

    def test_instability_is_looked_for_no_closer_than_by_the_smallest_step(self):
        """A quarter of a step that ended unstable was stable, half of it unstable again, and so on.

        Increments went down to what rounding leaves of them.
        """
        place = 0.0234 * DELTA_END

        class Unstable(SlidingStructure):
            def step(self, state, demand):
                new, report = super().step(state, demand)
                path = StepPath(excess=(0.0, 0.0), bend=(0.0, 0.0))
                return new, replace(report, unstable=new.delta > place, path=path)

        structure = Unstable(prescribes=True)
        curve = trace(structure, "displacement", max_displacement=2.0 * place)
        d = curve.control_displacement
        (before,) = d[:-1][(d[:-1] <= place) & (place < d[1:])]
        smallest = FLOOR_SHARE * STEP
        assert place - before <= 4.0 * smallest
        assert min(demand.increment for demand in structure.demands) >= smallest


class TestEveryStrategy:
    @pytest.mark.parametrize("strategy", ["displacement", "published"])
    def test_a_step_too_coarse_to_see_the_peak_is_refused(self, strategy):
        """A step of 1 m lowered wall 1's peak by a tenth without a word."""
        with pytest.raises(EngineError, match=r"too coarse .* take at most 0\.04 m"):
            trace(SlidingStructure(prescribes=True), strategy, displacement_step=0.041)
        trace(SlidingStructure(prescribes=True), strategy, displacement_step=0.04, max_steps=3)

    STRATEGIES = pytest.mark.parametrize(
        ("strategy", "prescribes"),
        [("displacement", False), ("displacement", True), ("published", False)],
    )

    @STRATEGIES
    def test_limits(self, strategy, prescribes):
        def run(**options):
            return trace(SlidingStructure(prescribes=prescribes), strategy, **options)

        steps = run(max_steps=30)
        assert steps.n_steps == 30 and steps.status == "stopped" and "30 steps" in steps.reason
        far = run(max_displacement=0.05)
        assert far.status == "finished" and "0.05 m" in far.reason
        assert far.control_displacement[-2] < 0.05 <= far.control_displacement[-1]
        stop = run(stop_multiplier=0.2)
        assert stop.status == "finished" and "0.2" in stop.reason
        assert stop.load_multiplier[-1] <= 0.2 <= stop.load_multiplier[-2]

    @STRATEGIES
    def test_the_curve_knows_the_stop_value_that_was_asked_for(self, strategy, prescribes):
        curve = trace(SlidingStructure(prescribes=prescribes), strategy, stop_multiplier=0.2)
        assert curve.stop_multiplier == 0.2
        # Between two points on either side of 0.2; that strategy's branch is biased.
        last = curve.control_displacement[-2:]
        assert last[0] <= curve.ultimate_displacement <= last[1]

    @STRATEGIES
    def test_a_stop_value_above_the_peak_ends_with_the_curve(self, strategy, prescribes):
        structure = SlidingStructure(prescribes=prescribes)
        curve = trace(structure, strategy, stop_multiplier=1.5 * PEAK, max_steps=5000)
        assert curve.status == "stopped"
        assert "lies below the stop multiplier 0.6" in curve.reason
        # The branch is there down to a hundredth of the peak.
        assert 0.0 <= curve.load_multiplier[-1] < 0.01 * curve.peak.load_multiplier
        assert curve.ultimate_displacement is None

    @STRATEGIES
    def test_a_structure_that_carries_nothing_ends(self, strategy, prescribes):
        structure = SlidingStructure(prescribes=prescribes, static=lambda delta: 0.0)
        curve = trace(structure, strategy, max_steps=5000)
        assert curve.status == "stopped" and "carries nothing" in curve.reason
        assert curve.n_steps == 100

    @STRATEGIES
    def test_the_same_run_twice(self, strategy, prescribes):
        one, two = (
            trace(SlidingStructure(prescribes=prescribes), strategy).points for _ in range(2)
        )
        assert repr(one) == repr(two)  # exact, and a NaN is one

    @STRATEGIES
    def test_an_engine_that_gives_up_keeps_the_curve(self, strategy, prescribes):
        class Breaking(SlidingStructure):
            def step(self, state, demand):
                if state.delta > 0.05:
                    raise EngineError("the engine broke")
                return super().step(state, demand)

        structure = Breaking(prescribes=prescribes)
        curve = trace(structure, strategy)
        assert curve.status == "stopped" and curve.reason == "the engine broke"
        assert curve.n_steps > 10 and structure.closed

    def test_one_that_does_not_stand_has_no_curve(self):
        class Falling(SlidingStructure):
            def start(self, problem):
                raise UnstableError('"b1" keeps moving')

        structure = Falling()
        with pytest.raises(UnstableError, match="b1"):
            trace(structure, "displacement")
        assert structure.closed

    def test_unknown_names(self):
        with pytest.raises(EngineError, match="fastest"):
            trace(SlidingStructure(), "fastest")
        with pytest.raises(EngineError, match="overshot"):
            trace(SlidingStructure(), "published", overshot=1.05)


class TestEnds:
    """`end_of_curve` itself: what is complete, what stopped, what goes on."""

    SETTINGS = ExcessSettings(
        displacement_step=STEP, stops=stops_of({"max_displacement": 0.1, "max_steps": 200})
    )

    def end(self, **progress):
        at = {"multiplier": 0.2, "highest": 0.4, "displacement": 0.05, "n_steps": 50}
        return end_of_curve(self.SETTINGS, Progress(**{**at, "static": True, **progress}))

    def test_most_points_end_nothing(self):
        assert self.end() is None
        assert self.end(n_steps=1, multiplier=0.0, highest=0.0) is None
        assert self.end(n_steps=1, multiplier=1e-5, highest=1e-5) is None

    def test_only_a_point_at_rest_completes_a_curve(self):
        assert self.end(multiplier=0.005).finished
        assert self.end(multiplier=0.005, static=False) is None
        assert self.end(displacement=0.1).finished
        in_motion = self.end(displacement=0.1, static=False)
        assert not in_motion.finished and "in motion" in in_motion.reason

    def test_a_peak_below_the_stop_value(self):
        """The curve ends at a tenth of it, as of any low peak; where another value is asked for it
        goes on to next to nothing."""
        low = {"highest": 0.008}
        assert self.end(multiplier=0.001, **low) is None
        assert self.end(multiplier=7e-4, **low).finished
        progress = {"displacement": 0.05, "n_steps": 50, "static": True, "highest": 0.4}
        asked = replace(self.SETTINGS, stop_multiplier=0.6)
        assert end_of_curve(asked, Progress(multiplier=0.005, **progress)) is None
        end = end_of_curve(asked, Progress(multiplier=0.003, **progress))
        assert not end.finished and "peak multiplier 0.4 lies below" in end.reason


class TestControlsHoldNoState:
    """Two analyses may share a control: all that evolves is in the state that it hands out."""

    @pytest.mark.parametrize(
        "control",
        [
            ExcessControl(ExcessSettings(displacement_step=STEP)),
            PublishedControl(PublishedSettings(displacement_step=STEP)),
        ],
        ids=lambda control: type(control).__name__,
    )
    def test_decisions_can_be_repeated(self, control):
        structure = SlidingStructure()
        state, report = structure.start(None)
        decision = control.first(report)
        for _ in range(120):
            state, report = structure.step(state, decision.demand)
            one, two = (control.decide(decision.state, decision.demand, report) for _ in range(2))
            assert one == two and isinstance(one.demand, Demand)
            decision = one


class TestOneValidation:
    """What Python asks of an analysis is checked by the table that a model file is checked by."""

    @pytest.mark.parametrize(
        ("key", "value", "said"),
        [
            ("displacement_step", -1, "must be greater than 0, it is -1"),
            ("displacement_step", 0, "must be greater than 0, it is 0"),
            ("max_displacement", "0.1", 'must be a number, it is the text "0.1": take the quotes'),
            ("max_displacement", float("nan"), "must be a finite number, it is nan"),
            ("time_step", 1e-300, "must be at least 1e-09, it is 1e-300: give it in s"),
            ("max_steps", 2.5, "must be a whole number, it is 2.5"),
            ("stop_multiplier", None, "must be a number, it is null"),
            ("patience", True, "must be a number, it is true"),
            ("overshoot", 0.99, "must be at least 1, it is 0.99"),
        ],
    )
    def test_an_option_says_what_the_file_says(self, tmp_path, key, value, said):
        model = published_wall(1)
        with pytest.raises(EngineError) as caught:
            pushover(model, **{key: value})
        assert str(caught.value).startswith(f"[analysis] {key}: ")
        assert said in str(caught.value)
        if isinstance(value, bool | None):
            return  # JSON's true and null
        data = model_to_dict(model)
        data["analysis"][key] = value
        (tmp_path / "wall.json").write_text(json.dumps(data))
        with pytest.raises(ModelError) as told:
            read_model(tmp_path / "wall.json")
        assert said in told.value.problems[0]

    @pytest.mark.parametrize("name", ["upright", "suited_step", "refined_share", "jump", "fall"])
    def test_what_follows_from_the_model_is_no_setting(self, name):
        """It would be taken as it is: there is no range to check it by."""
        with pytest.raises(EngineError, match=f'there is no setting "{name}"'):
            pushover(published_wall(1), **{name: 1.0})

    @pytest.mark.parametrize("cls", [PublishedSettings, ExcessSettings, DisplacementSettings])
    def test_settings_made_by_hand(self, cls):
        with pytest.raises(ControlError, match="max_steps: must be at least 1"):
            cls(displacement_step=STEP, stops=stops_of({"max_steps": 0}))

    @pytest.mark.parametrize("direction", [(-1.0, 0.0), (0.0, 1.0)])
    def test_control_direction_against_the_load(self, direction):
        with pytest.raises(ModelError, match=r"control\.direction: leads against the load"):
            published_wall(1).with_control(direction=direction)


def test_the_path_of_a_file_is_no_model():
    with pytest.raises(TypeError, match=r"read_model\('wall.toml'\) reads it"):
        pushover("wall.toml")
