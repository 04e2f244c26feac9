"""DXF and IFC by their libraries, where these are installed."""

from __future__ import annotations

import importlib
import io
import os
from pathlib import Path

import numpy as np
import pytest

from drawn import box, brick_wall
from drystone.geometry.plane import polygon
from drystone.geometry.space import solid
from drystone.io.drawings import ImportSettings, Shape, imported
from drystone.io.drawings import dxf as dxf_format
from drystone.model.construction.errors import ModelError

ezdxf = pytest.importorskip("ezdxf")

SQUARE = [(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)]


def drawing(unit=6):
    document = ezdxf.new("R2010", units=unit)
    return document, document.modelspace()


def saved(tmp_path: Path, document) -> Path:
    path = tmp_path / "a.dxf"
    document.saveas(path)
    return path


def blocks_of(path: Path, dimension=None, **settings):
    return imported(
        ImportSettings(file=path, **settings), lambda layer: (layer or "stone", 2e4), dimension
    )


class TestPlane:
    def test_closed_polylines_by_layer(self, tmp_path):
        document, space = drawing()
        space.add_lwpolyline(SQUARE, close=True, dxfattribs={"layer": "brick"})
        high = [(x, y + 1.0) for x, y in SQUARE]
        space.add_lwpolyline([*high, high[0]], dxfattribs={"layer": "brick"})
        low = [(x, y - 1.0) for x, y in SQUARE[::-1]]
        space.add_polyline2d(low, close=True, dxfattribs={"layer": "Support"})
        space.add_lwpolyline([(5, 5), (6, 6)], dxfattribs={"layer": "axes"})
        space.add_text("a title", dxfattribs={"layer": "axes"})
        space.add_point((0.5, 2.0), dxfattribs={"layer": "control"})
        made = blocks_of(saved(tmp_path, document))
        assert [(b.id, b.material, b.support) for b in made.blocks] == [
            ("brick/1", "brick", False),
            ("brick/2", "brick", False),
            ("Support/3", "Support", True),
        ]
        assert [polygon.signed_area(b.vertices) for b in made.blocks] == [1.0, 1.0, 1.0]
        assert made.control == (0.5, 2.0)
        notes = "\n".join(made.notes)
        assert '1 left out: open LWPOLYLINE on layer "axes"' in notes
        assert "TEXT" not in notes
        assert "ran clockwise" in notes

    def test_arcs_become_chords(self, tmp_path):
        document, space = drawing()
        # A circle of two half arcs: a bulge of 1 is half a turn.
        space.add_lwpolyline([(1, 0, 1), (-1, 0, 1)], format="xyb", close=True)
        (block,) = blocks_of(saved(tmp_path, document)).blocks
        # Chords lie a thousandth of the radius inside at most: two thirds of it in the mean.
        area = polygon.signed_area(block.vertices)
        assert np.pi * (1.0 - 2e-3) < area < np.pi
        assert np.hypot(*block.vertices.T) == pytest.approx(np.ones(len(block.vertices)))

    def test_units_are_read_or_asked_for(self, tmp_path):
        for number, unit, size in (
            (4, None, 1e-3),
            (1, None, 0.0254),
            (0, "cm", 0.01),
            (4, "m", 1),
        ):
            document, space = drawing(number)
            space.add_lwpolyline(SQUARE, close=True)
            made = blocks_of(saved(tmp_path, document), unit=unit)
            assert np.ptp(made.blocks[0].vertices, axis=0) == pytest.approx([size, size])
            assert ("as given" in "".join(made.notes)) == (number == 4 and unit == "m")
        document, space = drawing(0)
        space.add_lwpolyline(SQUARE, close=True)
        for number, said in ((0, "none"), (14, "Decimeters")):
            document, space = drawing(number)
            space.add_lwpolyline(SQUARE, close=True)
            with pytest.raises(ModelError, match=f"the file says {said}: give"):
                blocks_of(saved(tmp_path, document))
        with pytest.raises(ModelError, match="unit is missing"):
            blocks_of(saved(tmp_path, document))

    def test_damaged_numbers_are_not_guessed_at(self, tmp_path):
        for damaged in ("3,25", "4.25x", ""):
            document, space = drawing()
            space.add_lwpolyline([(x + 3.25, y) for x, y in SQUARE], close=True)
            path = saved(tmp_path, document)
            path.write_text(path.read_text().replace("3.25\n", damaged + "\n", 1))
            try:
                made = blocks_of(path)
            except ModelError as error:
                assert str(error).startswith('"a.dxf": is ')
            else:
                assert "was read with a guess" in "".join(made.notes)

    def test_references_are_followed(self, tmp_path):
        document, space = drawing()
        own = document.blocks.new("brick")
        own.add_lwpolyline(SQUARE, close=True)
        for k in range(3):
            space.add_blockref("brick", (2.0 * k, 0.0), dxfattribs={"rotation": 90.0})
        made = blocks_of(saved(tmp_path, document))
        assert [round(float(b.vertices[:, 0].max()), 9) for b in made.blocks] == [0.0, 2.0, 4.0]

    def test_layer_0_of_a_definition_is_the_layer_of_its_reference(self, tmp_path):
        document, space = drawing()
        inner = document.blocks.new("stone")
        inner.add_lwpolyline([(0, 0), (1, 0), (1, 1), (0, 1)], close=True)
        inner.add_lwpolyline(
            [(0, 1), (1, 1), (1, 2), (0, 2)], close=True, dxfattribs={"layer": "cap"}
        )
        document.blocks.new("pier").add_blockref("stone", (0, 0))
        space.add_blockref("pier", (0, 0), dxfattribs={"layer": "brick"})
        space.add_blockref("stone", (3, 0), dxfattribs={"layer": "lime"})
        space.add_blockref("stone", (6, 0))
        made = imported(ImportSettings(file=saved(tmp_path, document)), lambda layer: (layer, 2e4))
        found = [block.material for block in made.blocks]
        assert found == ["brick", "cap", "lime", "cap", "0", "cap"]

    def test_what_the_drawing_hides_is_left_out_and_told(self, tmp_path):
        document, space = drawing()
        document.layers.add("old").freeze()
        document.layers.add("draft").off()
        document.blocks.new("stone").add_lwpolyline([(0, 0), (1, 0), (1, 1)], close=True)
        square = np.array([(0, 0), (1, 0), (1, 1), (0, 1)])
        for k, layer in enumerate(("stone", "OLD", "draft")):
            space.add_lwpolyline(square + [2 * k, 0], close=True, dxfattribs={"layer": layer})
        space.add_blockref("stone", (9, 0), dxfattribs={"layer": "old"})
        space.add_text("a text", dxfattribs={"layer": "old"})
        space.add_lwpolyline(square, close=True, dxfattribs={"layer": "stone", "invisible": 1})
        made = blocks_of(saved(tmp_path, document))
        assert [block.id for block in made.blocks] == ["stone/1"]
        told = [n.removeprefix('import "a.dxf": ') for n in made.notes if "left out" in n]
        assert told == [
            '1 left out: INSERT on layer "old", which is frozen',
            '1 left out: LWPOLYLINE on layer "OLD", which is frozen',
            '1 left out: LWPOLYLINE on layer "draft", which is switched off',
            '1 left out: invisible LWPOLYLINE on layer "stone"',
        ]

    def test_a_block_that_was_moved_to_another_layer_is_of_that_one(self, tmp_path):
        square = np.array([(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)])
        names = "abcd"
        text = dxf_format.write(
            [
                Shape(name=name, vertices=square + [k, 0], layer="stone", support=name == "d")
                for k, name in enumerate(names)
            ],
            "four",
        )
        path = tmp_path / "model.dxf"
        path.write_text(text, encoding="utf-8")
        document = ezdxf.readfile(path)
        for entity, layer in zip(
            document.modelspace(), ("brick", "Support", "stone", "brick"), strict=True
        ):
            entity.dxf.layer = layer
        made = blocks_of(saved(tmp_path, document))
        found = [(block.id, block.material, block.support) for block in made.blocks]
        assert found == [
            ("a", "brick", False),
            ("b", "stone", True),
            ("c", "stone", False),
            ("d", "brick", False),
        ]

    def test_gaps_of_a_drawing_are_closed(self, tmp_path):
        document, space = drawing()
        space.add_lwpolyline(SQUARE, close=True)
        space.add_lwpolyline([(x, y + 1.003) for x, y in SQUARE], close=True)
        made = blocks_of(saved(tmp_path, document))
        assert made.blocks[1].vertices[:, 1].min() == made.blocks[0].vertices[:, 1].max()
        assert max(r.how_much for r in made.mended) == pytest.approx(0.0015, rel=1e-6)

    def test_what_is_no_outline_is_refused(self, tmp_path):
        document, space = drawing()
        space.add_lwpolyline([(0, 0), (1, 1), (1, 0), (0, 1)], close=True)
        with pytest.raises(ModelError, match=r'"0/1": .*(crosses itself|no area)'):
            blocks_of(saved(tmp_path, document))
        document, space = drawing()
        space.add_line((0, 0), (1, 1))
        with pytest.raises(
            ModelError, match=r'no closed polylines, only 1 LINE on layer "0" \(join them to closed'
        ):
            blocks_of(saved(tmp_path, document))

    def test_a_line_that_ends_where_it_begins_to_six_digits_is_closed(self, tmp_path):
        document, space = drawing()
        space.add_lwpolyline([*SQUARE, (1e-7, 0.0)])
        space.add_polyline3d([(x + 2.0, y, 3.0) for x, y in (*SQUARE, (0.0, 1e-7))])
        space.add_lwpolyline([(x + 4.0, y) for x, y in (*SQUARE, (0.0, 1e-5))])
        made = blocks_of(saved(tmp_path, document))
        assert [len(block.vertices) for block in made.blocks] == [4, 4]
        assert '1 left out: open LWPOLYLINE on layer "0"' in "".join(made.notes)

    def test_outlines_out_of_the_plane_are_not_foreshortened(self, tmp_path):
        document, space = drawing()
        space.add_lwpolyline(SQUARE, close=True)
        space.add_lwpolyline(SQUARE, close=True, dxfattribs={"extrusion": (0.0, -0.6, 0.8)})
        space.add_polyline3d([(x, 0.0, y) for x, y in SQUARE], close=True)
        document.blocks.new("stone").add_lwpolyline(SQUARE, close=True)
        space.add_blockref("stone", (0, 0), dxfattribs={"extrusion": (0.0, -1.0, 0.0)})
        made = blocks_of(saved(tmp_path, document), 2)
        assert [block.id for block in made.blocks] == ["0/1"]
        told = "".join(made.notes)
        assert '2 left out: LWPOLYLINE on layer "0", which does not lie in the plane of x' in told
        assert '1 left out: POLYLINE on layer "0", which does not lie in the plane of x' in told
        document, space = drawing()
        space.add_polyline3d([(x, 0.0, y) for x, y in SQUARE], close=True)
        with pytest.raises(ModelError, match="turn the drawing into that plane"):
            blocks_of(saved(tmp_path, document))

    def test_elevations_of_outlines_and_flipped_axes_do_not_count(self, tmp_path):
        document, space = drawing()
        space.add_lwpolyline(SQUARE, close=True, dxfattribs={"elevation": 7.0})
        flipped = [(-x, y + 1.0) for x, y in SQUARE]
        space.add_lwpolyline(flipped, close=True, dxfattribs={"extrusion": (0.0, 0.0, -1.0)})
        made = blocks_of(saved(tmp_path, document))
        assert np.array_equal(made.blocks[1].vertices.min(axis=0), (0.0, 1.0))
        assert np.array_equal(made.blocks[1].vertices.max(axis=0), (1.0, 2.0))

    def test_what_lies_in_paper_space_is_told_where_nothing_else_is(self, tmp_path):
        document, _ = drawing()
        document.paperspace().add_lwpolyline(SQUARE, close=True)
        with pytest.raises(ModelError, match="polylines; 1 entities lie in paper space, which is"):
            blocks_of(saved(tmp_path, document))


