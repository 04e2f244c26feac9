"""What others add from outside: one file and one line each, as an installed package would.

Every test writes one module and one entry point into a folder of its own, and runs a small wall by
a model file that names what was added and uses its keys.
"""

from __future__ import annotations

import json
from pathlib import Path
from textwrap import dedent
from typing import NamedTuple

import numpy as np
import pytest
from typer.testing import CliRunner

import drystone as ds
from drystone.assessment.errors import AssessmentError
from drystone.cli import app

HEAD = """
dimension = 2
thickness = 0.5

[material.stone]
unit_weight = 20e3

[joint]
friction_coefficient = 0.7
normal_stiffness = 1e9
shear_stiffness = 1e9

[load]
pattern = "mass"
direction = [1.0, 0.0]

[analysis]
max_displacement = 0.02
"""

BLOCKS = """
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
"""


class Toy(NamedTuple):
    """What a package of one module adds."""

    group: str  # of entry points
    name: str
    target: str  # of the entry point
    code: str


@pytest.fixture
def add(tmp_path, monkeypatch):
    """Install the package of a toy, or one whose entry point names something else."""

    def added(toy: Toy, target: str = "") -> None:
        site = tmp_path / "site"
        info = site / f"{toy.name}-1.0.dist-info"
        info.mkdir(parents=True)
        (site / f"{toy.target.partition(':')[0]}.py").write_text(dedent(toy.code))
        (info / "METADATA").write_text(f"Metadata-Version: 2.1\nName: {toy.name}\nVersion: 1.0\n")
        entry = f"[{toy.group}]\n{toy.name} = {target or toy.target}\n"
        (info / "entry_points.txt").write_text(entry)
        monkeypatch.syspath_prepend(str(site))

    return added


@pytest.fixture
def wall(tmp_path):
    """The small wall, with some of its lines replaced, as a file."""

    def written(*changes: tuple[str, str], blocks: str = BLOCKS, more: str = "") -> Path:
        text = HEAD + blocks
        for old, new in changes:
            assert old in text
            text = text.replace(old, new)
        path = tmp_path / "wall.toml"
        path.write_text(text + more)
        return path

    return written


def run(*arguments: object) -> str:
    """What a command of the command line prints, which must succeed."""
    done = CliRunner().invoke(app, [str(argument) for argument in arguments])
    assert done.exit_code == 0, done.output
    return done.output


def peak_of(path: Path) -> float:
    """The largest multiplier of a model file."""
    return ds.pushover(ds.read_model(path), progress=False).peak.load_multiplier


def again(model: ds.Model, folder: Path) -> ds.Model:
    """The model, written and read."""
    ds.write_model(model, folder / "again.toml")
    return ds.read_model(folder / "again.toml")


PATTERN = Toy(
    "drystone.patterns",
    "above",
    "above_pattern:AbovePattern",
    '''
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
''',
)


class TestPattern:
    CHANGE = ('pattern = "mass"', 'pattern = "above"\nfrom_height = 1.0')

    def test_a_wall_is_pushed_by_it(self, add, wall, tmp_path):
        add(PATTERN)
        # The upper half, 0.8 m high, slides (0.7) before it tips (0.6 / 0.8 = 0.75), but the whole
        # tips first: weight 2 on 0.3 m against weight 1 at 1.2 m.  A thousandth is elastic.
        assert peak_of(wall(self.CHANGE)) == pytest.approx(2 * 0.3 / 1.2, rel=0.01)
        model = ds.read_model(wall(self.CHANGE))
        written = again(model, tmp_path)
        assert written.load.from_height == 1.0
        np.testing.assert_array_equal(written.load.direction, model.load.direction)

    def test_what_cannot_be_loaded_is_told(self, add, wall):
        add(PATTERN, "above_pattern:NoSuchPattern")
        with pytest.raises(ds.ModelError, match=r"load\.pattern: cannot be .*NoSuchPattern"):
            ds.read_model(wall(self.CHANGE))
        ds.read_model(wall())  # and keeps nobody else from reading


