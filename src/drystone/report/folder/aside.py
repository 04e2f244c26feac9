"""Pictures of a run, drawn by a process beside it."""

from __future__ import annotations

from concurrent.futures import Future
from dataclasses import replace
from typing import TYPE_CHECKING, Any

from drystone.common.importing import importing
from drystone.io.results.outputs import Finished, written_of

if TYPE_CHECKING:
    from drystone.common.aside import Aside


def made_ready() -> None:
    """In the process: import what draws, which takes long, before there is anything to draw."""
    with importing():
        import drystone.io.results.results_reader
        import drystone.report.curve_figure
        import drystone.report.mechanism_figure  # noqa: F401
        from drystone.io.results.outputs import OUTPUTS
        from drystone.report import canvas

        dict(OUTPUTS.own())
        canvas.made_ready()


def drawn(done: Finished, language: str) -> bool:
    """In the process: what may be written there of an analysis, in the language that is spoken.

    False where the process does not know an output that the run has registered itself.
    """
    from drystone.common.language import speaking
    from drystone.common.registry import RegistryError
    from drystone.io.results.names import RESULTS
    from drystone.io.results.results_reader import ResultsReader

    with speaking(language), ResultsReader(done.folder / RESULTS) as results:
        done = replace(done, results=results)
        try:
            written = written_of(done.model)
        except RegistryError:
            return False
        for output, keys in written:
            if output.aside:
                output.write(done, keys)
    return True


def drawing(aside: Aside, done: Finished) -> Future[Any]:
    """Let the process draw an analysis that has ended; its ``results.h5`` is on the disk."""
    from drystone.common.language import current

    # Poses and contacts are there; what is sent is short.
    short = replace(done.curve, poses=None, contacts=None)
    sent = replace(done, curve=short, results=None)
    return aside.begin(f"{__name__}:drawn", sent, current())
