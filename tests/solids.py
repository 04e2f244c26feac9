"""Structures in space for tests: one block, leaves, façades, and models turned as a whole."""

from __future__ import annotations

import tomllib
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np
from scipy.spatial.transform import Rotation

from drystone.geometry.motion import moved_points
from drystone.geometry.plane.parts import convex_outlines
from drystone.geometry.space import solid
from drystone.geometry.space.solid import Part
from drystone.model.assembly import Assembly, Block, Corner
from drystone.model.joint_law import JointLaw
from drystone.model.loading import MassPattern
from drystone.model.model import Analysis, Model
from drystone.model.monitor import ControlPoint

UNIT_WEIGHT = 10e3  # N/m3


def box(name: str, low: Sequence[float], high: Sequence[float], *, support: bool = False) -> Block:
    """A block from its lowest to its highest corner [m]."""
    vertices, faces = solid.box([low, high])
    return Block(
        id=name,
        vertices=vertices,
        faces=faces,
        unit_weight=UNIT_WEIGHT,
        material="stone",
        support=support,
    )


def extruded_parts(outline: np.ndarray, depth: Sequence[float]) -> list[Part]:
    """Convex parts of `solid.extruded`: those of its outline, extruded."""
    return [Part(*solid.extruded(part, depth)) for part in convex_outlines(outline)]


def model_of(
    blocks: Sequence[Block],
    joint: JointLaw,
    *,
    push: Sequence[float],
    control: str | None = None,
    point: Sequence[float] | None = None,
    corner: Corner | None = None,
    points: int = 4,
    analysis: Analysis | None = None,
) -> Model:
    """A model pushed along ``push``; read at the highest point, the furthest along the push."""
    assembly = Assembly.build(blocks, joint=joint, corner=corner, points=points)
    along = np.asarray(push, float) / np.linalg.norm(push)
    if control is None:
        free = [b for b in blocks if not b.support]
        control = max(free, key=lambda b: (b.vertices[:, 2].max(), (b.vertices @ along).max())).id
    row = assembly.index(control)
    if point is None:
        vertices = blocks[row].vertices
        top = vertices[vertices[:, 2] > vertices[:, 2].max() - 1e-9]
        point = top[int(np.argmax(top @ along))]
    return Model(
        title="solids",
        assembly=assembly,
        load=MassPattern(direction=along),
        control_point=ControlPoint(block=row, point=np.asarray(point, float), direction=along),
        analysis=analysis or Analysis(engine="nscd"),
    )


def joint(friction: float, stiffness: float = 1e9, shear: float | None = None) -> JointLaw:
    """A dry joint without dilatancy; stiffnesses in Pa/m."""
    return JointLaw(
        friction_coefficient=friction,
        normal_stiffness=stiffness,
        shear_stiffness=stiffness if shear is None else shear,
    )


def one_block(
    b: float = 0.4,
    d: float = 0.6,
    h: float = 1.5,
    *,
    friction: float = 0.7,
    stiffness: float = 1e11,
    angle: float = 0.0,
    **more,
) -> Model:
    """One block b x d x h on a wide support, pushed at an angle [degrees] to x."""
    blocks = [
        box("base", (-2.0, -2.0, -0.3), (2.0 + b, 2.0 + d, 0.0), support=True),
        box("b1", (0.0, 0.0, 0.0), (b, d, h)),
    ]
    push = (np.cos(np.radians(angle)), np.sin(np.radians(angle)), 0.0)
    return model_of(blocks, joint(friction, stiffness), push=push, **more)


def leaf(
    *,
    length: float = 2.0,
    thickness: float = 0.2,
    courses: int = 8,
    stiffness: float = 1e10,
    **more,
) -> Model:
    """A leaf in running bond of units 0.4 x 0.175 m, 44 of them by default, pushed out of plane."""
    height, unit = 0.175, 0.4
    blocks = [box("base", (-0.5, -0.5, -0.3), (length + 0.5, thickness + 0.5, 0.0), support=True)]
    for course in range(courses):
        cuts = np.arange(0.0, length + 1e-9, unit)
        if course % 2:
            cuts = np.concatenate(([0.0], np.arange(0.5 * unit, length, unit), [length]))
        z = course * height
        for k in range(len(cuts) - 1):
            low, high = (cuts[k], 0.0, z), (cuts[k + 1], thickness, z + height)
            blocks.append(box(f"c{course}_{k}", low, high))
    return model_of(blocks, joint(0.65, stiffness), push=(0.0, 1.0, 0.0), **more)


def from_boxes(path: Path | str, *, push: Sequence[float], **more) -> Model:
    """A model file of boxes, read without the reader of model files."""
    data = tomllib.loads(Path(path).read_text())
    blocks = [box(b["id"], *b["box"], support=b.get("support", False)) for b in data["block"]]
    law = data["joint"]
    values = {
        "friction_coefficient": law["friction_coefficient"],
        "normal_stiffness": law["normal_stiffness"],
        "shear_stiffness": law["shear_stiffness"],
    }
    return model_of(blocks, JointLaw(**values), push=push, **more)


def turned(model: Model, rotation: Rotation, shift: Sequence[float] = (0.0, 0.0, 0.0)) -> Model:
    """The model turned and moved as a whole, gravity, load and control with it."""
    pose = np.zeros((1, 7))
    pose[0, :3], pose[0, 3:] = shift, rotation.as_quat(scalar_first=True)
    origin = np.zeros((1, 3))

    def carried(points: np.ndarray) -> np.ndarray:
        return moved_points(points, np.zeros(len(points), int), origin, pose)

    old, control = model.assembly, model.control_point
    blocks = []
    for block in old.blocks:
        parts = tuple(Part(carried(part.vertices), part.faces) for part in block.parts)
        blocks.append(replace(block, vertices=carried(block.vertices), parts=parts))
    assembly = replace(old, blocks=tuple(blocks), up=rotation.apply(old.up))
    return replace(
        model,
        assembly=assembly,
        load=MassPattern(direction=rotation.apply(model.load.direction)),
        control_point=replace(
            control,
            point=carried(control.point[None])[0],
            direction=rotation.apply(control.direction),
        ),
    )


def twisting_lever(side: float, points: int) -> float:
    """Mean distance of a square joint from its centre [m], as its contact points have it."""
    if points == 4:
        return side / np.sqrt(2.0)
    n = {9: 3, 16: 4}[points]
    # Points at the corners of (n - 1) x (n - 1) cells, each corner with a quarter of its cells.
    x = np.linspace(-0.5, 0.5, n) * side
    share = np.ones(n)
    share[[0, -1]] = 0.5
    weight = np.outer(share, share) / share.sum() ** 2
    return float(np.sum(weight * np.hypot(*np.meshgrid(x, x))))
