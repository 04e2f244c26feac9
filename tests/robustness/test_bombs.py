"""Small files that would grow without end: each is refused at once, with the limit."""

from __future__ import annotations

import io
import json
import time

import numpy as np
import pytest

import drystone as ds
from drystone.assessment.errors import AssessmentError
from drystone.assessment.rocking.motion import respond
from drystone.assessment.rocking.record import Record
from drystone.assessment.spectra.table import read_spectrum
from drystone.io.convert import read as read_script
from drystone.io.drawings import bodies, obj, ply, stl
from drystone.io.drawings.patterns import expression
from drystone.io.modelfile.parse import parse
from fuzzing import sound

#: Seconds of a processor; what was found took 15 and more, or all memory.
AT_ONCE = 5.0
PLANE = "dimension = 2\nthickness = 1.0\n" + sound.LAW + sound.PUSH


def said(error, function, *arguments, **keywords) -> str:
    """What is said by an error that comes at once."""
    begun = time.process_time()
    with pytest.raises(error) as told:
        function(*arguments, **keywords)
    assert time.process_time() - begun < AT_ONCE
    return str(told.value)


class TestModels:
    def told(self, tmp_path, text):
        path = tmp_path / "m.toml"
        path.write_text(PLANE + text)
        return said(ds.ModelError, ds.read_model, path)

    def test_courses_that_are_repeated(self, tmp_path):
        wall = '[wall]\nunit = [0.4, 0.2]\ncourses = ["{}"]\nrepeat = 10000\n'.format("1" * 2000)
        assert "gives more than 20000 blocks" in self.told(tmp_path, wall)

    def test_ties(self, tmp_path):
        tie = "[[spring]]\nfrom = { point = [0, 0] }\nto = { point = [1, 0] }\nstiffness = 1\n"
        assert "has 6,000 ties, and 5,000 are" in self.told(tmp_path, tie * 6000)

    def test_an_outline_like_a_comb(self, tmp_path):
        teeth = [[float(k), 5.0 + 3.0 * (k % 2)] for k in range(1200)]
        block = {"vertices": [*teeth, [1199.0, 20.0], [0.0, 20.0]]}
        text = sound.TWO + f'[[block]]\nid = "c"\nvertices = {block["vertices"]}\n'
        assert "reentrant corners, and 150 are the most" in self.told(tmp_path, text)

    def test_patterns(self):
        fits = expression("*a" * 40 + "*b").fullmatch
        begun = time.process_time()
        assert not fits("a" * 190)
        assert time.process_time() - begun < AT_ONCE
        for pattern, name, is_so in (
            ("*", "", True), ("a*", "abc", True), ("*c", "abc", True), ("a*b*c", "aXbbYc", True),
            ("a*b*c", "acb", False), ("*ab*ab*", "abab", True), ("*ab*ab*", "abb", False),
            ("?", "", False), ("a?*c", "abc", True), ("a**c", "a.\nc", True), ("a.c", "abc", False),
            ("*a", "aa", True), ("*a*", "b", False), ("a", "a", True),
        ):  # fmt: skip
            assert bool(expression(pattern).fullmatch(name)) is is_so, (pattern, name)

    @pytest.mark.parametrize(
        ("text", "words"),
        [
            (json.dumps({f"k{k}": 1 for k in range(300_000)}), "a table has 300,000 keys"),
            ('{"a": [' + "{}," * 2_000_000 + "1]}", "values, and 3,000,000 are the most"),
            ("{" + "".join(f'"k{k}": 1, ' for k in range(300_000)) + '"k9": 2}', "twice"),
            ("[" * 100_000, "nested too deeply"),
        ],
    )
    def test_json(self, text, words):
        assert words in said(ds.ModelError, parse, text.encode(), is_json=True)

    def test_faults_are_told_up_to_a_hundred(self, tmp_path):
        path = tmp_path / "m.json"
        path.write_text(json.dumps({f"k{k}": 1 for k in range(5000)}))
        with pytest.raises(ds.ModelError) as told:
            ds.read_model(path)
        assert len(told.value.problems) == 101
        # Beside the 5,000 unknown keys five are missing that a model needs.
        assert "has 4,905 more faults" in told.value.problems[-1]


