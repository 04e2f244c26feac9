"""Events along a curve: what collapses, when, and what the capacity is before.

The structures are small, and their figures follow by hand; every engine finds the same.
"""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import drystone as ds
from builders import rectangle, stack, stiff_joint
from drystone.assessment.errors import AssessmentError
from drystone.common.language import said_end, say
from drystone.limit import limits_beside, on_what_moves
from drystone.model.assembly import Block
from drystone.model.builders import make_model
from drystone.model.construction.errors import ModelError
from drystone.model.joint_law import JointLaw
from drystone.model.model import Analysis
from drystone.model.site import AssessmentInput, Site
from drystone.model.ties import BROKEN, ELASTIC, YIELDING, Bars, Tie, TieEnd
from drystone.results.curve import DYNAMIC, STATIC
from drystone.results.event_log import EventLog, events_of
from drystone.results.events import Event, EventKind, Outcome, falls_with, first_collapse
from solids import box

EXAMPLES = Path(__file__).parents[2] / "examples"
ENGINES = pytest.mark.parametrize("engine", ["equilibrium", "nscd", "distinct"])
STIFF = JointLaw(friction_coefficient=0.9, normal_stiffness=1e10, shear_stiffness=1e10)
SLIPPERY = JointLaw(friction_coefficient=0.2, normal_stiffness=1e10, shear_stiffness=1e10)
BASE, TALL = rectangle(-1.0, -0.5, 2.0, 0.5), rectangle(-0.8, 0.0, 0.4, 1.0)


def beside(ties=(), assessment=None, control="tall", **analysis):
    """A small block near the edge of a base slides at 0.2 and falls; a tall one rocks at 0.4."""
    outlines = {
        "base": BASE,
        "small": rectangle(0.78, 0.0, 0.2, 0.1),
        "tall": TALL,
        "hook": rectangle(1.1, 1.0, 0.2, 0.2),
    }
    return make_model(
        [
            Block(id=name, vertices=outline, unit_weight=2e4, support=name in ("base", "hook"))
            for name, outline in outlines.items()
        ],
        joint=STIFF,
        joint_between={frozenset({"base", "small"}): SLIPPERY},
        thickness=1.0,
        load_direction=(1.0, 0.0),
        control_block=control,
        ties=ties,
        assessment=assessment,
        analysis=Analysis(**analysis),
    )


def rope(block, x, y):
    """A strong tie from the middle of the small block."""
    return Tie(
        name="rope",
        start=TieEnd(block=block, point=np.array([x, y])),
        end=TieEnd(block="small", point=np.array([0.88, 0.05])),
        stiffness=1e7,
        yield_force=1e6,
        compression=False,
    )


def of_boxes(boxes, direction, control, *, friction, stiffness):
    """Boxes by their names and corners; that of the name "base" is a support."""
    return make_model(
        [box(name, *corners, support=name == "base") for name, corners in boxes.items()],
        joint=JointLaw(
            friction_coefficient=friction, normal_stiffness=stiffness, shear_stiffness=stiffness
        ),
        load_direction=direction,
        control_block=control,
    )


def traced(model, engine="equilibrium", **options):
    return ds.pushover(model, engine=engine, max_steps=4000, keep_poses=True, **options)


@ENGINES
def test_a_block_that_falls_limits_the_capacity(engine):
    """The peak of what is left, 0.4, is not that of the structure: the small block slid at 0.2."""
    curve = traced(beside(), engine)
    first = curve.first_collapse
    assert first.kind is EventKind.BLOCK_FALLEN and first.blocks == ("small",)
    assert first.outcome is Outcome.LEFT and first.motion > 0.1
    assert curve.events[0].kind is EventKind.LOSS_OF_EQUILIBRIUM
    assert curve.capacity.load_multiplier == pytest.approx(0.2, abs=4e-3)
    assert curve.capacity.load_multiplier <= 0.2 + 1e-3
    assert curve.peak.load_multiplier == pytest.approx(0.4, abs=0.02)
    assert curve.rises_after_collapse and "highest of what is left" in repr(curve)
    # It is told where the structure last was at rest before.
    at = curve.points[first.step]
    assert at.status == STATIC and first.control_displacement == at.control_displacement
    cut = curve.until(first)
    assert cut.ended_by is first and cut.peak == curve.capacity
    assert cut.ultimate_displacement <= first.control_displacement + 1e-6


