"""3DEC: prisms over the blocks' outlines, joints, supports, and the published strategy in FISH.

`threedec_solids` has what is other in space.

The plane of the model is that of x and y, with gravity along -y; the prisms reach half the
thickness to both sides of it.  3DEC has no rounded corners: they are cut off, at 45 degrees in a
right corner, which leaves the contact points where rounding would have them.
"""

from __future__ import annotations

from drystone.common.arrays import Array
from drystone.geometry.plane import polygon
from drystone.io.convert import itasca, threedec_solids
from drystone.io.convert.common import (
    Written,
    chamfered,
    control_notes,
    left_sharp,
    leg_of,
    materials,
    need_convex,
    need_stiffness,
    number,
    only_ours,
    strategy_notes,
    unchamfered,
)
from drystone.model.assembly import GRAVITY, Assembly, Corner
from drystone.model.model import Model

PROGRAM = "3DEC"

#: Gives the contacts between two blocks, by their regions, another joint material.
JOINT_LAW = """\
def joint_law(n_law, n_1, n_2)
  ic = contact_head
  loop while ic # 0
    n_a = b_region(c_b1(ic))
    n_b = b_region(c_b2(ic))
    if n_a = n_1 then
      if n_b = n_2 then
        c_mat(ic) = n_law
      end_if
    end_if
    if n_a = n_2 then
      if n_b = n_1 then
        c_mat(ic) = n_law
      end_if
    end_if
    ic = c_next(ic)
  end_loop
end
""".splitlines()


def _squared_distance(one: str, other: str, axes: str) -> str:
    """FISH of the squared distance of two points, whose components are named with ``{}``."""
    return " + ".join(f"({one.format(axis)} - {other.format(axis)})^2" for axis in axes)


def functions(axes: str) -> list[str]:
    """FISH of a model along ``axes``, of which the last is up."""
    to_centroid = _squared_distance("b_{}(ib)", "ctl_b{}", axes)
    to_point = _squared_distance("gp_{}(ig)", "ctl_{}", axes)
    control = "".join(f"  ctl_u = ctl_u + gp_{axis}dis(ctl_g) * read_{axis}\n" for axis in axes)
    return f"""\
def add_up
  total = 0.0
  ctl_b = 0
  least = 1e30
  ib = block_head
  loop while ib # 0
    if b_fix(ib) = 0 then
      total = total + grav * b_mass(ib)
    end_if
    away = {to_centroid}
    if away < least then
      least = away
      ctl_b = ib
    end_if
    ib = b_next(ib)
  end_loop
  ; the vertex of the control block that is nearest to the control point
  least = 1e30
  ig = b_gp(ctl_b)
  loop while ig # 0
    away = {to_point}
    if away < least then
      least = away
      ctl_g = ig
    end_if
    ig = gp_next(ig)
  end_loop
end
{itasca.put_loads(axes)}\
{itasca.stop_blocks(("x", "y", "z", "rx", "ry", "rz"))}\
{itasca.read_carried(axes)}\
def read_control
  ctl_u = 0.0
{control}\
end
@add_up
""".splitlines()


