"""What others add from outside: one file and one line each, as an installed package would.

Every test writes one module and one entry point into a folder of its own, and runs a small wall by
a model file that names what was added and uses its keys.
"""

from __future__ import annotations

import json
from pathlib import Path
from textwrap import dedent

import numpy as np
import pytest
from typer.testing import CliRunner

import drystone as ds
from drystone.assessment.errors import AssessmentError
from drystone.cli import app

WALL = """
dimension = 2
thickness = 0.5

[material.stone]
unit_weight = 20e3

[joint]
friction_coefficient = 0.7
normal_stiffness = 1e9
shear_stiffness = 1e9

[[block]]
id = "base"
support = true
vertices = [[0.0, -0.2], [0.6, -0.2], [0.6, 0.0], [0.0, 0.0]]

[[block]]
id = "low"
vertices = [[0.0, 0.0], [0.6, 0.0], [0.6, 0.8], [0.0, 0.8]]

[[block]]
id = "high"
vertices = [[0.0, 0.8], [0.6, 0.8], [0.6, 1.6], [0.0, 1.6]]

[load]
pattern = "mass"
direction = [1.0, 0.0]

[analysis]
max_displacement = 0.02
"""


@pytest.fixture
def add(tmp_path, monkeypatch):
    """Install a package of one module with one entry point."""

    def added(group: str, name: str, target: str, code: str) -> Path:
        site = tmp_path / "site"
        info = site / f"{name}-1.0.dist-info"
        info.mkdir(parents=True)
        module = target.partition(":")[0]
        (site / f"{module}.py").write_text(dedent(code))
        (info / "METADATA").write_text(f"Metadata-Version: 2.1\nName: {name}\nVersion: 1.0\n")
        (info / "entry_points.txt").write_text(f"[{group}]\n{name} = {target}\n")
        monkeypatch.syspath_prepend(str(site))
        return site

    return added


@pytest.fixture
def wall(tmp_path):
    """The small wall, with some of its lines replaced, as a file."""

    def written(*changes: tuple[str, str], more: str = "") -> Path:
        text = WALL
        for old, new in changes:
            assert old in text
            text = text.replace(old, new)
        path = tmp_path / "wall.toml"
        path.write_text(text + more)
        return path

    return written


PATTERN = '''
    """Forces on masses above a height."""

    from dataclasses import dataclass, replace
    from typing import ClassVar

    import numpy as np

    from drystone.common.keys import Key, Number
    from drystone.common.ranges import Range
    from drystone.model.loading.base import NO_MASSES, Directed


    @dataclass(frozen=True, kw_only=True, eq=False)
    class AbovePattern(Directed):
        name: ClassVar[str] = "above"
        file_keys: ClassVar[tuple[Key, ...]] = (
            *Directed.file_keys,
            Key(name="from_height", type=Number(Range(least=0.0, most=100.0, unit="m"))),
        )
        from_height: float

        def forces(self, assembly, masses=NO_MASSES):
            over = (assembly.centroid @ assembly.up > self.from_height)[:, None] * self.direction
            return masses.forces(assembly, over)

        def in_frame(self, scale):
            return replace(self, from_height=scale.height(self.from_height))

        def keys(self):
            return super().keys() | {"from_height": self.from_height}
'''


class TestPattern:
    CHANGE = ('pattern = "mass"', 'pattern = "above"\nfrom_height = 1.0')

    def test_a_wall_is_pushed_by_it(self, add, wall, tmp_path):
        add("drystone.patterns", "above", "above_pattern:AbovePattern", PATTERN)
        model = ds.read_model(wall(self.CHANGE))
        peak = ds.pushover(model, progress=False).peak.load_multiplier
        # The upper half, 0.8 m high, slides (0.7) before it tips (0.6 / 0.8 = 0.75), but the whole
        # tips first: weight 2 on 0.3 m against weight 1 at 1.2 m.  A thousandth is elastic.
        assert peak == pytest.approx(2 * 0.3 / 1.2, rel=0.01)
        ds.write_model(model, tmp_path / "again.toml")
        again = ds.read_model(tmp_path / "again.toml")
        assert again.load.from_height == 1.0
        np.testing.assert_array_equal(again.load.direction, model.load.direction)

    @pytest.mark.parametrize(
        ("new", "said"),
        [
            ('pattern = "above"', "load: from_height is missing: add it"),
            ('pattern = "above"\nfrom_height = -1.0', "load.from_height: must be at least 0"),
            ('pattern = "above"\nfrom_hight = 1.0', 'did you mean "from_height"?'),
            ('pattern = "abov"\nfrom_height = 1.0', 'did you mean "above"?'),
            ('pattern = "mass"\nfrom_height = 1.0', 'load: unknown key "from_height"'),
        ],
    )
    def test_its_keys_are_checked(self, add, wall, new, said):
        add("drystone.patterns", "above", "above_pattern:AbovePattern", PATTERN)
        with pytest.raises(ds.ModelError) as caught:
            ds.read_model(wall(('pattern = "mass"', new)))
        assert any(said in problem for problem in caught.value.problems), caught.value.problems

    def test_what_cannot_be_loaded_is_told(self, add, wall):
        add("drystone.patterns", "above", "above_pattern:NoSuchPattern", PATTERN)
        with pytest.raises(ds.ModelError, match=r"load\.pattern: cannot be .*NoSuchPattern"):
            ds.read_model(wall(self.CHANGE))
        ds.read_model(wall())  # and keeps nobody else from reading


