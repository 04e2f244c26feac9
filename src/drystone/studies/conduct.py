"""A study from its file to its tables, and one sample of it alone."""

from __future__ import annotations

import json
from collections.abc import Callable, Mapping
from os import PathLike
from pathlib import Path
from typing import Any

from drystone.common.language import speaking
from drystone.common.threads import available
from drystone.common.version import package_version
from drystone.io.modelfile.named import texts_named
from drystone.io.results.folder import OutputError, in_a_sentence, locked
from drystone.io.results.interrupts import uninterrupted
from drystone.io.results.names import SUMMARY
from drystone.io.results.summary import plain, write_summary
from drystone.studies.cluster import ClusterWorkers
from drystone.studies.digests import documents
from drystone.studies.errors import StudyError, needed, required
from drystone.studies.local import LocalWorkers
from drystone.studies.read import read_study
from drystone.studies.running import Progress, Workers, run
from drystone.studies.study import Study
from drystone.studies.tables import CURVES, Parts, read_samples
from drystone.studies.words import language_of

STUDY = "study.json"

Told = Callable[[Progress], None]


def study(
    source: str | PathLike[str] | Mapping[str, Any],
    *,
    out: str | PathLike[str] | None = None,
    workers: int | None = None,
    scheduler: str | None = None,
    resume: bool = False,
    model: str | PathLike[str] | None = None,
    function: str | None = None,
    figures: bool = True,
    progress: Callable[[Progress], None] | None = None,
) -> Any:
    """Compute a study; a frame of pandas with a row for each sample.

    Curves stand in ``curves.parquet`` of the folder, whose path is ``frame.attrs["folder"]``.  A
    study with a [target] gives the frame of its runs.

    Parameters
    ----------
    source
        A study file, or its keys as a dict; ``model`` of a dict may be a `Model`.
    out
        Folder of results; by default that of ``drystone study``, beside a dict "study-results".
    workers
        Processes of this machine, by default one a processor.
    scheduler
        Address of a Dask scheduler, whose workers compute then.
    resume
        Go on with what the folder holds of the same study.
    model, function
        In place of those that the study names, from anywhere: a study file names files of its own
        folder alone.
    figures
        Whether pictures are drawn.
    progress
        Is told how far the study is.

    Raises
    ------
    StudyError
        The study cannot be run; also where the extra of packages is missing, with the command that
        installs it.
    OutputError
        The folder cannot be written, or holds another study.
    """
    required("pyarrow", "pandas")
    asked = read_study(source, model=model, function=function)
    folder = folder_of(asked, out)
    if asked.target is not None:
        from drystone.studies.target import RUNS, aim

        aim(asked, folder, resume=resume, figures=figures, workers=workers)
        return needed("pandas").read_parquet(folder / RUNS)
    conduct(asked, folder, workers=workers, scheduler=scheduler, resume=resume, told=progress)
    conclude(asked, folder, figures=figures)
    frame = read_samples(folder)
    frame.attrs |= {"folder": str(folder), "curves": str(folder / CURVES)}
    return frame


def folder_of(asked: Study, out: str | PathLike[str] | None) -> Path:
    """The folder of results of a study."""
    if out is not None:
        return Path(out)
    stem = asked.source.stem if asked.source is not None else "study"
    return Path(f"{stem}-results")


def conduct(
    asked: Study,
    folder: Path,
    *,
    workers: int | None = None,
    scheduler: str | None = None,
    resume: bool = False,
    told: Told | None = None,
) -> Progress:
    """Compute what is missing of a study and put its tables in order.

    Raises
    ------
    KeyboardInterrupt
        Was interrupted: what came until then is kept in parts, for ``resume``.
    """
    with locked(folder):
        opened(asked, folder, resume=resume)
        parts = Parts(folder)
        parts.reopen()
        write_record(asked, folder, {"status": "running"})
        progress = Progress(total=asked.count)
        if not parts.done(asked.count).all():
            team = _workers(asked, workers, scheduler)
            try:
                progress = run(asked, folder, team, told=told)
            except KeyboardInterrupt:
                write_record(asked, folder, {"status": "interrupted"})
                raise
            finally:
                team.end()
        with uninterrupted():
            in_a_sentence(lambda: Parts(folder).merge(asked.count))
            rate = {"rate": progress.rate, "run_seconds": progress.seconds}
            write_record(asked, folder, {"status": "computed", **rate})
    return progress


def _workers(asked: Study, workers: int | None, scheduler: str | None) -> Workers:
    if scheduler is not None:
        return ClusterWorkers(scheduler)
    return LocalWorkers(min(workers or available(), asked.count), asked.task)


def opened(asked: Study, folder: Path, *, resume: bool) -> None:
    """See that a folder is empty, or holds the beginning of the same study.

    Raises
    ------
    OutputError
        Else; the message says what to do.
    """
    held = record_of(folder)
    if held is None:
        if resume:
            raise OutputError(f"{folder} holds no study to resume: leave out --resume")
        return
    if not resume:
        raise OutputError(
            f"{folder} holds a study already: go on with it by --resume, or choose another folder "
            "with --out"
        )
    check_same(asked, folder, held)


def check_same(asked: Study, folder: Path, held: Mapping[str, Any] | None = None) -> None:
    """See that a folder holds the same study, or none.

    Parameters
    ----------
    held
        What ``study.json`` says, where it was read before.

    Raises
    ------
    OutputError
        It holds another one; the message says where they differ.
    """
    held = record_of(folder) if held is None else held
    if held is not None and held.get("fingerprint") != asked.fingerprint:
        raise OutputError(
            f"{folder} {_difference(held.get('digests'), asked)}: choose another folder with --out"
        )


