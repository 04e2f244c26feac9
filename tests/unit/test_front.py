"""What a notebook user meets: names, short texts, frames, pictures on given axes."""

import inspect
import pickle
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
from drystone.common.progress import somebody_watches
from drystone.common.progress.points import Bar, Lines
from drystone.common.progress.watched import points_shown
from drystone.model import builders
from drystone.report.canvas import CURVE_COLOURS
from drystone.results.curve import COLUMNS


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


def test_results_are_read_without_what_reads_model_files():
    """So the process that draws beside a run is ready sooner."""
    code = (
        "import sys, drystone.io.results.results_reader; "
        "print([m for m in ('drystone.io.modelfile', 'pydantic') if m in sys.modules])"
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
    arch = ds.arch(span=4.0, thickness=0.4, voussoirs=9, abutments=True, unit_weight=2e4)
    assert len(arch) == 11  # two abutments
    assert ds.arch is builders.arch and ds.circular_arch is builders.circular_arch


def small_wall(**more):
    joint = ds.JointLaw(friction_coefficient=0.6, normal_stiffness=1e9, shear_stiffness=1e9)
    blocks = ds.wall(unit=(0.4, 0.2), courses=("11", "h1h"), base=True, unit_weight=2e4)
    return ds.make_model(blocks, joint=joint, thickness=0.5, **{"load_direction": (1, 0), **more})


class TestGiven:
    """What users give is taken as they write it, or refused where they do."""

    def test_a_settlement_of_plain_numbers_runs(self):
        down = ds.Settlement(blocks="base", direction=(0.0, -2.0), max=0.01)
        assert down.blocks == ("base",) and down.direction.tolist() == [0.0, -1.0]
        curve = ds.pushover(small_wall(load_direction=None, settlement=down), max_steps=2)
        assert curve.moves_supports and len(curve.points) == 3

    def test_a_settlement_has_the_names_and_units_of_files(self):
        turns = ds.Settlement(blocks=["base"], centre=(0, 0), max=30.0)
        assert turns.keys()["max"] == 30.0
        assert turns.largest == pytest.approx(np.pi / 6.0, rel=1e-15)

    @pytest.mark.parametrize(
        ("given", "sentence"),
        [
            ({"direction": (1.0, 0.0)}, "give blocks or group"),
            ({"blocks": ("a",)}, "give direction, or the centre"),
            ({"blocks": ("a",), "direction": (0, 0)}, "direction: has no length"),
            ({"blocks": ("a",), "direction": "down"}, "direction: must be two finite numbers"),
            ({"blocks": ("a",), "direction": (1, 0), "max": 0.0}, "max: must be greater than 0"),
        ],
    )
    def test_settlements_that_are_none_are_refused_at_once(self, given, sentence):
        with pytest.raises(ds.ModelError, match=sentence):
            ds.Settlement(**{"max": 0.1, **given})

    @pytest.mark.parametrize("name", ["Mass", "Uniform", "Triangular", "Tilt", "Modal"])
    def test_patterns_take_any_numbers(self, name):
        pattern = getattr(ds, f"{name}Pattern")(direction=(2, 0))
        assert small_wall(load_direction=None, load=pattern).load_along.tolist() == [1.0, 0.0]
        with pytest.raises(ds.ModelError, match=r"load\.direction"):
            getattr(ds, f"{name}Pattern")(direction=(0, 0))

    def test_a_direction_of_another_dimension_is_refused(self):
        with pytest.raises(ds.ModelError, match="must have 2 entries"):
            small_wall(load_direction=None, load=ds.MassPattern(direction=(1, 0, 0)))

    def test_a_load_may_be_a_direction(self):
        model = small_wall()
        turned = model.with_load((-1, 0))
        assert turned.load_along.tolist() == [-1.0, 0.0]
        assert turned.sha256 == model.with_load(direction=(-1, 0)).sha256
        for wrong in ("mass", 3.0):
            with pytest.raises(ds.ModelError, match=r"a pattern: give one, as ds\.MassPattern"):
                model.with_load(wrong)
            with pytest.raises(ds.ModelError, match="must be a pattern"):
                small_wall(load=wrong, load_direction=None)

    @pytest.mark.parametrize(
        ("key", "value", "words"),
        [
            ("cohesion", -1, "must be at least 0"),
            ("normal_stiffness", 0.0, "must be greater than 0"),
            ("friction_coefficient", float("nan"), "must be a finite number"),
            ("tensile_strength", "2", "must be a number"),
        ],
    )
    def test_laws_that_no_joint_has_are_refused_at_once(self, key, value, words):
        values = {"friction_coefficient": 0.6, "normal_stiffness": 1e9, "shear_stiffness": 1e9}
        with pytest.raises(ds.ModelError, match=rf"joint\.{key}: {words}"):
            ds.JointLaw(**{**values, key: value})

    def test_vertices_may_be_lists(self):
        block = ds.Block(id="a", vertices=[[0, 0], [1, 0], [1, 1], [0, 1]], unit_weight=2e4)
        assert block.dimension == 2 and block.vertices.dtype == float


class TestNames:
    """An unknown name is answered with those there are."""

    def test_of_groups_and_blocks(self):
        blocks = [replace(b, groups=("pier",)) for b in small_wall().assembly.blocks]
        joint = small_wall().assembly.joint
        model = ds.make_model(blocks, joint=joint, thickness=0.5, load_direction=(1, 0))
        with pytest.raises(KeyError, match='there is no group "peir": did you mean "pier"'):
            model.assembly.groups["peir"]
        with pytest.raises(KeyError, match='there is no block "x": there are "base", "c1u1"'):
            model.assembly.index("x")
        groups = pickle.loads(pickle.dumps(model.assembly.groups))
        with pytest.raises(KeyError, match='there is "pier"'):
            groups["x"]
        settlement = ds.Settlement(group="spandrel", direction=(0, -1), max=0.1)
        with pytest.raises(ds.ModelError, match=r'no group "spandrel": .*there is "pier"'):
            model.with_settlement(settlement)

    def test_of_the_groups_of_results(self, tmp_path, curve):
        model = wall_model()
        ds.save_results(curve, model, tmp_path / "out")
        with pytest.raises(KeyError, match='there is no group "x"'):
            ds.load_results(tmp_path / "out").groups["x"]


def test_a_curve_is_saved_with_the_model_that_was_traced(tmp_path):
    model = stack((0.4, 0.9))
    traced = ds.pushover(model, max_steps=3, progress=False)
    for other in (model.with_joint(friction_coefficient=0.1), stack((0.4, 0.9), (0.4, 0.9))):
        with pytest.raises(ValueError, match="traced of another structure"):
            ds.save_results(traced, other, tmp_path / "other")
    assert not list(tmp_path.iterdir())
    ds.write_model(model, tmp_path / "model.toml")
    for same in (model.with_analysis(max_steps=5), ds.read_model(tmp_path / "model.toml")):
        ds.save_results(traced, same, tmp_path / "same")


class TestProgress:
    """Bars show long work by default where somebody watches."""

    def told(self, monkeypatch, terminal, **options):
        monkeypatch.setattr("drystone.common.progress.watched.SHORT", 0.0)
        monkeypatch.setattr("sys.stderr.isatty", lambda: terminal, raising=False)
        shown = []
        monkeypatch.setattr(Bar, "__enter__", lambda self: shown.append("begun"))
        monkeypatch.setattr(Bar, "__call__", lambda self, point: shown.append(point.step))
        monkeypatch.setattr(Bar, "__exit__", lambda self, *error: shown.append("ended"))
        ds.pushover(small_wall(), max_steps=2, **options)
        return shown

    def test_on_a_terminal(self, monkeypatch):
        shown = self.told(monkeypatch, True)
        assert shown[-1] == "ended" and {"begun", 0, 1, 2} <= set(shown)
        assert self.told(monkeypatch, True, progress=False) == []

    def test_elsewhere_only_if_asked_for(self, monkeypatch):
        assert self.told(monkeypatch, False) == []
        assert "begun" in self.told(monkeypatch, False, progress=True)

    def test_short_work_shows_none(self, monkeypatch):
        monkeypatch.setattr("sys.stderr.isatty", lambda: True, raising=False)
        shown = []
        monkeypatch.setattr(Bar, "__enter__", lambda self: shown.append("begun"))
        with points_shown("wall", 0.01, None) as told:
            assert isinstance(told, Bar)
        assert shown == []

    def test_in_a_notebook(self, monkeypatch):
        shell = type("ZMQInteractiveShell", (), {})
        notebook = types.SimpleNamespace(get_ipython=shell)
        monkeypatch.setitem(sys.modules, "IPython", notebook)
        assert somebody_watches()
        monkeypatch.setitem(sys.modules, "ipywidgets", None)
        monkeypatch.setattr("importlib.util.find_spec", lambda name: None)
        with points_shown("wall", 0.01, None) as told:
            assert isinstance(told, Lines)  # bars are widgets there, which are not installed


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

    def test_of_limit_analysis(self):
        """1,123 lines of a wall of 220 blocks."""
        found = ds.collapse_load(small_wall())
        assert len(repr(found)) < 200 and "\n" not in repr(found)
        assert f"multiplier {found.load_multiplier:.4f}" in repr(found)

    def test_as_html(self, curve):
        html = replace(curve, reason="a < b")._repr_html_()
        assert html.count("<tr>") == 6 and "a &lt; b" in html
        assert html.count("<svg") == 1 and "<?xml" not in html

    def test_a_model_shows_the_viewer(self):
        html = small_wall()._repr_html_()
        assert html.startswith("<iframe srcdoc=") and html.count("<iframe") == 1
        inside = html.split('srcdoc="')[1].split('" sandbox')[0]
        assert '"' not in inside and "<" not in inside  # nothing of the page ends the frame

    def test_limit_analysis_shows_a_table(self):
        found = ds.collapse_load(small_wall())
        assert f"<td>{found.load_multiplier:.4f}</td>" in found._repr_html_()

    def test_a_folder_shows_the_viewer(self, curve, tmp_path):
        model = small_wall()
        traced = ds.pushover(model, max_steps=3, progress=False)
        ds.save_results(traced, model, tmp_path / "out")
        html = ds.load_results(tmp_path / "out")._repr_html_()
        assert html.startswith("<iframe") and len(html) > len(model._repr_html_())


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
        assert ds.plot_mechanism(model, pose, ax, initial=curve.poses[0]) is ax
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
