"""Files of modelling programs: what is read of them, and what is said of broken ones."""

from __future__ import annotations

import ast
import json
import re
import struct
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from drawn import box, brick_wall, obj_text
from drystone.geometry.space import solid
from drystone.io.drawings import ImportSettings, Shape, imported, read_drawing
from drystone.io.drawings import compas as compas_format
from drystone.io.drawings import obj as obj_format
from drystone.io.drawings import ply as ply_format
from drystone.io.drawings import stl as stl_format
from drystone.model.construction.errors import ModelError


def kept(tmp_path: Path, name: str, contents: str | bytes) -> Path:
    path = tmp_path / name
    path.write_bytes(contents if isinstance(contents, bytes) else contents.encode())
    return path


def blocks_of(path: Path, **settings):
    given = {"unit": "m", **({"up": "z"} if path.suffix not in (".dxf", ".json") else {})}
    return imported(
        ImportSettings(file=path, **{**given, **settings}), lambda layer: ("stone", 2e4)
    )


def volumes(made):
    return [solid.volume_of(b.vertices, b.faces) for b in made.blocks]


def shapes(blocks=None):
    return [
        Shape(name=n, vertices=v, faces=tuple(f), layer="stone", support=n.startswith("c0"))
        for n, v, f in blocks or brick_wall()
    ]


class TestObj:
    def test_an_object_is_a_block(self, tmp_path):
        made = blocks_of(kept(tmp_path, "wall.obj", obj_text(brick_wall())))
        assert [b.id for b in made.blocks] == [n for n, _, _ in brick_wall()]
        assert volumes(made) == pytest.approx([0.4 * 0.15 * 0.2] * 6, rel=1e-9)

    def test_groups_are_blocks_where_there_are_no_objects(self, tmp_path):
        text = obj_text(brick_wall()).replace("o ", "g ")
        assert len(blocks_of(kept(tmp_path, "a.obj", text)).blocks) == 6

    def test_connected_surfaces_are_blocks_where_there_is_neither(self, tmp_path):
        lines = obj_text(brick_wall()).splitlines()
        text = "\n".join(line for line in lines if not line.startswith("o "))
        made = blocks_of(kept(tmp_path, "a.obj", text))
        assert [b.id for b in made.blocks] == [f"b{k}" for k in range(1, 7)]

    def test_rows_counted_backwards_textures_and_long_lines(self, tmp_path):
        vertices, faces = box((0, 0, 0), (1, 1, 1))
        lines = ["o a b", "usemtl stone", "g south"]
        lines += ["v " + " ".join(map(str, v)) for v in vertices.tolist()]
        lines += ["f " + " ".join(f"{i - 8}/1/1" for i in face) for face in faces[:-1]]
        lines += ["f 4//2 1//2 \\", " 5 8 # the last one"]
        drawing = read_drawing(kept(tmp_path, "a.obj", "\r\n".join(lines)))
        (shape,) = drawing.shapes
        assert (shape.name, shape.layer, shape.groups) == ("a b", "stone", ("south",))
        assert shape.faces == (*faces[:-1], (3, 0, 4, 7))

    def test_what_is_written_reads_back(self, tmp_path):
        text = obj_format.write(shapes(), "a wall")
        drawing = read_drawing(kept(tmp_path, "a.obj", text))
        for shape, (name, vertices, faces) in zip(drawing.shapes, brick_wall(), strict=True):
            assert (shape.name, shape.layer, shape.faces) == (name, "stone", faces)
            assert shape.vertices.tobytes() == vertices.tobytes()

    @pytest.mark.parametrize("heading", ["o all", "", "o {}"])
    def test_each_solid_is_of_the_material_of_its_faces(self, tmp_path, heading):
        # One object, none at all, and objects with the same name: the first material was that of
        # all.
        lines, first = ["o all"] * (heading == "o all"), 1
        layers = ["stone", "brick", "stone", "brick", "brick", "tuff"]
        for layer, (_, vertices, faces) in zip(layers, brick_wall(), strict=True):
            lines += ["o Cube"] * (heading == "o {}") + [f"usemtl {layer}"]
            lines += ["v " + " ".join(map(str, v)) for v in vertices.tolist()]
            lines += ["f " + " ".join(str(first + i) for i in face) for face in faces]
            first += len(vertices)
        drawing = read_drawing(kept(tmp_path, "a.obj", "\n".join(lines)))
        assert [shape.layer for shape in drawing.shapes] == layers
        assert not drawing.notes
        name = {"o all": "all/{}", "": "b{}", "o {}": "Cube/{}"}[heading]
        assert [shape.name for shape in drawing.shapes] == [name.format(k) for k in range(1, 7)]

    def test_a_solid_with_faces_of_several_materials_is_told(self, tmp_path):
        vertices, faces = box((0, 0, 0), (1, 1, 1))
        lines = ["o a", *("v " + " ".join(map(str, v)) for v in vertices.tolist()), "usemtl stone"]
        rows = ["f " + " ".join(str(1 + i) for i in face) for face in faces]
        text = "\n".join([*lines, *rows[:2], "usemtl plaster", *rows[2:]])
        drawing = read_drawing(kept(tmp_path, "a.obj", text))
        assert [shape.layer for shape in drawing.shapes] == ["stone"]
        assert drawing.notes == (
            'of several materials are faces of "a", taken to be of that of its first face: give '
            "each block one",
        )

    def test_a_number_sign_is_a_letter_of_a_name(self, tmp_path):
        """Elsewhere a comment begins with it."""
        text = obj_text(brick_wall()[:1]).replace("o c0u0", "o stone #1\nusemtl granite #2")
        drawing = read_drawing(kept(tmp_path, "a.obj", text.replace("f ", "f ", 1) + "# end #\n"))
        assert [(shape.name, shape.layer) for shape in drawing.shapes] == [
            ("stone #1", "granite #2")
        ]

    @pytest.mark.parametrize("encoding", ["utf-8", "utf-8-sig", "latin-1"])
    def test_names_in_the_letters_of_older_programs(self, tmp_path, encoding):
        text = obj_text(brick_wall()[:1]).replace("o c0u0", "o Säule")
        path = kept(tmp_path, "a.obj", text.encode(encoding))
        assert [shape.name for shape in read_drawing(path).shapes] == ["Säule"]

    @pytest.mark.parametrize("heading", ["o a\n", ""])
    @pytest.mark.parametrize("sense", [1, -1])
    @pytest.mark.parametrize("again", [(0,), (0, 2), (0, 1, 2, 3, 4, 5)])
    def test_faces_that_are_drawn_again(self, tmp_path, again, sense, heading):
        """In either sense, and also where the surfaces of the file are the blocks."""
        vertices, faces = box((0, 0, 0), (1, 1, 1))
        doubled = [*faces, *(faces[k][::sense] for k in again)]
        text = obj_text([("a", vertices, doubled)]).replace("o a\n", heading)
        made = blocks_of(kept(tmp_path, "a.obj", text))
        assert volumes(made) == pytest.approx([1.0])
        assert [one.what for one in made.mended] == ["had faces that were drawn twice"]

    @pytest.mark.parametrize(
        ("text", "said"),
        [
            ("v 0 0\n", "line 1: a vertex needs three numbers"),
            ("v 0 0 x\n", 'line 1: "x" is no number'),
            ("v 0 0 nan\n", 'line 1: "nan" is no place'),
            ("v 0 0 0\nf 1 2 3\n", "line 2: there is no vertex 2 up to here, only 1"),
            ("v 0 0 0\nf 1 1\n", "line 2: a face needs three vertices"),
            ("v 0 0 0\nf a 1 1\n", 'line 2: "a" is no whole number'),
            ("v 0 0 0\n", "holds no faces"),
            ("  \n", "is empty"),
        ],
    )
    def test_what_is_said_of_broken_ones(self, tmp_path, text, said):
        with pytest.raises(ModelError) as error:
            blocks_of(kept(tmp_path, "a.obj", text))
        assert str(error.value).startswith('"a.obj": ')
        assert said in str(error.value)


