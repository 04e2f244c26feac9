"""What the writers share: numbered materials and laws, the published strategy's numbers, notes."""

from __future__ import annotations

import textwrap
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, fields
from pathlib import Path

import numpy as np

from drystone.common.arrays import Array
from drystone.control import PublishedSettings
from drystone.geometry import GeometryError
from drystone.geometry.plane import polygon
from drystone.model.assembly import GRAVITY, Assembly
from drystone.model.construction.errors import ModelError
from drystone.model.construction.words import printable
from drystone.model.joint_law import JointLaw
from drystone.model.model import Model

#: Settings of the published strategy that the files carry, with what each is.
STRATEGY = {
    "increment": "of the load multiplier, ascending",
    "overshoot": "applied over carried multiplier, descending",
    "balance_tolerance": "difference of multipliers that counts as equal",
    "patience": "steps neither in nor nearing balance that mean the peak",
}


#: Keys of [joint] that no file has, and what they are by default.
YIELDS = (
    "tensile_fracture_energy",
    "shear_fracture_energy",
    "residual_friction_coefficient",
    "residual_slip",
    "compressive_strength",
    "compressive_fracture_energy",
    "greatest_closure",
    "logarithmic_closure",
)
DRY = {declared.name: declared.default for declared in fields(JointLaw)}


@dataclass(frozen=True, kw_only=True)
class Written:
    """A file's text, and what the target cannot express, a sentence each."""

    text: str
    notes: tuple[str, ...]


@dataclass(frozen=True, kw_only=True)
class Materials:
    """Materials as other programs number them: one for each name and density."""

    density: tuple[float, ...]  # kg/m3
    name: tuple[str, ...]
    of_block: tuple[int, ...]  # counted from 1


@contextmanager
def only_ours(program: str) -> Iterator[None]:
    """Reading in here: what our writers do not write is a `ModelError`."""
    try:
        with np.errstate(over="raise", invalid="raise", divide="raise"):
            yield
    except (
        ArithmeticError,
        AttributeError,
        LookupError,
        TypeError,
        ValueError,
        SyntaxError,
    ) as error:
        what = printable(" ".join(f"{type(error).__name__}: {error}".split())[:120])
        raise ModelError([f"this {program} file is not one that drystone wrote ({what})"]) from None
    except (MemoryError, RecursionError):
        raise ModelError([f"this {program} file is nested too deeply"]) from None


def number(value: float) -> str:
    """Shortest text that reads back as the same number."""
    return repr(float(value))


def wrapped(notes: Sequence[str], mark: str) -> list[str]:
    """Notes as lines of comments that begin with ``mark``."""
    return [
        line
        for note in notes
        for line in textwrap.wrap(
            f"Note: {note}.", 78, initial_indent=mark, subsequent_indent=mark + "  "
        )
    ]


def file_name(source: str | None) -> str:
    """Name of the model file without its folders."""
    return Path(source).name if source else "a model made in Python"


def strategy(model: Model) -> dict[str, float]:
    """The published strategy's settings for a model, its own ones over the defaults."""
    default = PublishedSettings(displacement_step=1.0)
    options = model.analysis.options
    return {key: float(options.get(key, getattr(default, key))) for key in STRATEGY}


def strategy_notes(model: Model, program: str) -> list[str]:
    """What to know about the strategy that the file carries."""
    notes = [
        f"{program} gets the published strategy with an overshoot of "
        f"{strategy(model)['overshoot']:g}: its curve after the peak is biased upwards, see the "
        "page on theory"
    ]
    known = {*STRATEGY, "stop_multiplier", "mechanism_displacement"}
    left_out = [key for key in model.analysis.options if key not in known]
    if left_out:
        notes.append(f"settings that {program} has no use for were left out: {', '.join(left_out)}")
    return notes + _physics_notes(model, program)


def control_notes(model: Model, vertices: Array, program: str) -> list[str]:
    """What to know where the control point is none of its block's vertices (n, dim), as the file
    has them: other programs read how far a vertex has moved."""
    away = np.abs(vertices - model.control_point.point).max(axis=1)
    if away.min() < 1e-9:
        return []
    return [f"the control point is no corner of its block: {program} reads the nearest corner"]


def _physics_notes(model: Model, program: str) -> list[str]:
    """What the model has, and the file has not."""
    laws, notes = model.assembly.laws, []
    unlike = [key for key in YIELDS if any(getattr(law, key) != DRY[key] for law in laws)]
    if unlike:
        notes.append(f"the file's joints neither soften nor crush: {', '.join(unlike)} left out")
    if any(block.held for block in model.assembly.blocks):
        notes.append("rollers (held) were left out: those blocks are free to move")
    if model.assembly.points != model.assembly.usual_points:
        notes.append(
            f"the {model.assembly.points} contact points of an interface were left out: {program} "
            "finds its own"
        )
    if model.history is not None:
        notes.append("the history of displacements was left out: the load only grows")
    return notes


