"""How a command ends: exit statuses, sentences on standard error, JSON on standard output."""

from __future__ import annotations

import _thread
import json
import signal
import sys
import threading
import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from types import FrameType
from typing import Any, NoReturn

import typer

#: Exit statuses.
DONE, WRONG, UNFINISHED, INTERRUPTED = 0, 2, 3, 130

#: Sentences shown of a long list; JSON has them all.
MOST_SENTENCES = 20

#: Seconds after which a signal that came while a module was loaded is looked at again.
LOADED_EVERY = 1e-3

_IMPORTING = "<frozen importlib._bootstrap>"  # the file of the frames that load a module


@contextmanager
def outcome(*, as_json: bool, begun: Callable[[], bool] = lambda: False) -> Iterator[None]:
    """Run the body of a command; errors that are the user's to mend end it without a traceback.

    Parameters
    ----------
    as_json
        Whether standard output gets an object with the problems, too.
    begun
        Says whether results were written already: an error is then one of the analysis, not of
        the model.
    """
    try:
        with signals_as_interrupts():
            yield
    except KeyboardInterrupt:
        interrupted(begun(), as_json=as_json)
    except BrokenPipeError:
        raise  # the reader of standard output has seen enough
    except Exception as error:
        problems = sentences(error)
        if problems is None:
            raise
        fail(UNFINISHED if begun() else WRONG, problems, as_json=as_json)
    finally:
        note = getattr(sys.modules.get("drystone.common.kernel_cache"), "note", "")
        if note:  # else nothing is loaded for it, amid what was interrupted
            tell([note])


@contextmanager
def signals_as_interrupts() -> Iterator[None]:
    """Ctrl-C, and the first SIGTERM, raise `KeyboardInterrupt`: what was reached is kept.

    A signal waits until the module that is being loaded is complete: modules in C swallow an
    interrupt, make another error of it, or print a traceback.
    """
    waiting: set[signal.Signals] = set()

    def interrupt(number: int, frame: FrameType | None) -> None:
        if _imports(frame) > imports:
            if number not in waiting:
                waiting.add(signal.Signals(number))
                _thread.start_new_thread(again, (signal.Signals(number),))
            return
        if number == signal.SIGTERM:
            signal.signal(number, signal.SIG_IGN)  # the results are being written
        raise KeyboardInterrupt

    def again(number: signal.Signals) -> None:
        time.sleep(LOADED_EVERY)
        waiting.discard(number)
        _thread.interrupt_main(number)

    if threading.current_thread() is not threading.main_thread():
        yield  # signals are handled by the main thread alone
        return
    imports = _imports(sys._getframe())  # a module may itself run a command
    before = {number: signal.getsignal(number) for number in (signal.SIGINT, signal.SIGTERM)}
    if before[signal.SIGINT] not in (signal.SIG_DFL, signal.default_int_handler):
        del before[signal.SIGINT]  # ignored, as in the background, or taken care of
    try:
        for number in before:
            signal.signal(number, interrupt)
        yield
    finally:
        for number, handler in before.items():
            signal.signal(number, handler)


def _imports(frame: FrameType | None) -> int:
    """Frames of Python's own importing around one."""
    number = 0
    while frame is not None:
        number += frame.f_code.co_filename == _IMPORTING
        frame = frame.f_back
    return number


def sentences(error: Exception) -> list[str] | None:
    """What to tell the user of an error; None where it is a fault of the program."""
    from drystone.assessment.errors import AssessmentError
    from drystone.common.workers import WorkerError
    from drystone.engines.base import EngineError
    from drystone.io.results.folder import OutputError
    from drystone.model.construction.errors import ModelError

    if isinstance(error, ModelError):
        return error.problems
    if isinstance(error, AssessmentError | EngineError | OutputError | WorkerError):
        return [str(error)]
    if isinstance(error, OSError):
        where = f"{error.filename}: " if error.filename else ""
        return [f"{where}{error.strerror or error}"]
    return None


def fail(
    code: int,
    problems: Sequence[str],
    *,
    as_json: bool,
    status: str = "failed",
    extra: Mapping[str, Any] | None = None,
) -> NoReturn:
    """End the command: sentences on standard error and, if asked for, an object with them."""
    tell(problems)
    if as_json:
        reason = " ".join(problems)
        emit({"status": status, "reason": reason, "problems": list(problems), **(extra or {})})
    raise typer.Exit(code)


def interrupted(begun: bool, *, as_json: bool) -> NoReturn:
    """End the command; nothing is imported, which the interrupt may have left half done."""
    reason = f"interrupted: {'what was reached is kept' if begun else 'nothing was written'}"
    typer.echo(f"drystone: {reason}", err=True)
    if as_json:
        said = {"status": "interrupted", "reason": reason, "problems": [reason]}
        typer.echo(json.dumps(said, indent=2))
    raise typer.Exit(INTERRUPTED)


def tell(problems: Sequence[str]) -> None:
    """Write sentences to standard error."""
    from drystone.model.construction.words import printable

    for problem in problems[:MOST_SENTENCES]:
        lines = (printable(line) for line in problem.split("\n"))
        typer.echo("drystone: " + "\n".join(lines), err=True)
    if len(problems) > MOST_SENTENCES:
        typer.echo(f"drystone: and {len(problems) - MOST_SENTENCES} more", err=True)


def emit(value: dict[str, Any]) -> None:
    """Write one JSON object to standard output."""
    from drystone.io.results.summary import to_json

    typer.echo(to_json(value))


def exit_code(status: str) -> int:
    """Exit status for the status of a curve."""
    return {"finished": DONE, "interrupted": INTERRUPTED}.get(status, UNFINISHED)
