"""``drystone benchmark laboratory``: measured walls beside computed ones."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import typer

from drystone.cli.outcome import emit, tell

if TYPE_CHECKING:
    from drystone.laboratory.comparison import Compared

HEADS = (
    "wall", "sense", "peak\nkN", "ours\nkN", "ours/\nmeas.", "at\n%", "ours\n%", "K\nkN/mm",
    "ours", "1 %", "2 %", "3 %", "time\ns",
)  # fmt: skip
NOTE = "1, 2, 3 %: force at that drift, computed over measured; K: secant at 40 % of the peak"
#: Of the bilinear curves; each figure by the database, of its curve, and computed.
BILINEAR_HEADS = (
    "wall", "sense", "V_u kN\ndatabase", "\nmeasured", "\nours", "d_y %\ndatabase", "\nmeasured",
    "\nours", "d_u %\ndatabase", "\nmeasured", "\nours",
)  # fmt: skip
BILINEAR_NOTE = (
    "bilinear of equal area, first branch through 70 % of the peak, up to d_u, a drop by 20 % or\n"
    "the end: as the database gives it; of the measured and of the computed curve by the function\n"
    "of drystone assess"
)
#: Of the models.
MODEL_HEADS = ("wall", "E_wall\nMPa", "\nwhich is", "k_n\nPa/m", "friction", "f_c\nMPa")


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
        (False, "laboratory_monotonic.png", "Walls pushed one way: measured and computed"),
        (True, "laboratory_cyclic.png", "Walls pushed to and fro: measured and computed"),
    ):
        drawn = [one for one in found if one.wall.cyclic == cyclic]
        if drawn:
            draw_laboratory(drawn, out / file, title=what)
    if any(one.crack_map for one in found):
        draw_cracks(found, out / "laboratory_cracks.png", title="Crack maps and computed walls")
    result = as_dict(found)
    (out / "laboratory.json").write_text(to_json(result) + "\n", encoding="utf-8")
    if as_json:
        emit({**result, "directory": str(out)})
    else:
        from drystone.cli.benchmark import plain_table

        heads = [head if "\n" in head else f"\n{head}" for head in HEADS]
        typer.echo(plain_table(heads, _lines(found)))
        typer.echo(NOTE)
        heads = [head if "\n" in head else f"\n{head}" for head in BILINEAR_HEADS]
        typer.echo("\n" + plain_table(heads, _bilinear_lines(found)))
        typer.echo(BILINEAR_NOTE)
        heads = [head if "\n" in head else f"\n{head}" for head in MODEL_HEADS]
        typer.echo("\n" + plain_table(heads, _model_lines(found)))
        typer.echo("\n".join(_sums(result)))
        typer.echo(f"Pictures and figures are in {out}/")


def as_dict(found: Sequence[Compared]) -> dict[str, Any]:
    """All figures, for JSON."""
    from drystone.laboratory.comparison import ratios, spread
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
        "source": {key: said[key] for key in ("database", "citation")},
        "series": said["series"],
    }


def _sums(result: dict[str, Any]) -> list[str]:
    energy = result["computed_over_measured_energy"]
    of_energy = (
        []
        if energy is None
        else [
            f"energy of a cycle: computed over measured, median {energy['median']:.2f}, half of "
            f"them between {energy['lower_quartile']:.2f} and {energy['upper_quartile']:.2f}, of "
            f"{energy['n']}"
        ]
    )
    return of_energy + [
        f"{name}: computed over measured peak {group['mean']:.3f}, coefficient of variation "
        f"{group['coefficient_of_variation']:.3f}, of {group['n']} (none left out)"
        for name, group in result["computed_over_measured_peak"].items()
    ]


def _lines(found: Sequence[Compared]) -> list[list[str]]:
    lines = []
    for one in found:
        seconds = sum(curve.seconds for curve in one.variants.values())
        for sense in one.senses():
            a, b = one.figures(sense)
            shares = [
                "-" if x is None or y is None else f"{y / x:.2f}"
                for x, y in zip(a.at_drift, b.at_drift, strict=True)
            ]
            stiff = [f"{1e-6 * f.stiffness:.1f}" if sense > 0.0 else "-" for f in (a, b)]
            lines.append(
                [
                    one.wall.name, "+" if sense > 0.0 else "-",
                    f"{1e-3 * a.peak:.1f}", f"{1e-3 * b.peak:.1f}", f"{b.peak / a.peak:.3f}",
                    f"{a.peak_drift:.2f}", f"{b.peak_drift:.2f}", *stiff, *shares,
                    f"{seconds:.1f}" if sense > 0.0 else "",
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
                "-" if value is None else f"{value:.{digits}f}"
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
            f"{1e-6 * wall.wall_modulus:.0f}",
            wall.modulus_source,
            f"{wall.joint_stiffness:.3g}",
            f"{series()['series'][wall.series]['friction']:g}",
            f"{1e-6 * wall.strength:.1f}",
        ]
        for wall in (one.wall for one in found)
    ]
