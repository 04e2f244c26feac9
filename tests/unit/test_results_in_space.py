"""Results of solids as files: the same wall as in the plane, and readers of others."""

from __future__ import annotations

import base64
import json
import struct
import xml.etree.ElementTree as ET
import zlib
from dataclasses import fields, replace
from itertools import pairwise
from pathlib import Path

import h5py
import numpy as np
import pytest
import spaced
import synthetic
from matplotlib.image import imread

import solids
from drystone.contact.forces import ContactForces
from drystone.geometry.motion import rotation_vectors
from drystone.geometry.space import solid
from drystone.io.results import vtu
from drystone.io.results.csv import write_curve
from drystone.io.results.paraview import BlockFrames
from drystone.io.results.results_writer import ResultsWriter
from drystone.model.assembly import Assembly, Block
from drystone.model.model import Model
from drystone.report.folder.results import load_results, save_results
from drystone.results.curve import CapacityCurve


@pytest.fixture(scope="module")
def made() -> tuple[Model, Model, CapacityCurve]:
    """The wall in the plane and in space, and a curve of the latter with its states."""
    plane, model = spaced.wall_model()
    curve = synthetic.curve()
    found = [spaced.states(plane, p.control_displacement) for p in curve.points]
    poses, contacts = np.array([pose for pose, _ in found]), tuple(c for _, c in found)
    return plane, model, replace(curve, poses=poses, contacts=contacts)


@pytest.fixture(scope="module")
def folder(made, tmp_path_factory) -> Path:
    path = tmp_path_factory.mktemp("space") / "out"
    save_results(made[2], made[1], path)
    return path


def test_folder_is_complete(folder, made):
    files = {"summary.json", "curve.csv", "curve.png", "mechanism.png", "results.h5"}
    assert {p.name for p in folder.iterdir()} == {*files, "paraview"}
    summary = json.loads((folder / "summary.json").read_text())
    assert summary["dimension"] == 3 and summary["n_blocks"] == 12
    assert float(imread(folder / "mechanism.png")[..., :3].std()) > 0.01


def test_what_was_saved_is_loaded_to_the_bit(folder, made):
    _, model, curve = made
    loaded = load_results(folder)
    assert loaded.curve.points == curve.points
    np.testing.assert_array_equal(loaded.poses, curve.poses)
    for mine, theirs in zip(curve.contacts, loaded.contacts, strict=True):
        for field in fields(ContactForces):
            np.testing.assert_array_equal(getattr(theirs, field.name), getattr(mine, field.name))
    assert loaded.model is not None
    again = loaded.model.assembly
    assert again.ids == model.assembly.ids and again.dimension == 3
    # Volumes of hulls of the same vertices, in another order of summation.
    np.testing.assert_allclose(again.weight, model.assembly.weight, rtol=1e-12)


def test_curve_is_that_of_the_plane(folder, made, tmp_path):
    write_curve(made[2], tmp_path / "curve.csv")
    assert (folder / "curve.csv").read_text() == (tmp_path / "curve.csv").read_text()


def shapes_of(file: h5py.File) -> list[list[tuple[np.ndarray, list[tuple[int, ...]]]]]:
    """Parts of the blocks as the file's description says they are to be read."""
    names = ("offset", "vertices", "rows", "face_offset", "part_faces", "body")
    offset, vertices, rows, face_offset, part_faces, body = (file["blocks"][n][:] for n in names)
    blocks: list[list[tuple[np.ndarray, list[tuple[int, ...]]]]] = [
        [] for _ in range(len(file["blocks/id"]))
    ]
    for s, owner in enumerate(body):
        faces = [
            tuple(rows[face_offset[f] : face_offset[f + 1]] - offset[s])
            for f in range(part_faces[s], part_faces[s + 1])
        ]
        blocks[owner].append((vertices[offset[s] : offset[s + 1]], faces))
    return blocks


def stairs() -> Block:
    """Two steps, an L in the plane x-z, given as one concave solid: 0.75 m3."""
    outline = np.array([[0, 0], [1, 0], [1, 0.5], [0.5, 0.5], [0.5, 1], [0, 1]], float)
    vertices, faces = solid.extruded(outline, (0.0, 1.0))
    return Block(id="stairs", vertices=vertices, faces=faces, unit_weight=1e4, material="stone")