def write(model: Model, name: str = "") -> Written:
    """The model as a 3DEC data file; every block is a region of its own."""
    assembly = model.assembly
    need_stiffness(assembly, PROGRAM)
    need_convex(assembly, PROGRAM)
    solid = assembly.dimension == 3
    outlines = None if solid else chamfered(assembly)
    stuff = materials(assembly, outlines)
    notes = [*_corner_notes(assembly), *strategy_notes(model, PROGRAM)]
    if not solid:
        notes.append(
            "3DEC leaves the blocks free to move out of the plane: nothing pushes them there"
        )
    control = model.control_point.block
    corners = assembly.figures[control].parts[0].vertices if outlines is None else outlines[control]
    notes += control_notes(model, corners, PROGRAM)
    lines = [*itasca.heading(model, PROGRAM, notes), "new"]
    lines += _blocks(assembly, outlines)
    lines += itasca.properties(assembly, stuff)
    for k, kind in enumerate(stuff.of_block, start=1):
        if kind > 1:
            lines.append(f"change mat={kind} range region {k}")
    for k, fixed in enumerate(assembly.fixed, start=1):
        if fixed:
            lines.append(f"fix range region {k}")
    gravity = ["0.0", number(-GRAVITY)]
    gravity.insert(0 if solid else 2, "0.0")
    lines += ["gravity " + " ".join(gravity), ""]
    own = {
        "thick": (assembly.thickness, "m"),
        "leg": (leg_of(assembly), "m, of the corners that were cut off"),
    }
    lines += itasca.parameters(model, {} if solid else own, PROGRAM)
    if assembly.joint_between:
        lines += JOINT_LAW
        lines += [
            f"@joint_law({law}, {i + 1}, {j + 1})" for law, i, j in itasca.pair_laws(assembly)
        ]
        notes.append(itasca.LAWS_AS_DESIGNED)
    lines += ["", *functions("xyz" if solid else "xy"), *itasca.PUSHOVER]
    return Written(text="\n".join(lines) + "\n", notes=tuple(notes))


def _blocks(assembly: Assembly, outlines: list[Array] | None) -> list[str]:
    """A region for each block, with its id above; ``outlines`` in the plane alone."""
    front, back = number(0.5 * assembly.thickness), number(-0.5 * assembly.thickness)
    lines = []
    for k, block in enumerate(assembly.blocks, start=1):
        lines.append(f"; {itasca.quoted(block.id)}")
        if outlines is None:
            lines += threedec_solids.block_command(k, assembly.figures[k - 1].parts[0])
            continue
        lines += itasca.command(
            f"poly region {k} prism",
            "a",
            *(f"({number(x)},{number(y)},{front})" for x, y in outlines[k - 1]),
            "b",
            *(f"({number(x)},{number(y)},{back})" for x, y in outlines[k - 1]),
        )
    return [*lines, ""]


def _corner_notes(assembly: Assembly) -> list[str]:
    if assembly.dimension == 3:
        return left_sharp(assembly, PROGRAM)
    radius = assembly.corner.radius
    if not radius:
        return []
    return [f"3DEC has no rounded corners: they are chamfered with legs of {radius:g} m"]


def read(text: str) -> Model:
    """The model of a file that `write` wrote; its corners are chamfered or sharp."""
    with only_ours(PROGRAM):
        parsed = itasca.parse(text)
        return _solids(parsed) if "load_z" in parsed.values else _prisms(parsed)


def _solids(parsed: itasca.Parsed) -> Model:
    found = [threedec_solids.solid_of(words[2:]) for words in parsed.shapes]
    vertices, faces = [one for one, _ in found], [sides for _, sides in found]
    return itasca.assemble(
        parsed, vertices, within=_is_region, pair=_regions, corner=Corner(), faces=faces
    )


def _prisms(parsed: itasca.Parsed) -> Model:
    """Of their ends, from which chamfers are taken."""
    cut = [
        itasca.numbers(words[words.index("a") + 1 : words.index("b")]).reshape(-1, 3)[:, :2].copy()
        for words in parsed.shapes
    ]
    leg = parsed.values["leg"]
    outlines = [unchamfered(outline) for outline in cut] if leg else cut
    ratio = [
        polygon.signed_area(part) / polygon.signed_area(whole)
        for part, whole in zip(cut, outlines, strict=True)
    ]
    return itasca.assemble(
        parsed,
        outlines,
        within=_is_region,
        pair=_regions,
        corner=Corner(chamfer=leg or None),
        area_ratio=ratio if leg else None,
    )


def _is_region(row: int, words: list[str]) -> bool:
    """Whether a range is the block's region."""
    return int(words[1]) == row + 1


def _regions(words: list[str]) -> tuple[int, int]:
    """Rows of the blocks of two regions."""
    first, second = map(int, words)
    return first - 1, second - 1
