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

from drystone.common.arrays import Array
from drystone.common.language import Saying, said_end, say, speaking
from drystone.common.names import quoted, suggestion
from drystone.io.results.folder import in_a_sentence, locked
from drystone.studies.distributions import Uniform
from drystone.studies.errors import StudyError, needed
from drystone.studies.sample import FAILED, compute, is_missing
from drystone.studies.study import Study
from drystone.studies.tables import read_samples
from drystone.studies.words import language_of

RUNS = "runs.parquet"
#: Shares of the range that are tried, one row after the other, until two of them lie on either
#: side of the value: ends first, as most outputs rise or fall with a parameter.
PLACES = ((0.0, 1.0), (0.5,), (0.25, 0.75), (0.125, 0.375, 0.625, 0.875))


#: A bracket may hold a jump that has shrunk to the second share, while its outputs still differ by
#: the first share of what they did.  It is halved from then on, which no jump slows down, until its
#: outputs come together.  Of 600 random jumps none takes more than 12 runs at a tolerance of 1e-3,
#: with shares of 0.7 to 0.95 and of 0.5 to 0.75; outputs without a jump take as many as without.
_APART, _SHRUNK = 0.8, 0.5

Bracket = tuple[float, float]


class TooManyRunsError(Exception):
    """The search has used up its runs."""


class _JumpError(Exception):
    """Outputs lie on either side of the value, apart, at two places as close as asked."""

    def __init__(self, bracket: Bracket) -> None:
        super().__init__()
        self.bracket = bracket


class _SuspectError(Exception):
    """A bracket may hold a jump."""


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

            aimed = asked.target
            with speaking(language_of(asked.task.model)):
                in_a_sentence(lambda: draw(aimed, asked.task.names[0], found, folder))
        write_record(asked, folder, found)
    return found


def _searched(asked: Study, runs: Runs) -> dict[str, Any]:
    assert asked.target is not None
    target, name = asked.target, asked.task.names[0]
    output, value = target["output"], target["value"]
    low, high = target["parameter"][0]["range"]
    try:
        bracket = _bracket(runs, low, high, value)
        if bracket is None:
            return _none(runs, name, output, value, low, high)
        root = _root(runs, bracket, value, target["tolerance"], high - low)
    except TooManyRunsError:
        so_far = _so_far(runs, name, value)
        return _told("stopped", say("study.stopped", n=len(runs.rows), so_far=so_far))
    except _NoNumberError:
        return _told("stopped", say("study.no_output", output=output, file=RUNS))
    except _JumpError as jump:
        return _jump(runs, name, output, value, jump.bracket)
    known = {"output": output, "value": value, "name": name}
    reached = _number(runs.output_at(root))
    said = say("study.reached", **known, at=root, reached=reached)
    return {**_told("finished", said), "value": root, "reached": reached}


def _told(status: str, said: Saying) -> dict[str, Any]:
    """The end of a search, without a value: its sentence, in English and so that it can be said in
    every language."""
    return {"status": status, "value": None, "sentence": str(said), "said": said.as_dict()}


def _root(runs: Runs, bracket: Bracket, value: float, tolerance: float, width: float) -> float:
    """Where the output has the value, to a share of the parameter, by Brent's method.

    The output there is as close to the value as its slope makes it: to e times the share, where the
    output goes with the power e of the parameter.

    Where a bracket that shrinks keeps its outputs apart, it is halved instead.

    Parameters
    ----------
    bracket
        Two runs on either side of the value.
    width
        Of the range that is searched: a jump is located to plus or minus ``tolerance`` of it.

    Raises
    ------
    _JumpError
        They do.
    """
    from scipy.optimize import brentq

    while True:
        exact = [x for x, y in runs.pairs() if y == value]
        if exact:
            return exact[0]
        watch = _Watch(runs, bracket, value)
        try:
            return float(brentq(watch, *bracket, xtol=1e-3 * tolerance * width, rtol=tolerance))
        except _SuspectError:
            bracket = _halved(runs, watch.bracket, value, 2.0 * tolerance * width)


def _so_far(runs: Runs, name: str, value: float) -> Saying:
    """Between which two runs the output passes the value, where it does."""
    for (a, ya), (b, yb) in pairwise(runs.pairs()):
        if (ya - value) * (yb - value) <= 0.0:
            return say("study.so_far", below=ya, name=name, a=a, above=yb, b=b)
    return say("study.not_so_far")