@ENGINES
def test_a_small_stone_that_topples_is_seen(engine):
    """A pinnacle of 2 % of the weight topples at 0.2 / 0.8, which inertia over all load hides."""
    boxes = {
        "base": ((-1.0, -1.0, -0.3), (3.0, 2.0, 0.0)),
        "body": ((0.0, 0.0, 0.0), (2.0, 0.6, 1.2)),
        "pinnacle": ((1.7, 0.2, 1.2), (1.9, 0.4, 2.0)),
    }
    model = of_boxes(boxes, (0.0, 1.0, 0.0), "body", friction=0.6, stiffness=1e9)
    curve = traced(model, engine, falling="stop", max_displacement=0.001)
    assert curve.first_collapse.blocks == ("pinnacle",)
    # Soft joints take 4e-4 of it; `nscd` knows its static multiplier to 5e-4.
    assert curve.capacity.load_multiplier == pytest.approx(0.25, rel=4e-3)
    assert curve.capacity.load_multiplier <= 0.25 + 5e-4


def test_the_analysis_ends_at_the_first_collapse_where_asked():
    curve = traced(beside(), falling="stop")
    assert curve.status == "finished" and '"small" has collapsed' in curve.reason
    assert curve.peak.load_multiplier < 0.21 and not curve.rises_after_collapse
    assert curve.ultimate_displacement == curve.first_collapse.control_displacement


def test_a_part_that_may_fall_does_not_end_it():
    asked = AssessmentInput(values={"parts_that_may_fall": ["small"]}, folder="")
    model = beside(assessment=asked)
    curve = traced(model, falling="stop")
    assert curve.peak.load_multiplier == pytest.approx(0.4, abs=0.02)
    assert first_collapse(curve.events, model.parts_that_may_fall) is not curve.first_collapse


def test_a_part_that_is_not_there_may_not_fall():
    asked = AssessmentInput(values={"parts_that_may_fall": ["smal"]}, folder="")
    with pytest.raises(ModelError, match=r'parts_that_may_fall.*"smal".*did you mean "small"'):
        beside(assessment=asked)


def test_a_block_that_hangs_on_a_tie_has_fallen():
    """It slides towards the hook that holds it, off the base, and hangs there."""
    curve = traced(beside(ties=(rope("hook", 1.2, 1.0),)), max_displacement=0.1)
    first = curve.first_collapse
    assert first.blocks == ("small",) and first.outcome is Outcome.HANGING
    assert not curve.blocks_left and "hangs on ties" in first.what
    assert curve.capacity.load_multiplier < 0.21


def test_a_curve_that_loses_nothing_has_no_collapse_before_its_end():
    """The tall block alone: the peak is the capacity, and only its own fall is told."""
    model = make_model(
        [
            Block(id="base", vertices=BASE, unit_weight=2e4, support=True),
            Block(id="tall", vertices=TALL, unit_weight=2e4),
        ],
        joint=STIFF, thickness=1.0, load_direction=(1.0, 0.0), control_block="tall",
    )  # fmt: skip
    curve = traced(model)
    assert curve.capacity == curve.peak and not curve.rises_after_collapse
    assert all(event.step >= curve.peak.step for event in curve.events)
    assert first_collapse(curve.events) is None


def test_events_of_a_stored_curve_are_those_found_on_the_way(tmp_path):
    model = beside()
    curve = traced(model, keep_contacts=True)
    again = events_of(
        model, curve.points, curve.poses, curve.contacts, ties=curve.ties, left=curve.blocks_left
    )
    assert again == curve.events
    ds.save_results(curve, model, tmp_path / "out")
    loaded = ds.load_results(tmp_path / "out")
    assert loaded.curve.events == curve.events
    assert loaded.summary["capacity_multiplier"] == curve.capacity.load_multiplier
    assert [e["kind"] for e in loaded.summary["events"]] == [str(e.kind) for e in curve.events]