class TestStl:
    def test_text_keeps_names(self, tmp_path):
        text = stl_format.write(shapes(), "a wall")
        made = blocks_of(kept(tmp_path, "a.stl", text))
        assert [b.id for b in made.blocks] == [n for n, _, _ in brick_wall()]
        assert volumes(made) == pytest.approx([0.4 * 0.15 * 0.2] * 6, rel=1e-9)

    def test_binary_is_cut_into_connected_surfaces(self, tmp_path):
        made = blocks_of(kept(tmp_path, "a.stl", binary_stl(brick_wall())))
        assert len(made.blocks) == 6
        # Numbers of 24 bits at seven metres: half a micrometre of 0.15 m, three sides.
        assert volumes(made) == pytest.approx([0.4 * 0.15 * 0.2] * 6, rel=1e-5)
        assert all(len(b.faces) == 6 for b in made.blocks)

    def test_torn_ones_are_refused(self, tmp_path):
        whole = binary_stl(brick_wall())
        for contents, said in (
            (whole[:-7], "says 72 triangles"),
            (b"abc", "too short"),
            (b"solid a\nfacet\nouter loop\nvertex 0 0\n", "three numbers"),
            (b"solid a\nendsolid a\n" + b" " * 80, "holds no triangles"),
        ):
            with pytest.raises(ModelError, match=said):
                blocks_of(kept(tmp_path, "a.stl", contents))