class TestSpace:
    def test_faces_polyface_meshes_and_meshes(self, tmp_path):
        document, space = drawing()
        blocks = brick_wall()
        for _, vertices, faces in blocks[:2]:
            for face in faces:
                space.add_3dface(vertices[list(face)].tolist(), dxfattribs={"layer": "low"})
        for _, vertices, faces in blocks[2:4]:
            mesh = space.add_mesh(dxfattribs={"layer": "middle"})
            with mesh.edit_data() as data:
                data.vertices, data.faces = vertices.tolist(), [list(f) for f in faces]
        for _, vertices, faces in blocks[4:]:
            space.add_polyface(dxfattribs={"layer": "high"}).append_faces(
                [vertices[list(f)].tolist() for f in faces]
            )
        made = blocks_of(saved(tmp_path, document), support=("low",))
        volumes = [solid.volume_of(b.vertices, b.faces) for b in made.blocks]
        assert volumes == pytest.approx([0.4 * 0.15 * 0.2] * 6, rel=1e-9)
        by_layer = [b.material for b in made.blocks]
        assert sorted(by_layer) == ["high"] * 2 + ["low"] * 2 + ["middle"] * 2
        assert [b.material for b in made.blocks if b.support] == ["low", "low"]
        assert all(b.groups == (b.material,) for b in made.blocks)

    def test_what_is_written_reads_back(self, tmp_path):
        shapes = [
            Shape(name=f"{n} / south", vertices=v, faces=tuple(f), layer="stone: a",
                  groups=("x", n), support=n == "c0u0")
            for n, v, f in brick_wall()
        ]  # fmt: skip
        text = dxf_format.write(shapes, "a wall", (1.0, 2.0, 3.0))
        path = tmp_path / "a.dxf"
        path.write_text(text)
        made = blocks_of(path)
        assert made.control == (1.0, 2.0, 3.0)
        for block, shape in zip(made.blocks, shapes, strict=True):
            assert (block.id, block.material, block.support) == (
                shape.name,
                shape.layer,
                shape.support,
            )
            assert block.groups[-2:] == shape.groups
            assert block.vertices.tobytes() == shape.vertices.tobytes()

    def test_solids_with_flat_faces_are_read(self, tmp_path):
        from ezdxf.acis import api as acis
        from ezdxf.render import forms

        document, space = drawing()
        acis.export_dxf(
            space.add_3dsolid(dxfattribs={"layer": "stone"}), [acis.body_from_mesh(forms.cube())]
        )
        (block,) = blocks_of(saved(tmp_path, document)).blocks
        assert block.material == "stone"
        assert solid.volume_of(block.vertices, block.faces) == pytest.approx(1.0, rel=1e-9)

    def test_other_solids_are_asked_for_as_meshes(self, tmp_path):
        document, space = drawing()
        space.add_3dsolid().sat = ["400 0 1 0", "nobody knows this"]
        with pytest.raises(ModelError, match="export them as meshes"):
            blocks_of(saved(tmp_path, document), 3)

    def test_errors_hold_no_letters_that_steer_a_terminal(self, tmp_path):
        document, space = drawing()
        space.add_lwpolyline([(x + 3.25, y) for x, y in SQUARE], close=True)
        path = saved(tmp_path, document)
        path.write_text(path.read_text().replace("3.25\n", "3.25\x1b[31mx\x07\n", 1))
        with pytest.raises(ModelError) as caught:
            blocks_of(path)
        assert all(problem.isprintable() for problem in caught.value.problems)

    def test_what_another_file_holds_is_not_shown(self, tmp_path):
        path = tmp_path / "a.dxf"
        path.write_text("root:x:0:0:secret\n" * 40)
        with pytest.raises(ModelError, match="is no DXF file") as caught:
            blocks_of(path)
        assert "secret" not in str(caught.value)

    def test_torn_files_are_refused(self, tmp_path):
        document, space = drawing()
        space.add_lwpolyline(SQUARE, close=True)
        stream = io.StringIO()
        document.write(stream)
        for contents in ("not a drawing", stream.getvalue()[:200], "0\nSECTION\n2\nENTITIES\n"):
            path = tmp_path / "a.dxf"
            path.write_text(contents)
            with pytest.raises(ModelError, match=r'"a\.dxf": '):
                blocks_of(path, unit="m")


