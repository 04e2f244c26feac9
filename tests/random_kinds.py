"""Random structures of every kind, plane and space, by name.

    model = KINDS["tower"](seed)

One seed, one structure, the same on every machine.  Of those made here, what does not stand with a
margin by limit analysis is drawn again; their joints are as soft as 1e8 Pa/m or as stiff as 1e12,
friction is any of masonry's, loads come from any side, half of them up or down a slope.  Names that
end in "-plane" are of the plane, and so are "plane" and "bonded".
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import partial

import numpy as np
from numpy.random import Generator

import buildings
import drystone as ds
from bonded_walls import KINDS as BONDS
from bonded_walls import bonded_law, bonded_wall
from buildings import stone_of
from drystone.geometry import GeometryError
from drystone.limit import ASSOCIATIVE, collapse_load
from drystone.model import builders
from drystone.model.builders import placed
from drystone.model.builders.coursing import Bond, Line
from drystone.model.builders.panel import panel
from drystone.model.builders.piers import pier
from drystone.model.builders.portal import LINTEL
from drystone.model.builders.profile import SHAPES
from drystone.model.builders.stones import Mason, rectangle
from drystone.model.builders.strip import Strip
from random_solids import MOST_DRAWS, random_solids, stands_with_margin
from structures import structure

#: Most blocks of a structure, its base included.
MOST_BLOCKS = 80
#: Steepest load, up or down from the horizontal [degrees].
STEEPEST = 20.0

#: Free blocks of a structure, and its supports where it is not to stand on a base under all.
Maker = Callable[[Generator, bool], list[ds.Block]]


def drawn(seed: int, name: str, make: Maker, space: bool) -> ds.Model:
    """A structure of its own in the plane or in space, of dry joints."""
    rng = np.random.default_rng([seed, space, *name.encode()])
    for _ in range(MOST_DRAWS):
        try:
            blocks = make(rng, space)
            if not any(block.support for block in blocks):
                blocks = placed(blocks, base=True)
            model = _model(rng, blocks, space)
        except (ds.ModelError, GeometryError):  # measures that fit no structure
            continue
        if 2 <= model.assembly.n_blocks <= MOST_BLOCKS and _can_be_traced(model):
            return replace(model, title=f"{name} {seed}")
    raise AssertionError(f"{name} {seed}: none of {MOST_DRAWS} stands")


def _model(rng: Generator, blocks: Sequence[ds.Block], space: bool) -> ds.Model:
    """Blocks with joints, edges, weight and load at random."""
    weight = float(rng.uniform(15e3, 25e3))
    blocks = [replace(block, unit_weight=weight) for block in blocks]
    size = min(float(np.ptp(b.vertices, axis=0).min()) for b in blocks if not b.support)
    small = round(0.03 * size, 4)
    corner = {0: ds.Corner(radius=small), 1: ds.Corner(chamfer=small)}
    stiffness = any_stiffness(rng)
    law = ds.JointLaw(
        friction_coefficient=round(float(rng.uniform(0.4, 0.9)), 3),
        normal_stiffness=stiffness,
        shear_stiffness=stiffness * float(rng.choice([0.4, 1.0, 10.0])),
    )
    return ds.make_model(
        blocks,
        joint=law,
        load_direction=any_direction(rng, space),
        corner=corner.get(int(rng.integers(8))),
        points=int(rng.choice([4, 4, 9] if space else [2, 2, 5])),
        **({} if space else {"thickness": 1.0}),
    )


def _can_be_traced(model: ds.Model) -> bool:
    """Whether it stands with a margin, and some multiple of its load brings it down."""
    return stands_with_margin(model) and np.isfinite(
        collapse_load(model, flow=ASSOCIATIVE).load_multiplier
    )


def any_stiffness(rng: Generator) -> float:
    """Of joints in compression [Pa/m]."""
    return 10.0 ** float(rng.uniform(8.0, 12.0))


def any_direction(rng: Generator, space: bool) -> tuple[float, ...]:
    """Of the load, half of them level."""
    slope = np.radians(float(rng.uniform(-STEEPEST, STEEPEST)) * float(rng.integers(2)))
    if not space:
        return float(rng.choice([-1.0, 1.0]) * np.cos(slope)), float(np.sin(slope))
    angle = float(rng.uniform(0.0, 2.0 * np.pi))
    level = np.cos(slope) * np.array([np.cos(angle), np.sin(angle)])
    return float(level[0]), float(level[1]), float(np.sin(slope))


# --- walls -----------------------------------------------------------------------------------


def opening(rng: Generator, space: bool) -> list[ds.Block]:
    """A wall with one or two openings, in any bond."""
    unit = round(float(rng.uniform(0.3, 0.5)), 2), round(float(rng.uniform(0.15, 0.25)), 2)
    n, courses = int(rng.integers(1, 3)), int(rng.integers(4, 8))
    sill = int(rng.integers(0, courses - 3)) * unit[1]
    high = int(rng.integers(1, 3)) * unit[1]
    wide = float(rng.uniform(0.8, 1.5)) * unit[0]
    pier_wide = float(rng.uniform(1.5, 2.2)) * unit[0]
    return panel(
        length=n * wide + (n + 1) * pier_wide,
        height=courses * unit[1],
        unit=unit,
        unit_weight=1.0,
        thickness=float(rng.uniform(0.15, 0.35)) if space else None,
        bond=str(rng.choice(["running", "stack", "flemish"])) if space else "running",
        openings=[
            {"at": pier_wide + k * (wide + pier_wide), "width": wide, "height": high, "sill": sill}
            for k in range(n)
        ],
    )


def leaves(rng: Generator, space: bool) -> list[ds.Block]:
    """Two or three leaves side by side, joined by headers in some courses, or by none."""
    unit = round(float(rng.uniform(0.35, 0.5)), 2), round(float(rng.uniform(0.15, 0.25)), 2)
    return panel(
        length=float(rng.uniform(2.0, 3.5)) * unit[0],
        height=int(rng.integers(4, 8)) * unit[1],
        unit=unit,
        unit_weight=1.0,
        thickness=float(rng.uniform(0.35, 0.6)),
        leaves=int(rng.integers(2, 4)),
        headers=int(rng.choice([0, 2, 3])),
    )


def rubble(rng: Generator, space: bool) -> list[ds.Block]:
    """A piece of wall of polygonal stones, which go through it in space."""
    return builders.rubble(
        length=float(rng.uniform(0.8, 2.0)),
        height=float(rng.uniform(0.6, 1.8)),
        stone=(float(rng.uniform(0.25, 0.45)), float(rng.uniform(0.18, 0.3))),
        seed=int(rng.integers(2**31)),
        unit_weight=1.0,
        depth=float(rng.uniform(0.25, 0.5)) if space else None,
    )


def tower(rng: Generator, space: bool) -> list[ds.Block]:
    """Round or square with openings that climb around it; in the plane, two piers in one."""
    unit = round(float(rng.uniform(0.4, 0.6)), 2), round(float(rng.uniform(0.25, 0.4)), 2)
    courses, n = int(rng.integers(4, 8)), int(rng.integers(0, 3))
    sill, high = int(rng.integers(1, 3)) * unit[1], unit[1]
    if space:
        return builders.tower(
            width=float(rng.uniform(1.0, 1.6)),
            thickness=float(rng.uniform(0.2, 0.35)),
            height=courses * unit[1],
            unit=unit,
            unit_weight=1.0,
            shape=str(rng.choice(["round", "square"])),
            openings=n,
            opening=(0.8 * unit[0], high),
            first_sill=sill,
            climb=unit[1],
        )
    courses, wide = courses + 4, float(rng.uniform(0.8, 1.2)) * unit[0]
    length = wide + float(rng.uniform(2.5, 3.5)) * unit[0]
    at = 0.5 * (length - wide)
    openings = [
        {"at": at, "width": wide, "height": high, "sill": sill + 3 * k * unit[1]} for k in range(n)
    ]
    return panel(
        length=length, height=courses * unit[1], unit=unit, unit_weight=1.0, openings=openings
    )


def stairs(rng: Generator, space: bool) -> list[ds.Block]:
    """A flight of steps on masonry; in space their ends are built into a wall, each step lies on
    the one below, and nothing else carries it."""
    tread, rise = float(rng.uniform(0.28, 0.4)), float(rng.uniform(0.16, 0.22))
    n, over = int(rng.integers(3, 7)), float(rng.uniform(0.1, 0.3))
    mason = Mason(unit_weight=1.0)
    thick, out = float(rng.uniform(0.25, 0.45)), float(rng.uniform(0.4, 0.9))
    strip = Strip(
        mason=mason, bond=Bond(name="running", unit=tread), thickness=thick if space else None
    )
    end = (n + 1.0) * tread
    made = []
    for k in range(n):
        levels, step = (k * rise, (k + 1) * rise), (k * tread, (k + 1.0 + over) * tread)
        if not space:
            made += strip.course(k, levels, Line(step[0]), Line(end + 0.5 * tread))
            continue
        made.append(
            mason.box(f"step{k}", (step[0], 0.0, levels[0]), (step[1], thick + out, levels[1]))
        )
        if k > 0:
            made += strip.course(k, levels, Line(0.0), Line(step[0]))
        before = replace(strip, prefix="b")
        made += before.course(k, levels, Line(step[1]), Line(end + 0.5 * tread))
    for k in range(n, n + int(rng.integers(1, 3)) if space else n):
        made += strip.course(k, (k * rise, (k + 1) * rise), Line(0.0), Line(end + 0.5 * tread))
    return made


# --- arches ----------------------------------------------------------------------------------


def arch(rng: Generator, space: bool) -> list[ds.Block]:
    """An arch of any intrados between abutments."""
    span = float(rng.uniform(1.0, 3.0))
    return builders.arch(
        thickness=span * float(rng.uniform(0.08, 0.2)),
        unit_weight=1.0,
        span=span,
        rise=span * float(rng.uniform(0.2, 0.7)),
        shape=str(rng.choice(SHAPES)),
        voussoirs=2 * int(rng.integers(3, 9)) + int(rng.integers(2)),
        depth=float(rng.uniform(0.3, 0.8)) if space else None,
        abutments=True,
    )


def portal(rng: Generator, space: bool) -> list[ds.Block]:
    """An arch or a lintel on piers of courses."""
    span, shape = float(rng.uniform(0.8, 2.0)), str(rng.choice([*SHAPES, LINTEL]))
    curve = {} if shape == LINTEL else {"voussoirs": 2 * int(rng.integers(3, 6)) + 1}
    wide = float(rng.uniform(0.4, 0.9))
    return builders.portal(
        span=span,
        thickness=span * float(rng.uniform(0.12, 0.22)),
        pier_width=wide,
        pier_height=float(rng.uniform(0.5, 1.5)),
        unit=(wide * float(rng.choice([0.5, 1.1])), float(rng.uniform(0.2, 0.35))),
        unit_weight=1.0,
        shape=shape,
        depth=float(rng.uniform(0.3, 0.7)) if space else None,
        **curve,
    )


def plateband(rng: Generator, space: bool) -> list[ds.Block]:
    """A flat arch, its joints through one point below, between abutments or on piers; in space it
    may be of two rings side by side."""
    span, n = float(rng.uniform(1.0, 2.5)), 2 * int(rng.integers(2, 6)) + 1
    high, lean = span * float(rng.uniform(0.15, 0.3)), float(rng.uniform(0.1, 0.4))
    wide, foot = float(rng.uniform(0.5, 1.0)), 0.0
    depth = (0.0, float(rng.uniform(0.3, 0.6))) if space else None
    mason, on_piers = Mason(unit_weight=1.0), bool(rng.integers(2))
    low = np.linspace(-0.5 * span, 0.5 * span, n + 1)
    top = low * (1.0 + 2.0 * lean * high / span)
    made = []
    sides = {"left": (-0.5 * span - wide, -0.5 * span), "right": (0.5 * span, 0.5 * span + wide)}
    if on_piers:
        foot = float(rng.uniform(0.4, 1.0))
        unit = wide, float(rng.uniform(0.2, 0.35))
        for side, own in sides.items():
            made += pier(mason, unit, own, foot, depth[1] if depth else None, f"{side}/", side)
    for side, inner, a, b in (
        ("left", -1.0, low[0], top[0]),
        ("right", 1.0, low[-1], top[-1]),
    ):
        end = inner * (0.5 * span + wide)
        outline = np.array([(a, foot), (b, foot + high), (end, foot + high), (end, foot)])
        outline = outline if inner < 0.0 else outline[::-1]
        made.append(mason.upright(f"{side}/end", outline, depth, support=not on_piers))
    rings = int(rng.integers(1, 3)) if depth else 1
    for k in range(n):
        outline = np.array(
            [
                (low[k], foot),
                (low[k + 1], foot),
                (top[k + 1], foot + high),
                (top[k], foot + high),
            ]
        )
        cuts = np.linspace(*depth, rings + 1) if depth else [None]
        for r in range(rings):
            own = (float(cuts[r]), float(cuts[r + 1])) if depth else None
            made.append(mason.upright(f"v{k}r{r}", outline, own))
    return made


def vault(rng: Generator, space: bool) -> list[ds.Block]:
    """A barrel in running bond, or a groin vault over a square."""
    span = float(rng.uniform(1.2, 3.0))
    thickness = span * float(rng.uniform(0.1, 0.16))
    if rng.integers(2):
        return builders.groin_vault(
            span=span,
            thickness=thickness,
            voussoirs=int(rng.choice([5, 7])),
            unit=float(rng.uniform(0.35, 0.6)) * span,
            unit_weight=1.0,
            mitred=bool(rng.integers(2)),
        )
    length = span * float(rng.uniform(0.4, 0.9))
    return builders.barrel_vault(
        length=length,
        thickness=thickness,
        unit=length / float(rng.uniform(1.5, 3.0)),
        unit_weight=1.0,
        span=span,
        rise=span * float(rng.uniform(0.25, 0.6)),
        shape=str(rng.choice(SHAPES)),
        voussoirs=2 * int(rng.integers(3, 6)) + 1,
        abutments=True,
    )


# --- stacks ----------------------------------------------------------------------------------


def leaning(rng: Generator, space: bool) -> list[ds.Block]:
    """One to three stacks whose stones lean to one side, each further out than the one below."""
    made = []
    for s in range(int(rng.integers(1, 4))):
        n, z, turn = int(rng.integers(3, 9)), 0.0, float(rng.uniform(0.0, 2.0 * np.pi))
        half = rng.uniform(0.2, 0.4, 2)
        out = float(rng.uniform(0.2, 0.9)) * half.min() / n
        middle = np.array([1.4 * s, 0.0])
        step = out * np.array([np.cos(turn), np.sin(turn)])
        ring = np.array([(-1, -1), (1, -1), (1, 1), (-1, 1)]) * half
        for k in range(n):
            top = z + float(rng.uniform(0.15, 0.35))
            if space:
                c, w = np.cos(0.1 * k), np.sin(0.1 * k)  # and turns as it goes up
                own = ring @ np.array([[c, w], [-w, c]]) if s % 2 else ring
                low, high = own + middle, own + middle + step
                vertices = np.vstack(
                    [np.column_stack((r, np.full(4, h))) for r, h in ((low, z), (high, top))]
                )
                made.append(stone_of(f"s{s}b{k}", vertices))
            else:
                (x, _), (dx, _) = middle, step
                outline = rectangle(x - half[0], z, x + half[0], top)
                outline[2:, 0] += dx
                made.append(Mason(unit_weight=1.0).upright(f"s{s}b{k}", outline, None))
            middle, z = middle + step, top
    return made


# --- of others -------------------------------------------------------------------------------


def _other(rng: Generator, space: bool) -> ds.Model:
    """A structure of any kind with dry joints."""
    own = SPACE if space else PLANE
    name = str(rng.choice([*own]))
    return drawn(int(rng.integers(2**31)), name, own[name], space)


def changed(seed: int, name: str, change: Callable[..., ds.Model], space: bool) -> ds.Model:
    """A structure of any kind, changed; drawn again where it then does not stand.

    With mortar it is not asked again: limit analysis takes minutes where joints can be crushed.
    """
    rng = np.random.default_rng([seed, space, *name.encode()])
    for _ in range(MOST_DRAWS):
        other = _other(rng, space)
        model = change(rng, other)
        if change is mortar or _can_be_traced(model):
            return replace(model, title=f"{name} {seed}: {other.title}")
    raise AssertionError(f"{name} {seed}: none of {MOST_DRAWS} stands")


def tied(rng: Generator, model: ds.Model) -> ds.Model:
    """With a tie from its highest block to the ground, and in half of them another from the
    highest to the lowest; some are tightened, some break."""
    a = model.assembly
    free = np.flatnonzero(~a.fixed)
    order = free[np.argsort(a.centroid[free] @ a.up)]
    place = [block.vertices.mean(axis=0) for block in a.blocks]
    height = float(place[order[-1]] @ a.up)
    foot = place[order[-1]] - height * a.up
    foot[0] += float(rng.choice([-1.0, 1.0]) * rng.uniform(0.5, 1.5)) * height
    ends = [(order[-1], ds.TieEnd(point=foot))]
    if len(order) > 3 and rng.integers(2):
        other = int(order[len(order) // 2])
        ends.append((order[-2], ds.TieEnd(block=a.ids[other], point=place[other])))
    ties = []
    for k, (row, end) in enumerate(ends):
        start = ds.TieEnd(block=a.ids[row], point=place[row])
        strength = float(rng.uniform(0.2, 2.0) * a.heaviest_weight)
        tie = ds.Tie(
            name=f"t{k}",
            start=start,
            end=end,
            area=3e-4,
            young_modulus=2e11,
            yield_force=strength,
            pretension=float(rng.choice([0.0, 0.2])) * strength,
            breaking_elongation=float(rng.choice([np.inf, 0.01])),
            compression=False,
        )
        ties.append(tie)
    return model.with_ties(ties)


def loaded(rng: Generator, model: ds.Model) -> ds.Model:
    """With a surcharge on its highest block, as a mass or not, and a force on another one."""
    a = model.assembly
    free = np.flatnonzero(~a.fixed)
    order = free[np.argsort(a.centroid[free] @ a.up)]
    weight = float(a.heaviest_weight)
    roof = ds.SurchargeLoad(
        block=a.ids[order[-1]],
        weight=float(rng.uniform(0.3, 5.0)) * weight,
        point=str(rng.choice(["top", "centre"])),
        mass=bool(rng.integers(2)),
    )
    force = rng.uniform(-0.2, 0.2, a.dimension) * weight
    push = ds.ForceLoad(block=a.ids[int(rng.choice(free))], force=force, mass=False)
    return model.with_load(dead_loads=(roof, push)[: int(rng.integers(1, 3))])


def mortar(rng: Generator, model: ds.Model) -> ds.Model:
    """With bonds that soften, joints that are crushed, or both."""
    a = model.assembly
    weight = max(block.unit_weight for block in a.blocks)
    top = max(float((block.vertices @ a.up).max()) for block in a.blocks)
    return ds.make_model(
        a.blocks,
        joint=bonded_law(rng, str(rng.choice(BONDS)), weight * max(top, 0.5)),
        load=model.load,
        corner=a.corner,
        points=9 if a.dimension == 3 else 5,
        analysis=ds.Analysis(options={"max_displacement": 0.2 * max(top, 0.5)}),
        **({} if a.dimension == 3 else {"thickness": a.thickness}),
    )


def stiff(seed: int, space: bool) -> ds.Model:
    """A structure of `structures` or `random_solids`, its joints of any stiffness and its load from
    any side."""
    rng = np.random.default_rng([seed, space])
    for k in range(MOST_DRAWS):
        other = int(rng.integers(2**31)) + k
        model = (random_solids if space else structure)(other)
        stiffness = any_stiffness(rng) * max(1.0, float(np.ptp(model.assembly.centroid[:, -1])))
        model = model.with_joint(
            normal_stiffness=stiffness,
            shear_stiffness=stiffness * float(rng.choice([0.4, 1.0, 100.0])),
        ).with_load(direction=any_direction(rng, space))
        if _can_be_traced(model):
            analysis = replace(model.analysis, engine="equilibrium")
            return replace(model, title=f"stiff {seed}: {model.title}", analysis=analysis)
    raise AssertionError(f"stiff {seed}: none of {MOST_DRAWS} stands")


# --- buildings, domes ------------------------------------------------------------------------


def _joints(rng: Generator) -> dict[str, float]:
    """Friction and stiffness of any kind of joint that walls have."""
    return {
        "friction": round(float(rng.uniform(0.45, 0.85)), 3),
        "stiffness": any_stiffness(rng),
    }


def corner(seed: int) -> ds.Model:
    """Two walls that meet in a corner."""
    rng = np.random.default_rng(seed)
    units = int(rng.integers(2, 5)), int(rng.integers(2, 5))
    courses = int(rng.integers(3, 8))
    return buildings.corner_wall(units, courses, push=_any_side(rng), **_joints(rng))


def box(seed: int) -> ds.Model:
    """Four walls around a square."""
    rng = np.random.default_rng(seed)
    size = int(rng.integers(2, 5)), int(rng.integers(3, 6))
    return buildings.box_building(*size, push=_any_side(rng), **_joints(rng))


def round_arch(seed: int) -> ds.Model:
    """A segment of a circle in space."""
    rng = np.random.default_rng(seed)
    shape = {
        "n_voussoirs": int(rng.integers(7, 24)),
        "thickness": float(rng.uniform(0.25, 0.5)),
        "width": float(rng.uniform(0.3, 0.9)),
        "embrace": float(rng.choice([120.0, 140.0, 160.0])),
    }
    return buildings.arch(**shape, push=_any_side(rng), **_joints(rng))


def dome(seed: int) -> ds.Model:
    """A hemisphere of voussoirs."""
    rng = np.random.default_rng(seed)
    shape = int(rng.integers(3, 7)), int(rng.integers(8, 14))
    thickness = float(rng.uniform(0.35, 0.6))
    return buildings.dome(*shape, thickness=thickness, push=_any_side(rng), **_joints(rng))


def _any_side(rng: Generator) -> tuple[float, float, float]:
    angle = float(rng.uniform(0.0, 2.0 * np.pi))
    return np.cos(angle), np.sin(angle), 0.0


SPACE: dict[str, Maker] = {
    "opening": opening,
    "leaves": leaves,
    "rubble": rubble,
    "tower": tower,
    "stairs": stairs,
    "arches": arch,
    "portal": portal,
    "plateband": plateband,
    "vault": vault,
    "leaning": leaning,
}
#: Leaves and vaults are of space alone.
PLANE: dict[str, Maker] = {
    name: make for name, make in SPACE.items() if name not in ("leaves", "vault")
}
CHANGED: dict[str, Callable[[Generator, ds.Model], ds.Model]] = {
    "tied": tied,
    "loaded": loaded,
    "mortar": mortar,
}


def _kinds() -> dict[str, Callable[[int], ds.Model]]:
    made: dict[str, Callable[[int], ds.Model]] = {
        "plane": structure,
        "bonded": bonded_wall,
        "solids": random_solids,
        "bonded-space": partial(bonded_wall, dimension=3),
        "corner": corner,
        "box": box,
        "arch": round_arch,
        "dome": dome,
    }
    for space, own, end in ((False, PLANE, "-plane"), (True, SPACE, "")):
        for name, make in own.items():
            made[name + end] = partial(drawn, name=name, make=make, space=space)
        for name, change in CHANGED.items():
            made[name + end] = partial(changed, name=name, change=change, space=space)
        made[f"stiff{end}"] = partial(stiff, space=space)
    return made


KINDS = _kinds()