class TestDrawings:
    def test_references_in_rows_and_in_each_other(self):
        ezdxf = pytest.importorskip("ezdxf")
        from drystone.io.drawings import dxf

        document = ezdxf.new("R2000")
        block = document.blocks.new("A")
        block.add_lwpolyline([(0, 0), (1, 0), (1, 1)], close=True)
        rows = {"column_count": 30000, "row_count": 30000, "column_spacing": 1, "row_spacing": 1}
        document.modelspace().add_blockref("A", (0, 0), dxfattribs=rows)
        stream = io.StringIO()
        document.write(stream)
        told = said(ds.ModelError, dxf.read, stream.getvalue().encode(), 2)
        assert "has 900,000,000 entities, and 100,000 are the most" in told

    def test_ply_of_rows_without_columns(self):
        head = b"ply\nformat ascii 1.0\n" + b"element a 200000\n" * 2000 + b"end_header\n"
        assert "rows of elements" in said(ds.ModelError, ply.read, head)

    def test_a_face_of_millions_of_corners(self):
        text = b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf " + b"1 2 3 " * 500_000
        assert "corners of faces" in said(ds.ModelError, obj.read, text)

    def test_stl_of_vertices_without_facets(self):
        text = b"solid a\n" + b"vertex 0 0 0\n" * 3_000_000
        assert "has 1,000,000 faces" in said(ds.ModelError, stl.read, text)

    def test_bodies(self):
        text = sound.bodies()[0] + "coo1=0 coo2=0\n" * 300_000
        assert "vertices, and 200,000 are" in said(ds.ModelError, bodies.read, text.encode())


class TestTables:
    def test_rows(self, tmp_path):
        path = tmp_path / "s.csv"
        path.write_text("T,Se\n" + "".join(f"{k},1\n" for k in range(150_000)))
        told = said(AssessmentError, read_spectrum, path, unit="g", damping=0.05)
        assert "has 150,000 rows, and 100,000 are the most" in told

    @pytest.mark.parametrize("number", ["1e308", "inf", "nan", "-1e7"])
    def test_numbers(self, tmp_path, number):
        path = tmp_path / "s.csv"
        path.write_text(f"T,Se\n0,0.2\n1,{number}\n")
        told = said(AssessmentError, read_spectrum, path, unit="g", damping=0.05)
        assert "line 3: is not finite, or beyond 1e+06" in told

    def test_a_spectrum_that_is_nothing_but_the_ground(self, tmp_path):
        """Its corner period was zero, which was found where it was scaled."""
        path = tmp_path / "s.csv"
        path.write_text("T,Se\n0,0.2\n1,0\n2,0\n")
        told = said(AssessmentError, read_spectrum, path, unit="g", damping=0.05)
        assert "no value after the first is above zero" in told

    def test_a_record_of_uneven_steps(self):
        """None is longer than the median: so long a record would have 1e15."""
        record = Record(time=np.array([0.0, 1e-9, 2e-9, 1e6]), acceleration=np.ones(4))
        told = said(AssessmentError, respond, None, record, restitution=0.9, sides="two")
        assert "give it in even steps" in told


@pytest.mark.parametrize("ending", ["dat", "3ddat", "py"])
@pytest.mark.parametrize("piece", [b"\xff", b"(" * 100_000, b"a." * 3000, b"1e400 "])
def test_scripts(tmp_path, ending, piece):
    for contents in sound.scripts(ending):
        path = tmp_path / f"a.{ending}"
        half = len(contents) // 3
        path.write_bytes(contents[:half] + piece + contents[half:])
        try:
            read_script(path)  # what stands in a comment says nothing
        except ds.ModelError as error:
            assert all(p.startswith(str(path)) and len(p) < 400 for p in error.problems)
