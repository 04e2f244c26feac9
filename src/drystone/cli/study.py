"""``drystone study``: many curves of one model with varied parameters."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from drystone.cli.options import AsJson, Quiet
from drystone.cli.outcome import DONE, UNFINISHED, emit, outcome, tell
from drystone.common.language import say, speaking

if TYPE_CHECKING:
    from drystone.studies.running import Progress
    from drystone.studies.study import Study

#: Reasons that are told on the terminal.
MOST_REASONS = 3

StudyFile = Annotated[
    Path, typer.Argument(metavar="STUDY", help="Study file, TOML or JSON.", show_default=False)
]
Folder = Annotated[
    Path | None,
    typer.Option(
        metavar="DIR", help="Folder of results. [default: STUDY-results]", show_default=False
    ),
]
Workers = Annotated[
    int | None,
    typer.Option(
        metavar="N",
        min=1,
        help="Processes that share the samples. [default: one for each processor]",
        show_default=False,
    ),
]
Scheduler = Annotated[
    str | None,
    typer.Option(
        metavar="ADDRESS",
        help="Dask scheduler whose workers compute the samples, for instance tcp://host:8786.",
        show_default=False,
    ),
]
Resume = Annotated[
    bool, typer.Option("--resume", help="Continue the study from the samples that DIR holds.")
]
Sample = Annotated[
    int | None,
    typer.Option(
        metavar="N",
        min=0,
        help="Run sample N again alone, with all files, into DIR/sample_N.",
        show_default=False,
    ),
]


OtherModel = Annotated[
    Path | None,
    typer.Option(
        "--model",
        metavar="FILE",
        help="Model file, from anywhere, instead of the one that STUDY names.",
        show_default=False,
    ),
]
OtherFunction = Annotated[
    str | None,
    typer.Option(
        "--function",
        metavar="MODULE:NAME",
        help="Function, from Python's search path, instead of the one that STUDY names.",
        show_default=False,
    ),
]


# Many: options of the command.
def study(
    study_file: StudyFile,
    out: Folder = None,
    workers: Workers = None,
    scheduler: Scheduler = None,
    resume: Resume = False,
    sample: Sample = None,
    model: OtherModel = None,
    function: OtherFunction = None,
    as_json: AsJson = False,
    quiet: Quiet = False,
) -> None:
    """Trace many curves of one model with varied parameters, and evaluate them together."""
    begun = False
    with outcome(as_json=as_json, begun=lambda: begun):
        from drystone.io.results.folder import check_writable
        from drystone.studies.conduct import conclude, conduct, folder_of, opened
        from drystone.studies.errors import required
        from drystone.studies.read import read_study
        from drystone.studies.words import language_of

        required("pyarrow", "pandas")
        asked = read_study(study_file, model=model, function=function)
        folder = folder_of(asked, out)
        check_writable(folder)
        if sample is not None:
            _again(asked, folder, sample, as_json=as_json, quiet=quiet)
            raise typer.Exit(DONE)
        if asked.target is not None:
            reached = _aimed(asked, folder, resume, workers, as_json=as_json, quiet=quiet)
            raise typer.Exit(DONE if reached else UNFINISHED)
        opened(asked, folder, resume=resume)  # better known before the work
        begun = True
        with _Shown(asked.title, quiet=quiet or as_json) as told:
            conduct(asked, folder, workers=workers, scheduler=scheduler, resume=resume, told=told)
        found = conclude(asked, folder)
        if as_json:
            emit({**found, "directory": str(folder)})
        else:
            with speaking(language_of(asked.task.model)):
                typer.echo(report(found, folder))
    raise typer.Exit(DONE if "finished" in found["statuses"] else UNFINISHED)


def _again(asked: Study, folder: Path, sample: int, *, as_json: bool, quiet: bool) -> None:
    from drystone.studies.conduct import check_same, run_again, values_of

    check_same(asked, folder)
    own = run_again(asked, folder, sample)
    values = dict(zip(asked.task.names, values_of(asked, folder, sample), strict=True))
    if as_json:
        emit({"status": "done", "sample": sample, "values": values, "directory": str(own)})
    elif not quiet:
        typer.echo("\n".join(f"{name} = {value}" for name, value in values.items()))
        typer.echo(f"sample {sample} is written into {own}/")


def _aimed(
    asked: Study, folder: Path, resume: bool, workers: int | None, *, as_json: bool, quiet: bool
) -> bool:
    """Look for what [target] asks for; whether there is such a value."""
    from drystone.studies.target import aim
    from drystone.studies.words import language_of, of_sentence

    def told(text: str) -> None:
        if not quiet and not as_json:
            tell([text])

    found = aim(asked, folder, resume=resume, told=told, workers=workers)
    if as_json:
        emit({**found, "directory": str(folder)})
    else:
        with speaking(language_of(asked.task.model)):
            runs = _said("runs", n=found["n_runs"], folder=str(folder))
            typer.echo(f"{asked.title}\n  {of_sentence(found)}\n  {runs}")
    return bool(found["status"] == "finished")


class _Shown:
    """Progress on standard error: a bar on a terminal, a line now and then elsewhere."""

    def __init__(self, title: str, *, quiet: bool) -> None:
        self._title, self._quiet = title, quiet
        self._bar: Any = None
        self._task: Any = None
        from drystone.common.progress.points import SECONDS_BETWEEN_LINES

        self._between = self._next = SECONDS_BETWEEN_LINES

    def __enter__(self) -> _Shown:
        if not self._quiet and sys.stderr.isatty():
            from rich.console import Console
            from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn

            self._bar = Progress(
                TextColumn("{task.description}", markup=False), BarColumn(bar_width=24),
                MofNCompleteColumn(), TextColumn("{task.fields[state]}"),
                console=Console(stderr=True), refresh_per_second=2, transient=True,
            )  # fmt: skip
            self._task = self._bar.add_task(self._title, total=None, state="")
            self._bar.start()
        return self

    def __exit__(self, *error: object) -> None:
        if self._bar is not None:
            self._bar.stop()

    def __call__(self, progress: Progress) -> None:
        if self._quiet:
            return
        state = state_of(progress)
        if self._bar is not None:
            self._bar.update(self._task, total=progress.total, completed=progress.done, state=state)
        elif progress.seconds >= self._next:
            self._next = progress.seconds + self._between
            tell([f"{self._title}: {progress.done} of {progress.total}, {state}"])


def state_of(progress: Progress) -> str:
    """Rate, failures and time left."""
    from drystone.common.progress.points import clock_time

    left = progress.seconds_left
    text = f"{progress.rate:.3g} a second, {progress.failed} failed"
    return text if left is None else f"{text}, {clock_time(left)} left"


def report(found: dict[str, Any], folder: Path) -> str:
    """The few lines that a person wants to read first, in the language that is spoken."""
    from drystone.model.construction.words import printable
    from drystone.studies.findings import on_peaks
    from drystone.studies.page import counts_of
    from drystone.studies.words import of_reason

    def row(name: str, value: str) -> str:
        return f"  {printable(name):<22} {printable(value)}"

    many = found["n_samples"]
    sampled = _said("sampled", n=many, design=found["design"], counts=counts_of(found))
    lines = [printable(str(found["title"])), row(_said("samples"), sampled)]
    if found.get("n_certified") is not None:
        certified = _said("among", n=found["n_certified"], many=many)
        lines.append(row(_said("certified"), certified))
    lines += [row(_said("peak"), note) for note in on_peaks(found)]
    for why, n in _reasons(found):
        lines.append(row(_said("why_not"), _said("times", n=n, why=of_reason(why))))
    for name in found["effects"]:
        own = found["columns"][name]
        known = {"median": own["median"], "low": own["p05"], "high": own["p95"]}
        lines.append(row(name, _said("summary", **known)))
    lines += [line for name, own in (found.get("indices") or {}).items() if own
              for line in _of_indices(printable(name), own["parameters"])]  # fmt: skip
    lines += [row(one["name"], _of_fragility(one)) for one in found.get("fragility", [])]
    lines.append(row(_said("results"), f"{folder}/"))
    return "\n".join(lines)


def _said(key: str, **fields: Any) -> str:
    """A word or sentence, in the language that is spoken."""
    return say(f"study_screen.{key}", **fields).spoken


def _reasons(found: dict[str, Any]) -> list[tuple[str, int]]:
    """What most samples say why they are not finished, the most frequent first."""
    return sorted(found.get("reasons", {}).items(), key=lambda item: -item[1])[:MOST_REASONS]


def _of_fragility(one: dict[str, Any]) -> str:
    """A fragility curve, or why there is none."""
    from drystone.studies.words import why_not_fitted, word

    if one.get("median") is None:
        return word("not_fitted", why=why_not_fitted(one))
    n = one.get("n_left_out")
    left_out = _said("left_out", n=n) if n else _said("none_left_out")
    low, high = one["median_confidence"]
    known = {"median": one["median"], "low": low, "high": high, "beta": one["beta"]}
    return _said("fitted", **known, left_out=left_out)


def _of_indices(output: str, parameters: dict[str, Any]) -> list[str]:
    """Indices of an output, each with half its 95 % interval."""
    from drystone.model.construction.words import printable

    lines = [f"  {_said('indices', output=output)}"]
    for name, own in parameters.items():
        told = [
            _said("index", what=_said(key), value=own[key], half=own[f"{key}_confidence"])
            for key in ("first", "total", "mu_star")
            if key in own
        ]
        lines.append(f"    {printable(name):<20} {', '.join(told)}")
    return lines
