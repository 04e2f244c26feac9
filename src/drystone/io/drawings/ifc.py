"""IFC by ifcopenshell: masonry elements as blocks; of those that are decomposed, their parts."""

from __future__ import annotations

import tempfile
import time
from collections import Counter
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
from drystone.model.construction.words import listed, printable

#: What is no masonry, in any version of the schema; the subtypes of each are none either.
NO_MASONRY = (
    "IfcBearing", "IfcCurtainWall", "IfcDistributionElement", "IfcDoor", "IfcEarthworksElement",
    "IfcElectricalElement", "IfcEquipmentElement", "IfcFastener", "IfcFurnishingElement",
    "IfcGeographicElement", "IfcGeotechnicalElement", "IfcImpactProtectionDevice",
    "IfcMechanicalFastener", "IfcMooringDevice", "IfcNavigationElement", "IfcRail", "IfcRailing",
    "IfcReinforcingElement", "IfcShadingDevice", "IfcSign", "IfcTrackElement",
    "IfcTransportElement", "IfcTransportationDevice", "IfcVibrationDamper",
    "IfcVibrationIsolator", "IfcWindow",
)  # fmt: skip
#: What is no element of its own: openings and projections, which the shapes of others have, and
#: limits of spaces.
SILENT = ("IfcFeatureElement", "IfcVirtualElement")
#: Kinds that stand for the ground.
SUPPORTS = ("IfcFooting", "IfcDeepFoundation", "IfcPile")


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
    bodies, others = _bodies(file)
    shapes: list[Shape] = []
    several: list[str] = []  # elements of several materials
    missing: list[str] = []  # and of none
    for element, support in bodies:
        try:
            made: Any = ifcopenshell.geom.create_shape(settings, element)
        except Exception:  # no solid, or none that the kernel can make
            others[_without_solid(element)] += 1
            continue
        vertices = np.array(made.geometry.verts, dtype=np.float64).reshape(-1, 3)
        faces = np.array(made.geometry.faces, dtype=np.int64).reshape(-1, 3).tolist()
        check_faces(len(vertices), faces)
        storey, (layer, count) = _storey(element), _material(element)
        if count != 1:
            (several if count else missing).append(_name(element))
        shapes.append(
            Shape(
                name=_name(element),
                vertices=vertices,
                faces=tuple(map(tuple, faces)),
                layer=layer,
                groups=(storey,) if storey else (),
                support=support,
            )
        )
    left_out = [f"{n} left out: {what}" for what, n in sorted(others.items())]
    if not shapes:
        only = f" ({'; '.join(left_out[:3])})" if left_out else ""
        raise ModelError([f"holds no walls, slabs, columns or other solids of masonry{only}"])
    # The kernel gives metres whatever the file's unit is.
    notes = (*left_out, *_on_materials(several, missing))
    return Drawing(shapes=tuple(shapes), unit="m", up="z", notes=notes)


def _on_materials(several: list[str], missing: list[str]) -> list[str]:
    """Sentences on elements of several materials, and on those of none."""
    found = []
    if several:
        found.append(
            "with several materials, of which that of the thickest layer is taken, or else the "
            f"first: {listed(several)}"
        )
    if missing:
        found.append(f"without a material in the file: {listed(missing)}")
    return found


def _bodies(file: Any) -> tuple[list[tuple[Any, bool]], Counter[str]]:
    """Elements of masonry that become blocks, in the order of the file, and whether each is a
    support; by kind, how many elements are left out."""
    others: Counter[str] = Counter()
    seen: set[int] = set()
    found = [
        one
        for element in file.by_type("IfcElement")
        if not any(whole.is_a("IfcElement") for whole in _wholes(element))
        for one in _in(element, False, seen, others)
    ]
    return sorted(found, key=lambda one: one[0].id()), others


def _in(
    element: Any, support: bool, seen: set[int], others: Counter[str]
) -> list[tuple[Any, bool]]:
    """The parts of an element that become blocks; without any of masonry the element itself."""
    if element.id() in seen or any(map(element.is_a, SILENT)):
        return []
    seen.add(element.id())
    if kind := next(filter(element.is_a, NO_MASONRY), ""):
        others[kind] += 1
        return []
    support = support or any(map(element.is_a, SUPPORTS))
    if found := [one for part in _parts(element) for one in _in(part, support, seen, others)]:
        return found
    if getattr(element, "Representation", None) is None:
        others[_without_solid(element)] += 1
        return []
    return [(element, support)]


def _without_solid(element: Any) -> str:
    return f"{element.is_a()} without a solid"


def _parts(element: Any) -> list[Any]:
    return [
        part
        for relation in getattr(element, "IsDecomposedBy", ()) or ()
        for part in relation.RelatedObjects
    ]


def _wholes(element: Any) -> list[Any]:
    """What an element is a part of: at most one, if the file is sound."""
    return [relation.RelatingObject for relation in getattr(element, "Decomposes", ()) or ()]


def _name(element: Any) -> str:
    return tidy_name(element.Name or "") or tidy_name(element.GlobalId)


def _storey(element: Any) -> str:
    """Name of the storey that it, or what it is a part of, is in."""
    for _ in range(8):
        for relation in getattr(element, "ContainedInStructure", ()) or ():
            return tidy_name(relation.RelatingStructure.Name or "")
        wholes = _wholes(element)
        if not wholes:
            return ""
        element = wholes[0]
    return ""


def _material(element: Any) -> tuple[str, int]:
    """The name of an element's material, and how many materials it has.

    Of several that of the thickest layer, or the first where they are no layers.
    """
    from ifcopenshell.util.element import get_material

    parts = _parts_of_material(get_material(element, should_skip_usage=True))
    named = [(thickness, name) for thickness, name in parts if name]
    if not named:
        return "", 0
    return max(named, key=lambda part: part[0])[1], len({name for _, name in named})


def _parts_of_material(material: Any) -> list[tuple[float, str]]:
    """Thickness, in units of the file, and name of each part of a material; 0 of all but layers."""
    for key in ("MaterialLayers", "MaterialProfiles", "MaterialConstituents"):
        if hasattr(material, key):
            return [
                (getattr(part, "LayerThickness", None) or 0.0, _called(part.Material))
                for part in getattr(material, key) or ()
            ]
    if hasattr(material, "Materials"):
        return [(0.0, _called(part)) for part in material.Materials]
    # One layer, profile or constituent of no set has its material as well.
    return [(0.0, _called(getattr(material, "Material", material)))]


def _called(material: Any) -> str:
    """Its name; nothing where a layer is of air, or a material has none."""
    return tidy_name(getattr(material, "Name", None) or "")


def _line(error: Exception) -> str:
    return printable(" ".join(str(error).split())[:200])


FORMAT = Format(name="ifc", endings=(".ifc",), read=lambda data, *_: read(data))