def binary_stl(blocks) -> bytes:
    triangles = [
        (v[f[0]], v[f[k]], v[f[k + 1]])
        for _, v, fs in blocks
        for f in fs
        for k in range(1, len(f) - 1)
    ]
    rows = b"".join(
        struct.pack("<12fH", 0, 0, 0, *(float(x) for p in t for x in p), 0) for t in triangles
    )
    return b"made by a test".ljust(80) + struct.pack("<I", len(triangles)) + rows


class TestPly:
    def test_text_keeps_blocks_and_names(self, tmp_path):
        made = blocks_of(kept(tmp_path, "a.ply", ply_format.write(shapes(), "a wall")))
        assert [b.id for b in made.blocks] == [n for n, _, _ in brick_wall()]

    def test_a_block_may_be_called_as_the_end_of_the_header(self, tmp_path):
        (_, vertices, faces), *_ = brick_wall()
        text = ply_format.write(shapes([("end_header", vertices, faces)]), "end_header")
        assert [b.id for b in blocks_of(kept(tmp_path, "a.ply", text)).blocks] == ["end_header"]

    @pytest.mark.parametrize("order", ["<", ">"])
    def test_binary_with_other_columns(self, tmp_path, order):
        name = {"<": "little", ">": "big"}[order]
        vertices, faces = box((0, 0, 0), (1, 1, 2))
        head = (
            f"ply\nformat binary_{name}_endian 1.0\nelement vertex 8\nproperty float x\n"
            "property float y\nproperty float z\nproperty uchar red\nelement face 6\n"
            "property list uchar int vertex_index\nproperty float quality\nend_header\n"
        ).encode()
        body = b"".join(struct.pack(order + "3fB", *v, 7) for v in vertices)
        body += b"".join(struct.pack(order + "B4if", 4, *f, 0.5) for f in faces)
        made = blocks_of(kept(tmp_path, "a.ply", head + body))
        assert volumes(made) == pytest.approx([2.0], rel=1e-6)
        with pytest.raises(ModelError, match="ends in face 6"):
            blocks_of(kept(tmp_path, "b.ply", head + body[:-5]))

    def test_what_is_said_of_broken_ones(self, tmp_path):
        for text, said in (
            ("plx", "is no PLY file"),
            ("ply\nformat ascii 1.0\nend_header\n", "no faces"),
            ("ply\nformat odd 1.0\nend_header\n", 'format "odd"'),
            ("ply\nformat ascii 1.0\nelement vertex 99999999999\nend_header\n", "are the most"),
            (
                "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nend_header\n1\n",
                "no x, y and z",
            ),
        ):
            with pytest.raises(ModelError, match=said):
                blocks_of(kept(tmp_path, "a.ply", text))


def mesh_data(vertices, faces):
    return {
        "vertex": {
            str(k): dict(zip("xyz", v, strict=True)) for k, v in enumerate(vertices.tolist())
        },
        "face": {str(k): list(f) for k, f in enumerate(faces)},
    }


def moved(x, y, z):
    """The matrix of a translation."""
    return [[1, 0, 0, x], [0, 1, 0, y], [0, 0, 1, z], [0, 0, 0, 1]]


def turned_about_z():
    """The matrix of a quarter turn: x becomes y, and y becomes -x."""
    return [[0, -1, 0, 0], [1, 0, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]]


def element(mesh=None, *, kind="BlockElement", name="", support=False, matrix=None):
    """An element as a model of compas_model writes it: a class, and a mesh if that has one."""
    geometry = mesh and {"dtype": "compas.datastructures/Mesh", "data": mesh_data(*mesh)}
    motion = {"dtype": "compas.geometry/Transformation", "data": {"matrix": matrix}}
    data = {
        "name": name or kind,
        "is_support": support,
        "transformation": motion if matrix else None,
        "geometry": geometry,
    }
    return {"dtype": f"compas_dem.elements/{kind}", "data": data}


