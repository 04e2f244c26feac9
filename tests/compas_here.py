"""Structures of compas_dem, for tests: its templates, a wall of boxes, a vault of polygons."""

from __future__ import annotations

from typing import Any

MU, STIFFNESS, DENSITY = 0.7, 1e10, 2200.0  # -, Pa/m, kg/m3: limestone of compas_dem


def problem_of(model: Any, name: str = "test") -> Any:
    """A problem on a model: limestone, dry joints."""
    from compas_dem.material import Stone
    from compas_dem.problem import Problem

    stone = Stone.from_predefined_material("LIMESTONE")
    model.add_material(stone)
    model.assign_material(stone, elements=list(model.elements()))
    problem = Problem(model, name=name)
    problem.set_contact_model("MohrCoulomb", mu=MU)
    problem.set_joint_model(kn=STIFFNESS, kt=STIFFNESS)
    return problem


def arch(n: int = 8, thickness: float = 0.9) -> Any:
    """An arch of `ArchTemplate` on its two end blocks."""
    from compas_dem.models import BlockModel
    from compas_dem.templates import ArchTemplate

    model = BlockModel()
    for mesh in ArchTemplate(rise=3, span=10, thickness=thickness, depth=1.0, n=n).blocks():
        model.add_block_from_mesh(mesh)
    model.add_supports([0, n - 1])
    return model


def barrel_vault() -> Any:
    """A barrel vault of `BarrelVaultTemplate`, which sets its supports itself."""
    from compas_dem.models import BlockModel
    from compas_dem.templates import BarrelVaultTemplate

    template = BarrelVaultTemplate(
        span=4.0, length=1.0, thickness=0.5, rise=1.2, vou_span=7, vou_length=1
    )
    return BlockModel.from_barrelvault(template)


def wall() -> Any:
    """Three courses of boxes in running bond on a slab; the template of walls makes no blocks."""
    from compas.geometry import Box, Frame
    from compas_dem.models import BlockModel

    def box(x: float, z: float, length: float) -> Any:
        place = Frame([x + length / 2, 0.1, z + 0.1], [1, 0, 0], [0, 1, 0])
        return Box(length, 0.2, 0.2, frame=place)

    boxes = [box(-0.2, -0.2, 1.2)]
    boxes += [box(0.0, 0.0, 0.4), box(0.4, 0.0, 0.4)]
    boxes += [box(0.0, 0.2, 0.2), box(0.2, 0.2, 0.4), box(0.6, 0.2, 0.2)]
    boxes += [box(0.0, 0.4, 0.4), box(0.4, 0.4, 0.4)]
    model = BlockModel.from_boxes(boxes)
    model.add_support(0)
    return model


def triangulation_dual() -> Any:
    """A vault of polygons on its rim: the dual of a triangulation."""
    from compas.datastructures import Mesh
    from compas_dem.models import BlockModel

    mesh = Mesh.from_meshgrid(dx=6, nx=3)
    for vertex in mesh.vertices():
        x, y, _ = mesh.vertex_coordinates(vertex)
        mesh.vertex_attribute(vertex, "z", 1.5 - ((x - 3) ** 2 + (y - 3) ** 2) / 12)
    model = BlockModel.from_triangulation_dual(mesh, lengthfactor=0.7, tmin=0.3, tmax=0.5)
    for block in model.elements():
        x, y, _ = block.point
        block.is_support = min(x, y, 6 - x, 6 - y) < 0.8
    return model