def test_a_larger_share_counts_fewer_blocks():
    """A block moves by itself by more than its size; with a share of 100 none has collapsed."""
    assert traced(beside(event_share=100.0), max_displacement=0.05).events[-1].is_collapse, (
        "a block that leaves has fallen whatever the share"
    )
    held = traced(beside(ties=(rope("base", 0.5, -0.05),)), max_displacement=0.05)
    assert held.first_collapse is None


def test_a_step_at_rest_in_which_a_block_goes_far_is_a_jump():
    """Whatever an engine says of it: no step leads a block by its own size."""
    model = beside()
    curve = traced(model, max_displacement=1e-6, keep_contacts=True)
    assert not curve.events
    poses = curve.poses.copy()
    poses[-1, model.assembly.index("small"), 1] -= 0.4
    (lost, fallen) = events_of(model, curve.points, poses, curve.contacts)
    assert lost.kind is EventKind.LOSS_OF_EQUILIBRIUM and fallen.blocks == ("small",)
    assert fallen.kind is EventKind.BLOCK_FALLEN and fallen.step == curve.points[-2].step


def test_a_curve_that_ends_amid_a_fall_tells_no_rest():
    """The control point has turned back under a negative multiplier: a state that is at rest as
    long as it is held there."""
    model = beside()
    curve = traced(model, max_displacement=1e-6, keep_contacts=True)
    poses = curve.poses.copy()
    poses[-1, model.assembly.index("small"), 1] -= 0.4
    back = replace(curve.points[-1], load_multiplier=-0.02, control_displacement=-1e-6)
    *_, fallen = events_of(model, (*curve.points[:-1], back), poses, curve.contacts)
    assert fallen.blocks == ("small",) and fallen.outcome is Outcome.IN_MOTION


def test_blocks_of_all_events_of_one_jump_fall_together():
    """Some of them fall and some come to rest elsewhere: a control point on either takes part."""
    place = {"step": 3, "control_displacement": 0.1, "load_multiplier": 0.2, "motion": 1.0}
    events = [
        Event(kind=EventKind.BLOCK_FALLEN, blocks=("a",), outcome=Outcome.AT_REST, **place),
        Event(kind=EventKind.BLOCK_DISPLACED, blocks=("b",), outcome=Outcome.AT_REST, **place),
        Event(kind=EventKind.BLOCK_FALLEN, blocks=("c",), **{**place, "step": 9}),
        Event(kind=EventKind.SUPPORT_LOST, blocks=("base",), **place),
    ]
    assert falls_with(events, events[0]) == {"a", "b"}


def test_a_jump_that_no_step_would_show_is_no_event():
    """Up to 2 % of a block's smallest extent: the shortest steps are as long."""
    model = beside()
    curve = traced(model, max_displacement=1e-6, keep_contacts=True)
    moving = replace(curve.points[-1], status=DYNAMIC)
    points = [*curve.points, moving, replace(curve.points[-1], step=moving.step + 1)]
    contacts = [*curve.contacts, *[curve.contacts[-1]] * 2]

    def found(distance):
        poses = np.concatenate([curve.poses, *[curve.poses[-1:]] * 2])
        poses[-1, model.assembly.index("small"), 0] += distance
        return events_of(model, points, poses, contacts)

    assert not found(0.019 * 0.1)
    (lost,) = found(0.021 * 0.1)
    assert lost.kind is EventKind.LOSS_OF_EQUILIBRIUM and lost.blocks == ("small",)


