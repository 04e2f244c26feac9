"""What nobody means is counted and refused before any work on it."""

from __future__ import annotations

import os
import time

import numpy as np
import pytest

import drystone as ds
from drystone.assessment.errors import AssessmentError
from drystone.assessment.spectra.table import read_spectrum
from drystone.common.ranges import LARGEST
from drystone.geometry.broad import candidate_pairs
from drystone.io.drawings import obj, ply, stl
from drystone.model.construction.contents import read_bytes

HEAD = """
dimension = {dimension}
{thickness}
[material.stone]
unit_weight = 20e3
[joint]
friction_coefficient = 0.6
normal_stiffness = 1e9
shear_stiffness = 1e9
[load]
pattern = "mass"
direction = {direction}
"""
PLANE = HEAD.format(dimension=2, thickness="thickness = 1.0", direction=[1.0, 0.0])
SPACE = HEAD.format(dimension=3, thickness="", direction=[1.0, 0.0, 0.0])
BLOCK = '[[block]]\nid = "b{}"\nvertices = [[0, 0], [1, 0], [1, 1], [0, 1]]\n'

#: Seconds of the processor in which a refusal comes; what they replace took 12 to 120 s and more.
AT_ONCE = 5.0


def refused(tmp_path, text):
    """The sentences on a model file, and seconds of the processor until they are there."""
    path = tmp_path / "m.toml"
    path.write_text(text)
    begun = time.process_time()
    with pytest.raises(ds.ModelError) as caught:
        ds.read_model(path)
    assert time.process_time() - begun < AT_ONCE
    return str(caught.value)


class TestModels:
    def test_more_blocks_than_anything_takes(self, tmp_path):
        n = LARGEST["blocks"] + 1
        told = refused(tmp_path, PLANE + "".join(map(BLOCK.format, range(n))))
        assert "the model has 20,001 blocks, and 20,000 are the most" in told

    def test_as_many_made_in_python(self):
        vertices = np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0]])
        blocks = [ds.Block(id=f"b{k}", vertices=vertices, unit_weight=2e4) for k in range(20_001)]
        joint = ds.JointLaw(friction_coefficient=0.6, normal_stiffness=1e9, shear_stiffness=1e9)
        with pytest.raises(ds.ModelError, match="has 20,001 blocks"):
            ds.make_model(blocks, joint=joint, thickness=1.0, load_direction=(1, 0))

    @pytest.mark.parametrize(
        "keys",
        [
            'kind = "rubble"\nlength = 300.0\nheight = 300.0\nstone = [1.0, 1.0]\nseed = 1',
            'kind = "arch"\nspan = 6e5\nthickness = 1.0\nsize = 0.5\nabutments = true',
        ],
    )
    def test_builders_count_first(self, tmp_path, keys):
        """Rubble of 90,000 stones, an arch of 600 km."""
        told = refused(tmp_path, f"{PLANE}[[build]]\n{keys}\n")
        assert "build[1] gives more than 20000 blocks" in told

    def test_an_arch_of_6000_km(self, tmp_path):
        keys = 'kind = "arch"\nspan = 6e6\nthickness = 1.0\nsize = 0.5\nabutments = true'
        assert "span: must be at most 1e+06" in refused(tmp_path, f"{PLANE}[[build]]\n{keys}\n")

    def test_names_that_fill_screens(self, tmp_path):
        name = "x" * 1_000_000
        told = refused(tmp_path, PLANE + BLOCK.format(name))
        assert "has 1,000,001 letters: a name has at most 200" in told and len(told) < 300

    def test_names_made_in_python(self):
        block = ds.Block(id="x" * 201, vertices=[[0, 0], [1, 0], [1, 1]], unit_weight=2e4)
        joint = ds.JointLaw(friction_coefficient=0.6, normal_stiffness=1e9, shear_stiffness=1e9)
        with pytest.raises(ds.ModelError, match="the id has 201 letters"):
            ds.make_model([block], joint=joint, thickness=1.0, load_direction=(1, 0))


