"""What UDEC and 3DEC have in common: their command lines and their language FISH.

The files are written for UDEC 6 and 3DEC 5.  A command is a line, going on after an ampersand; what
follows a semicolon is a comment.  Names that these programs have no place for (of the model, its
blocks and materials) are kept in comments as JSON texts.
"""

from __future__ import annotations

import json
import re
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np

from drystone.common.arrays import Array
from drystone.geometry.space.solid import Faces
from drystone.io.convert.common import (
    STRATEGY,
    Materials,
    file_name,
    friction_angle,
    friction_coefficient,
    mass_direction,
    number,
    strategy,
    wrapped,
)
from drystone.model.assembly import GRAVITY, Assembly, Block, Corner
from drystone.model.construction.model import make_model
from drystone.model.joint_law import JointLaw
from drystone.model.model import Analysis, Model

#: Letters after which a line is continued.
WIDTH = 78


def quoted(text: str) -> str:
    """Text for a comment: in double quotes, on one line, ASCII only."""
    return json.dumps(text)


def command(*words: str) -> list[str]:
    """Lines of one command; a word is never torn."""
    lines, line = [], words[0]
    for word in words[1:]:
        if len(line) + 1 + len(word) > WIDTH - 2:
            lines.append(line + " &")
            line = "    " + word
        else:
            line += " " + word
    return [*lines, line]


def heading(model: Model, program: str, notes: Sequence[str]) -> list[str]:
    """Comments at the top of a file."""
    return [
        f"; {program} input of drystone, from {quoted(file_name(model.source))}",
        f"; title {quoted(model.title)}",
        "; Units: m, kg, s, N.",
        *wrapped(notes, "; "),
        "",
    ]


def parameters(model: Model, values: dict[str, tuple[float, str]], program: str) -> list[str]:
    """The FISH function that sets every number of the analysis, and its call."""
    s = strategy(model)
    centre = model.assembly.centroid[model.control_point.block]
    every: dict[str, tuple[float, str]] = {
        "grav": (GRAVITY, "m/s2"),
        **values,
        **_vector("load_", mass_direction(model, program), "direction of the load pattern"),
        **_vector("ctl_", model.control_point.point, "m, control point as designed"),
        **_vector("ctl_b", centre, "m, centroid of the block that it is on"),
        **_vector("read_", model.control_point.direction, "direction of the control displacement"),
        **{key: (s[key], text) for key, text in STRATEGY.items()},
        "stop_mult": (model.analysis.stop_multiplier, "multiplier at which the analysis ends"),
        "n_cycles": (100.0, "cycles before the blocks are stopped again"),
    }
    lines = ["def parameters"]
    for name, (value, text) in every.items():
        shown = f"{int(value)}" if name in ("patience", "n_cycles") else number(value)
        lines.append(f"  {name} = {shown}" + (f"  ; {text}" if text else ""))
    return [*lines, "end", "@parameters", ""]


def _vector(name: str, values: Array, text: str) -> dict[str, tuple[float, str]]:
    """Components as parameters, the text beside the first one."""
    return {
        name + axis: (float(value), text if axis == "x" else "")
        for axis, value in zip("xyz", values, strict=False)
    }


def put_loads(axes: str) -> str:
    """FISH that puts the load pattern times the multiplier on every block that moves."""
    loads = "".join(
        f"      b_{axis}load(ib) = lam * grav * b_mass(ib) * load_{axis}\n" for axis in axes
    )
    return f"""\
def put_loads
  ib = block_head
  loop while ib # 0
    if b_fix(ib) = 0 then
{loads}\
    end_if
    ib = b_next(ib)
  end_loop
end
"""


def read_carried(axes: str) -> str:
    """FISH that reads what the supports carry of the load, over its sum.

    The last of the ``axes`` is up.  The supports carry a part of the weight along a load that
    leans, too.
    """
    level, up = axes[:-1], axes[-1]
    held = "".join(f"      held = held + b_{axis}force(ib) * load_{axis}\n" for axis in level)
    return f"""\
def read_carried
  held = 0.0
  ib = block_head
  loop while ib # 0
    if b_fix(ib) # 0 then
{held}\
      held = held + (b_{up}force(ib) + grav * b_mass(ib)) * load_{up}
    end_if
    ib = b_next(ib)
  end_loop
  lam_c = held / total + load_{up}
end
"""


def stop_blocks(velocities: Sequence[str]) -> str:
    """FISH that stops all blocks, with the names of their velocities in the program."""
    zeros = "".join(f"    b_{name}vel(ib) = 0.0\n" for name in velocities)
    return f"""\
def stop_blocks
  ib = block_head
  loop while ib # 0
{zeros}\
    ib = b_next(ib)
  end_loop
end
"""


