"""[control] history: what files say, and what is wrong with it; cycles of loops."""

import math
from dataclasses import replace

import numpy as np
import pytest
import synthetic

import drystone as ds
from builders import stack, stiff_joint
from drystone.assessment.mechanism.envelope import static_envelope
from drystone.common.language import say
from drystone.model.construction.errors import ModelError
from drystone.results.cycles import cycles_of, envelope, reversals
from drystone.results.events import Event, EventKind

TEXT = """
dimension = 2
thickness = 1.0
[material.stone]
unit_weight = 10e3
[joint]
friction_coefficient = 0.3
normal_stiffness = 1e8
shear_stiffness = 1e8
[[block]]
id = "base"
vertices = [[-1.0, -0.2], [1.0, -0.2], [1.0, 0.0], [-1.0, 0.0]]
support = true
[[block]]
id = "b"
vertices = [[-0.3, 0.0], [0.3, 0.0], [0.3, 0.4], [-0.3, 0.4]]
[load]
pattern = "mass"
direction = [1.0, 0.0]
[control]
"""


def read(tmp_path, control):
    path = tmp_path / "model.toml"
    path.write_text(TEXT + control)
    return ds.read_model(path)


def test_a_list_amplitudes_and_a_file(tmp_path):
    assert read(tmp_path, "history = [0.005, -0.005]").history.targets == (0.005, -0.005)
    twice = read(tmp_path, "amplitudes = [0.01, 0.02]\ncycles = 2").history.targets
    assert twice == (0.01, -0.01, 0.01, -0.01, 0.02, -0.02, 0.02, -0.02, 0.0)
    (tmp_path / "h.txt").write_text("# m\n0.01\n-0.01  # back\n\n0\n")
    assert read(tmp_path, 'history = "h.txt"').history.targets == (0.01, -0.01, 0.0)
    assert read(tmp_path, "").history is None


@pytest.mark.parametrize(
    ("control", "said"),
    [
        ("history = []", "control.history: is empty"),
        ("history = [nan]", "control.history[1]: must be a finite number"),
        ("history = [0.01, inf]", "control.history[2]: must be a finite number"),
        ('history = ["a"]', "control.history[1]: must be a finite number"),
        ("history = 0.01", "control.history: must be a list"),
        ("history = [0.01, 0.01]", "control.history[2]: the control point is at 0.01 m already"),
        ("history = [0.0, 0.01]", "control.history[1]: the control point is at zero"),
        ("history = [0.01, 50.0]", "control.history[2]: 50 m is beyond the structure"),
        ("amplitudes = [-0.01]", "control.amplitudes[1]: must be a positive number"),
        ("amplitudes = [0.01]\ncycles = 0", "control.cycles: must be a whole number"),
        ("amplitudes = [0.01]\ncycles = 1000000", "control.cycles: has 2,000,000 displacements"),
        ("cycles = 3", "control.cycles: needs amplitudes"),
        ("history = [0.01]\namplitudes = [0.01]", "has both history and amplitudes"),
        ('history = "none.txt"', "there is no such file"),
        ('history = "/etc/hostname"', "outside of the model file's folder"),
    ],
)
def test_bad_histories_are_refused_with_their_place(tmp_path, control, said):
    with pytest.raises(ModelError) as error:
        read(tmp_path, control)
    assert said in str(error.value)


def test_a_line_of_a_file_that_is_no_number_is_named(tmp_path):
    (tmp_path / "h.txt").write_text("0.01\nmm\n")
    with pytest.raises(ModelError, match="line 2: must be one number"):
        read(tmp_path, 'history = "h.txt"')


def test_it_is_part_of_the_model(tmp_path):
    model = read(tmp_path, "history = [0.005, -0.005]")
    ds.write_model(model, tmp_path / "again.toml")
    assert ds.read_model(tmp_path / "again.toml").history == model.history
    assert model.with_history(None).sha256 != model.with_history([0.01]).sha256


def test_the_published_strategy_pushes_one_way(tmp_path):
    model = read(tmp_path, "history = [0.005, -0.005]")
    with pytest.raises(ds.EngineError, match="pushes one way"):
        ds.pushover(model, strategy="published")


