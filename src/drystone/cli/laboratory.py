"""``drystone benchmark laboratory``: measured walls beside computed ones."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import typer

from drystone.cli.outcome import emit, tell
from drystone.common.language import number, say, spoken

if TYPE_CHECKING:
    from drystone.laboratory.comparison import Compared

#: Heads of the tables, see `laboratory_head` of the languages; drifts between.
HEADS = (
    "wall", "sense", "peak", "ours_peak", "ratio", "at", "ours_at", "stiffness", "ours", "1 %",
    "2 %", "3 %", "seconds",
)  # fmt: skip
#: Of the bilinear curves; each figure by the database, of its curve, and computed.
BILINEAR_HEADS = (
    "wall", "sense", "level", "measured", "ours", "yield", "measured", "ours", "ultimate",
    "measured", "ours",
)  # fmt: skip
#: Of the models.
MODEL_HEADS = ("wall", "modulus", "source", "joint", "friction", "strength")


def run_laboratory(out: Path, names: Sequence[str], *, as_json: bool, quiet: bool) -> None:
    """Compute the walls, write pictures and table into a folder, print the table."""
    from drystone.io.results.folder import check_writable
    from drystone.io.results.summary import to_json
    from drystone.laboratory.comparison import laboratory
    from drystone.report.crack_figure import draw_cracks
    from drystone.report.laboratory_figure import draw_laboratory

    check_writable(out)
    out.mkdir(parents=True, exist_ok=True)

    def told(name: str, curve: Any) -> None:
        if not quiet:
            tell([f"{name}: {curve.seconds:.1f} s, {curve.reason}"])

    found = laboratory(names=names, told=told)
    for cyclic, file, what in (
        (False, "laboratory_monotonic.png", _word("one_way")),
        (True, "laboratory_cyclic.png", _word("to_and_fro")),
    ):
        drawn = [one for one in found if one.wall.cyclic == cyclic]
        if drawn:
            draw_laboratory(drawn, out / file, title=what)
    if any(one.crack_map for one in found):
        draw_cracks(found, out / "laboratory_cracks.png", title=_word("cracks"))
    result = as_dict(found)
    (out / "laboratory.json").write_text(to_json(result) + "\n", encoding="utf-8")
    if as_json:
        emit({**result, "directory": str(out)})
    else:
        from drystone.cli.benchmark import plain_table

        typer.echo(plain_table(_heads(HEADS), _lines(found)))
        typer.echo(_word("note"))
        typer.echo("\n" + plain_table(_heads(BILINEAR_HEADS), _bilinear_lines(found)))
        typer.echo(_word("bilinear_note"))
        typer.echo("\n" + plain_table(_heads(MODEL_HEADS), _model_lines(found)))
        typer.echo("\n".join(_sums(result)))
        typer.echo(_word("written", folder=out))


def _word(key: str, **fields: Any) -> str:
    """A word or sentence, in the language that is spoken."""
    return say(f"laboratory.{key}", **fields).spoken


def _heads(keys: Sequence[str]) -> list[str]:
    """Heads of a table, of two lines."""
    return [f"\n{key}" if "%" in key else say(f"laboratory_head.{key}").spoken for key in keys]


# Long: the keys of a file.
def as_dict(found: Sequence[Compared]) -> dict[str, Any]:
    """All figures, for JSON."""
    from drystone.laboratory.comparison import (
        energy_by_drift,
        lacking_compliance,
        ratios,
        spread,
    )
    from drystone.laboratory.walls import series

    rows: list[dict[str, Any]] = []
    for one in found:
        wall = one.wall
        senses: dict[str, Any] = {}
        for sense in one.senses():
            measured, computed = one.figures(sense)
            senses["+" if sense > 0.0 else "-"] = {
                "measured": measured.as_dict,
                "computed": computed.as_dict,
                "peak_ratio": computed.peak / measured.peak,
            }
        rows.append(
            {
                "wall": wall.name,
                "reference": wall.reference,
                "cyclic": wall.cyclic,
                "failure": wall.failure,
                "database": dict(wall.given),
                "model": {
                    "wall_modulus": wall.wall_modulus,
                    "modulus_source": wall.modulus_source,
                    "joint_stiffness": wall.joint_stiffness,
                    "strength": wall.strength,
                },
                "senses": senses,
                "energy_per_cycle": [
                    {"amplitude": a, "measured": m, "computed": c} for a, m, c in one.energies()
                ],
                "max_residual": max(curve.residual for curve in one.variants.values()),
                "seconds": sum(curve.seconds for curve in one.variants.values()),
            }
        )
    groups: dict[str, dict[str, float]] = {}  # by how walls were pushed
    for name, chosen in (
        ("monotonic", [row for row in rows if not row["cyclic"]]),
        ("cyclic", [row for row in rows if row["cyclic"]]),
    ):
        values = [s["peak_ratio"] for row in chosen for s in row["senses"].values()]
        if values:
            mean, scatter = ratios(values)
            groups[name] = {"n": len(values), "mean": mean, "coefficient_of_variation": scatter}
    said = series()
    energies = [
        cycle["computed"] / cycle["measured"] for row in rows for cycle in row["energy_per_cycle"]
    ]
    return {
        "rows": rows,
        "computed_over_measured_peak": groups,
        "computed_over_measured_energy": spread(energies),
        "computed_over_measured_energy_by_drift": energy_by_drift(found),
        "lacking_compliance": lacking_compliance(found),
        "source": {key: said[key] for key in ("database", "citation")},
        "series": said["series"],
    }


def _sums(result: dict[str, Any]) -> list[str]:
    energy = result["computed_over_measured_energy"]
    lines = [] if energy is None else [_word("energy", **energy)]
    lines += [
        _word("energy_by_drift", **within)
        for within in result["computed_over_measured_energy_by_drift"]
    ]
    for group in result["lacking_compliance"]:
        known = {key: 1e6 * group[key] for key in ("mean", "least", "greatest")}
        force = 1e-3 * group["vertical_force"]
        named = {"series": group["series"], "n": group["n"], "force": force}
        lines.append(_word("compliance", **named, **known))
    return lines + [
        _word("peaks", group=say(f"laboratory.{name}"), **group)
        for name, group in result["computed_over_measured_peak"].items()
    ]


def _lines(found: Sequence[Compared]) -> list[list[str]]:
    lines = []
    for one in found:
        seconds = sum(curve.seconds for curve in one.variants.values())
        for sense in one.senses():
            a, b = one.figures(sense)
            shares = [
                "-" if x is None or y is None else number(y / x, ".2f")
                for x, y in zip(a.at_drift, b.at_drift, strict=True)
            ]
            stiff = [number(1e-6 * f.stiffness, ".1f") if sense > 0.0 else "-" for f in (a, b)]
            lines.append(
                [
                    one.wall.name, "+" if sense > 0.0 else "-",
                    number(1e-3 * a.peak, ".1f"), number(1e-3 * b.peak, ".1f"),
                    number(b.peak / a.peak, ".3f"),
                    number(a.peak_drift, ".2f"), number(b.peak_drift, ".2f"), *stiff, *shares,
                    number(seconds, ".1f") if sense > 0.0 else "",
                ]
            )  # fmt: skip
    return lines


def _bilinear_lines(found: Sequence[Compared]) -> list[list[str]]:
    lines = []
    for one in found:
        for sense in one.senses():
            mark = "+" if sense > 0.0 else "-"
            columns: list[tuple[float | None, ...]] = [
                one.wall.bilinear_given(sense),
                *(figures.bilinear_values for figures in one.figures(sense)),
            ]
            cells = [
                "-" if value is None else number(value, f".{digits}f")
                for values, digits in zip(zip(*columns, strict=True), (1, 2, 2), strict=True)
                for value in values
            ]
            lines.append([one.wall.name, mark, *cells])
    return lines


def _model_lines(found: Sequence[Compared]) -> list[list[str]]:
    from drystone.laboratory.walls import series

    return [
        [
            wall.name,
            number(1e-6 * wall.wall_modulus, ".0f"),
            spoken(wall.modulus_source),
            number(wall.joint_stiffness, ".3g"),
            number(series()["series"][wall.series]["friction"], "g"),
            number(1e-6 * wall.strength, ".1f"),
        ]
        for wall in (one.wall for one in found)
    ]
