"""UDEC: polygons with rounded corners, joints, supports, and the published strategy in FISH.

UDEC rounds a corner so that its arc begins at a given distance from the corner, our radius is that
of the arc: in a right corner the two are the same.
"""

from __future__ import annotations

import numpy as np

from drystone.common.arrays import Array
from drystone.geometry.plane import polygon
from drystone.io.convert import itasca
from drystone.io.convert.common import (
    Written,
    control_notes,
    materials,
    need_convex,
    need_stiffness,
    number,
    only_ours,
    strategy_notes,
)
from drystone.model.assembly import GRAVITY, Assembly, Corner
from drystone.model.construction.errors import ModelError
from drystone.model.model import Model

PROGRAM = "UDEC"
#: Rounding that stands for sharp corners, over the shortest edge.
SHARP = 1e-3
#: Boxes that pick one block by its centroid, over the smallest extent of a block.
BOX = 1e-3

FUNCTIONS = f"""\
def add_up
  total = 0.0
  ib = block_head
  loop while ib # 0
    if b_fix(ib) = 0 then
      total = total + grav * b_mass(ib)
    end_if
    ib = b_next(ib)
  end_loop
  ; the corner of the control block that is nearest to the control point
  ctl_b = b_near(ctl_bx, ctl_by)
  first = b_corner(ctl_b)
  ctl_c = first
  least = 1e30
  ic = first
  turning = 1
  loop while turning = 1
    away = (cor_x(ic) - ctl_x)^2 + (cor_y(ic) - ctl_y)^2
    if away < least then
      least = away
      ctl_c = ic
    end_if
    ic = cor_link(ic)
    if ic = first then
      turning = 0
    end_if
    if ic = 0 then
      turning = 0
    end_if
  end_loop
  ctl_x0 = cor_x(ctl_c)
  ctl_y0 = cor_y(ctl_c)
end
{itasca.put_loads("xy")}\
{itasca.stop_blocks(("x", "y", "r"))}\
{itasca.read_carried("xy")}\
def read_control
  ctl_u = (cor_x(ctl_c) - ctl_x0) * read_x + (cor_y(ctl_c) - ctl_y0) * read_y
end
@add_up
""".splitlines()

#: Gives the contacts between two blocks, picked by points inside them, another joint material.
JOINT_LAW = """\
def joint_law(n_law, x_1, y_1, x_2, y_2)
  ib_1 = b_near(x_1, y_1)
  ib_2 = b_near(x_2, y_2)
  ic = contact_head
  loop while ic # 0
    if c_b1(ic) = ib_1 then
      if c_b2(ic) = ib_2 then
        c_mat(ic) = n_law
      end_if
    end_if
    if c_b1(ic) = ib_2 then
      if c_b2(ic) = ib_1 then
        c_mat(ic) = n_law
      end_if
    end_if
    ic = c_next(ic)
  end_loop
end
""".splitlines()


