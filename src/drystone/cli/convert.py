"""``drystone convert``: between model files and the files of other programs."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import asdict
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from drystone.cli.options import AsJson, Quiet
from drystone.cli.outcome import DONE, emit, outcome

if TYPE_CHECKING:
    from drystone.model.assembly import Block

#: Endings of model files; JSON may be one, or an assembly of COMPAS.
MODEL = "model"


# Many, as a drawing may need all of them.
def convert(
    source: Annotated[
        Path,
        typer.Argument(
            metavar="IN",
            help="A model file or a drawing.",
            show_default=False,
        ),
    ],
    file: Annotated[
        Path,
        typer.Argument(metavar="OUT", help="File to write.", show_default=False),
    ],
    to: Annotated[
        str | None,
        typer.Option(
            metavar="NAME",
            help="model, a program such as udec, or a format of drawings such as dxf; ? lists "
            "them. "
            "[default: by OUT's ending]",
            show_default=False,
        ),
    ] = None,
    from_: Annotated[
        str | None,
        typer.Option(
            "--from",
            metavar="NAME",
            help="model, a program such as udec, or a format of drawings such as dxf; ? lists "
            "them. "
            "[default: by IN's ending]",
            show_default=False,
        ),
    ] = None,
    unit: Annotated[
        str | None,
        typer.Option(help="Unit of the drawing: m, cm, mm, in or ft.", show_default=False),
    ] = None,
    up: Annotated[
        str | None,
        typer.Option(help="Axis that points up in the drawing: z or y.", show_default=False),
    ] = None,
    support: Annotated[
        list[str] | None,
        typer.Option(help="Supports in the drawing: ids, groups or layers.", show_default=False),
    ] = None,
    support_below: Annotated[
        float | None,
        typer.Option(
            help="Blocks that reach below this height [m] are supports.", show_default=False
        ),
    ] = None,
    material: Annotated[
        str | None,
        typer.Option(help="Material of blocks whose layer does not name one.", show_default=False),
    ] = None,
    tolerance: Annotated[
        float | None,
        typer.Option(
            help="Largest motion of a vertex, over the shortest edge of its block (in the plane "
            "over its least width). [default: 0.02]",
            show_default=False,
        ),
    ] = None,
    bent_faces: Annotated[
        str | None,
        typer.Option(
            help="How faces that are not flat are cut: fans or bends. [default: fans]",
            show_default=False,
        ),
    ] = None,
    overlap: Annotated[
        float | None,
        typer.Option(
            help="Depth [m] up to which overlaps are closed. [default: 0]", show_default=False
        ),
    ] = None,
    like: Annotated[
        Path | None,
        typer.Option(
            metavar="MODEL",
            help="Model file from which materials, joints, load and analysis are taken.",
            show_default=False,
        ),
    ] = None,
    as_json: AsJson = False,
    quiet: Quiet = False,
) -> None:
    """Write a model in another program's format, or a drawing as a model, and say what is lost."""
    with outcome(as_json=as_json):
        from drystone.io.results.folder import check_apart

        check_apart(source, [file])
        kind = kind_of(source, from_)
        given = {
            "unit": unit,
            "up": up,
            "support": tuple(support or ()),
            "support_below": support_below,
            "material": material,
            "tolerance": tolerance,
            "bent_faces": bent_faces,
            "overlap": overlap,
        }
        if kind.startswith("drawing "):
            found = _from_drawing(source, kind.split(" ")[1], file, to, given, like)
        else:
            _no_drawing({**given, "like": like})
            found = _from_model(source, kind, file, to)
        if as_json:
            emit({"status": "done", "file": str(file), **found})
        elif not quiet:
            typer.echo(f"{file} is written for {found['target']}")
            for note in found["notes"]:
                typer.echo(f"  note: {note}")
    raise typer.Exit(DONE)


def kind_of(source: Path, name: str | None) -> str:
    """What a file is: "model", another program's name, or "drawing " and its format."""
    from drystone.io.convert import PROGRAMS
    from drystone.io.drawings import FORMATS
    from drystone.model.construction.errors import ModelError

    readable = [target.name for target in PROGRAMS.values() if target.read]
    if name is not None:
        if name in FORMATS:
            return f"drawing {name}"
        if name in (MODEL, *readable):
            return name
        known = ", ".join((MODEL, *readable, *FORMATS.names()))
        raise ModelError([f'there is nothing to read from "{name}": take one of {known}'])
    ending = source.suffix.lower()
    if ending == ".json":
        return MODEL if _holds(source, b'"dimension"') else "drawing compas"
    if ending == ".dat":
        return (
            "drawing bodies" if _holds(source, b"$bdyty") or _holds(source, b"$bodies") else "udec"
        )
    for _, one in FORMATS.loaded():
        if ending in one.endings:
            return f"drawing {one.name}"
    for target in PROGRAMS.values():
        if target.read and ending in target.endings:
            return target.name
    return MODEL