METHOD = '''
    """A share of the peak against a ground acceleration."""

    from drystone.assessment.methods.base import Assessment, LimitState, spectra_of
    from drystone.common.keys import Key, Number
    from drystone.common.ranges import Range

    NAME, STATES, MORE_STATES, READINGS = "toy", ("SLV",), ("held",), ("base_shear",)
    KEYS = (Key(name="safe_share", type=Number(Range(least=1.0, most=100.0, unit="percent"))),)


    def assess(capacity, spectra, settings):
        share = settings.need("safe_share", "of the peak that counts")
        borne = share * float(max(capacity.spectral_acceleration))
        given, _, _ = spectra_of(spectra, STATES, "SLV", settings)
        asked = float(given["SLV"].sa(0.0, 0.05))
        state = LimitState(
            name="SLV",
            ground_acceleration_capacity=borne,
            ground_acceleration_demand=asked,
            satisfied=borne >= asked,
        )
        return Assessment(
            method=NAME, capacity=capacity, settings=settings, limit_states=(state,),
            reference_state="SLV", activation_acceleration=borne, confidence_factor=None,
            quantities={"share": share},
        )
'''

SITE = """
[site]
code = "ntc2018"
ag = 0.1
F0 = 2.5
TC_star = 0.3
soil = "A"
topography = "T1"
"""


class TestMethod:
    TABLE = '\n[assessment]\nmethod = "toy"\nsafe_share = 50.0\n'

    def test_a_wall_is_assessed_by_it(self, add, wall):
        add("drystone.methods", "toy", "toy_method", METHOD)
        model = ds.read_model(wall(more=SITE + self.TABLE))
        verdict = ds.pushover(model, progress=False).assess(model)
        (state,) = verdict.limit_states
        assert verdict.method == "toy" and verdict.as_dict()["share"] == 0.5  # of 50 percent
        # Both blocks lean together: alpha_0 = 0.3 / 0.8, of which half is borne; 0.1 g is asked.
        assert state.safety_index == pytest.approx(0.5 * (0.3 / 0.8) / 0.1, rel=0.03)

    def test_the_command_line_takes_it_over_the_method_of_the_file(self, add, wall, tmp_path):
        add("drystone.methods", "toy", "toy_method", METHOD)
        path = wall(more=SITE + self.TABLE.replace('"toy"', '"rocking"'))
        arguments = [str(path), "--method", "toy", "--one-sense", "--out", str(tmp_path / "out")]
        done = CliRunner().invoke(app, ["assess", *arguments, "--json", "--quiet"])
        assert done.exit_code == 0, done.output
        (sense,) = json.loads(done.stdout)["senses"].values()
        assert (sense["method"], sense["share"]) == ("toy", 0.5)

    @pytest.mark.parametrize(
        ("new", "said"),
        [
            ("safe_share = 500.0", "assessment.safe_share: must be at most 100"),
            ("safe_shares = 50.0", 'did you mean "safe_share"?'),
            ('limit_states = ["hold"]', 'did you mean "held"?'),
        ],
    )
    def test_its_keys_and_states_are_checked(self, add, wall, new, said):
        add("drystone.methods", "toy", "toy_method", METHOD)
        with pytest.raises(ds.ModelError) as caught:
            ds.read_model(wall(more=SITE + self.TABLE.replace("safe_share = 50.0", new)))
        assert any(said in problem for problem in caught.value.problems), caught.value.problems

    def test_what_it_needs_is_asked_for(self, add, wall):
        add("drystone.methods", "toy", "toy_method", METHOD)
        text = SITE + self.TABLE.replace("safe_share = 50.0", "")
        model = ds.read_model(wall(more=text))  # a key is no must where the command line may say it
        with pytest.raises(AssessmentError, match='method "toy" needs "safe_share"'):
            ds.pushover(model, progress=False).assess(model)


