"""IFC by ifcopenshell: masonry elements as blocks; of those that are decomposed, their parts."""

from __future__ import annotations

import tempfile
import time
from concurrent.futures import wait
from importlib.util import find_spec
from pathlib import Path
from typing import Any

import numpy as np

from drystone.common.aside import Aside
from drystone.common.workers import WorkerError
from drystone.io.drawings.drawing import Drawing, Shape, check_faces, tidy_name
from drystone.io.drawings.format import Format
from drystone.model.construction.errors import ModelError
from drystone.model.construction.words import printable

#: What is built and may be of stone; doors, furniture and pipes are not.
KINDS = (
    "IfcBeam", "IfcBuildingElementPart", "IfcBuildingElementProxy", "IfcColumn", "IfcFooting",
    "IfcMember", "IfcPlate", "IfcRoof", "IfcSlab", "IfcStair", "IfcStairFlight", "IfcWall",
    "IfcPile", "IfcDiscreteAccessory", "IfcElementAssembly",
)  # fmt: skip
#: Kinds that stand for the ground.
SUPPORTS = ("IfcFooting", "IfcPile")


#: Seconds that a file may take: the largest that are read take a few minutes.
MOST_SECONDS = 600.0


def read(contents: bytes) -> Drawing:
    """The blocks of a file; raises `ModelError`.

    The file is read in a process of its own: some torn files crash the library, or keep it busy
    without end.
    """
    if find_spec("ifcopenshell") is None:
        raise ModelError(["needs ifcopenshell, which is not installed: pip install drystone[ifc]"])
    until = time.monotonic() + MOST_SECONDS
    with Aside() as aside:
        future = aside.begin(f"{__name__}:parsed", contents)
        while not future.done() and time.monotonic() < until:
            wait([future], timeout=0.2)  # in pieces, so that signals are heard on every system
        if not future.done():
            raise ModelError(
                [f"takes more than {MOST_SECONDS:g} s to read: export the walls and floors alone"]
            )
    try:
        drawing: Drawing = future.result()
    except WorkerError:
        raise ModelError(["is torn: the library that reads it crashed: export it again"]) from None
    return drawing


def parsed(contents: bytes) -> Drawing:
    """The same, read in this process."""
    import ifcopenshell
    import ifcopenshell.geom

    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "model.ifc"
        path.write_bytes(contents)
        try:
            file = ifcopenshell.open(str(path))
        except Exception as error:  # whatever the parser meets
            raise ModelError([f"is no IFC file that can be read: {_line(error)}"]) from None
    settings = ifcopenshell.geom.settings()
    settings.set("use-world-coords", True)
    shapes, without = [], []
    for element in _elements(file):
        try:
            made: Any = ifcopenshell.geom.create_shape(settings, element)
        except Exception:  # no solid, or none that the kernel can make
            without.append(_name(element))
            continue
        vertices = np.array(made.geometry.verts, dtype=np.float64).reshape(-1, 3)
        faces = np.array(made.geometry.faces, dtype=np.int64).reshape(-1, 3).tolist()
        check_faces(len(vertices), faces)
        storey = _storey(element)
        shapes.append(
            Shape(
                name=_name(element),
                vertices=vertices,
                faces=tuple(map(tuple, faces)),
                layer=_material(element),
                groups=(storey,) if storey else (),
                support=any(element.is_a(kind) for kind in SUPPORTS),
            )
        )
    if not shapes:
        raise ModelError(["holds no walls, slabs, columns or other solids of masonry"])
    notes = (
        (f"{len(without)} elements have no solid and were left out, the first is {without[0]}",)
        if without
        else ()
    )
    # The kernel gives metres whatever the file's unit is.
    return Drawing(shapes=tuple(shapes), unit="m", up="z", notes=notes)


def _elements(file: Any) -> list[Any]:
    """Elements of masonry that are not made of others."""
    found: dict[int, Any] = {}
    for kind in KINDS:
        try:
            listed = file.by_type(kind)
        except RuntimeError:  # a kind that this schema does not have
            continue
        for element in listed:
            parts = [
                part
                for relation in getattr(element, "IsDecomposedBy", ()) or ()
                for part in relation.RelatedObjects
            ]
            if not parts and getattr(element, "Representation", None) is not None:
                found[element.id()] = element
    return [found[key] for key in sorted(found)]


def _name(element: Any) -> str:
    return tidy_name(element.Name or "") or tidy_name(element.GlobalId)


def _storey(element: Any) -> str:
    """Name of the storey that it, or what it is a part of, is in."""
    for _ in range(8):
        for relation in getattr(element, "ContainedInStructure", ()) or ():
            return tidy_name(relation.RelatingStructure.Name or "")
        whole = [relation.RelatingObject for relation in getattr(element, "Decomposes", ()) or ()]
        if not whole:
            return ""
        element = whole[0]
    return ""


def _material(element: Any) -> str:
    import ifcopenshell.util.element

    material = ifcopenshell.util.element.get_material(element)
    return tidy_name(getattr(material, "Name", "") or "") if material else ""


def _line(error: Exception) -> str:
    return printable(" ".join(str(error).split())[:200])


FORMAT = Format(name="ifc", endings=(".ifc",), read=lambda data, *_: read(data))
