"""What a notebook user meets: names, short texts, frames, pictures on given axes."""

import inspect
import subprocess
import sys
import types
from dataclasses import replace

import matplotlib
import numpy as np
import pytest
from matplotlib.figure import Figure
from synthetic import pose_at, pushover, wall_model

import drystone as ds
from builders import stack
from drystone.curve import COLUMNS
from drystone.report.canvas import CURVE_COLOURS


@pytest.fixture(scope="module")
def curve():
    return pushover(wall_model(), keep_poses=True, keep_contacts=True)


@pytest.mark.parametrize("name", ds.__all__)
def test_every_public_name_resolves_and_says_what_it_is(name):
    value = getattr(ds, name)
    if name != "__version__":
        text = inspect.getdoc(value) or ""
        # The docstring is its own, not the signature that dataclasses write.
        assert len(text) > 20 and not text.startswith(f"{name}(")


def test_directory_lists_the_public_names():
    assert {"Block", "JointLaw", "Corner", "make_model", "wall", "arch", "pushover"} <= set(dir(ds))
    assert dir(ds) == sorted(ds.__all__)


def test_names_for_type_checkers_are_those_at_run_time():
    """The imports that only type checkers see bring the same names as `__getattr__`."""
    source = inspect.getsource(ds)
    block = source.split("if TYPE_CHECKING:")[1].split("\n\n")[0]
    names = {
        piece.split(" as ")[-1].strip()
        for line in block.strip().splitlines()
        for piece in line.split(" import ")[1].split(",")
    }
    assert names | {"__version__"} == set(ds.__all__)


def test_unknown_name_is_refused():
    with pytest.raises(AttributeError, match="no attribute 'walls'"):
        ds.walls  # noqa: B018


def test_import_brings_nothing_heavy_along():
    code = (
        "import sys, drystone; dir(drystone); "
        "print([m for m in ('numpy', 'numba', 'scipy', 'h5py', 'matplotlib') if m in sys.modules])"
    )
    found = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert found.stdout.strip() == "[]"


def test_models_from_the_front():
    """A wall and an arch from what `ds` gives alone."""
    joint = ds.JointLaw(friction_coefficient=0.6, normal_stiffness=1e9, shear_stiffness=1e9)
    blocks = ds.wall(unit=(0.4, 0.2), courses=("11", "h1h"), base=True, unit_weight=2e4)
    wall = ds.make_model(
        blocks, joint=joint, corner=ds.Corner(radius=0.01), thickness=0.5, load_direction=(1, 0)
    )
    assert wall.assembly.n_blocks == 5
    arch = ds.arch(radius=2.0, thickness=0.4, embrace=120.0, n_voussoirs=9, unit_weight=2e4)
    assert len(arch) == 11  # two abutments


class TestTexts:
    """118,045 characters of a curve on the screen."""

    def test_of_a_curve(self, curve):
        assert len(repr(curve)) < 200
        assert f"points {len(curve.points)}" in repr(curve)
        assert f"peak {curve.peak.load_multiplier:.4f}" in repr(curve)

    def test_of_a_curve_without_points(self, curve):
        assert "points 0" in repr(replace(curve, points=()))

    def test_of_models_and_assemblies(self):
        model = wall_model()
        assert len(repr(model)) < 300 and len(repr(model.assembly)) < 150

    def test_as_html(self, curve):
        html = replace(curve, reason="a < b")._repr_html_()
        assert html.count("<tr>") == 6 and "a &lt; b" in html and len(html) < 1000


class TestFrame:
    def test_has_every_column(self, curve, monkeypatch):
        """By a stand-in, so that the test needs no pandas."""
        pandas = types.ModuleType("pandas")
        pandas.DataFrame = dict
        monkeypatch.setitem(sys.modules, "pandas", pandas)
        frame = curve.to_frame()
        assert tuple(frame) == COLUMNS
        np.testing.assert_array_equal(frame["load_multiplier"], curve.load_multiplier)

    def test_without_pandas_is_a_sentence(self, curve, monkeypatch):
        monkeypatch.setitem(sys.modules, "pandas", None)
        with pytest.raises(ImportError, match=r"install it, or take curve\.column"):
            curve.to_frame()


class TestPictures:
    def test_curve_on_given_axes(self, curve):
        ax = Figure().subplots()
        assert curve.plot(ax) is ax
        x, y = ax.get_lines()[0].get_data()
        assert x[0] == curve.control_displacement[0] and y[0] == curve.load_multiplier[0]

    def test_several_curves_on_the_same_axes(self, curve):
        """Each in a colour of its own, and the axes wide enough for the widest."""
        ax = Figure().subplots()
        short = replace(curve, points=curve.points[: len(curve.points) // 2])
        short.plot(ax, label="short")
        narrow = ax.get_xlim()[1]
        curve.plot(ax, label="whole")
        lines = [line for line in ax.get_lines() if not line.get_label().startswith("_")]
        colours = [line.get_color() for line in lines if line.get_label()[0] in "sw"]
        assert tuple(colours) == CURVE_COLOURS[:2]
        assert ax.get_xlim()[1] > max(narrow, 0.99 * curve.control_displacement.max())

    def test_mechanism_on_given_axes(self, curve):
        model = wall_model()
        ax = Figure().subplots()
        pose = pose_at(model, 0.2)
        assert ds.plot_mechanism(model, pose, ax, settled=curve.poses[0]) is ax
        assert {"moving", "support"} <= set(ax.get_legend_handles_labels()[1])

    def test_model_as_designed(self):
        ax = ds.plot_model(wall_model(), Figure().subplots())
        assert "moving" not in ax.get_legend_handles_labels()[1]

    def test_all_poses_at_once_are_refused(self, curve):
        with pytest.raises(ValueError, match=r"curve\.poses\[-1\]"):
            ds.plot_mechanism(wall_model(), curve.poses, Figure().subplots())

    def test_without_axes_they_make_a_figure_that_is_shown(self, curve):
        with matplotlib.rc_context():
            matplotlib.use("agg")
            from matplotlib import pyplot

            before = len(pyplot.get_fignums())
            assert curve.plot().figure.number in pyplot.get_fignums()
            assert len(pyplot.get_fignums()) == before + 1
            pyplot.close("all")


def test_states_are_kept_unless_a_recorder_has_them():
    model = stack((0.4, 0.9))
    curve = ds.pushover(model, max_steps=2)
    assert len(curve.poses) == len(curve.contacts) == len(curve.points)

    class Recorder:
        def begin(self, *_): ...
        def point(self, *_): ...
        def end(self, *_): ...

    curve = ds.pushover(model, max_steps=2, recorder=Recorder())
    assert curve.poses is None and curve.contacts is None


def test_models_compare_as_what_they_are():
    """Each is itself and nothing else: comparing their arrays raised an error."""
    first, second = stack((0.4, 0.5)), stack((0.4, 0.5))
    assert first == first and first != second
    assert first.assembly == first.assembly and first.assembly != second.assembly
    assert len({first, second, first}) == 2