def _difference(before: Any, asked: Study) -> str:
    """Why the study of a folder cannot be continued, within a sentence.

    Parameters
    ----------
    before
        Digests that the folder holds; None where an earlier version wrote it.
    """
    if not isinstance(before, dict):
        return "is of an earlier version, which did not record all that its samples follow from"
    now = asked.digests
    other = [name for name in dict.fromkeys((*now, *before)) if before.get(name) != now.get(name)]
    return f"holds another study than this file says: they differ in {' and '.join(other)}"


def record_of(folder: Path) -> dict[str, Any] | None:
    """What ``study.json`` says; None where there is none."""
    try:
        found: dict[str, Any] = json.loads((folder / STUDY).read_text(encoding="utf-8"))
    except FileNotFoundError:
        return None
    except (OSError, ValueError) as error:
        raise OutputError(f"{folder / STUDY} cannot be read ({error}): remove it") from None
    return found


def write_record(asked: Study, folder: Path, more: Mapping[str, Any]) -> None:
    """Write ``study.json``: what the study is, and what is said here of it."""
    record = {
        "title": asked.title,
        "status": "running",
        "design": asked.design,
        "n_samples": asked.count,
        "seed": asked.seed,
        "parameters": list(asked.task.names),
        "outputs": list(asked.task.outputs),
        "version": package_version(),
        "fingerprint": asked.fingerprint,
        "digests": asked.digests,
        "source": None if asked.source is None else str(asked.source),
        **more,
        "study": plain({**asked.given, "model": asked.task.model}),
        "files": _files_of(asked),
    }
    in_a_sentence(lambda: write_summary(record, folder / STUDY))


def _files_of(asked: Study) -> dict[str, str]:
    """Texts of the files that the model and its parameters name, by their names."""
    task = asked.task
    if task.files is not None:
        return dict(task.files)
    folder = Path(task.source or "").parent
    found: dict[str, str] = {}
    for document in documents(asked):
        found |= texts_named(document, folder)
    return found


def conclude(asked: Study, folder: Path, *, figures: bool = True) -> dict[str, Any]:
    """What a study says, into ``study.json`` and figures; returns what the file says."""
    from drystone.studies.findings import findings

    found = findings(asked, folder)
    drawn: list[str] = []
    if figures:
        from drystone.studies.figures import draw_all

        with speaking(language_of(asked.task.model)):
            drawn = draw_all(asked.title, folder, found)
    held = record_of(folder) or {}
    kept: dict[str, Any] = {key: held[key] for key in ("rate", "run_seconds") if key in held}
    write_record(asked, folder, {**kept, "status": "finished", **found, "figures": drawn})
    return record_of(folder) or {}


def values_of(asked: Study, folder: Path, sample: int) -> list[Any]:
    """Values of the parameters of a sample; of a search, those of one of the runs in its folder.

    Raises
    ------
    StudyError
        There is no such sample.
    """
    runs: list[dict[str, Any]] = []
    if asked.target is not None:
        from drystone.studies.target import RUNS

        if (folder / RUNS).is_file():
            runs = needed("pyarrow.parquet").read_table(folder / RUNS).to_pylist()
    n = asked.count if asked.target is None else len(runs)
    if n == 0:
        raise StudyError([f"--sample: {folder} holds no runs of this search: begin it first"])
    if not 0 <= sample < n:
        raise StudyError(
            [f"--sample {sample}: the study has samples 0 to {n - 1}: give one of them"]
        )
    if asked.target is None:
        return asked.values_at(sample)
    return [runs[sample][name] for name in asked.task.names]


def run_again(asked: Study, folder: Path, sample: int, seed: int | None = None) -> Path:
    """Run one sample again alone, with all files of ``drystone run``; the folder they are in.

    Parameters
    ----------
    seed
        That its row holds; by default it is derived from that of the study.

    Raises
    ------
    StudyError
        There is no such sample, or it has no model.
    """
    from drystone.analysis.driver import pushover
    from drystone.limit import limits_beside
    from drystone.report.folder.directory import ResultsDirectory
    from drystone.studies.sample import digest_of, document_of, model_of

    if asked.task.function is not None:
        raise StudyError(["--sample: a function has no curve: call it from Python"])
    task = asked.task
    document = document_of(task, values_of(asked, folder, sample))
    seed = task.seed_at(sample) if seed is None else seed
    model = model_of(task, document, seed, digest_of(document))
    own = folder / f"sample_{sample}"
    with ResultsDirectory(own, beside=limits_beside(model)) as results:
        pushover(
            model,
            engine=task.engine,
            strategy=task.strategy,
            recorder=results,
            threads=1,
            progress=False,
        )
    from drystone.io.modelfile import write_model

    in_a_sentence(lambda: write_model(model, own / "model.toml"))
    return own


def extremes_of(folder: Path) -> list[Path]:
    """Folders of the samples of least and greatest peak of a study (where supports move, of their
    least reaction), run again where they are not there.

    Raises
    ------
    StudyError
        The study has no curves, or its file is missing.
    """
    record = record_of(folder) or {}
    extremes = record.get("extremes") or {}
    samples = extremes.get("peak_multiplier") or extremes.get("least_reaction")
    if samples is None:
        raise StudyError([f"{folder}: the study has no curves: finish it by --resume"])
    found = []
    for sample in dict.fromkeys((samples["least"], samples["greatest"])):
        own = folder / f"sample_{sample}"
        if not (own / SUMMARY).is_file():
            kept = read_study(record["study"], files=record.get("files") or {})
            rows = read_samples(folder, ["sample", "seed"]).set_index("sample")
            run_again(kept, folder, sample, int(rows["seed"][sample]))
        found.append(own)
    return found