class TestCompas:
    """The layouts of several versions; the fields that matter are all that is written."""

    def check(self, path, supports):
        made = blocks_of(path)
        assert len(made.blocks) == 6
        assert [b.id for b in made.blocks if b.support] == supports
        assert volumes(made) == pytest.approx([0.4 * 0.15 * 0.2] * 6, rel=1e-9)

    def test_what_is_written_reads_back(self, tmp_path):
        path = kept(tmp_path, "a.json", compas_format.write(shapes(), "a wall"))
        self.check(path, ["c0u0", "c0u1"])

    def test_blocks_beside_an_assembly_as_the_oldest(self, tmp_path):
        data = {
            "blocks": {str(k): mesh_data(v, f) for k, (_, v, f) in enumerate(brick_wall())},
            "assembly": {"vertex": {"0": {"is_support": True}, "1": {"is_support": False}}},
        }
        self.check(kept(tmp_path, "a.json", json.dumps(data)), ["0"])

    def test_elements_of_a_model_as_the_newest(self, tmp_path):
        elements = [
            element((v - [1, 2, 3], f), name=n, support=n == "c0u0", matrix=moved(1.0, 2.0, 3.0))
            for n, v, f in brick_wall()
        ]
        data = {"dtype": "compas_dem.models/BlockModel", "data": {"elements": elements}}
        path = kept(tmp_path, "a.json", json.dumps(data))
        self.check(path, ["c0u0"])
        made = blocks_of(path)
        for block, (name, vertices, _) in zip(made.blocks, brick_wall(), strict=True):
            assert block.id == name
            assert np.abs(block.vertices - vertices).max() < 1e-12

    def test_a_group_moves_its_elements(self, tmp_path):
        """Elements lie side by side, and a tree tells which is a part of which."""
        low, high = "low", "high"
        elements = {
            "inner": element(kind="Group", matrix=turned_about_z()),
            "outer": element(kind="Group", matrix=moved(10.0, 0.0, 0.0)),
            low: element(box((1, 0, 0), (2, 1, 1)), matrix=moved(0.0, 0.0, 1.0)),
            high: element(box((0, 0, 2), (1, 1, 3))),
        }
        part = [{"name": "ElementNode", "element": low}]
        inner = [{"name": "ElementNode", "element": "inner", "children": part}]
        outer = {"name": "ElementNode", "element": "outer", "children": inner}
        root = {"name": "root", "children": [outer, {"name": "ElementNode", "element": high}]}
        for table in (elements, [{"guid": key, **own} for key, own in elements.items()]):
            data = {"elements": table, "tree": {"root": root}}
            data |= {"transformation": {"data": {"matrix": moved(0.0, 5.0, 0.0)}}}
            made = blocks_of(kept(tmp_path, "a.json", json.dumps({"data": data})))
            # Up by 1, a quarter turn about z, 10 along x, and with the whole model 5 along y.
            first, second = (block.vertices for block in made.blocks)
            assert first.min(axis=0) == pytest.approx([9.0, 6.0, 1.0])
            assert first.max(axis=0) == pytest.approx([10.0, 7.0, 2.0])
            assert second.min(axis=0) == pytest.approx([0.0, 5.0, 2.0])
            assert not made.notes

    def test_elements_have_the_names_that_they_were_given(self, tmp_path):
        at = [box((0, 0, k), (1, 1, k + 1)) for k in range(5)]
        names = ["pier", "twice", "twice", "BlockElement", ""]
        elements = {
            f"guid{k}": element(one, name=name)
            for k, (one, name) in enumerate(zip(at, names, strict=True))
        }
        made = blocks_of(kept(tmp_path, "a.json", json.dumps({"elements": elements})))
        assert [b.id for b in made.blocks] == ["pier", "guid1", "guid2", "guid3", "guid4"]

    def test_boxes_are_read_in_their_frames(self, tmp_path):
        frame = {"point": [10.0, 0.0, 0.0], "xaxis": [0.0, 2.0, 0.0], "yaxis": [-1.0, 0.5, 0.0]}
        sides = {"xsize": 1.0, "ysize": 2.0, "zsize": 4.0}
        for own in (frame, {"dtype": "compas.geometry/Frame", "data": frame}):
            data = {"dtype": "compas.geometry/Box", "data": {**sides, "frame": own}}
            made = blocks_of(kept(tmp_path, "a.json", json.dumps({"pier": data})))
            (block,) = made.blocks
            assert block.id == "pier"
            # The first axis is y; the second, square to it, is -x.
            assert block.vertices.min(axis=0) == pytest.approx([9.0, -0.5, -2.0])
            assert block.vertices.max(axis=0) == pytest.approx([11.0, 0.5, 2.0])
            assert volumes(made) == pytest.approx([8.0])

    @pytest.mark.parametrize(
        ("change", "said"),
        [
            ({"xsize": 0.0}, 'block "pier": its box has a side that is not above zero'),
            ({"ysize": "a"}, 'block "pier": a side of its box is no finite number'),
            ({"frame": {"point": [0, 0, 0]}}, 'block "pier": the xaxis of its frame'),
            (
                {"frame": {"point": [0, 0, 0], "xaxis": [1, 0, 0], "yaxis": [2, 0, 0]}},
                'block "pier": the axes of its frame are in one line',
            ),
        ],
    )
    def test_torn_boxes_are_told(self, tmp_path, change, said):
        frame = {"point": [0, 0, 0], "xaxis": [1, 0, 0], "yaxis": [0, 1, 0]}
        data = {"xsize": 1.0, "ysize": 1.0, "zsize": 1.0, "frame": frame} | change
        path = kept(tmp_path, "a.json", json.dumps({"pier": {"data": data}}))
        with pytest.raises(ModelError, match=said):
            blocks_of(path)

    def test_what_has_no_mesh_is_counted(self, tmp_path):
        ball = {"dtype": "compas.geometry/Sphere", "data": {"radius": 1.0}}
        brep = {"dtype": "compas_occ.brep/OCCBrep", "data": {"vertices": [{}], "faces": [{}]}}
        empty = {"dtype": "compas.datastructures/Mesh", "data": {"vertex": {}, "face": {}}}
        stone = box((0, 0, 0), (1, 1, 1))
        notch = {"dtype": "compas_dem.elements/BlockFeature", "data": mesh_data(*stone)}
        elements = {
            "a": element(stone, name="a") | {"features": [notch]},
            "b": element(kind="ColumnElement"),
            "c": element(kind="Group"),
            "d": {"dtype": "compas_dem.elements/Block", "data": {"geometry": brep}},
        }
        data = {"elements": elements, "beside": [ball, ball, empty]}
        made = blocks_of(kept(tmp_path, "a.json", json.dumps(data)))
        assert [b.id for b in made.blocks] == ["a"]
        assert [note.split(": ", 1)[1] for note in made.notes] == [
            "1 left out: BlockFeature, a feature",
            "1 left out: ColumnElement",
            "1 left out: Mesh",
            "1 left out: OCCBrep",
            "2 left out: Sphere",
        ]
        path = kept(tmp_path, "b.json", json.dumps([ball, ball]))
        with pytest.raises(ModelError, match=r"holds no meshes \(2 left out: Sphere\)"):
            blocks_of(path)

    def test_what_lies_between_two_blocks_is_none(self, tmp_path):
        plate = np.array([[0, 0, 1], [1, 0, 1], [1, 1, 1], [0, 1, 1]], float)
        mesh = {"dtype": "compas.datastructures/Mesh", "data": mesh_data(plate, [(0, 1, 2, 3)])}
        joint = {"dtype": "compas_dem.interactions/FrictionContact", "data": {"mesh": mesh}}
        nodes = {
            repr(name): {"block": mesh_data(*box((0, 0, k), (1, 1, k + 1))), "is_support": k == 0}
            for k, name in enumerate(("edge", "contacts"))
        }
        graphs = [
            {"node": nodes, "edge": {"'edge'": {"'contacts'": {"interfaces": [{"mesh": mesh}]}}}},
            {"node": nodes, "edge": {"'edge'": {"'contacts'": {"contacts": [joint]}}}},
            {"node": nodes, "joints": [joint]},
            {"node": {key.strip("'"): own for key, own in nodes.items()}, "interfaces": [mesh]},
        ]
        for graph in graphs:
            made = blocks_of(kept(tmp_path, "a.json", json.dumps({"graph": graph})))
            assert [(b.id, b.support) for b in made.blocks] == [("edge", True), ("contacts", False)]

    @pytest.mark.parametrize(
        "name", ["a'b", 'a "b"', "back\\slash", "7", "semicircle/left", "tree"]
    )
    def test_nodes_have_the_literals_of_their_names_as_keys(self, tmp_path, name):
        (first, *_) = shapes()
        text = compas_format.write([replace(first, name=name)], "a wall")
        (key,) = json.loads(text)["data"]["graph"]["data"]["node"]
        assert str(ast.literal_eval(key)) == name
        assert [b.id for b in blocks_of(kept(tmp_path, "a.json", text)).blocks] == [name]

    def test_keys_of_nodes_that_are_no_literals_are_names(self, tmp_path):
        for key in ("it's", "'torn", "'a' b'", "(1, 2)", "'\\d'"):
            data = {"node": {key: {"block": mesh_data(*box((0, 0, 0), (1, 1, 1)))}}}
            (block,) = blocks_of(kept(tmp_path, "a.json", json.dumps(data))).blocks
            assert block.id == {"'\\d'": "\\d"}.get(key, key)

    def test_half_edges_and_polyhedra(self, tmp_path):
        vertices, faces = box((0, 0, 0), (1, 1, 1))
        ahead = [{str(a): str(b) for a, b in zip(f, f[1:] + f[:1], strict=True)} for f in faces]
        old = mesh_data(vertices, faces) | {"face": dict(zip("abcdef", ahead, strict=True))}
        solid_data = {"vertices": vertices.tolist(), "faces": [list(f) for f in faces]}
        for data in ({"blocks": {"7": old}}, {"data": {"block": {"7": solid_data}}}):
            made = blocks_of(kept(tmp_path, "a.json", json.dumps(data)))
            assert [b.id for b in made.blocks] == ["7"]
            assert volumes(made) == pytest.approx([1.0])

    def test_flat_supports_are_given_a_thickness_and_other_flat_blocks_refused(self, tmp_path):
        plate = np.array([[-1, -1, 0], [2, -1, 0], [2, 2, 0], [-1, 2, 0]], float)
        stone = box((0, 0, 0), (1, 1, 1))
        for held in (True, False):
            data = {
                "blocks": {"0": mesh_data(plate, [(0, 1, 2, 3)]), "1": mesh_data(*stone)},
                "assembly": {"vertex": {"0": {"is_support": held}}},
            }
            path = kept(tmp_path, "a.json", json.dumps(data))
            if held:
                made = blocks_of(path)
                low = made.blocks[0].vertices
                assert (low[:, 2].min(), low[:, 2].max()) == pytest.approx((-0.3, 0.0))
                assert made.mended[0].how_much == pytest.approx(0.3)  # a tenth of 3 m
            else:
                with pytest.raises(ModelError, match='"0": it is flat'):
                    blocks_of(path)

    @pytest.mark.parametrize(
        ("text", "said"),
        [
            ("{", "line 1, column 2: not valid JSON"),
            ("[" * 10000, "no JSON that an assembly has|not valid JSON"),
            ("{}", "holds no meshes"),
            ('{"blocks": {"0": {"vertex": {"0": {"x": 1}}, "face": {"0": [0]}}}}', "finite x, y"),
            (
                '{"blocks": {"0": {"vertex": {"0": {"x": 1, "y": 0, "z": 0}}, "face": {"0": [5]}'
                "}}}",
                "names vertex 5",
            ),
            (
                '{"blocks": {"0": {"vertex": {"0": {"x": 1, "y": 0, "z": 0}}, '
                '"face": {"0": ["\u202e5"]}}}}',
                r"names vertex \\u202e5",  # nothing that turns the sentence round
            ),
        ],
    )
    def test_what_is_said_of_broken_ones(self, tmp_path, text, said):
        with pytest.raises(ModelError, match=said):
            blocks_of(kept(tmp_path, "a.json", text))