class IfcModel:
    """A file in millimetres of boxes on one storey, by ifcopenshell; arguments are in metres."""

    PARTS = (
        "aggregate", "context", "geometry", "material", "project", "root", "spatial", "unit",
    )  # fmt: skip

    def __init__(self):
        pytest.importorskip("ifcopenshell")
        self.api = importlib.import_module("ifcopenshell.api")
        for part in self.PARTS:
            importlib.import_module(f"ifcopenshell.api.{part}")
        self.file = self.api.project.create_file()
        project = self.make("IfcProject", "a")
        self.api.unit.assign_unit(self.file)
        model = self.api.context.add_context(self.file, context_type="Model")
        self.body = self.api.context.add_context(
            self.file,
            context_type="Model",
            context_identifier="Body",
            target_view="MODEL_VIEW",
            parent=model,
        )
        self.storey = self.make("IfcBuildingStorey", "ground")
        self.put_in(project, self.storey)

    def make(self, kind, name):
        return self.api.root.create_entity(self.file, ifc_class=kind, name=name)

    def put_in(self, whole, *parts):
        self.api.aggregate.assign_object(self.file, products=list(parts), relating_object=whole)

    def box(self, kind, name, low, high, whole=None):
        """An element on the storey, or a part of another element."""
        element = self.make(kind, name)
        vertices, faces = box(low, high)
        shape = self.api.geometry.add_mesh_representation(
            self.file,
            context=self.body,
            vertices=[vertices.tolist()],
            faces=[[list(f) for f in faces]],
        )
        self.api.geometry.assign_representation(self.file, product=element, representation=shape)
        if whole is not None:
            self.put_in(whole, element)
        elif not element.is_a("IfcFeatureElement"):
            self.api.spatial.assign_container(
                self.file, products=[element], relating_structure=self.storey
            )
        return element

    def material(self, name):
        return self.api.material.add_material(self.file, name=name)

    def layered(self, element, *layers):
        """Give an element layers of a material and a thickness [mm], as walls are exported."""
        made = self.api.material.add_material_set(
            self.file, name="layers", set_type="IfcMaterialLayerSet"
        )
        for material, thickness in layers:
            layer = self.api.material.add_layer(self.file, layer_set=made, material=material)
            layer.LayerThickness = thickness
        self.assign(element, made, "IfcMaterialLayerSetUsage")

    def assign(self, element, material, kind="IfcMaterial"):
        self.api.material.assign_material(
            self.file, products=[element], type=kind, material=material
        )

    def blocks(self, tmp_path, **settings):
        path = tmp_path / "a.ifc"
        self.file.write(str(path))
        return blocks_of(path, **settings)