def write(model: Model, name: str = "") -> Written:
    """The model as a UDEC data file."""
    assembly = model.assembly
    if assembly.dimension == 3:
        raise ModelError(["dimension: UDEC has only the plane: convert solids for 3dec or lmgc90"])
    need_stiffness(assembly, PROGRAM)
    need_convex(assembly, PROGRAM)
    rounding, notes = rounding_of(assembly)
    notes += strategy_notes(model, PROGRAM)
    if assembly.thickness != 1.0:
        notes.append(
            f"UDEC's blocks are 1 m thick: its forces are those of a wall of {assembly.thickness:g}"
            " m divided by that, its multipliers are the same"
        )
    notes += control_notes(model, assembly.blocks[model.control_point.block].vertices, PROGRAM)
    stuff = materials(assembly)
    lines = [*itasca.heading(model, PROGRAM, notes), "new", f"round {number(rounding)}"]
    for block in assembly.blocks:
        lines.append(f"; {itasca.quoted(block.id)}")
        clockwise = block.vertices[::-1]
        lines += itasca.command("block", *(f"{number(x)},{number(y)}" for x, y in clockwise))
    lines.append("")
    lines += itasca.properties(assembly, stuff)
    box = BOX * min(float(np.ptp(block.vertices, axis=0).min()) for block in assembly.blocks)
    for (x, y), k in zip(assembly.centroid, stuff.of_block, strict=True):
        if k > 1:
            lines.append(f"change mat={k} {_box(x, y, box)}")
    for (x, y), fixed in zip(assembly.centroid, assembly.fixed, strict=True):
        if fixed:
            lines.append(f"fix {_box(x, y, box)}")
    lines += [f"set gravity=0.0,{number(-GRAVITY)}", ""]
    lines += itasca.parameters(
        model, {"thick": (assembly.thickness, "m, that of the model")}, PROGRAM
    )
    if assembly.joint_between:
        lines += JOINT_LAW
        lines += [f"@joint_law({', '.join(words)})" for words in _pairs(assembly)]
        notes.append(itasca.LAWS_AS_DESIGNED)
    lines += ["", *FUNCTIONS, *itasca.PUSHOVER]
    return Written(text="\n".join(lines) + "\n", notes=tuple(notes))


def rounding_of(assembly: Assembly) -> tuple[float, list[str]]:
    """UDEC's rounding length [m], and where it is not what the model says."""
    corner = assembly.corner
    if corner.radius:
        if _all_right(assembly):
            return float(corner.radius), []
        return float(corner.radius), [
            "UDEC's rounding is a length along the edges: corners that are not right get another "
            f"radius than {corner.radius:g} m"
        ]
    if corner.chamfer:
        return float(corner.chamfer), [
            f"UDEC has no chamfers: corners are rounded over the same {corner.chamfer:g} m"
        ]
    shortest = min(
        float(np.hypot(*(np.roll(b.vertices, -1, axis=0) - b.vertices).T).min())
        for b in assembly.blocks
    )
    return SHARP * shortest, ["UDEC has no sharp corners: they are rounded as little as will do"]


def _pairs(assembly: Assembly) -> list[list[str]]:
    return [
        [str(k), *(number(value) for row in (i, j) for value in assembly.centroid[row])]
        for k, i, j in itasca.pair_laws(assembly)
    ]


def _box(x: float, y: float, box: float) -> str:
    sides = (x - box, x + box, y - box, y + box)
    return "range " + " ".join(number(side) for side in sides)


def _all_right(assembly: Assembly) -> bool:
    for block in assembly.blocks:
        edges = np.roll(block.vertices, -1, axis=0) - block.vertices
        edges = edges / np.hypot(*edges.T)[:, None]
        if np.abs(np.sum(edges * np.roll(edges, -1, axis=0), axis=1)).max() > 1e-9:
            return False
    return True


def read(text: str) -> Model:
    """The model of a file that `write` wrote."""
    with only_ours(PROGRAM):
        return _model(itasca.parse(text))


def _model(parsed: itasca.Parsed) -> Model:
    if parsed.rounding is None:
        raise ValueError("it lacks round")
    outlines = [itasca.numbers(words).reshape(-1, 2)[::-1].copy() for words in parsed.shapes]
    if any(len(outline) < 3 for outline in outlines):
        raise ValueError("a block has fewer than three corners")
    centres = [polygon.mass_properties(outline).centroid for outline in outlines]

    def pair(words: list[str]) -> tuple[int, int]:
        first, second = itasca.numbers(words).reshape(2, 2)
        return itasca.nearest(centres, first), itasca.nearest(centres, second)

    return itasca.assemble(
        parsed,
        outlines,
        within=lambda i, words: _inside(centres[i], itasca.numbers(words)),
        pair=pair,
        corner=Corner(radius=parsed.rounding),
    )


def _inside(point: Array, box: Array) -> bool:
    return bool(box[0] < point[0] < box[1] and box[2] < point[1] < box[3])