def stairs_model() -> Model:
    blocks = [solids.box("base", (-1, -1, -0.5), (2, 2, 0), support=True), stairs()]
    return solids.model_of(blocks, solids.joint(0.6), push=(1.0, 0.0, 0.0))


def test_shapes_are_read_as_described(tmp_path):
    model = stairs_model()
    ResultsWriter(tmp_path / "r.h5", model, "nscd", "displacement").close()
    with h5py.File(tmp_path / "r.h5") as file:
        shapes = shapes_of(file)
        assert file["poses"].shape == (0, 2, 7)
        assert file["poses"].attrs["unit"] == "m, m, m, 1, 1, 1, 1"
        assert file["blocks/vertices"].attrs["unit"] == "m"
        assert file["contacts/tangential_reaction"].shape == (0, 2)
        np.testing.assert_array_equal(file["blocks/axes"], model.assembly.axes)
    assert [len(parts) for parts in shapes] == [1, 2]
    volume = [
        sum(solid.mass_properties(v, tuple(faces)).volume for v, faces in parts) for parts in shapes
    ]
    assert volume == pytest.approx([3 * 3 * 0.5, 0.75], rel=1e-12)  # m3, of sums of a few terms


def test_concave_outlines_are_whole_in_the_file(tmp_path):
    """In the plane a block is one outline, and the file has no more in it than it had."""
    corner = np.array([[0, 0], [1, 0], [1, 0.5], [0.5, 0.5], [0.5, 1], [0, 1]], float)
    plane = synthetic.wall_model()
    blocks = [*plane.assembly.blocks[:1], Block(id="L", vertices=corner, unit_weight=1e4)]
    assembly = Assembly.build(blocks, joint=plane.assembly.joint)
    model = replace(plane, assembly=assembly, control_point=replace(plane.control_point, block=1))
    ResultsWriter(tmp_path / "r.h5", model, "nscd", "displacement").close()
    with h5py.File(tmp_path / "r.h5") as file:
        assert set(file["blocks"]) == {"id", "offset", "vertices", "centroid", "weight", "support"}
        np.testing.assert_array_equal(file["blocks/vertices"][4:], corner)
        assert file["blocks/offset"][:].tolist() == [0, 4, 10]


# ParaView