def test_ifc_elements_are_blocks(tmp_path):
    model = IfcModel()
    model.box("IfcWall", "wall", (0, 0, 0), (2, 0.3, 1))
    model.box("IfcFooting", "foot", (0, 0, -0.5), (2, 0.3, 0))
    made = model.blocks(tmp_path)
    found = {b.id: (round(solid.volume_of(b.vertices, b.faces), 9), b.support) for b in made.blocks}
    assert found == {"wall": (0.6, False), "foot": (0.3, True)}
    assert all(b.groups == ("ground",) for b in made.blocks)
    path = tmp_path / "a.ifc"
    path.write_text("ISO-10303-21;\nnothing\n")
    with pytest.raises(ModelError, match=r'"a\.ifc": '):
        blocks_of(path)


def test_ifc_elements_of_any_kind_are_blocks_unless_they_are_no_masonry(tmp_path):
    model = IfcModel()
    stones = ("IfcWall", "IfcChimney", "IfcRamp", "IfcRampFlight", "IfcCovering", "IfcCivilElement")
    others = ("IfcRailing", "IfcDoor", "IfcFurniture", "IfcFlowSegment", "IfcFlowSegment")
    for k, kind in enumerate((*stones, *others)):
        model.box(kind, kind, (2 * k, 0, 0), (2 * k + 1, 1, 1))
    model.box("IfcOpeningElement", "opening", (0, 5, 0), (1, 6, 1))
    model.make("IfcStair", "nothing")
    made = model.blocks(tmp_path)
    assert [b.id for b in made.blocks] == list(stones)
    notes = [note.split(": ", 1)[1] for note in made.notes]
    assert notes[:-1] == [
        "2 left out: IfcDistributionElement",
        "1 left out: IfcDoor",
        "1 left out: IfcFurnishingElement",
        "1 left out: IfcRailing",
        "1 left out: IfcStair without a solid",
        'without a material in the file: "IfcWall", "IfcChimney", "IfcRamp", "IfcRampFlight", '
        '"IfcCovering" and 1 more',
    ]


