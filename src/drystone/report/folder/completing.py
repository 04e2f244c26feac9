"""The files of a run that was killed, written from what it has kept."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

from drystone.common.language import say
from drystone.io.results.folder import OutputError, locked
from drystone.io.results.hdf5 import RUNNING
from drystone.io.results.interrupts import uninterrupted
from drystone.io.results.names import PARAVIEW, RESULTS
from drystone.report.folder.ending import finished, write_long, write_short
from drystone.report.folder.results import load_results


def write_files(path: Path | str, *, formats: Sequence[str] = ()) -> dict[str, Any]:
    """Write what a run that was killed has not: tables, summary, pictures and series for ParaView.

    They are of the points that ``results.h5`` has.  The run can go on afterwards.

    Parameters
    ----------
    path
        The folder of results; of a run that has ended its files are written again.
    formats
        Of pictures beside PNG: "svg", "pdf".

    Returns
    -------
    What ``summary.json`` holds.

    Raises
    ------
    OutputError
        The folder holds no points, a run writes there, or nothing can be written there.
    """
    from drystone.limit import limits_beside  # takes long

    folder = Path(path)
    if not (folder / RESULTS).is_file():
        load_results(folder)  # says so, before anything is made there
    with locked(folder):
        stored = load_results(folder)
        curve, model = stored.curve, stored.model
        if model is None:
            raise OutputError(
                f"{folder / RESULTS}: the model in it cannot be read by this version: trace it "
                "again"
            )
        if not curve.points:
            raise OutputError(f"{folder / RESULTS}: its curve has no points yet")
        if curve.status == RUNNING:  # and no other process has the folder
            curve = replace(curve, status="stopped", reason=str(say("end.killed")))
        done = finished(folder, model, curve, limits_beside(model), formats=formats)
        (folder / PARAVIEW).mkdir(exist_ok=True)
        with uninterrupted():
            write_short(done)
            write_long(done)
    return done.summary
