"""``drystone check``: what a model file holds, or what is wrong with it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import asdict
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from drystone.cli.options import AsJson, ModelFile, Quiet
from drystone.cli.outcome import DONE, WRONG, emit, fail, outcome

if TYPE_CHECKING:
    from drystone.io.modelfile.sketch import Sketch
    from drystone.model.inspection import Inspection
    from drystone.model.model import Model

#: What a model that cannot be read has none of.
COUNTS = ("n_blocks", "n_supports", "n_joints", "n_contacts", "weight")


def check(
    model_file: ModelFile,
    blocks: Annotated[
        bool, typer.Option("--blocks", help="List the blocks: name, place, size, groups.")
    ] = False,
    as_json: AsJson = False,
    quiet: Quiet = False,
) -> None:
    """List what a model file holds, or what is wrong with it.

    Warnings, on what is probably not intended or cannot stand, leave the exit status at 0. For a
    drawing, or a file without supports, materials, joints or load, the blocks are listed.
    """
    with outcome(as_json=as_json):
        from drystone.cli.sketches import block_lines, block_rows, model_or_sketch
        from drystone.io.modelfile import ModelError
        from drystone.io.modelfile.sketch import Sketch
        from drystone.model.inspection import inspect

        try:
            model, wrong = model_or_sketch(model_file)
        except ModelError as error:
            fail(WRONG, error.problems, as_json=as_json, extra=dict.fromkeys(COUNTS))
        listed = block_lines(model.assembly) if blocks else []
        rows = {"blocks": block_rows(model.assembly)} if blocks else {}
        if isinstance(model, Sketch):
            _tell_sketch(model_file, model, wrong, listed, rows, as_json=as_json)
            raise typer.Exit(DONE)
        found = inspect(model)
        against, reaction, why_not = statics(model)
        problems = [*found.problems, *against]
        if as_json:
            mended = [asdict(record) for record in model.mended]
            carried = {"reaction": reaction, "reaction_note": why_not}
            more = {"status": "valid", "problems": problems, "mended": mended}
            emit({**asdict(found), **carried, **more, **rows})
        else:
            typer.echo("\n".join([report(found, problems, reaction, why_not), *listed]))
    raise typer.Exit(DONE)


def _tell_sketch(
    path: Path,
    sketch: Sketch,
    wrong: Sequence[str],
    listed: Sequence[str],
    rows: dict[str, Any],
    *,
    as_json: bool,
) -> None:
    """What there is of blocks that are no model yet, and what is missing; exits if wrong."""
    from drystone.cli.sketches import lacking, refused
    from drystone.model.construction.words import printable
    from drystone.model.inspection import contact_count, joint_count

    against = refused(sketch, wrong)
    if against:
        if len(sketch.overlaps[0]):
            against.append(f"{path}: drystone show draws in red where blocks overlap")
        if listed and not as_json:
            typer.echo("\n".join(listed))
        extra = {**dict.fromkeys(COUNTS), **rows}
        fail(WRONG, against, as_json=as_json, extra=extra)
    assembly = sketch.assembly
    n_joints = joint_count(assembly)
    if as_json:
        emit(
            {
                "status": "incomplete",
                "title": sketch.title,
                "dimension": assembly.dimension,
                "n_blocks": assembly.n_blocks,
                "n_supports": assembly.n_supports,
                "n_joints": n_joints,
                "n_contacts": contact_count(assembly),
                "weight": None,
                "missing": list(sketch.missing),
                "problems": [lacking(sketch)],
                "notes": list(sketch.notes),
                "mended": [asdict(record) for record in sketch.mended],
                **rows,
            }
        )
        return
    lines = [
        printable(sketch.title),
        f"  blocks         {assembly.n_blocks}",
        f"  supports       {assembly.n_supports}",
        f"  joints         {n_joints}",
        *(f"  note: {note}" for note in sketch.notes),
        f"  warning: {lacking(sketch)}",
        *listed,
    ]
    typer.echo("\n".join(lines))


def mode_rows(found: Inspection) -> list[tuple[str, str]]:
    """What is known of ties, of dead loads and of the mode of vibration."""
    rows = []
    if found.n_ties:
        rows.append(("ties", str(found.n_ties)))
    if any(found.dead_load):
        parts = ", ".join(f"{force / 1e3:.4g}" for force in found.dead_load)
        rows.append(("dead loads", f"({parts}) kN in all"))
    if found.mode is not None:
        rows.append(
            (
                "mode",
                f"the {found.mode.number}. of {found.mode.period:.4g} s, with "
                f"{100.0 * found.mode.participation:.1f} % of the mass",
            )
        )
    return rows


def statics(model: Model) -> tuple[list[str], float | None, str | None]:
    """What limit analysis says against a model: it falls, or no load brings it down; and the
    reaction of the supports at rest [N], or why there is none."""
    from drystone.common.ranges import most_blocks

    most = most_blocks(model.assembly.dimension)
    if model.assembly.n_blocks > most:
        return [], None, f"not looked for in more than {most} blocks, nor whether they stand"
    from drystone.limit import at_rest, is_locked  # takes long to import

    rest = at_rest(model)
    if rest.falls:
        return [f"the structure {rest.falls}"], None, "none: it falls"
    if model.settlement is None and is_locked(model):
        locked = "load: no multiple of it brings the structure down: turn its direction"
        return [locked], rest.reaction, None
    return [], rest.reaction, None


def report(
    found: Inspection,
    problems: Sequence[str],
    reaction: float | None = None,
    why_not: str | None = None,
) -> str:
    """The model in a few lines."""
    from drystone.model.construction.words import printable

    sides = [high - low for low, high in zip(found.lower, found.upper, strict=True)]
    point = ", ".join(f"{x:g}" for x in found.control_point)
    borne = [("reaction", why_not)] if why_not else []
    if reaction is not None:
        borne = [("reaction", f"{reaction / 1e3:.4g} kN of the supports")]
    rows = (
        ("blocks", str(found.n_blocks)),
        ("supports", str(found.n_supports)),
        (
            "joints",
            f"{found.n_joints} of {found.joint_area:.4g} m2, with {found.n_contacts} contact "
            "points at rest",
        ),
        ("volume", f"{found.volume:.4g} m3"),
        ("weight", f"{found.weight / 1e3:.4g} kN"),
        *borne,
        ("size", " x ".join(f"{side:.4g} m" for side in sides)),
        ("load", found.load),
        *mode_rows(found),
        ("control point", f'({point}) m on block "{found.control_block}"'),
    )
    lines = [printable(found.title), *(f"  {name:<14} {value}" for name, value in rows)]
    notes = [note for note in found.warnings if note not in problems]
    return "\n".join(
        [
            *lines,
            *(f"  note: {note}" for note in notes),
            *(f"  warning: {problem}" for problem in problems),
        ]
    )