def test_ifc_parts_are_blocks_and_wholes_without_masonry_among_their_parts(tmp_path):
    model = IfcModel()
    leaves = model.make("IfcWall", "leaves")
    model.box("IfcCovering", "leaf", (0, 0, 0), (1, 0.1, 1), whole=leaves)
    model.box("IfcBuildingElementPart", "core", (0, 0.1, 0), (1, 0.3, 1), whole=leaves)
    reinforced = model.box("IfcWall", "reinforced", (2, 0, 0), (3, 0.3, 1))
    model.box("IfcReinforcingBar", "bar", (2.1, 0.1, 0), (2.2, 0.2, 1), whole=reinforced)
    footing = model.make("IfcFooting", "footing")
    model.box("IfcBuildingElementPart", "plinth", (0, 0, -1), (3, 0.3, 0), whole=footing)
    facade = model.make("IfcCurtainWall", "facade")
    model.box("IfcPlate", "pane", (0, 9, 0), (1, 9.1, 1), whole=facade)
    made = model.blocks(tmp_path)
    found = {b.id: b.support for b in made.blocks}
    assert found == {"leaf": False, "core": False, "reinforced": False, "plinth": True}
    notes = [note.split(": ", 1)[1] for note in made.notes]
    assert notes[:2] == ["1 left out: IfcCurtainWall", "1 left out: IfcReinforcingElement"]