BODIES = """\
! File BODIES

$bdyty
 RBDY2      1
$blmty
 PLAIN      1  behav  TDURx  avrd= 0.1000000D+01  gyrd= 0.0000000D+00
$nodty
 NO3xx      1                coo1= 0.1000000D+01  coo2= 0.2000000D+01  coo3= 0.0000000D+00
$tacty
 POLYG      1  color  BLEUx  nb_vertex=      4
                             coo1=-0.5000000D+00  coo2=-0.5000000D+00
                             coo1= 0.5000000D+00  coo2=-0.5000000D+00
                             coo1= 0.5000000D+00  coo2= 0.5000000D+00
                             coo1=-0.5000000D+00  coo2= 0.5000000D+00
$$$$$$
"""


def bodies_3d(blocks) -> str:
    lines = ["! File BODIES", ""]
    for k, (_, vertices, faces) in enumerate(blocks, 1):
        middle = vertices.mean(axis=0)
        cut = [(f[0], f[i], f[i + 1]) for f in faces for i in range(1, len(f) - 1)]
        number = lambda x: f"{x: .14E}".replace("E", "D")  # noqa: E731
        lines += ["$bdyty", f" RBDY3      {k}", "$blmty"]
        lines += [" PLAIN      1  behav  STONE  avrd= 0.0D+00", "$nodty"]
        lines += [
            " NO6xx      1   " + "".join(f"coo{i}={number(x)}  " for i, x in enumerate(middle, 1))
        ]
        lines += ["     " + "".join(f"coo{i}={number(0.0)}  " for i in (4, 5, 6)), "$tacty"]
        lines += [f" POLYR      1  color  REDxx  nb_vertex={len(vertices)}  nb_faces={len(cut)}"]
        lines += [
            "   " + "".join(f"coo{i}={number(x)}  " for i, x in enumerate(v - middle, 1))
            for v in vertices
        ]
        lines += ["   " + "".join(f"ver{i}={j + 1}  " for i, j in enumerate(f, 1)) for f in cut]
        lines += ["$$$$$$"]
    return "\n".join(lines) + "\n"