class _Watch:
    """How far the output is from a value, over the parameter; raises `_SuspectError`.

    Parameters
    ----------
    bracket
        Where the search begins; ``bracket`` afterwards is the last one.
    """

    def __init__(self, runs: Runs, bracket: Bracket, value: float) -> None:
        self._runs, self._value, self.bracket = runs, value, bracket
        self._before = [bracket]

    def __call__(self, x: float) -> float:
        off = _number(self._runs.output_at(x)) - self._value
        self.bracket = _narrowed(self._runs, self.bracket, self._value)
        apart, width = _apart(self._runs, self.bracket), self.bracket[1] - self.bracket[0]
        if off and any(
            width <= _SHRUNK * (b - a) and apart >= _APART * _apart(self._runs, (a, b))
            for a, b in self._before
        ):
            raise _SuspectError
        self._before.append(self.bracket)
        return off


def _halved(runs: Runs, bracket: Bracket, value: float, narrow: float) -> Bracket:
    """The first half of a half ... whose outputs have come together.

    Raises
    ------
    _JumpError
        They have not where the bracket is as narrow as asked.
    """
    first = _apart(runs, bracket)
    while bracket[1] - bracket[0] > narrow:
        _number(runs.output_at(0.5 * (bracket[0] + bracket[1])))
        bracket = _narrowed(runs, bracket, value)
        if _apart(runs, bracket) < _APART * first:
            return bracket
    raise _JumpError(bracket)


def _narrowed(runs: Runs, bracket: Bracket, value: float) -> Bracket:
    """The first two neighbours within a bracket that lie on either side of the value."""
    inside = [(x, y) for x, y in runs.pairs() if bracket[0] <= x <= bracket[1]]
    return next(
        (a, b) for (a, ya), (b, yb) in pairwise(inside) if (ya - value) * (yb - value) <= 0.0
    )


def _apart(runs: Runs, bracket: Bracket) -> float:
    """How far the outputs at both ends lie apart."""
    a, b = (_number(runs.output_at(x)) for x in bracket)
    return abs(b - a)


def _bracket(runs: Runs, low: float, high: float, value: float) -> Bracket | None:
    """Two neighbours on either side of the value; None where there are none."""
    for shares in PLACES:
        for share in shares:
            runs.output_at(low + share * (high - low))
        for (a, ya), (b, yb) in pairwise(runs.pairs()):
            if (ya - value) * (yb - value) <= 0.0 and low <= a and b <= high:
                return a, b
    return None


def _jump(runs: Runs, name: str, output: str, value: float, bracket: Bracket) -> dict[str, Any]:
    """The output passes the value without having it, as where another mechanism takes over."""
    (a, b), (ya, yb) = bracket, (_number(runs.output_at(x)) for x in bracket)
    known = {"output": output, "value": value, "name": name}
    said = say("study.jumps", **known, below=ya, a=a, above=yb, b=b)
    return {**_told("jump", said), "jump_at": [a, b]}


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
    asked = {"name": name, "low": low, "high": high, "output": output, "value": value}
    if known:
        x, y = min(known, key=lambda pair: abs(pair[1] - value))
        return _told("none", say("study.nearest", **asked, n=len(runs.rows), found=y, at=x))
    return _told("none", say("study.no_run", **asked, why=said_end(runs.rows[0]["reason"])))


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
    known = dict(zip("ab", asked.task.names, strict=True))
    known |= {"output": target["output"], "value": target["value"]}
    if line:
        found = _told("finished", say("study.line", **known))
    else:
        least, most = float(np.nanmin(z)), float(np.nanmax(z))
        found = _told("none", say("study.no_line", **known, low=least, high=most))
    del found["value"]
    found |= {"contour": line, "n_runs": len(frame)}
    if figures:
        from drystone.studies.figures import target_map

        with speaking(language_of(asked.task.model)):
            in_a_sentence(lambda: target_map(asked, (x, y, z), folder))
    write_record(grid, folder, found)
    frame.to_parquet(folder / RUNS)
    return found


def _crossings(x: Array, y: Array, z: Array, value: float) -> list[list[float]]:
    """Where the output has the value: at points of the map, and between neighbours along either
    parameter, by linear interpolation; in the order of the first parameter, then of the second."""
    off = z - value
    line = [[float(a), float(b)] for a, b in zip(x[off == 0.0], y[off == 0.0], strict=True)]
    rows, columns = off.shape
    pairs = [((i, k), (i, k + 1)) for i in range(rows) for k in range(columns - 1)]
    pairs += [((i, k), (i + 1, k)) for i in range(rows - 1) for k in range(columns)]
    for a, b in pairs:
        if min(off[a], off[b]) < 0.0 < max(off[a], off[b]):
            share = off[a] / (off[a] - off[b])
            line.append([float(p[a] + share * (p[b] - p[a])) for p in (x, y)])
    return sorted(line)
