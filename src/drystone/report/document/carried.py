"""Tables of what a structure carries beside its own weight: ties and springs, dead loads."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence

import numpy as np
from numpy.typing import ArrayLike

from drystone.common.language import number as spelt
from drystone.model.loading import DeadLoad
from drystone.model.model import Model
from drystone.model.ties import STATES, Tie, TieEnd, names_of
from drystone.report.document.facts import NOTHING, number
from drystone.results.forces import TieRecord

Words = Mapping[str, str]


def of_ties(ties: Sequence[Tie], words: Words) -> list[tuple[str, ...]]:
    """Name, both ends, stiffness, strength and breaking elongation of every tie."""
    return [
        (
            name,
            _end(tie.start, words),
            _end(tie.end, words),
            number(tie.per_length, "N/m"),
            number(tie.pretension / 1e3, "kN") if tie.pretension else NOTHING,
            number(tie.strength / 1e3, "kN"),
            number(tie.breaking_elongation, "m"),
            words["yes"] if tie.compression else words["no"],
        )
        for name, tie in zip(names_of(ties), ties, strict=True)
    ]


def _end(end: TieEnd, words: Words) -> str:
    """A block and a point of it."""
    point = _listed(end.point, ".5g", words)
    return f"{words['ground'] if end.block is None else end.block} ({point})"


def _listed(values: ArrayLike, form: str, words: Words) -> str:
    """Coordinates, in the language that is spoken."""
    # Rounded sums are no -0.
    numbers = (spelt(float(f"{x:{form}}") + 0.0, "g") for x in np.asarray(values, float).tolist())
    return words["between_numbers"].join(numbers)


def ties_at(record: TieRecord, rows: Sequence[int], words: Words) -> list[tuple[str, ...]]:
    """Force and state of every tie at points of the curve, a column each."""
    return [
        (name, *(_does(record, row, column, words) for row in rows))
        for column, name in enumerate(record.names)
    ]


def _does(record: TieRecord, row: int, column: int, words: Words) -> str:
    state = words[STATES[record.branch[row, column]]]
    force = float(record.force[row, column])
    return f"{number(force / 1e3, 'kN')}, {state}" if force else state


def of_dead_loads(model: Model, words: Words) -> list[tuple[str, ...]]:
    """Name, kind, place, resultant with its direction, stage and mass of every dead load."""
    return [
        (
            load.name or f"{words['load']} {k + 1}",
            words[f"kind_{load.keys()['kind']}"],
            _place(load, words),
            *_resultant(load, model, words),
            str(load.stage),
            words["yes"] if load.mass else words["no"],
        )
        for k, load in enumerate(model.dead_loads)
    ]


def _place(load: DeadLoad, words: Words) -> str:
    """The block or group, and which point or faces of it."""
    keys = load.keys()
    of = "block" if "block" in keys else "group"
    found = words[f"on_{of}"].format(name=keys[of])
    if "side" in keys:
        side = _listed(keys["side"], ".3g", words)
        return f"{found}, {words['faces'].format(side=side)}"
    point = keys["point"]
    if isinstance(point, str):
        return f"{found}, {words[f'at_{point}']}"
    return f"{found}, ({_listed(point, '.5g', words)}) m"


def _resultant(load: DeadLoad, model: Model, words: Words) -> tuple[str, str]:
    """The sum of its forces, and which way it acts: down, or a unit vector."""
    total = load.forces(model.assembly).force.sum(axis=0)
    size = float(np.linalg.norm(total))
    if not size > 0.0:
        return number(0.0, "kN"), NOTHING
    way = total / size
    if math.isclose(float(way @ model.assembly.up), -1.0, rel_tol=1e-9):
        return number(size / 1e3, "kN"), words["down"]
    return number(size / 1e3, "kN"), f"({_listed(way, '.3f', words)})"
