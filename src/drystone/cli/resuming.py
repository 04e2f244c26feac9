"""``drystone run --resume``: a run that stopped goes on in its folder."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import typer

from drystone.cli.directions import Asked, resume_directions
from drystone.cli.outcome import DONE, emit, outcome, tell

if TYPE_CHECKING:
    from drystone.report.folder.kept import Kept

#: What takes an end out.
NONE = "none"


def ends_of(texts: Sequence[str]) -> dict[str, float | None]:
    """Ends of a curve as ``KEY=VALUE`` texts say them; raises `typer.BadParameter`."""
    ends: dict[str, float | None] = {}
    for text in texts:
        key, equals, value = text.partition("=")
        try:
            ends[key.strip()] = None if value.strip() == NONE else float(value)
        except ValueError:
            equals = ""
        if not equals:
            raise typer.BadParameter(
                f'"{text}" is not KEY=VALUE with a number, such as max_displacement=0.3',
                param_hint="--extend",
            )
    return ends


def resume_run(
    folder: Path,
    model_file: Path | None,
    ends: Mapping[str, float | None],
    asked: Asked,
    *,
    threads: int | None,
    as_json: bool,
    quiet: bool,
) -> int:
    """Go on with the run of a folder; the exit status."""
    begun = False
    with outcome(as_json=as_json, begun=lambda: begun):
        from drystone.cli.compiler import compiling
        from drystone.cli.run import told
        from drystone.common.progress import progress_for
        from drystone.io.results.checkpoint import PLAN
        from drystone.io.results.names import RESULTS
        from drystone.limit import limits_beside
        from drystone.report.folder.directory import ResultsDirectory
        from drystone.report.folder.resume import (
            check_farther,
            check_resumes,
            extended_to,
            go_on,
        )

        if not folder.is_dir():
            raise typer.BadParameter(f"there is no folder {folder}", param_hint="--resume")
        if (folder / PLAN).is_file() and not (folder / RESULTS).is_file():
            begun = True
            return resume_directions(
                folder, ends, processes=threads, as_json=as_json, quiet=quiet or as_json
            )
        with ResultsDirectory(
            folder, mechanism_displacement=asked.mechanism_at, formats=asked.formats
        ) as results:
            kept = results.take_up()
            check_same(kept, model_file)
            if kept.complete and not ends:
                return _complete(kept, as_json=as_json)
            check_resumes(kept)
            check_farther(kept, ends)
            if kept.past is None:
                tell([f"{folder} keeps no state yet: its run begins anew"])
            model = extended_to(kept.model, ends)
            begun = True
            title, stop = folder.name, model.analysis.stop_multiplier
            with compiling(kept.engine, model.assembly.dimension, quiet=quiet or as_json):
                results.beside = beside = limits_beside(model)
                with progress_for(title, stop, quiet=quiet) as progress:
                    curve = go_on(kept, model, results, progress=progress, threads=threads)
        return told(curve, model, beside, results, as_json=as_json)
    raise AssertionError("`outcome` lets nothing pass")


def check_same(kept: Kept, model_file: Path | None) -> None:
    """Say where the model file is not the one that the run began with.

    Raises
    ------
    OutputError
        The file was named in the command.
    """
    from drystone.io.modelfile import read_model
    from drystone.io.results.folder import OutputError
    from drystone.model.construction.errors import ModelError

    origin = kept.model.origin
    began = kept.model.sha256 if origin is None else origin.sha256
    if model_file is not None:
        if read_model(model_file).sha256 != began:
            raise OutputError(
                f"{model_file} has changed since the run in {kept.path} began, or is another "
                f"model: run it anew, or leave it out to go on with the model that {kept.path} "
                "keeps"
            )
        return
    if origin is None or not Path(origin.path).is_file():
        return
    try:
        same = read_model(origin.path).sha256 == began
    except (OSError, ModelError):
        same = False
    if not same:
        tell(
            [f"{origin.path} has changed since: the run goes on with the model that it began with"]
        )


def _complete(kept: Kept, *, as_json: bool) -> int:
    """Tell that nothing is left to do."""
    import json

    from drystone.common.language import say
    from drystone.io.results.names import SUMMARY

    mend = "--extend gives it another end"
    if kept.history_is_over:
        mend = str(say("end.history_is_over"))
    tell([f"the curve in {kept.path} is complete ({kept.reason}): {mend}"])
    if as_json:
        told = json.loads((kept.path / SUMMARY).read_text(encoding="utf-8"))
        emit({**told, "directory": str(kept.path)})
    return DONE