class TestBodies:
    def test_a_polygon(self, tmp_path):
        (tmp_path / "DRV_DOF.DAT").write_text(
            "$bdyty\n RBDY2  1\n$dofty\n"
            + "".join(f" vlocy {n} CT= 0.0\n" for n in (1, 2, 3))
            + "$$$$$$\n"
        )
        path = kept(tmp_path, "BODIES.DAT", BODIES)
        made = imported(ImportSettings(file=path), lambda layer: (layer, 2e4), 2)
        (block,) = made.blocks
        assert (block.id, block.material, block.groups) == ("rbdy21", "TDURx", ("TDURx", "BLEUx"))
        assert block.support
        assert block.vertices.tolist() == [[0.5, 1.5], [1.5, 1.5], [1.5, 2.5], [0.5, 2.5]]

    @pytest.mark.parametrize(
        ("rows", "held"),
        [
            ("vlocy 2 CT= 0.0\n", ("y",)),
            ("vlocy 1 0.0 0.0 0.0 0.0 1.0 0.0\nvlocy 3 0.0D0\n", ("x", "turn")),
            ("force 1 5.0\n", ()),
        ],
    )
    def test_what_is_driven_in_part_is_held_by_rollers(self, tmp_path, rows, held):
        """It was taken for a support."""
        (tmp_path / "DRV_DOF.DAT").write_text(f"$bdyty\n RBDY2  1\n$dofty\n{rows}$$$$$$\n")
        (block,) = blocks_of(kept(tmp_path, "BODIES.DAT", BODIES), up=None).blocks
        assert not block.support and block.held == held

    @pytest.mark.parametrize(
        ("row", "said"),
        [
            ("vlocy 1 0.5 0.0 0.0 0.0 1.0 0.0", "DRV_DOF.DAT line 4: a body is driven at a speed"),
            ("vlocy 1 0.0 0.1 6.3 0.0 1.0 0.0", "driven at a speed"),
            ("vlocy 1 evolution motion.dat", "driven at a speed"),
        ],
    )
    def test_bodies_that_are_driven_at_a_speed_are_refused(self, tmp_path, row, said):
        (tmp_path / "DRV_DOF.DAT").write_text(f"$bdyty\n RBDY2  1\n$dofty\n{row}\n$$$$$$\n")
        with pytest.raises(ModelError, match=said):
            blocks_of(kept(tmp_path, "BODIES.DAT", BODIES), up=None)

    def test_rollers_are_not_turned(self, tmp_path):
        (tmp_path / "DRV_DOF.DAT").write_text("$bdyty\n RBDY2  1\n$dofty\nvlocy 2 0.0\n$$$$$$\n")
        path = kept(tmp_path, "BODIES.DAT", BODIES)
        with pytest.raises(ModelError, match="rollers stay along the axes"):
            blocks_of(path, up=None, rotation=(30.0,))

    def test_polyhedra_along_their_axes_of_inertia(self, tmp_path):
        """As the preprocessor writes them: vertices along axes that DOF.INI has, in columns."""
        blocks, rng = brick_wall(), np.random.default_rng(4)
        along, state = [], ["! DOF", "$steps      0                time= 0.0000000D+00"]
        for k, (name, vertices, faces) in enumerate(blocks, 1):
            axes = np.linalg.qr(rng.normal(size=(3, 3)))[0]
            axes[:, 2] *= np.linalg.det(axes)
            middle, moved = vertices.mean(axis=0), 0.25 * k
            along.append((name, (vertices - middle) @ axes + middle - [0.0, 0.0, moved], faces))
            state += ["$bdyty", f" RBDY3  {k:7d}", "$nodty", f" NO6xx      1    X(3)={moved: .7e}"]
            state += [f"  V({n})= 0.0" for n in (1, 2, 3)]
            state += [
                "    ".join(f"{key}({n})={x: .12e}" for n, x in enumerate(column, 1))
                for key, column in zip("abg", axes.T, strict=True)
            ]
            state += ["$$$$$$"]
        text = bodies_3d(along).replace("avrd= 0.0D+00", "avrd= 0.1 \n   I1  = 0.3D-02  I2  = 1.0")
        path = kept(tmp_path, "BODIES.DAT", re.sub(r"(?m)^(   coo1.*)coo3=", r"\1coor=", text))
        kept(tmp_path, "DOF.INI", "\n".join(state))
        made = imported(ImportSettings(file=path, tolerance=0.0), lambda layer: (layer, 2e4))
        for block, (_, vertices, _) in zip(made.blocks, blocks, strict=True):
            assert len(block.vertices) == 8
            away = np.linalg.norm(block.vertices[:, None] - vertices, axis=2)
            assert away.min(axis=1).max() < 1e-10  # of the digits
        assert not any("DOF.INI" in note for note in made.notes)
        (tmp_path / "DOF.INI").unlink()
        with_none = imported(ImportSettings(file=path), lambda layer: (layer, 2e4))
        assert any("there is no DOF.INI beside it" in note for note in with_none.notes)
        assert with_none.sha256 != made.sha256

    def test_axes_that_are_no_frame_are_refused(self, tmp_path):
        path = kept(tmp_path, "BODIES.DAT", bodies_3d(brick_wall()[:1]))
        lines = ("a(1)= 1.0 a(2)= 0.0 a(3)= 0.0", "b(1)= 0.0 b(2)= 1.0 b(3)= 0.0",
                 "g(1)= 0.0 g(2)= 0.0 g(3)=-1.0")  # fmt: skip
        kept(tmp_path, "DOF.INI", "\n".join((" RBDY3  1", *lines)))
        with pytest.raises(ModelError, match=r"its axes in DOF\.INI are no right-handed frame"):
            imported(ImportSettings(file=path), lambda layer: (layer, 2e4))

    def test_polyhedra(self, tmp_path):
        path = kept(tmp_path, "BODIES.DAT", bodies_3d(brick_wall()))
        made = imported(ImportSettings(file=path), lambda layer: (layer, 2e4))
        assert volumes(made) == pytest.approx([0.4 * 0.15 * 0.2] * 6, rel=1e-9)
        assert all(len(b.faces) == 6 for b in made.blocks)

    @pytest.mark.parametrize(
        ("old", "new", "said"),
        [
            ("$$$$$$", "", "has no end"),
            ("nb_vertex=      4", "nb_vertex=      5", "says 5 vertices"),
            ("RBDY2      1", "RBDY2      x", "no whole number"),
            ("POLYG      1", "DISKx      1", "holds no polygons"),
            ("RBDY2      1", "MAILx      1", "meshed bodies"),
        ],
    )
    def test_what_is_said_of_broken_ones(self, tmp_path, old, new, said):
        path = kept(tmp_path, "BODIES.DAT", BODIES.replace(old, new))
        with pytest.raises(ModelError, match=said):
            imported(ImportSettings(file=path), lambda layer: (layer, 2e4))