class TestAssessment:
    def verdict(self, curve, model, **more):
        motion = {"ag": 0.1, "F0": 2.5, "TC_star": 0.3, "soil": "B", "topography": "T1"}
        asked = {"method": "ntc2018-local", "confidence_factor": 1.35, **more}
        return curve.assess(model, site=Site(code="ntc2018", values=motion), **asked)

    def test_limit_states_lie_before_the_first_collapse(self):
        """Two anchored stones stay behind and fall as the facade leans out; it goes on."""
        model = ds.read_model(EXAMPLES / "tied_facade.toml")
        curve = traced(model)
        first = curve.first_collapse
        assert first.blocks == ("c6u1", "c6u2")
        verdict = self.verdict(curve, model)
        assert verdict.capacity.collapse_displacement == first.control_displacement
        for state in verdict.limit_states:
            place = state.limit_control_displacement
            assert place is None or place < first.control_displacement
        notes = verdict.assessment.assumptions
        assert any("fall" in note for note in notes)
        assert 'on the block "c6u3", takes no part' in notes[1]  # after the sense
        assert "or name the part in [assessment] parts_that_may_fall" in notes[1]

    def test_a_control_point_that_stays_behind_gives_no_verdict(self):
        """The small block falls in a jump, of which the tall one's displacements say nothing."""
        model = beside()
        with pytest.raises(AssessmentError, match="the control point stands still"):
            self.verdict(traced(model), model)

    def test_a_limit_state_beyond_an_event_says_so_first(self):
        model = beside(
            assessment=AssessmentInput(values={"parts_that_may_fall": ["small"]}, folder="")
        )
        verdict = self.verdict(traced(model), model)
        notes = verdict.assessment.assumptions
        assert any("lies at" in n and "beyond this event" in n for n in notes[:3])
        assert not any("No connection of the model breaks" in note for note in notes)
        assert np.isfinite(verdict.safety_index)

    def test_connections_are_sound_only_where_they_were_looked_at(self):
        model = beside(control="small")
        verdict = self.verdict(traced(model), model)
        assert any("No connection of the model breaks" in n for n in verdict.assessment.assumptions)
        from drystone.assessment.methods import assess

        unseen = replace(verdict.capacity, losses=None)
        again = assess(unseen, dict(verdict.assessment.spectra), verdict.assessment.settings)
        assert any("was not examined" in note for note in again.assumptions)


def said_of(block):
    """What is said of a control point that was put on a block."""
    return str(say("end.control_moved", block=block))


class TestWhatMoves:
    """Limit analysis finds that the small block slides; the tall one, the highest, stands still."""

    def test_a_control_point_that_nobody_named_is_put_on_the_part_that_moves(self):
        model = beside(control=None)
        control = model.control_point
        assert model.assembly.ids[control.block] == "tall" and control.default
        watching = on_what_moves(model, limits_beside(model))
        assert model.assembly.ids[watching.control_point.block] == "small"
        curve = traced(watching, falling="stop")
        assert curve.capacity.load_multiplier == pytest.approx(0.2, abs=4e-3)

    @pytest.mark.parametrize("falling", ["remove", "stop"])
    def test_python_puts_it_there_as_run_does_and_says_so(self, tmp_path, falling):
        model = beside(control=None).with_analysis(falling=falling)
        watching = on_what_moves(model, limits_beside(model))
        curve, known = ds.pushover(model), ds.pushover(watching)
        np.testing.assert_array_equal(curve.load_multiplier, known.load_multiplier)
        np.testing.assert_array_equal(curve.control_displacement, known.control_displacement)
        assert curve.control_point.block == watching.control_point.block
        assert curve.reason == "; ".join((known.reason, said_of("small")))
        spoken = said_end(curve.reason).in_language("it")
        assert 'il punto di controllo è sul blocco "small"' in spoken
        # What is made of the curve is of that point, whatever the model at hand says.
        ds.save_results(curve, model, tmp_path / "out")
        control = ds.load_results(tmp_path / "out").model.control_point
        assert control.block == watching.control_point.block
        assert curve.traced_of(model).control_point is curve.control_point

    def test_a_curve_of_what_collapses_is_traced_once(self):
        model = ds.published_wall(1)
        seen = []
        curve = ds.pushover(model, progress=seen.append)
        assert len(seen) == len(curve.points) and curve.control_point is model.control_point

    def test_a_curve_that_ends_before_anything_collapses_keeps_its_control_point(self):
        """It shows no part that falls without it: limit analysis is not asked."""
        model = beside(control=None)
        curve = ds.pushover(model, max_displacement=1e-6)
        assert curve.first_collapse is None and curve.status == "finished"
        assert curve.control_point is model.control_point

    def test_one_that_was_named_stays_and_is_told(self):
        model = beside(control="tall")
        found = limits_beside(model)
        assert found.control_still and on_what_moves(model, found) is model
        assert said_of("small") not in traced(model).reason

    def test_who_named_it_is_known_after_a_change(self):
        assert beside(control=None).with_joint(friction_coefficient=0.5).control_point.default
        assert not beside(control="tall").with_joint(friction_coefficient=0.5).control_point.default
        assert not beside(control=None).with_control(block="small").control_point.default


