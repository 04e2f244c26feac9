"""``drystone check``: what a model file holds, or what is wrong with it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import asdict
from typing import TYPE_CHECKING

import typer

from drystone.commands.options import AsJson, ModelFile, Quiet
from drystone.commands.outcome import DONE, WRONG, emit, fail, outcome

if TYPE_CHECKING:
    from drystone.inspection import Inspection
    from drystone.model import Model

#: What a model that cannot be read has none of.
COUNTS = ("n_blocks", "n_supports", "n_joints", "n_contacts", "weight")


def check(model_file: ModelFile, as_json: AsJson = False, quiet: Quiet = False) -> None:
    """Say what a model file holds, or what is wrong with it.

    Warnings, on what is hardly meant or cannot stand, leave the exit status at 0.
    """
    with outcome(as_json=as_json):
        from drystone.engines import engine_names
        from drystone.inspection import inspect
        from drystone.modelfile import ModelError, read_model

        try:
            model = read_model(model_file, need_stiffness=False, engines=engine_names())
        except ModelError as error:
            fail(WRONG, error.problems, as_json=as_json, extra=dict.fromkeys(COUNTS))
        found = inspect(model)
        against, reaction, why_not = statics(model)
        problems = [*found.problems, *against]
        if as_json:
            mended = [asdict(record) for record in model.mended]
            carried = {"reaction": reaction, "reaction_note": why_not}
            more = {"status": "valid", "problems": problems, "mended": mended}
            emit({**asdict(found), **carried, **more})
        else:
            typer.echo(report(found, problems, reaction, why_not))
    raise typer.Exit(DONE)


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
    from drystone.ranges import MOST_BLOCKS

    most = MOST_BLOCKS[model.assembly.dimension]
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
    from drystone.builders.words import printable

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