#: The published strategy in FISH.  It calls the functions above, and ``read_control``, which each
#: program writes in its own way and which sets ``ctl_u``.
PUSHOVER = """\
; The strategy of Bouckaert, Godio and de Almeida (2022): the multiplier goes
; up by increments as long as the supports carry what is applied; the peak
; has passed when what is missing no longer shrinks by a tenth within a few
; steps, or a tenth less is carried than before; from there on the multiplier
; is the carried one times the overshoot.  Over the control
; displacement table 1 has the applied, table 2 the carried multiplier.
def look
  put_loads
  stop_blocks
  command
    cycle @n_cycles
  end_command
  read_carried
  read_control
end
def equilibrate
  lam = 0.0
  loop n (1, 200)
    look
  end_loop
end
def pushover
  lam = increment
  n_point = 0
  waited = 0
  least = 1e30
  most = 0.0
  descending = 0
  going = 1
  loop while going = 1
    look
    n_point = n_point + 1
    xtable(1, n_point) = ctl_u
    ytable(1, n_point) = lam
    xtable(2, n_point) = ctl_u
    ytable(2, n_point) = lam_c
    if descending = 0 then
      missing = abs(lam - lam_c)
      most = max(most, lam_c)
      if missing <= balance_tolerance then
        lam = lam + increment
        waited = 0
        least = 1e30
      else
        if missing < 0.9 * least then
          least = missing
          waited = 0
        end_if
        waited = waited + 1
        if waited > patience then
          descending = 1
        end_if
        if lam_c < 0.9 * most - balance_tolerance then
          descending = 1
        end_if
      end_if
    end_if
    if descending = 1 then
      if lam < stop_mult then
        going = 0
      else
        lam = overshoot * lam_c
      end_if
    end_if
  end_loop
end
@equilibrate
@pushover
""".splitlines()


@dataclass
class Parsed:
    """What a file says, its blocks and ranges as the words by which each program gives them."""

    title: str = ""
    values: dict[str, float] = field(default_factory=dict)  # of `parameters`
    ids: list[str] = field(default_factory=list)
    shapes: list[list[str]] = field(default_factory=list)  # of the blocks, without the verb
    rounding: float | None = None  # m
    density: list[float] = field(default_factory=list)  # kg/m3, of the materials
    names: list[str] = field(default_factory=list)  # of the materials
    laws: list[JointLaw] = field(default_factory=list)
    kinds: list[tuple[int, list[str]]] = field(default_factory=list)  # materials, from 1; ranges
    supports: list[list[str]] = field(default_factory=list)  # ranges
    between: list[tuple[int, list[str]]] = field(default_factory=list)  # laws, from 1; two blocks

    def take(self, words: Sequence[str], comment: str) -> None:
        """Note what a command says, with the quoted text of its last comment."""
        match words:
            case ["round", length]:
                self.rounding = float(length)
            case ["block" | "poly", *shape]:
                self.shapes.append(shape)
                self.ids.append(comment)
            case ["prop", "mat", _, "dens", density]:
                self.density.append(float(density))
                self.names.append(comment)
            case ["prop", *pairs]:
                keys = zip(pairs[0::2], map(float, pairs[1::2]), strict=True)
                self.laws.append(law_of(dict(keys)))
            case ["change", "mat", k, "range", *where]:
                self.kinds.append((int(k), where))
            case ["fix", "range", *where]:
                self.supports.append(where)
            case ["@joint_law", k, *pair]:
                self.between.append((int(k), pair))


def parse(text: str) -> Parsed:
    """Read what `heading`, `command` and `parameters` wrote."""
    parsed = Parsed()
    inside: str | None = None
    for line, comment in _lines(text, parsed):
        words = [word for word in re.split(r"[\s=,()]+", line) if word]
        if words[0] == "def":
            inside = words[1]
        elif line.strip() == "end":
            inside = None
        elif inside == "parameters":
            parsed.values[words[0]] = float(words[1])
        elif inside is None:
            parsed.take(words, comment)
    return parsed


def _lines(text: str, parsed: Parsed) -> Iterator[tuple[str, str]]:
    """Whole commands without their comments, and the quoted text of the comment they have."""
    pending, comment = "", ""
    for raw in text.splitlines():
        line, _, remark = raw.partition(";")
        match = re.match(r'\s*(title )?("(?:[^"\\]|\\.)*")', remark)
        if match and match[1]:
            parsed.title = json.loads(match[2])
        elif match:
            comment = json.loads(match[2])
        if not line.strip() and not pending:
            continue
        if line.rstrip().endswith("&"):
            pending += line.rstrip()[:-1] + " "
            continue
        yield pending + line, comment
        pending, comment = "", ""


def numbers(words: Sequence[str]) -> Array:
    """Words as numbers, (n,)."""
    return np.array([float(word) for word in words])


#: Where joints have laws of their own: what the file cannot do.
LAWS_AS_DESIGNED = (
    "joints with laws of their own keep them as designed: contacts that form later get the first "
    "law"
)