def test_a_layer_of_ifc_is_the_name_of_the_material(tmp_path):
    ifcopenshell = pytest.importorskip("ifcopenshell")
    model = IfcModel()
    tuff, brick, plaster = map(model.material, ("tuff", "brick", "plaster"))
    walls = {
        name: model.box("IfcWall", name, (2 * k, 0, 0), (2 * k + 1, 0.3, 1))
        for k, name in enumerate(("plain", "layered", "plastered", "listed", "set", "one", "none"))
    }
    model.assign(walls["plain"], tuff)
    model.layered(walls["layered"], (tuff, 150.0), (tuff, 150.0))
    model.layered(walls["plastered"], (plaster, 20.0), (brick, 280.0))
    model.assign(walls["listed"], brick, "IfcMaterialList")
    made = model.api.material.add_material_set(
        model.file, name="set", set_type="IfcMaterialConstituentSet"
    )
    for material in (tuff, plaster):
        model.api.material.add_constituent(model.file, constituent_set=made, material=material)
    model.assign(walls["set"], made)
    layer = model.file.createIfcMaterialLayer(brick, 280.0)
    model.file.createIfcRelAssociatesMaterial(
        ifcopenshell.guid.new(), None, None, None, [walls["one"]], layer
    )
    made = model.blocks(tmp_path)
    assert {b.id: b.material for b in made.blocks} == {
        "plain": "tuff",
        "layered": "tuff",
        "plastered": "brick",
        "listed": "brick",
        "set": "tuff",
        "one": "brick",
        "none": "stone",  # of the import
    }
    notes = [note.split(": ", 1)[1] for note in made.notes]
    assert notes[:2] == [
        "with several materials, of which that of the thickest layer is taken, or else the first: "
        '"plastered", "set"',
        'without a material in the file: "none"',
    ]


@pytest.mark.parametrize(
    ("does", "said"), [("os.abort()", "is torn: the library"), ("time.sleep(60)", "more than 3 s")]
)
def test_a_library_that_crashes_or_never_ends_is_told(tmp_path, monkeypatch, does, said):
    """What ifcopenshell 0.9 does with some torn files; here a library in its place does it."""
    package = tmp_path / "ifcopenshell"
    package.mkdir()
    (package / "__init__.py").write_text(f"import os, time\ndef open(path):\n    {does}\n")
    (package / "geom.py").write_text("")
    monkeypatch.syspath_prepend(tmp_path)
    monkeypatch.setenv("PYTHONPATH", str(tmp_path), prepend=os.pathsep)
    monkeypatch.setattr("drystone.io.drawings.ifc.MOST_SECONDS", 3.0)
    path = tmp_path / "a.ifc"
    path.write_text("ISO-10303-21;")
    with pytest.raises(ModelError, match=said):
        blocks_of(path)


def test_a_library_that_is_missing_is_named(tmp_path, monkeypatch):
    import sys

    path = tmp_path / "a.dxf"
    path.write_text("0\nEOF\n")
    monkeypatch.setitem(sys.modules, "ezdxf", None)
    with pytest.raises(ModelError, match=r"pip install drystone\[dxf\]"):
        blocks_of(path)
    path = tmp_path / "a.ifc"
    path.write_text("ISO-10303-21;")
    monkeypatch.setitem(sys.modules, "ifcopenshell", None)
    with pytest.raises(ModelError, match=r"pip install drystone\[ifc\]"):
        blocks_of(path)