def ellipse(n=4001, amplitude=2.0, force=3.0, lag=0.3, loops=2):
    """Of a Kelvin solid: its loop encloses pi F a sin(lag)."""
    phase = np.linspace(0.0, 2.0 * math.pi * loops, n)
    return amplitude * np.sin(phase), force * np.sin(phase + lag)


def test_an_ellipse_encloses_what_it_does():
    x, y = ellipse()
    cycles = cycles_of(x, y)
    assert len(cycles) == 2 and all(cycle.closed for cycle in cycles)
    for cycle in cycles:
        assert cycle.energy == pytest.approx(math.pi * 6.0 * math.sin(0.3), rel=1e-4)
        # Jacobsen's ratio of a Kelvin solid: half the tangent of its lag.
        assert cycle.damping == pytest.approx(0.5 * math.tan(0.3), rel=1e-4)
        assert cycle.secant_stiffness == pytest.approx(1.5 * math.cos(0.3), rel=1e-4)
        assert cycle.residual_after_greatest == pytest.approx(2.0 * math.sin(0.3), rel=1e-3)


def test_noise_is_no_reversal():
    x, y = ellipse()
    rng = np.random.default_rng(1)
    shaken = x + 0.01 * rng.uniform(-1.0, 1.0, len(x))
    assert len(reversals(shaken, noise=0.03)) == len(reversals(x))
    assert len(cycles_of(shaken, y, noise=0.03)) == 2


def test_a_fall_on_the_way_to_a_target_is_no_cycle():
    """Thrown back by 0.6 on the way to 2, the path had four cycles."""
    x = np.array([0.0, 1.0, 0.4, 2.0, -1.0, -0.5, -2.0, 0.0])
    assert len(cycles_of(x, x)) > 1
    (cycle,) = cycles_of(x, x, least_way=1.0)  # half of the way from zero to the first target
    assert cycle.closed and (cycle.first, cycle.last) == (0, 7)
    assert (cycle.greatest, cycle.least) == (2.0, -2.0)


def test_a_path_that_does_not_come_back_is_open():
    x, y = ellipse(loops=1)
    (cycle,) = cycles_of(x[:3000], y[:3000])
    assert not cycle.closed and cycle.damping is None


def test_one_sided_cycles_begin_where_they_turn():
    x = np.array([0.0, 2.0, 1.0, 2.0, 0.0])
    y = np.array([0.0, 2.0, 0.0, 2.0, 0.0])
    assert [(c.first, c.last) for c in cycles_of(x, y)] == [(0, 2), (2, 4)]


def test_the_envelope_is_where_it_goes_farther_out():
    x, y = ellipse(loops=2)
    out, _ = envelope(x, y, 1.0)
    assert np.all(np.diff(out) > 0.0) and out[-1] == pytest.approx(2.0)
    back, _ = envelope(x, y, -1.0)
    assert back.min() == pytest.approx(-2.0)


def rocked(history, pattern=None):
    """A block of 0.5 x 4 m that rocks to and fro, and its curve."""
    options = {} if pattern is None else {"load": pattern}
    model = stack((0.5, 4.0), joint=stiff_joint(0.8), **options).with_history(history)
    return ds.pushover(model, keep_poses=True)


def test_a_collapse_in_one_sense_is_none_of_the_other():
    """It was taken for that: the other sense had a collapse at its last point."""
    curve = rocked([0.05, -0.05, 0.10, -0.10, 0.15])
    out = curve.points[int(np.argmax(curve.control_displacement))]
    place = {
        "step": out.step,
        "control_displacement": out.control_displacement,
        "load_multiplier": out.load_multiplier,
    }
    fallen = Event(kind=EventKind.BLOCK_FALLEN, blocks=("b1",), motion=1.0, **place)
    cut = replace(curve, events=(fallen,)).until(fallen)
    along, against = cut.outward(), cut.outward(-1.0)
    assert (along.status, along.ended_by.step) == ("finished", len(along.points) - 1)
    assert (against.status, against.ended_by) == ("stopped", None)
    assert against.reason == "; ".join((str(say("end.not_in_this_sense", most=0.1)), cut.reason))
    assert along.reason == cut.reason
    assert static_envelope(along).collapse_displacement == pytest.approx(0.15, rel=1e-6)
    assert static_envelope(against).collapse_displacement is None