class TestSettings:
    """Units, axes, place, supports: what the file does not say is asked for."""

    @pytest.fixture
    def path(self, tmp_path):
        return kept(tmp_path, "a.obj", obj_text(brick_wall()))

    def test_unit_and_up_are_asked_for(self, path):
        with pytest.raises(ModelError, match="unit is missing"):
            blocks_of(path, unit=None)
        with pytest.raises(ModelError, match="up is missing"):
            blocks_of(path, up=None)

    @pytest.mark.parametrize(("unit", "metres"), [("mm", 1e-3), ("cm", 1e-2), ("ft", 0.3048)])
    def test_units(self, path, unit, metres):
        assert sum(volumes(blocks_of(path, unit=unit))) == pytest.approx(
            0.072 * metres**3, rel=1e-9
        )

    def test_y_up_becomes_z_up(self, tmp_path):
        vertices, faces = box((0, 0, 0), (1, 2, 3))
        path = kept(tmp_path, "a.obj", obj_text([("a", vertices, faces)]))
        made = blocks_of(path, up="y")
        (block,) = made.blocks
        assert np.ptp(block.vertices, axis=0).tolist() == [1.0, 3.0, 2.0]
        assert volumes(made) == pytest.approx([6.0])
        assert "y pointed up" in made.notes[0]

    def test_rotation_and_then_origin(self, path):
        plain, turned = blocks_of(path), blocks_of(path, rotation=(90.0,), origin=(1.0, 2.0, 3.0))
        for a, b in zip(plain.blocks, turned.blocks, strict=True):
            x, y, z = a.vertices.T
            assert np.array_equal(b.vertices, np.column_stack((-y, x, z)) + [1.0, 2.0, 3.0])
        about_x = blocks_of(path, rotation=(90.0, 0.0, 90.0))
        x, y, z = plain.blocks[0].vertices.T
        assert np.array_equal(about_x.blocks[0].vertices, np.column_stack((z, x, y)))

    def test_supports_by_name_group_layer_and_height(self, tmp_path, path):
        names = [n for n, _, _ in brick_wall()]
        held = lambda made: [b.id for b in made.blocks if b.support]  # noqa: E731
        assert held(blocks_of(path, support=("c0*",))) == names[:2]
        assert held(blocks_of(path, support=("c?u1",))) == names[1::2]
        assert held(blocks_of(path, support_below=0.1)) == names[:2]
        assert held(blocks_of(path, support_below=0.21)) == names[:4]
        with pytest.raises(ModelError, match='no block, group or layer "c9"'):
            blocks_of(path, support=("c9",))
        with pytest.raises(ModelError, match="no block reaches below -1 m"):
            blocks_of(path, support_below=-1.0)
        text = obj_text(brick_wall()).replace("o c1u0", "o c1u0\nusemtl Support")
        text = text.replace("o c1u1", "o c1u1\nusemtl stone")  # a material holds until the next
        assert held(blocks_of(kept(tmp_path, "b.obj", text))) == ["c1u0"]

    def test_names_and_groups(self, path):
        made = blocks_of(path, name="south", group="walls")
        assert made.blocks[0].id == "south/c0u0"
        assert made.blocks[0].groups == ("walls",)

    def test_formats_and_files_that_are_not_there(self, tmp_path, path):
        for file, settings, said in (
            (tmp_path / "none.obj", {}, "there is no such file"),
            (tmp_path, {"format": "obj"}, "is a folder"),
            (path.with_suffix(".xyz"), {}, 'ending ".xyz" belongs to no format'),
            (path, {"format": "objx"}, 'no format "objx": did you mean "obj"'),
        ):
            with pytest.raises(ModelError, match=said):
                blocks_of(file, **settings)