OUTPUT = '''
    """Every n-th point of the curve, rounded, a line each."""

    from drystone.common.keys import Key, Whole
    from drystone.io.results.outputs import Output


    def write(done, keys):
        rows = done.curve.points[:: keys.get("every", 1)]
        lines = [f"{p.control_displacement:.3e} {p.load_multiplier:.3e}" for p in rows]
        (done.folder / "toy.txt").write_text("\\n".join(lines))


    TOY = Output(
        files=("toy.txt",), write=write, short=True,
        keys=(Key(name="every", type=Whole(1, 100), default=1),),
    )
'''


class TestOutput:
    ASKED = '\n[[output]]\nkind = "toy"\nevery = 3\n'

    def test_a_wall_is_written_by_it(self, add, wall, tmp_path):
        add("drystone.outputs", "toy", "toy_output:TOY", OUTPUT)
        out = tmp_path / "out"
        path = wall(more=self.ASKED)
        done = CliRunner().invoke(app, ["run", str(path), "--out", str(out), "--json", "--quiet"])
        assert done.exit_code == 0, done.output
        n_points = len((out / "curve.csv").read_text().splitlines()) - 1
        assert len((out / "toy.txt").read_text().splitlines()) == -(-n_points // 3)
        ds.write_model(ds.read_model(path), tmp_path / "again.toml")
        again = ds.read_model(tmp_path / "again.toml")
        assert again.analysis.outputs == (("toy", {"every": 3}),)
        # A run that does not ask for it removes the old one.
        done = CliRunner().invoke(app, ["run", str(wall()), "--out", str(out), "--json", "--quiet"])
        assert done.exit_code == 0, done.output
        assert (out / "curve.csv").exists() and not (out / "toy.txt").exists()

    @pytest.mark.parametrize(
        ("new", "said"),
        [
            ("every = 0", "output[1].every: must be at least 1"),
            ("evry = 3", 'did you mean "every"?'),
        ],
    )
    def test_its_keys_are_checked(self, add, wall, new, said):
        add("drystone.outputs", "toy", "toy_output:TOY", OUTPUT)
        with pytest.raises(ds.ModelError) as caught:
            ds.read_model(wall(more=self.ASKED.replace("every = 3", new)))
        assert any(said in problem for problem in caught.value.problems), caught.value.problems


DRAWING = '''
    """A line for each solid: its name, and x, y and z of two corners of a box."""

    import numpy as np

    from drystone.io.drawings.drawing import Drawing, Shape
    from drystone.io.drawings.format import LOST, Format
    from drystone.model.construction.errors import ModelError

    FACES = ((0, 2, 3, 1), (4, 5, 7, 6), (0, 1, 5, 4), (2, 6, 7, 3), (0, 4, 6, 2), (1, 3, 7, 5))


    def read(contents, path, dimension):
        shapes = []
        for line in contents.decode().splitlines():
            name, *numbers = line.split()
            if len(numbers) != 6:
                raise ModelError([f"the line of {name} has not six numbers"])
            low, high = np.array(numbers, float).reshape(2, 3)
            corners = [
                [(low, high)[k][0], (low, high)[j][1], (low, high)[i][2]]
                for k in (0, 1) for j in (0, 1) for i in (0, 1)
            ]
            shapes.append(Shape(name=name, vertices=np.array(corners), faces=FACES))
        return Drawing(shapes=tuple(shapes), unit="m", up="z")


    def write(shapes, title, control):
        rows = [(one.name, *one.vertices.min(0), *one.vertices.max(0)) for one in shapes]
        return "\\n".join(" ".join(map(str, row)) for row in rows)


    BOXES = Format(name="boxes", endings=(".box",), read=read, write=write, supports=LOST)
'''

DRAWN = """
dimension = 3

[material.stone]
unit_weight = 20e3

[joint]
friction_coefficient = 0.7
normal_stiffness = 1e9
shear_stiffness = 1e9

[[import]]
file = "wall.box"
format = "boxes"
support = ["base"]

[load]
pattern = "mass"
direction = [1.0, 0.0, 0.0]

[analysis]
max_displacement = 0.02
"""


class TestDrawing:
    def test_a_wall_is_read_from_it_and_written_to_it(self, add, wall, tmp_path):
        add("drystone.drawings", "boxes", "box_drawing:BOXES", DRAWING)
        drawing, drawn = tmp_path / "wall.box", tmp_path / "drawn.toml"
        done = CliRunner().invoke(app, ["convert", str(wall()), str(drawing)])
        assert done.exit_code == 0, done.output
        assert 'supports are not marked in this format: "base"' in done.output.replace("\n", " ")
        drawn.write_text(DRAWN)
        model = ds.read_model(drawn)
        assert set(model.assembly.ids) == {"base", "low", "high"}
        # Both lean together: 0.3 m beside 0.8 m.
        peak = ds.pushover(model, progress=False).peak.load_multiplier
        assert peak == pytest.approx(0.3 / 0.8, rel=0.03)

    def test_the_command_line_knows_it_by_its_ending_and_by_its_name(self, add, wall, tmp_path):
        add("drystone.drawings", "boxes", "box_drawing:BOXES", DRAWING)
        drawing, made = tmp_path / "wall.box", tmp_path / "made.toml"
        done = CliRunner().invoke(app, ["convert", str(wall()), str(drawing), "--to", "boxes"])
        assert done.exit_code == 0, done.output
        done = CliRunner().invoke(app, ["convert", str(drawing), str(made), "--support", "base"])
        assert done.exit_code == 0, done.output
        assert "low" in made.read_text()
        listed = CliRunner().invoke(app, ["convert", str(drawing), str(made), "--from", "?"])
        assert listed.exit_code == 2 and "boxes" in listed.output

    def test_a_name_that_is_not_there_is_answered_with_those_that_are(self, add, tmp_path):
        add("drystone.drawings", "boxes", "box_drawing:BOXES", DRAWING)
        path = tmp_path / "wall.toml"
        path.write_text(DRAWN.replace('"boxes"', '"boxs"'))
        with pytest.raises(ds.ModelError, match=r"import\[1\].*format.*did you mean .boxes."):
            ds.read_model(path)


STOP = '''
    """The curve ends where the multiplier has fallen by a share of its highest."""

    from drystone.common.keys import Key, Number
    from drystone.common.ranges import Range
    from drystone.control.progress import End
    from drystone.control.stops import Stop


    def end(share, progress):
        if progress.static and progress.multiplier < (1.0 - share) * progress.highest:
            return End(reason=f"the multiplier has fallen by {share:g} of its peak", finished=True)
        return None


    FALL = Stop(key=Key(name="most_fall", type=Number(Range(least=0.01, most=1.0))), end=end)
'''


class TestStop:
    CHANGE = ("max_displacement = 0.02", "most_fall = 0.2")

    @pytest.mark.parametrize(
        ("engine", "strategy"),
        [("equilibrium", "displacement"), ("nscd", "displacement"), ("nscd", "published")],
    )
    def test_the_curve_of_a_wall_ends_by_it(self, add, wall, tmp_path, engine, strategy):
        add("drystone.stops", "most_fall", "fall_stop:FALL", STOP)
        model = ds.read_model(wall(self.CHANGE))
        curve = ds.pushover(model, engine=engine, strategy=strategy, progress=False)
        assert curve.reason == "the multiplier has fallen by 0.2 of its peak"
        assert curve.status == "finished"
        assert curve.points[-1].load_multiplier < 0.8 * curve.peak.load_multiplier
        assert curve.points[-2].load_multiplier > 0.7 * curve.peak.load_multiplier
        ds.write_model(model, tmp_path / "again.toml")
        assert ds.read_model(tmp_path / "again.toml").analysis.options == {"most_fall": 0.2}

    @pytest.mark.parametrize(
        ("new", "said"),
        [
            ("most_fall = 2.0", "analysis.most_fall: must be at most 1"),
            ("most_fal = 0.2", 'did you mean "most_fall"?'),
        ],
    )
    def test_its_key_is_checked(self, add, wall, new, said):
        add("drystone.stops", "most_fall", "fall_stop:FALL", STOP)
        with pytest.raises(ds.ModelError) as caught:
            ds.read_model(wall((self.CHANGE[0], new)))
        assert any(said in problem for problem in caught.value.problems), caught.value.problems

    def test_in_python(self, add, wall):
        add("drystone.stops", "most_fall", "fall_stop:FALL", STOP)
        model = ds.read_model(wall())
        curve = ds.pushover(model, most_fall=0.1, max_displacement=1.0, progress=False)
        assert curve.reason == "the multiplier has fallen by 0.1 of its peak"
        with pytest.raises(ds.EngineError, match="most_fall: must be at most 1"):
            ds.pushover(model, most_fall=2.0, progress=False)