def arrays_of(path: Path) -> dict[str, np.ndarray]:
    """Arrays of a grid by their names, read by what VTK's description of the format says."""
    root = ET.parse(path).getroot()
    assert root.attrib["type"] == "UnstructuredGrid"
    assert root.attrib["header_type"] == "UInt64"
    kinds = {name: kind for kind, name in vtu.TYPE_NAMES.items()}
    found = {}
    for array in root.iter("DataArray"):
        text = (array.text or "").encode()
        # Three numbers and one for each piece, in letters of their own: first only the number.
        (pieces,) = struct.unpack("=Q", base64.b64decode(text[:12])[:8])
        head = 4 * -(-8 * (3 + pieces) // 3)
        sizes = struct.unpack(f"={3 + pieces}Q", base64.b64decode(text[:head]))[3:]
        body, raw = base64.b64decode(text[head:]), b""
        for size in sizes:
            raw, body = raw + zlib.decompress(body[:size]), body[size:]
        values = np.frombuffer(raw, kinds[array.attrib["type"]])
        width = int(array.attrib.get("NumberOfComponents", 1))
        found[array.attrib["Name"]] = values.reshape(-1, width) if width > 1 else values
    return found


def volumes(grid: dict[str, np.ndarray]) -> np.ndarray:
    """Of polyhedra, from VTK's stream of faces; their points have to be those of the cell."""
    found, start = [], 0
    ends = np.append(0, grid["offsets"])
    for cell, end in enumerate(grid["faceoffsets"]):
        stream = grid["faces"][start:end].tolist()
        faces, at = [], 1
        for _ in range(stream[0]):
            faces.append(stream[at + 1 : at + 1 + stream[at]])
            at += 1 + stream[at]
        assert at == len(stream)
        points = grid["connectivity"][ends[cell] : ends[cell + 1]].tolist()
        assert {row for face in faces for row in face} == set(points)
        found.append(
            sum(
                grid["Points"][face[0]] @ np.cross(grid["Points"][b], grid["Points"][c]) / 6.0
                for face in faces
                for b, c in pairwise(face[1:])
            )
        )
        start = end
    return np.array(found)


def test_grids_hold_the_moved_solids(folder, made):
    plane, model, curve = made
    (last,) = sorted((folder / "paraview").glob("blocks_*.vtu"))[-1:]
    grid = arrays_of(last)
    flat = synthetic.pose_at(plane, curve.points[-1].control_displacement)
    assert set(grid["types"]) == {vtu.POLYHEDRON}
    np.testing.assert_allclose(volumes(grid), model.assembly.volume, rtol=1e-12)
    np.testing.assert_array_equal(grid["displacement"], spaced.vectors(flat[:, :2]))
    # About -y, see `spaced`; to and from a quaternion some units in the last place are lost.
    expected = np.column_stack((0 * flat[:, 2], -flat[:, 2], 0 * flat[:, 2]))
    np.testing.assert_allclose(grid["rotation"], expected, rtol=0, atol=1e-15)
    assert grid["block"].tolist() == list(range(13))
    assert grid["is_support"].tolist() == [1] + [0] * 12
    assert grid["moving"].tolist() == [0] * 4 + [1] * 9  # as in the plane
    corner = spaced.vectors(plane.assembly.outline(12, flat))
    own = grid["Points"][-8:]
    for place in corner:  # each of the outline's on both faces of the prism
        assert np.sum(np.linalg.norm(own[:, [0, 2]] - place[[0, 2]], axis=1) < 1e-14) == 2


def test_grids_of_contacts_hold_vectors(folder, made):
    _, _, curve = made
    (last,) = sorted((folder / "paraview").glob("contacts_*.vtu"))[-1:]
    grid, contacts = arrays_of(last), curve.contacts[-1]
    np.testing.assert_array_equal(grid["Points"], contacts.position)
    np.testing.assert_array_equal(grid["reaction"], contacts.vectors())
    np.testing.assert_array_equal(grid["normal"], contacts.normal)
    np.testing.assert_array_equal(grid["status"], contacts.status)


def test_blocks_of_several_parts_are_several_cells(tmp_path):
    model = stairs_model()
    pose = model.assembly.design_pose()
    pose[1] = [0.3, 0.0, 0.1, np.cos(0.2), 0.0, 0.0, np.sin(0.2)]  # 0.4 rad about z
    BlockFrames(model.assembly).write(tmp_path / "b.vtu", pose)
    grid = arrays_of(tmp_path / "b.vtu")
    assert grid["block"].tolist() == [0, 1, 1]
    assert grid["moving"].tolist() == [0, 1, 1]
    np.testing.assert_allclose(grid["rotation"][1:], [[0.0, 0.0, 0.4]] * 2, atol=1e-15)
    assert volumes(grid)[1:].sum() == pytest.approx(0.75, rel=1e-12)
    np.testing.assert_array_equal(grid["weight"], model.assembly.weight[[0, 1, 1]])


def test_vtk_itself_reads_the_solids(folder, made):
    pyvista = pytest.importorskip("pyvista")
    (last,) = sorted((folder / "paraview").glob("blocks_*.vtu"))[-1:]
    grid = pyvista.read(last)
    assert grid.n_cells == made[1].assembly.n_bodies
    sized = grid.compute_cell_sizes(length=False, area=False)
    np.testing.assert_allclose(np.abs(sized["Volume"]), made[1].assembly.volume, rtol=1e-6)


def test_rotations_of_either_dimension():
    np.testing.assert_array_equal(rotation_vectors(np.array([[0.0, 0.0, 2.5]])), [2.5])
    q = np.array([[0, 0, 0, np.cos(0.6), 0, np.sin(0.6), 0], [0, 0, 0, -1.0, 0, 0, 0]])
    np.testing.assert_allclose(rotation_vectors(q), [[0, 1.2, 0], [0, 0, 0]], atol=1e-15)
