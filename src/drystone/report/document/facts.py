"""Rows of the report's tables: names from the words, values with their units."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping
from typing import Any

import numpy as np

from drystone.common.language import number as spelt
from drystone.common.language import said_end, say, spoken
from drystone.model.assembly import Assembly
from drystone.model.joint_law import JointLaw
from drystone.model.model import Model
from drystone.results.curve import DYNAMIC, CapacityCurve

#: What stands for a number that there is none of.
NOTHING = "\N{EN DASH}"
TIMES = " \N{MULTIPLICATION SIGN} "
Row = tuple[str, str]
Words = Mapping[str, str]


def number(value: Any, unit: str = "", digits: int = 4) -> str:
    """A number with its unit, in the language that is spoken; a dash where there is none."""
    if value is None or (isinstance(value, float) and not math.isfinite(value)):
        return NOTHING
    text = spelt(float(value), f".{digits}g") if not isinstance(value, int) else str(value)
    return f"{text} {unit}".strip()


def status_words(status: str) -> str:
    """How an analysis ended, in the language that is spoken; as it is where no table has it."""
    try:
        return say(f"status.{status}").spoken
    except KeyError:
        return status


def of_model(model: Model, words: Words) -> list[Row]:
    """What the model holds."""
    a = model.assembly
    low, high = a.packed.vertices.min(axis=0), a.packed.vertices.max(axis=0)
    control = model.control_point
    point = words["between_numbers"].join(spelt(x, ".5g") for x in control.point)
    rows = [
        (words["dimension"], str(a.dimension)),
        (words["blocks"], str(a.n_blocks)),
        (words["supports"], str(a.n_supports)),
        (words["joints"], str(len(a.interfaces.block_a))),
        (words["volume"], number(float(a.volume[~a.fixed].sum()), "m³")),
        (words["weight"], number(float(a.weight[~a.fixed].sum()) / 1e3, "kN")),
        (words["size"], TIMES.join(number(float(side), "m") for side in high - low)),
    ]
    if model.settlement is not None:
        rows.append((words["load"], spoken(model.settlement.words)))
    else:
        on = words["on_block"].format(point=point, block=a.ids[control.block])
        rows += [(words["load"], spoken(model.load.words)), (words["control"], on)]
    rows.append((words["corner"], spoken(a.corner.words)))
    if a.depth is not None:
        rows.insert(1, (words["thickness"], number(a.depth, "m")))
    return rows


def of_cycles(curve: CapacityCurve, words: Words) -> dict[str, Any] | None:
    """A head, and a row for each cycle of a curve that goes to and fro; None without any."""
    if not curve.cycles:
        return None
    rows = []
    for k, cycle in enumerate(curve.cycles, 1):
        stiffness = cycle.secant_stiffness
        values = (
            cycle.energy,
            cycle.damping,
            None if stiffness is None else 1e-3 * stiffness,
            cycle.greatest,
            cycle.least,
            cycle.residual_after_greatest,
            cycle.residual_after_least,
        )
        rows.append((str(k), *(number(value) for value in values)))
    return {"head": list(words.values()), "rows": rows}


def of_materials(assembly: Assembly) -> list[tuple[str, ...]]:
    """Material, unit weight, number of blocks, their weight; supports apart."""
    found: dict[tuple[str, float], list[int]] = {}
    for i, block in enumerate(assembly.blocks):
        if not assembly.fixed[i]:
            found.setdefault((block.material, block.unit_weight), []).append(i)
    return [
        (
            name or NOTHING,
            number(unit_weight / 1e3, "kN/m³"),
            str(len(rows)),
            number(float(assembly.weight[rows].sum()) / 1e3, "kN"),
        )
        for (name, unit_weight), rows in found.items()
    ]


def of_laws(assembly: Assembly, words: Words) -> list[tuple[str, ...]]:
    """Joints and the numbers of their law; the general one first."""
    general = words["others"] if assembly.joint_between else words["all_joints"]
    laws = [(general, assembly.joint)]
    laws += [
        (f" {NOTHING} ".join(sorted(names)), law) for names, law in assembly.joint_between.items()
    ]
    return [(name, *_law(law)) for name, law in laws]


def _law(law: JointLaw) -> tuple[str, ...]:
    return (
        number(law.friction_coefficient),
        number(law.normal_stiffness, "Pa/m"),
        number(law.shear_stiffness, "Pa/m"),
        f"{spelt(law.dilatancy_angle, 'g')}°",
        number(law.cohesion, "Pa"),
        number(law.tensile_strength, "Pa"),
    )


def of_analysis(
    curve: CapacityCurve, model: Model | None, summary: Mapping[str, Any], words: Words
) -> list[Row]:
    """How it was traced and what came out."""
    rows = [
        (words["engine"], curve.engine),
        (words["strategy"], curve.strategy),
        (words["stop"], number(curve.stop_multiplier)),
    ]
    if model is not None and model.analysis.options:
        given = model.analysis.options.items()
        options = words["between_numbers"].join(f"{k} = {spelt(v, 'g')}" for k, v in given)
        rows.append((words["options"], options))
    rows += [
        (words["status"], status_words(curve.status)),
        (words["reason"], spoken(said_end(curve.reason))),
    ]
    if curve.points:
        peak = curve.peak
        name = words["peak"] if curve.peak_passed else words["highest"]
        if curve.rises_after_collapse:
            whole, name = curve.capacity, words["highest_after"]
            rows += [
                (words["capacity"], number(whole.load_multiplier)),
                (words["peak_at"], number(whole.control_displacement, "m")),
            ]
        rows += [
            (name, number(peak.load_multiplier)),
            (words["peak_at"], number(peak.control_displacement, "m")),
            (words["ultimate"], number(curve.ultimate_displacement, "m")),
        ]
    rows += _of_limits(summary, words)
    if curve.events:
        rows.append((words["events"], "; ".join(event.said.spoken for event in curve.events)))
    if math.isfinite(curve.wall_time):
        rows.append((words["wall_time"], number(curve.wall_time, "s", 3)))
    return rows


def _of_limits(summary: Mapping[str, Any], words: Words) -> list[Row]:
    """Multipliers of limit analysis, with the ranges that contact points and paths leave."""
    low, high = summary.get("collapse_range") or (summary.get("non_associative_multiplier"), None)
    ranges = (
        (
            ("associative", summary.get("associative_multiplier")),
            ("across_corners", summary.get("upper_bound")),
        ),
        (("non_associative", low), ("non_associative_most", high)),
    )
    rows: list[Row] = []
    for (key, least), (key_of_most, most) in ranges:
        if least is not None:
            rows.append((words[key], number(least)))
        if most is not None and number(most) != number(least):
            rows.append((words[key_of_most], number(most)))
    return rows


def of_certificate(curve: CapacityCurve, model: Model | None, words: Words) -> list[Row]:
    """What judges every point: the worst of all of them."""
    if not curve.points:
        return []
    rows = [
        (words["points"], str(len(curve.points))),
        (words["dynamic"], str(int(np.sum(curve.column("status") == DYNAMIC)))),
        (words["unstable"], str(int(np.sum(curve.column("unstable"))))),
        (words["residual"], _worst(curve, "residual", words["of_heaviest"], words)),
    ]
    share = ""
    if model is not None:
        deepest = np.nanmax(np.append(curve.column("penetration"), 0.0))
        percent = spelt(100.0 * deepest / model.assembly.smallest_extent, ".2g")
        share = f"{words['between_numbers']}{percent} {words['of_smallest']}"
    rows.append((words["penetration"], _worst(curve, "penetration", "m", words) + share))
    for name, column in (("friction", "friction_violation"), ("lost_shear", "lost_shear")):
        rows.append((words[name], _worst(curve, column, words["of_heaviest"], words)))
    return rows


def _worst(curve: CapacityCurve, name: str, unit: str, words: Words) -> str:
    """The largest value of a column, and where."""
    values = np.asarray(curve.column(name), float)
    if not np.isfinite(values).any():
        return NOTHING
    row = int(np.nanargmax(values))
    if values[row] == 0.0:
        return "0"
    return f"{spelt(values[row], '.2g')} {unit} ({words['step']} {curve.points[row].step})"


def validity(
    curve: CapacityCurve, model: Model | None, extrapolated: bool, words: Words
) -> list[str]:
    """Sentences on how far the results may be trusted, those that apply."""
    if curve.moves_supports:
        found = [words[key] for key in ("rigid", "supports", "joints", "one_motion")]
        if model is not None and model.assembly.dimension == 2:
            found.append(words["plane"])
    else:
        found = [words[key] for key in ("rigid", "static", "joints", "pattern")]
    if model is not None and not curve.moves_supports:
        found.append(words["plane" if model.assembly.dimension == 2 else "torsion"])
    if curve.points:
        for name, values in (
            ("dynamic", curve.column("status") == DYNAMIC),
            ("unstable", curve.column("unstable")),
        ):
            if np.any(values):
                found.append(words[name].format(count=int(np.sum(values))))
        if not curve.peak_passed and not curve.moves_supports:
            found.append(words["no_peak"])
        found += _penetrated(curve, model, words)
    if curve.status != "finished":
        found.append(words["unfinished"].format(reason=spoken(said_end(curve.reason))))
    if curve.first_collapse is not None:
        found.append(words["collapse"].format(event=curve.first_collapse.said.spoken))
    if extrapolated:
        found.append(words["extrapolated"])
    return found


def _penetrated(curve: CapacityCurve, model: Model | None, words: Words) -> Iterable[str]:
    """A sentence where joints close by more than a hundredth of the smallest block."""
    if model is None:
        return []
    share = float(np.nanmax(np.append(curve.column("penetration"), 0.0)))
    share /= model.assembly.smallest_extent
    return (
        [words["penetration"].format(share=f"{spelt(100.0 * share, '.2g')} %")]
        if share > 0.01
        else []
    )