def test_what_happens_in_one_sense_counts_in_the_other_from_there_on():
    """A tie that yields at 0.10 m, between -0.05 and -0.10 m: the way back to -0.05 m is as it was.
    One that yields at 0.15 m, after the last point of the other sense, does not count there."""
    curve = rocked([0.05, -0.05, 0.10, -0.10, 0.15])
    x = curve.control_displacement
    for place, wanted in ((0.10, [0.05]), (0.15, [])):
        step = int(np.argmax(x > place - 1e-6))
        yielded = Event(
            kind=EventKind.TIE_YIELDED,
            step=step,
            control_displacement=float(x[step]),
            load_multiplier=0.1,
            ties=("rod",),
        )
        against = replace(curve, events=(yielded,)).outward(-1.0)
        assert [e.control_displacement for e in against.events] == pytest.approx(wanted, abs=1e-6)


def test_energies_of_a_table_that_tilts():
    """Its load is l F / sqrt(1 + l^2), not l F."""
    history = [0.05, -0.05, 0.05]
    table, ground = (
        rocked(history, pattern(direction=np.array([1.0, 0.0])))
        for pattern in (ds.TiltPattern, ds.MassPattern)
    )
    level = 0.125 * (1.0 - 0.05 / 0.5)  # b/h, and less by the share of the way to the collapse
    ratio = table.cycles[0].force_at_greatest / ground.cycles[0].force_at_greatest
    assert ratio == pytest.approx(1.0 / math.hypot(1.0, level), abs=1e-4)


def test_the_digest_is_also_that_of_the_file_of_displacements(tmp_path):
    (tmp_path / "h.txt").write_text("0.01\n-0.01\n")
    one = read(tmp_path, 'history = "h.txt"')
    (tmp_path / "h.txt").write_text("0.01\n-0.02\n")
    other = read(tmp_path, 'history = "h.txt"')
    assert one.sha256 != other.sha256
    listed = read(tmp_path, "history = [0.01, -0.02]")
    assert listed.history == other.history and listed.sha256 != other.sha256


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("", "control.history: is empty"),
        ("# nothing\n\n", "control.history: is empty"),
        ("0.01\nnan\n", "control.history[2]: must be a finite number"),
        ("0.01\n-50\n", "control.history[2]: -50 m is beyond the structure"),
        ("0.01 0.02\n", "line 1: must be one number"),
        ("0.01\n" * 3, "control.history[2]: the control point is at 0.01 m already"),
    ],
)
def test_bad_files_of_displacements_are_refused_with_their_place(tmp_path, text, said):
    (tmp_path / "h.txt").write_text(text)
    with pytest.raises(ModelError) as error:
        read(tmp_path, 'history = "h.txt"')
    assert said in str(error.value)


def test_thousands_of_cycles_can_be_interrupted_and_read(tmp_path):
    """Five thousand cycles begin at once; where they are stopped, what was reached is there."""
    model = read(tmp_path, "amplitudes = [0.001]\ncycles = 5000")
    assert len(model.history.targets) == 10_001

    class Recorder:
        n = 0

        def begin(self, model, engine, strategy):
            pass

        def point(self, point, pose, contacts):
            self.n += 1
            if self.n == 200:
                raise KeyboardInterrupt

        def end(self, curve):
            self.ended = curve

    curve = ds.pushover(model, recorder=Recorder())
    assert curve.status == "interrupted" and len(curve.points) >= 199
    assert curve.is_cyclic and curve.cycles and curve.cycles[0].closed


def test_an_envelope_without_a_way_out_ends_at_zero_without_a_sign():
    """A curve that goes one way alone, seen in the other."""
    assert "goes to 0 m, where" in synthetic.curve().outward(-1.0).reason