BUILDER = Toy(
    "drystone.builders",
    "leaning_pile",
    "leaning_pile:LEANING_PILE",
    '''
    """Stones of one size on top of each other, each further to the right than the one below."""

    from typing import Annotated

    from drystone.common.keys import Whole
    from drystone.model.builders.base import AlongY, Builder, FromZero, Metres
    from drystone.model.builders.stones import Mason


    def leaning_pile(
        *,
        width: Metres,
        height: Metres,
        stones: Annotated[int, Whole(1, 20), "how many"],
        unit_weight: float,
        lean: FromZero = 0.0,
        depth: AlongY = None,
        material: str = "",
    ):
        mason = Mason(unit_weight=unit_weight, material=material)
        y = ((), ()) if depth is None else ((0.0,), (depth,))
        return [
            mason.box(
                f"b{k + 1}",
                (k * lean, *y[0], k * height),
                (width + k * lean, *y[1], (k + 1) * height),
            )
            for k in range(stones)
        ]


    LEANING_PILE = Builder(make=leaning_pile)
''',
)


class TestBuilder:
    TABLE = """
        [[build]]
        kind = "leaning_pile"
        width = 0.6
        height = 0.8
        stones = 2
        lean = 0.05
        base = true
    """
    #: Weight 2 on what is left of 0.6 m before the toe, against weight 2 at 0.8 m.
    PEAK = (0.6 - 0.325) / 0.8

    def test_a_wall_is_built_by_it(self, add, wall):
        add(BUILDER)
        path = wall(blocks=self.TABLE)
        ids = ("leaning_pile/base", "leaning_pile/b1", "leaning_pile/b2")
        assert ds.read_model(path).assembly.ids == ids
        assert peak_of(path) == pytest.approx(self.PEAK, rel=0.02)

    def test_and_one_in_space(self, add, wall):
        add(BUILDER)
        changes = (
            ("dimension = 2\nthickness = 0.5", "dimension = 3"),
            ("[1.0, 0.0]", "[1.0, 0.0, 0.0]"),
            ("lean = 0.05", "lean = 0.05\ndepth = 0.5"),
        )
        assert peak_of(wall(*changes, blocks=self.TABLE)) == pytest.approx(self.PEAK, rel=0.02)
        with pytest.raises(ds.ModelError, match=r"build\[1\]: depth is missing: add it \(in m, al"):
            ds.read_model(wall(*changes[:2], blocks=self.TABLE))


METHOD = Toy(
    "drystone.methods",
    "toy",
    "toy_method",
    '''
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
            activation_acceleration=borne, confidence_factor=None,
            quantities={"share": share},
        )
''',
)

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
        add(METHOD)
        model = ds.read_model(wall(more=SITE + self.TABLE))
        verdict = ds.pushover(model, progress=False).assess(model)
        (state,) = verdict.limit_states
        assert verdict.method == "toy" and verdict.as_dict()["share"] == 0.5  # of 50 percent
        # Both blocks lean together: alpha_0 = 0.3 / 0.8, of which half is borne; 0.1 g is asked.
        assert state.safety_index == pytest.approx(0.5 * (0.3 / 0.8) / 0.1, rel=0.03)

    def test_the_command_line_takes_it_over_the_method_of_the_file(self, add, wall, tmp_path):
        add(METHOD)
        path = wall(more=SITE + self.TABLE.replace('"toy"', '"rocking"'))
        arguments = ("--method", "toy", "--one-sense", "--out", tmp_path / "out")
        told = json.loads(run("assess", path, *arguments, "--json", "--quiet"))
        (sense,) = told["senses"].values()
        assert (sense["method"], sense["share"]) == ("toy", 0.5)

    def test_what_it_needs_is_asked_for(self, add, wall):
        add(METHOD)
        text = SITE + self.TABLE.replace("safe_share = 50.0", "")
        model = ds.read_model(wall(more=text))  # a key is no must where the command line may say it
        with pytest.raises(AssessmentError, match='method "toy" needs "safe_share"'):
            ds.pushover(model, progress=False).assess(model)