class TestCrowds:
    """Blocks on the same place: 20,000 have 2e8 pairs, each of which was kept and told."""

    @pytest.mark.parametrize("dimension", [2, 3])
    def test_are_counted_and_not_kept(self, dimension):
        low = np.zeros((19_000, dimension))
        candidate_pairs(low[:100], low[:100] + 1.0)  # compiles
        begun = time.process_time()
        with pytest.raises(ds.ModelError, match="more than 9,500,000 pairs of 19,000 blocks"):
            candidate_pairs(low, low + 1.0)
        assert time.process_time() - begun < AT_ONCE

    def test_that_are_none(self):
        """A block that all others stand on, and 5,000 that all touch 26."""
        grid = np.stack(np.meshgrid(*[np.arange(17.0)] * 3), axis=-1).reshape(-1, 3)
        low = np.vstack((grid, [[-1.0, -1.0, -1.0]]))
        high = np.vstack((grid + 1.0, [[20.0, 20.0, 20.0]]))
        a, _ = candidate_pairs(low, high)
        assert len(a) > 13 * 15**3

    def test_of_a_few_are_told_up_to_a_thousand(self, tmp_path):
        told = PLANE + "".join(map(BLOCK.format, range(60)))
        (tmp_path / "m.toml").write_text(told)
        with pytest.raises(ds.ModelError) as caught:
            ds.read_model(tmp_path / "m.toml")
        overlaps = [text for text in caught.value.problems if "overlap" in text]
        assert len(overlaps) == 1001 and "770 more pairs of blocks overlap" in overlaps[-1]


class TestDrawings:
    def told(self, read, contents):
        begun = time.process_time()
        with pytest.raises(ds.ModelError) as caught:
            read(contents)
        assert time.process_time() - begun < AT_ONCE
        return str(caught.value)

    def test_obj(self):
        """A million vertices took 11 s, a million faces 120."""
        told = self.told(obj.read, b"v 0 0 0\n" * 1_000_000 + b"f 1 2 3\n")
        assert "has 1,000,000 vertices, and 200,000 are the most" in told
        told = self.told(obj.read, b"v 0 0 0\n" * 3 + b"f 1 2 3\n" * 1_000_000)
        assert "has 1,000,000 faces" in told

    def test_stl(self):
        told = self.told(stl.read, bytes(80) + (300_000).to_bytes(4, "little") + bytes(15_000_000))
        assert "has 300,000 faces" in told
        facet = b"facet normal 0 0 1\nouter loop\nendloop\nendfacet\n"
        assert "has 300,000 faces" in self.told(stl.read, b"solid a\n" + facet * 300_000)

    def test_ply(self):
        head = b"ply\nformat ascii 1.0\nelement vertex 300000\nproperty float x\nend_header\n"
        assert "has 300,000 vertices" in self.told(ply.read, head)


class TestFiles:
    @pytest.mark.skipif(not hasattr(os, "mkfifo"), reason="there are no such files here")
    def test_pipes_and_devices_are_not_opened(self, tmp_path):
        """A pipe was waited for without end, a device without end was read until memory was."""
        pipe = tmp_path / "a.obj"
        os.mkfifo(pipe)
        table = '[[import]]\nfile = "{}"\nformat = "obj"\nunit = "m"\nup = "z"\n'
        told = refused(tmp_path, SPACE + table.format(pipe))
        assert "is a pipe or a device: save what it gives as a file" in told
        for file in (pipe, "/dev/zero"):
            with pytest.raises(ds.ModelError, match="is a pipe or a device"):
                ds.read_model(file)
            with pytest.raises(AssessmentError, match="is a pipe or a device"):
                read_spectrum(file, unit="g", damping=0.05)

    def test_size(self, tmp_path):
        path = tmp_path / "m.toml"
        with path.open("wb") as file:
            file.truncate(LARGEST["file"] + 1_000_000)  # takes no space on the disk
        with pytest.raises(ds.ModelError, match="has 65 MB, and 64 MB are the most"):
            read_bytes(path, "the file")
