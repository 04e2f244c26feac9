"""The value of a parameter for which an output reaches a value: by bracketing and Brent's method.

Every run is kept, so that a search that was interrupted goes on.  Of two parameters a grid is
computed, and where the output has the value is a line on its map.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from dataclasses import replace
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np

from drystone.common.names import quoted, suggestion
from drystone.io.results.folder import in_a_sentence, locked
from drystone.studies.distributions import Uniform
from drystone.studies.errors import StudyError, needed
from drystone.studies.sample import FAILED, compute, is_missing
from drystone.studies.study import Study
from drystone.studies.tables import read_samples

RUNS = "runs.parquet"
#: Shares of the range that are tried, one row after the other, until two of them lie on either
#: side of the value: ends first, as most outputs rise or fall with a parameter.
PLACES = ((0.0, 1.0), (0.5,), (0.25, 0.75), (0.125, 0.375, 0.625, 0.875))


#: How far an output may be from its value where the search ends, over the tolerance: beyond it
#: jumps there.
_NEAR = 20.0


class TooManyRunsError(Exception):
    """The search has used up its runs."""


class Runs:
    """Runs of a search by the parameter's value, kept in a file.

    Parameters
    ----------
    told
        Is told a sentence on each run.
    """

    def __init__(
        self, asked: Study, folder: Path, most: int, told: Callable[[str], None] | None
    ) -> None:
        self._asked, self._path, self._most, self._told = asked, folder / RUNS, most, told
        self._name = asked.task.names[0]
        assert asked.target is not None
        self._output = asked.target["output"]
        self.rows: list[dict[str, Any]] = []
        if self._path.exists():
            self.rows = needed("pyarrow.parquet").read_table(self._path).to_pylist()
        self._known = {row[self._name]: row for row in self.rows}

    def output_at(self, value: float) -> float | None:
        """The output where the parameter has a value; None where the run has none.

        Raises
        ------
        TooManyRunsError
            It would be one run too many.
        StudyError
            There is no such output.
        """
        row = self._known.get(value)
        if row is None:
            row = self._computed(value)
        found = row.get(self._output)
        return None if found is None or is_missing(found) else float(found)

    def _computed(self, value: float) -> dict[str, Any]:
        if len(self.rows) >= self._most:
            raise TooManyRunsError
        row = dict(compute(self._asked.task, len(self.rows), [value]).row)
        if row["status"] != FAILED and self._output not in row:
            known = [name for name in row if isinstance(row[name], int | float)]
            raise StudyError(
                [f"target output: there is no {quoted(self._output)}: "
                 f"{suggestion(self._output, known)}"]
            )  # fmt: skip
        self.rows.append(row)
        self._known[value] = row
        _write_runs(self.rows, self._path)
        if self._told is not None:
            found = row.get(self._output)
            what = row["reason"] if is_missing(found) else f"{self._output} = {found:.6g}"
            self._told(f"run {len(self.rows)}: {self._name} = {value:.6g}, {what}")
        return row

    def pairs(self) -> list[tuple[float, float]]:
        """Values of the parameter with their outputs, in order."""
        known = [(row[self._name], row.get(self._output)) for row in self.rows]
        return sorted((float(x), float(y)) for x, y in known if y is not None and not is_missing(y))


def _write_runs(rows: Sequence[dict[str, Any]], path: Path) -> None:
    from drystone.studies.tables import samples_table, write_table

    in_a_sentence(lambda: write_table(samples_table(rows), path))


def aim(
    asked: Study,
    folder: Path,
    *,
    resume: bool = False,
    figures: bool = True,
    told: Callable[[str], None] | None = None,
    workers: int | None = None,
) -> dict[str, Any]:
    """Look for what [target] asks for; what ``study.json`` says of it.

    ``status`` is "finished" where there is such a value, "none" where there is none in the range,
    "jump" where the output passes it without having it, and "stopped" where the search has not
    come to an end; ``sentence`` says it.
    """
    assert asked.target is not None
    if len(asked.target["parameter"]) == 2:
        return _map(asked, folder, resume=resume, figures=figures, workers=workers)
    from drystone.studies.conduct import opened, write_record

    begun = time.perf_counter()
    with locked(folder):
        opened(asked, folder, resume=resume)
        write_record(asked, folder, {"status": "running"})
        runs = Runs(asked, folder, asked.target["most_runs"], told)
        try:
            found = _searched(asked, runs)
        except KeyboardInterrupt:
            write_record(asked, folder, {"status": "interrupted"})
            raise
        found |= {"n_runs": len(runs.rows), "curve": runs.pairs()}
        found["run_seconds"] = time.perf_counter() - begun
        if figures:
            from drystone.studies.figures import target as draw

            in_a_sentence(lambda: draw(asked, found, folder))
        write_record(asked, folder, found)
    return found


def _searched(asked: Study, runs: Runs) -> dict[str, Any]:
    from scipy.optimize import brentq

    assert asked.target is not None
    target, name = asked.target, asked.task.names[0]
    output, value = target["output"], target["value"]
    low, high = target["parameter"][0]["range"]
    try:
        bracket = _bracket(runs, low, high, value)
        if bracket is None:
            return _none(runs, name, output, value, low, high)
        exact = [x for x, y in runs.pairs() if y == value]
        root = exact[0] if exact else brentq(
            lambda x: _number(runs.output_at(x)) - value,
            *bracket,
            xtol=1e-3 * target["tolerance"] * (high - low),
            rtol=0.5 * target["tolerance"],
        )  # fmt: skip
    except TooManyRunsError:
        return {
            "status": "stopped",
            "value": None,
            "sentence": f"stopped after {len(runs.rows)} runs: give most_runs of [target] a larger "
            "number, or a narrower range",
        }
    except _NoNumberError:
        return {
            "status": "stopped",
            "value": None,
            "sentence": f"stopped: a run on the way has no {output}, see {RUNS}: take a range in "
            "which all have one",
        }
    reached = runs.output_at(root)
    if reached is None or abs(reached - value) > _NEAR * target["tolerance"] * (abs(value) or 1.0):
        return _jump(runs, name, output, value, root)
    return {
        "status": "finished",
        "value": root,
        "reached": reached,
        "sentence": f"{output} = {value:g} at {name} = {root:.6g}",
    }


def _bracket(runs: Runs, low: float, high: float, value: float) -> tuple[float, float] | None:
    """Two neighbours on either side of the value; None where there are none."""
    for shares in PLACES:
        for share in shares:
            runs.output_at(low + share * (high - low))
        for (a, ya), (b, yb) in pairwise(runs.pairs()):
            if (ya - value) * (yb - value) <= 0.0 and low <= a and b <= high:
                return a, b
    return None


def _jump(runs: Runs, name: str, output: str, value: float, root: float) -> dict[str, Any]:
    """The output passes the value without having it, as where another mechanism takes over."""
    a, b = next(
        (one, other)
        for one, other in pairwise(runs.pairs())
        if one[0] <= root <= other[0] and (one[1] - value) * (other[1] - value) <= 0.0
    )
    sentence = (
        f"{output} jumps over {value:g}: it is {a[1]:.6g} at {name} = {a[0]:.6g} and {b[1]:.6g} at "
        f"{b[0]:.6g}"
    )
    return {"status": "jump", "value": None, "jump_at": [a[0], b[0]], "sentence": sentence}


class _NoNumberError(Exception):
    """A run on the way has no output."""


def _number(found: float | None) -> float:
    if found is None:
        raise _NoNumberError
    return found


def _none(
    runs: Runs, name: str, output: str, value: float, low: float, high: float
) -> dict[str, Any]:
    known = runs.pairs()
    sentence = f"no value of {name} from {low:g} to {high:g} gives {output} = {value:g}: "
    if known:
        x, y = min(known, key=lambda pair: abs(pair[1] - value))
        sentence += f"the nearest of {len(runs.rows)} runs is {y:.6g} at {x:.6g}"
    else:
        sentence += f"no run has one, the first because {runs.rows[0]['reason']}"
    return {"status": "none", "value": None, "sentence": sentence}


def _map(
    asked: Study, folder: Path, *, resume: bool, figures: bool, workers: int | None
) -> dict[str, Any]:
    """The output over two parameters, and where it has the value."""
    from drystone.studies.conduct import conduct, write_record

    assert asked.target is not None
    target, (a, b) = asked.target, asked.target["parameter"]
    laws = tuple(Uniform(low=one["range"][0], high=one["range"][1]) for one in (a, b))
    grid = replace(asked, design="grid", laws=laws, steps=(a["steps"], b["steps"]))
    conduct(grid, folder, workers=workers, resume=resume)
    frame = read_samples(folder)
    if target["output"] not in frame:
        raise StudyError([f"target output: there is no {quoted(target['output'])}"])
    shape = a["steps"], b["steps"]
    x, y, z = (
        frame[name].to_numpy(dtype=float, na_value=np.nan).reshape(shape)
        for name in (*asked.task.names, target["output"])
    )
    line = _crossings(x, y, z, target["value"])
    names = f"{asked.task.names[0]} and {asked.task.names[1]}"
    what = f"{target['output']} = {target['value']:g}"
    found: dict[str, Any] = {
        "status": "finished" if line else "none",
        "sentence": f"{what} on a line through the map of {names}"
        if line
        else f"no values of {names} in their ranges give {what}: it goes from "
        f"{np.nanmin(z):.6g} to {np.nanmax(z):.6g}",
        "contour": line,
        "n_runs": len(frame),
    }
    if figures:
        from drystone.studies.figures import target_map

        in_a_sentence(lambda: target_map(asked, (x, y, z), folder))
    write_record(grid, folder, found)
    frame.to_parquet(folder / RUNS)
    return found


def _crossings(x: Any, y: Any, z: Any, value: float) -> list[list[float]]:
    """Points between neighbours along the second parameter, by linear interpolation."""
    line = []
    for row in range(len(x)):
        for k in range(x.shape[1] - 1):
            before, after = z[row, k] - value, z[row, k + 1] - value
            if before * after <= 0.0 and before != after:
                share = before / (before - after)
                line.append(
                    [float(x[row, k]), float(y[row, k] + share * (y[row, k + 1] - y[row, k]))]
                )
    return line