OUTPUT = Toy(
    "drystone.outputs",
    "toy",
    "toy_output:TOY",
    '''
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
''',
)


class TestOutput:
    ASKED = '\n[[output]]\nkind = "toy"\nevery = 3\n'

    def test_a_wall_is_written_by_it(self, add, wall, tmp_path):
        add(OUTPUT)
        out = tmp_path / "out"
        path = wall(more=self.ASKED)
        run("run", path, "--out", out, "--json", "--quiet")
        n_points = len((out / "curve.csv").read_text().splitlines()) - 1
        assert len((out / "toy.txt").read_text().splitlines()) == -(-n_points // 3)
        written = again(ds.read_model(path), tmp_path)
        assert written.analysis.outputs == (("toy", {"every": 3}),)
        assert written.with_analysis(max_steps=3).analysis.outputs == written.analysis.outputs
        # A run that does not ask for it removes the old one.
        run("run", wall(), "--out", out, "--json", "--quiet")
        assert (out / "curve.csv").exists() and not (out / "toy.txt").exists()


DRAWING = Toy(
    "drystone.drawings",
    "boxes",
    "box_drawing:BOXES",
    '''
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
''',
)


class TestDrawing:
    TABLE = """
        [[import]]
        file = "wall.box"
        format = "boxes"
        support = ["base"]
    """
    IN_SPACE = (
        ("dimension = 2\nthickness = 0.5", "dimension = 3"),
        ("[1.0, 0.0]", "[1.0, 0.0, 0.0]"),
    )

    def test_a_wall_is_read_from_it_and_written_to_it(self, add, wall, tmp_path):
        add(DRAWING)
        said = run("convert", wall(), tmp_path / "wall.box")
        assert 'supports are not marked in this format: "base"' in said.replace("\n", " ")
        drawn = wall(*self.IN_SPACE, blocks=self.TABLE)
        assert set(ds.read_model(drawn).assembly.ids) == {"base", "low", "high"}
        # Both lean together: 0.3 m beside 0.8 m.
        assert peak_of(drawn) == pytest.approx(0.3 / 0.8, rel=0.03)

    def test_the_command_line_knows_it_by_its_ending_and_by_its_name(self, add, wall, tmp_path):
        add(DRAWING)
        drawing, made = tmp_path / "wall.box", tmp_path / "made.toml"
        run("convert", wall(), drawing, "--to", "boxes")
        run("convert", drawing, made, "--support", "base")
        assert "low" in made.read_text()
        listed = CliRunner().invoke(app, ["convert", str(drawing), str(made), "--from", "?"])
        assert listed.exit_code == 2 and "boxes" in listed.output


STOP = Toy(
    "drystone.stops",
    "most_fall",
    "fall_stop:FALL",
    '''
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
''',
)


class TestStop:
    CHANGE = ("max_displacement = 0.02", "most_fall = 0.2")

    @pytest.mark.parametrize(
        ("engine", "strategy"),
        [("equilibrium", "displacement"), ("nscd", "displacement"), ("nscd", "published")],
    )
    def test_the_curve_of_a_wall_ends_by_it(self, add, wall, tmp_path, engine, strategy):
        add(STOP)
        model = ds.read_model(wall(self.CHANGE))
        curve = ds.pushover(model, engine=engine, strategy=strategy, progress=False)
        assert curve.reason == "the multiplier has fallen by 0.2 of its peak"
        assert curve.status == "finished"
        assert curve.points[-1].load_multiplier < 0.8 * curve.peak.load_multiplier
        assert curve.points[-2].load_multiplier > 0.7 * curve.peak.load_multiplier
        assert again(model, tmp_path).analysis.options == {"most_fall": 0.2}

    def test_in_python(self, add, wall):
        add(STOP)
        model = ds.read_model(wall())
        curve = ds.pushover(model, most_fall=0.1, max_displacement=1.0, progress=False)
        assert curve.reason == "the multiplier has fallen by 0.1 of its peak"
        # Likewise where the support turns about a point to the left of it: the wall's arm shortens.
        turned = ds.Settlement(
            blocks=(model.assembly.ids[0],), centre=(-0.5, 0.0), clockwise=False, max=10.0
        )
        curve = ds.pushover(model.with_settlement(turned), most_fall=0.1, progress=False)
        assert curve.reason == "the multiplier has fallen by 0.1 of its peak"
        with pytest.raises(ds.EngineError, match="most_fall: must be at most 1"):
            ds.pushover(model, most_fall=2.0, progress=False)


ENGINE = Toy(
    "drystone.engines",
    "monolith",
    "toy_engine:MonolithEngine",
    (Path(__file__).parents[1] / "engines" / "toy_engine.py").read_text(encoding="utf-8"),
)


def test_a_wall_is_run_by_an_engine(add, wall, tmp_path):
    add(ENGINE)
    path = wall(("[analysis]", '[analysis]\nengine = "monolith"'))
    summary = json.loads(run("run", path, "--out", tmp_path / "out", "--json"))
    assert summary["engine"] == "monolith"
    assert summary["reason"].endswith("its joints do not open")
    # One piece that turns carries its half width over the height of its centroid.
    assert summary["peak_multiplier"] == pytest.approx(0.3 / 0.8, rel=0.01)
    assert peak_of(path) == summary["peak_multiplier"]  # in Python


@pytest.mark.parametrize(
    ("toy", "old", "new", "said"),
    [
        (PATTERN, "from_height = 1.0", "", "load: from_height is missing: add it"),
        (PATTERN, "= 1.0", "= -1.0", "load.from_height: must be at least 0"),
        (PATTERN, "from_height", "from_hight", 'did you mean "from_height"?'),
        (PATTERN, '"above"', '"abov"', 'did you mean "above"?'),
        (PATTERN, '"above"', '"mass"', 'load: unknown key "from_height"'),
        (BUILDER, "stones = 2", "", "build[1]: stones is missing: add it (how many)"),
        (BUILDER, "stones = 2", "stones = 21", "build[1].stones: must be at most 20, it is 21"),
        (BUILDER, "lean = ", "leen = ", 'build[1]: unknown key "leen": did you mean "lean"?'),
        (BUILDER, '"leaning_pile"', '"leaning_pil"', 'did you mean "leaning_pile"?'),
        (BUILDER, "base = true", "depth = 0.5", "build[1].depth: is for models in space only"),
        (METHOD, "= 50.0", "= 500.0", "assessment.safe_share: must be at most 100"),
        (METHOD, "safe_share", "safe_shares", 'did you mean "safe_share"?'),
        (METHOD, "safe_share = 50.0", 'limit_states = ["hold"]', 'did you mean "held"?'),
        (OUTPUT, "every = 3", "every = 0", "output[1].every: must be at least 1"),
        (OUTPUT, "every", "evry", 'did you mean "every"?'),
        (
            DRAWING,
            '"boxes"',
            '"boxs"',
            'import[1].format: must not be "boxs": did you mean "boxes"?',
        ),
        (STOP, "= 0.2", "= 2.0", "analysis.most_fall: must be at most 1"),
        (STOP, "most_fall", "most_fal", 'did you mean "most_fall"?'),
    ],
)
def test_keys_are_checked(add, wall, toy, old, new, said):
    add(toy)
    head, tables = {
        PATTERN: ([TestPattern.CHANGE], {}),
        BUILDER: ([], {"blocks": TestBuilder.TABLE}),
        METHOD: ([], {"more": SITE + TestMethod.TABLE}),
        OUTPUT: ([], {"more": TestOutput.ASKED}),
        DRAWING: (TestDrawing.IN_SPACE, {"blocks": TestDrawing.TABLE}),
        STOP: ([TestStop.CHANGE], {}),
    }[toy]
    path = wall(*head, **tables)
    path.write_text(path.read_text().replace(old, new))
    with pytest.raises(ds.ModelError) as caught:
        ds.read_model(path)
    assert any(said in problem for problem in caught.value.problems), caught.value.problems