def _holds(source: Path, words: bytes) -> bool:
    from drystone.model.construction.contents import read_bytes
    from drystone.model.construction.errors import ModelError

    try:
        return words in read_bytes(source, "the file")
    except ModelError:
        return False


def _no_drawing(given: dict[str, Any]) -> None:
    """Refuse options that say what a drawing does not."""
    from drystone.model.construction.errors import ModelError

    wrong = [
        f"--{key.replace('_', '-')}" for key, value in given.items() if value not in (None, ())
    ]
    if wrong:
        raise ModelError([f"{', '.join(wrong)}: is for drawings, and a model says it itself"])


def _from_drawing(
    source: Path, kind: str, file: Path, to: str | None, given: dict[str, Any], like: Path | None
) -> dict[str, Any]:
    """Write the model file of a drawing, and what was mended beside it."""
    from drystone.common.ranges import problem
    from drystone.geometry.mended import BENDS, FANS
    from drystone.io.convert.from_drawing import from_drawing, mended_csv
    from drystone.io.drawings import UNITS, ImportSettings
    from drystone.model.construction.errors import ModelError

    if (to or MODEL) != MODEL or (to is None and file.suffix.lower() != ".toml"):
        raise ModelError([f"{source}: is a drawing: make a model of it first, in a file .toml"])
    own = {key: value for key, value in given.items() if value is not None}
    wrong = [
        f"--{key}: {text}"
        for key in ("tolerance", "overlap")
        if (text := problem(key, own.get(key, 0.0)))
    ]
    if own.get("bent_faces") not in (None, FANS, BENDS):
        wrong.append(f"--bent-faces: must be {FANS} or {BENDS}")
    if given["unit"] not in (None, *UNITS):
        wrong.append(f"--unit: must be one of {', '.join(UNITS)}")
    if given["up"] not in (None, "z", "y"):
        wrong.append("--up: must be z or y")
    if wrong:
        raise ModelError(wrong)
    settings = ImportSettings(file=source, format=kind, **own)
    made = from_drawing(settings, like)
    _check_blocks(made.blocks, source, file)
    file.write_text(made.text, encoding="utf-8", newline="\n")
    found: dict[str, Any] = {
        "target": MODEL,
        "n_blocks": len(made.blocks),
        "notes": list(made.notes),
        "mended": [asdict(record) for record in made.mended],
    }
    report = file.with_name(f"{file.stem}.mended.csv")
    report.unlink(missing_ok=True)  # of another drawing
    if made.mended:
        report.write_text(mended_csv(made.mended), encoding="utf-8", newline="\n")
        found["notes"].append(f"what was done to which block is in {report.name}")
        found["mended_file"] = str(report)
    return found


def _check_blocks(blocks: Sequence[Block], source: Path, file: Path) -> None:
    """Refuse a model that would be refused when it is read, with a picture that shows where."""
    from drystone.io.modelfile.sketch import Sketch
    from drystone.model.construction.errors import ModelError
    from drystone.model.construction.words import quoted
    from drystone.report.sketch_figure import draw_sketch

    places = [f"import[1] block {quoted(block.id)}" for block in blocks]
    sketch = Sketch.of(blocks, title=source.stem, places=places, closing="--overlap {:g}")
    if not sketch.problems:
        return
    problems = [f"{source}: {one.replace('import[1] ', '')}" for one in sketch.problems]
    if len(sketch.overlaps[0]):
        picture = file.with_suffix(".png")
        draw_sketch(sketch, picture)
        problems.append(f"{picture} shows in red where; {file} is not written")
    raise ModelError(problems)


def _from_model(source: Path, kind: str, file: Path, to: str | None) -> dict[str, Any]:
    """Write a model, read from a model file or from what `convert` wrote."""
    from drystone.io.convert import convert as write
    from drystone.io.convert import read, target_of
    from drystone.io.modelfile import read_model, write_model

    as_model = to == MODEL or (to is None and file.suffix.lower() == ".toml")
    target = None if as_model else target_of(file, to, beside=(MODEL,))
    if kind == MODEL:
        model = read_model(source, need_stiffness=False)
    else:
        model = read(source, kind)
    if target is None:
        write_model(model, file)
        return {"target": MODEL, "notes": list(model.notes)}
    return {"target": target.name, "notes": list(write(model, file, target.name))}