def materials(assembly: Assembly, outlines: list[Array] | None = None) -> Materials:
    """Number the materials; ``outlines`` of other area than the blocks' keep the blocks' weight."""
    numbers: dict[tuple[str, float], int] = {}
    of_block = []
    for i, block in enumerate(assembly.blocks):
        density = block.unit_weight / GRAVITY
        if outlines is not None:
            density *= polygon.signed_area(block.vertices) / polygon.signed_area(outlines[i])
            density = float(f"{density:.14g}")  # blocks of one shape get one number
        of_block.append(numbers.setdefault((block.material, density), len(numbers) + 1))
    return Materials(
        density=tuple(density for _, density in numbers),
        name=tuple(name for name, _ in numbers),
        of_block=tuple(of_block),
    )


def need_stiffness(assembly: Assembly, program: str) -> None:
    """Raise `ModelError` where a joint has no stiffness."""
    for law in assembly.laws:
        if law.normal_stiffness is None or law.shear_stiffness is None:
            raise ModelError(
                [f"joint: {program} needs normal_stiffness and shear_stiffness: add them in Pa/m"]
            )


def need_convex(assembly: Assembly, program: str) -> None:
    """Raise `ModelError` where a block has several parts."""
    several = [
        block.id
        for block, figure in zip(assembly.blocks, assembly.figures, strict=True)
        if len(figure.parts) > 1
    ]
    if several:
        raise ModelError(
            [
                f'block "{several[0]}"{f" and {len(several) - 1} more" * (len(several) > 1)}: '
                f"{program} has only convex blocks, and this one has several parts: leave it "
                "out, or make its parts blocks of their own"
            ]
        )


def mass_direction(model: Model, program: str) -> Array:
    """(dim,) direction of forces in proportion to mass; raises `ModelError` for all other loads."""
    if model.settlement is not None:
        raise ModelError(
            [
                f"settlement: a file for {program} has no supports that move: use an engine of "
                "drystone"
            ]
        )
    if model.load.name != "mass":
        raise ModelError(
            [
                f'load.pattern: a file for {program} has the pattern "mass", and this is '
                f'"{model.load.name}": take an engine of drystone'
            ]
        )
    if model.dead_loads:
        raise ModelError(
            [f"dead_load: a file for {program} has only the weight: use an engine of drystone"]
        )
    if model.ties:
        raise ModelError([f"tie: a file for {program} has no ties: use an engine of drystone"])
    return model.load_along


def left_sharp(assembly: Assembly, program: str) -> list[str]:
    """What to know of edges in space that are rounded or cut off."""
    corner = assembly.corner
    if not corner.radius and not corner.chamfer:
        return []
    return [f"the edges are {corner.words} in the model, and sharp in {program}"]


def leg_of(assembly: Assembly) -> float:
    """Legs of the chamfers that stand for the corners [m]; 0 for sharp ones."""
    return float(assembly.corner.chamfer or assembly.corner.radius or 0.0)


def chamfered(assembly: Assembly) -> list[Array]:
    """Outlines with chamfers of `leg_of`, or as they are.

    Raises
    ------
    ModelError
        Rounded corners fit where chamfers with legs of their radius do not: at blunt corners.
    """
    leg = leg_of(assembly)
    if not leg:
        return [block.vertices for block in assembly.blocks]
    outlines = []
    for block in assembly.blocks:
        try:
            outlines.append(polygon.chamfered_core(block.vertices, leg).vertices)
        except GeometryError as error:
            raise ModelError(
                [f'corner, at block "{block.id}": corners become chamfers, and {error}']
            ) from None
    return outlines


def unchamfered(outline: Array) -> Array:
    """Outline that `polygon.chamfered_core` was given, from what it made of it."""
    start, end = outline[0::2], outline[1::2]
    direction = end - start
    before, along = np.roll(start, 1, axis=0), np.roll(direction, 1, axis=0)
    # Where each edge meets the one before it.
    cross = along[:, 0] * direction[:, 1] - along[:, 1] * direction[:, 0]
    arm = start - before
    share = (arm[:, 0] * direction[:, 1] - arm[:, 1] * direction[:, 0]) / cross
    return before + share[:, None] * along


def friction_angle(law: JointLaw) -> float:
    """Degrees."""
    return float(np.degrees(np.arctan(law.friction_coefficient)))


def friction_coefficient(angle: float) -> float:
    """Of a friction angle in degrees."""
    return float(np.tan(np.radians(angle)))
