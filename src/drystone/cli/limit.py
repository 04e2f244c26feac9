"""``drystone limit``: collapse multiplier and mechanism by limit analysis."""

from __future__ import annotations

from collections.abc import Sequence
from enum import StrEnum
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from drystone.cli.options import AsJson, ModelFile, Quiet
from drystone.cli.outcome import DONE, UNFINISHED, WRONG, emit, fail, outcome, tell

if TYPE_CHECKING:
    from drystone.limit import Collapse

#: Exit statuses; a structure that cannot be brought down is an answer like any other.
STATUSES = {
    "finished": DONE,
    "bracketed": DONE,
    "locked": DONE,
    "unstable": WRONG,
    "failed": UNFINISHED,
}


class Flow(StrEnum):
    """How joints slide; the names are those of the library."""

    associative = "associative"
    non_associative = "non-associative"


FlowChoice = Annotated[
    Flow | None,
    typer.Option(help="How joints slide. [default: both, one after the other]", show_default=False),
]
Paths = Annotated[
    int | None,
    typer.Option(
        metavar="N",
        min=1,
        help="Paths to non-associative collapse states. [default: 8, or 1 from 200 blocks on, in "
        "space from 50]",
        show_default=False,
    ),
]
Alpha = Annotated[
    float,
    typer.Option(
        min=0.0,
        max=0.99,
        help="Slope of the strength that a joint keeps, over its friction coefficient.",
    ),
]
Beta = Annotated[
    float,
    typer.Option(
        min=0.01, max=1.0, help="Weight of the newest normal forces in the next strength."
    ),
]
Folder = Annotated[
    Path | None,
    typer.Option(
        metavar="DIR",
        help="Folder for limit.json and the picture of the mechanism. [default: they are not "
        "written]",
        show_default=False,
    ),
]


def limit(
    model_file: ModelFile,
    flow: FlowChoice = None,
    paths: Paths = None,
    alpha: Alpha = 0.0,
    beta: Beta = 0.6,
    out: Folder = None,
    as_json: AsJson = False,
    quiet: Quiet = False,
) -> None:
    """Find the collapse multiplier and the mechanism by limit analysis of rigid blocks."""
    begun = False
    with outcome(as_json=as_json, begun=lambda: begun):
        from drystone.cli.compiler import compiling
        from drystone.io.modelfile import ModelError, read_model
        from drystone.limit import FLOWS, NonAssociativeSettings, collapse_loads, default_paths
        from drystone.limit.collapse import NO_LOAD
        from drystone.model.construction.words import printable
        from drystone.report.folder.limit import collapse_to_dict, write_collapse

        try:
            model = read_model(model_file, need_stiffness=False, need_engine=False)
        except ModelError as error:
            fail(WRONG, error.problems, as_json=as_json, extra=_empty(flow))
        if model.settlement is not None:
            fail(WRONG, [f"{model_file}: {NO_LOAD}"], as_json=as_json, extra=_empty(flow))
        if out is not None:
            from drystone.io.results.folder import check_apart, check_writable
            from drystone.report.folder.limit import limit_files

            check_writable(out)
            check_apart(model_file, limit_files(out))
        settings = NonAssociativeSettings(
            alpha=alpha, beta=beta, n_paths=paths or default_paths(model.assembly)
        )
        with compiling("", model.assembly.dimension, quiet=quiet or as_json):
            results = collapse_loads(
                model, flows=FLOWS if flow is None else (flow.value,), settings=settings
            )
        code = max(STATUSES[result.status] for result in results)
        problems = [
            f"{model_file}: {result.reason}"
            for result in results
            if STATUSES[result.status] != DONE
        ]
        if out is not None:
            begun = True
            write_collapse(results, model, out)
        tell(list(dict.fromkeys(problems)))
        if as_json:
            found = [collapse_to_dict(result) for result in results]
            written = {} if out is None else {"directory": str(out)}
            # The last is the non-associative one, where there are two: the flow of a dry joint.
            emit({**found[-1], "title": model.title, "flows": found, **written})
        elif code != WRONG:
            typer.echo(report(printable(model.title), results, out))
    raise typer.Exit(code)


def report(title: str, results: Sequence[Collapse], folder: Path | None) -> str:
    """The multipliers and what there is to know about them."""
    lines = [title]
    for result in results:
        lines.append(f"  {result.flow:<22} {_value(result)}")
        if result.status == "finished":
            lines.append(f"  {'':<22} {result.reason}")
            lines.append(
                f"  {'':<22} equilibrium to {result.residual:.0e}, joint law to "
                f"{result.friction_violation:.0e}, flow rule to {result.dilatancy_violation:.0e}, "
                f"balance of power to {result.duality_gap:.0e}"
            )
    if folder is not None:
        lines.append(f"  {'results':<22} {folder}/")
    return "\n".join(lines)


def _value(result: Collapse) -> str:
    if result.status != "finished":
        return result.reason
    from drystone.common.names import number_of
    from drystone.limit import multiplier_text, range_text

    text = multiplier_text(result.load_multiplier, 5)
    if result.flow == Flow.non_associative.value:
        found = range_text(result.collapse_range, 5)
        paths = number_of(result.n_paths, "path")
        text += f"   over {paths}" if found == text else f"   lowest of {found} over {paths}"
    return text


def _empty(flow: Flow | None) -> dict[str, Any]:
    """Keys of a result that there is none of."""
    name = (flow or Flow.non_associative).value
    return {"flow": name, "collapse_multiplier": None, "collapse_range": None}