def properties(assembly: Assembly, stuff: Materials) -> list[str]:
    """Commands that number the materials and the joint laws; all joints get the first law."""
    lines = [
        f"prop mat={k} dens={number(density)}  ; {quoted(material)}"
        for k, (density, material) in enumerate(zip(stuff.density, stuff.name, strict=True), 1)
    ]
    for k, law in enumerate(assembly.laws, start=1):
        lines += command("prop", f"jmat={k}", *law_words(law))
    return [*lines, "set jmatdf=1", "change jmat=1"]


def law_words(law: JointLaw) -> list[str]:
    """Joint properties, common to UDEC and 3DEC."""
    assert law.normal_stiffness is not None and law.shear_stiffness is not None
    return [
        f"jkn={number(law.normal_stiffness)}",
        f"jks={number(law.shear_stiffness)}",
        f"jfric={number(friction_angle(law))}",
        f"jcoh={number(law.cohesion)}",
        f"jtens={number(law.tensile_strength)}",
        f"jdil={number(law.dilatancy_angle)}",
        *([f"zdil={number(law.dilatancy_end)}"] if np.isfinite(law.dilatancy_end) else []),
    ]


def law_of(values: Mapping[str, float]) -> JointLaw:
    """The law of joint properties."""
    return JointLaw(
        friction_coefficient=friction_coefficient(values["jfric"]),
        normal_stiffness=values["jkn"],
        shear_stiffness=values["jks"],
        dilatancy_angle=values["jdil"],
        dilatancy_end=values.get("zdil", np.inf),
        cohesion=values["jcoh"],
        tensile_strength=values["jtens"],
    )


def pair_laws(assembly: Assembly) -> list[tuple[int, int, int]]:
    """Number of the law and rows of the two blocks, of pairs that lie near and have their own."""
    p, q = assembly.packed.near_pairs()
    a, b = assembly.packed.body[p], assembly.packed.body[q]
    index = assembly.law_index(a, b)
    return [(int(k) + 1, int(i), int(j)) for k, i, j in zip(index, a, b, strict=True) if k > 0]


#: What a file says of a block.
BLOCK = ("id", "vertices", "unit_weight", "material", "support", "faces")


def assemble(
    parsed: Parsed,
    outlines: Sequence[Array],
    *,
    within: Callable[[int, list[str]], bool],
    pair: Callable[[list[str]], tuple[int, int]],
    corner: Corner,
    area_ratio: Sequence[float] | None = None,
    faces: Sequence[Faces] | None = None,
) -> Model:
    """A model from what a file says.

    Parameters
    ----------
    within
        Whether the block of a row is in a range, which is given by its words.
    pair
        Rows of the two blocks that a law of their own names.
    area_ratio
        Area of each block in the file over that of its outline.
    faces
        In space, where ``outlines`` are vertices.
    """
    if not parsed.shapes or not parsed.laws:
        raise ValueError("it lacks block, poly or prop")
    ids, rows = parsed.ids, range(len(outlines))
    material = [next((k for k, where in parsed.kinds if within(i, where)), 1) for i in rows]
    support = [any(within(i, where) for where in parsed.supports) for i in rows]
    between = [(k, *pair(words)) for k, words in parsed.between]
    v = parsed.values
    ratio = area_ratio or [1.0] * len(outlines)
    pairs = zip(material, ratio, strict=True)
    # Rounded, so that blocks of one material have one weight again.
    weight = [float(f"{parsed.density[k - 1] * GRAVITY * r:.12g}") for k, r in pairs]
    stuff = [parsed.names[k - 1] for k in material]
    columns = (ids, outlines, weight, stuff, support, faces or [()] * len(ids))
    blocks = [Block(**dict(zip(BLOCK, row, strict=True))) for row in zip(*columns, strict=True)]
    load, at, along, centre = (
        [v[name + axis] for axis in ("xyz" if faces else "xy")]
        for name in ("load_", "ctl_", "read_", "ctl_b")
    )
    control = nearest([block.figure().centroid for block in blocks], np.array(centre))
    return make_model(
        blocks,
        joint=parsed.laws[0],
        joint_between={frozenset((ids[i], ids[j])): parsed.laws[k - 1] for k, i, j in between},
        corner=corner,
        thickness=v["thick"] if faces is None else None,
        load_direction=load,
        control_block=ids[control],
        control_point=at,
        control_direction=along,
        analysis=Analysis(
            strategy="published",
            stop_multiplier=v["stop_mult"],
            options={key: v[key] for key in STRATEGY},
        ),
        title=parsed.title,
    )


def nearest(centres: Sequence[Array], point: Array) -> int:
    """Row of the centroid that is nearest to a point."""
    return int(np.argmin([np.linalg.norm(centre - point) for centre in centres]))