@ENGINES
def test_what_an_engine_follows_as_it_falls_has_fallen(engine):
    """A slender block leans on another at last; the control point, on a pier, went back and forth.

    Some engines pass its fall as equilibria under a load against the load: the highest multiplier,
    0.152 of what is left, was told as the capacity.
    """
    boxes = {
        "base": ((-1.0, -1.0, -0.3), (3.0, 1.0, 0.0)),
        "slender": ((-0.5, 0.0, 0.0), (-0.3, 0.3, 1.8)),
        "foot": ((0.0, 0.0, 0.0), (0.4, 0.4, 1.0)),
        "pier": ((0.0, 0.0, 1.0), (0.4, 0.4, 2.0)),
    }
    model = of_boxes(boxes, (1.0, 0.0, 0.0), "pier", friction=0.7, stiffness=1e10)
    curve = ds.pushover(model, engine=engine)
    assert curve.first_collapse.blocks == ("slender",)
    assert curve.capacity.load_multiplier == pytest.approx(0.2 / 1.8, rel=0.01)
    assert curve.rises_after_collapse


@pytest.mark.parametrize("engine", ["equilibrium", "nscd", "distinct"])
def test_a_tie_breaks_after_the_last_state_at_rest(engine):
    """A rod of 10 kN on a wall of 0.5 x 4 m: 1/8 + T y/(W h) = 1.125 before, not 0.12 after.  It
    breaks where it is 12 mm longer, to a step of the fastest block, here of 0.2 mm."""
    rod = ds.Tie(
        start=ds.TieEnd(block="b1", point=np.array([-0.25, 4.0])),
        end=ds.TieEnd(point=np.array([-1.25, 4.0])),
        stiffness=1e6,
        yield_force=10e3,
        breaking_elongation=0.012,
        compression=False,
    )
    model = stack((0.5, 4.0), joint=stiff_joint(0.8), ties=(rod,))
    curve = ds.pushover(model, engine=engine, displacement_step=2e-4, max_displacement=0.02)
    (broken,) = (event for event in curve.events if event.kind == EventKind.TIE_BROKEN)
    assert broken.control_displacement == pytest.approx(0.012, rel=0.02)
    assert broken.load_multiplier == pytest.approx(0.125 + 10e3 * 4.0 / (20e3 * 2.0), rel=3e-3)
    assert curve.points[broken.step].status == "static"
    (yielded,) = (event for event in curve.events if event.kind == EventKind.TIE_YIELDED)
    assert yielded.step <= broken.step


def test_a_tie_that_yields_and_breaks_in_motion_does_so_in_this_order():
    """Its steps are those of the rest before; of two at one step the yield is the first."""
    log = EventLog(model := beside(ties=(rope("base", 0.5, -0.05),)))
    curve = traced(model, max_displacement=1e-6, keep_contacts=True)
    rest, pose = curve.points[-1], curve.poses[-1]
    for point, branch in (
        (rest, ELASTIC),
        (replace(rest, step=rest.step + 1, status=DYNAMIC), YIELDING),
        (replace(rest, step=rest.step + 2, status=DYNAMIC), BROKEN),
    ):
        state = replace(Bars.of(model.assembly, model.ties).first(), branch=np.array([branch]))
        log.add(point, pose, lambda: curve.contacts[-1], ties=state)
    kinds = [(event.kind, event.step) for event in log.events if event.ties]
    assert kinds == [(EventKind.TIE_YIELDED, rest.step), (EventKind.TIE_BROKEN, rest.step)]
