"""A study under way: chunks of samples are given out, results are written in parts."""

from __future__ import annotations

import time
from collections import deque
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, Protocol

import numpy as np

from drystone.common.version import package_version
from drystone.common.workers import Call
from drystone.studies.sample import FAILED, Chunk, Outcome, begun_row
from drystone.studies.study import Study
from drystone.studies.tables import Parts

#: What a chunk is meant to take [s]: long beside what giving it out takes, short beside what is
#: lost with a process.
CHUNK_SECONDS = 2.0
MOST_IN_CHUNK = 2000
#: A part is written when as many samples wait, or when the last one is as long ago [s]; the longer
#: a study takes the longer it is, so that there are never many parts.
PART_SAMPLES, PART_SECONDS, PART_SHARE = 5000, 5.0, 0.01
#: Processes that a sample may end before it is left alone.
MOST_LOST = 2


class Workers(Protocol):
    """Who computes chunks: processes of this machine, or a cluster."""

    def wanted(self) -> int:
        """How many more calls can be taken now."""

    def begin(self, number: int, call: Call) -> None:
        """Take a call."""

    def next(self, timeout: float) -> tuple[int, str, Any] | None:
        """What came of a call, as `common.workers.Pool.next` tells."""

    def count(self) -> int:
        """How many there are."""

    def end(self) -> None:
        """No more is wanted."""


@dataclass(kw_only=True)
class Progress:
    """How far a study is."""

    total: int
    done: int = 0
    failed: int = 0
    before: int = 0  # of those done, by an earlier run
    seconds: float = 0.0  # since this run has begun

    @property
    def rate(self) -> float:
        """Samples in a second."""
        return (self.done - self.before) / self.seconds if self.seconds > 0.0 else 0.0

    @property
    def seconds_left(self) -> float | None:
        """None before it is known."""
        return (self.total - self.done) / self.rate if self.rate > 0.0 else None


@dataclass(kw_only=True)
class _Given:
    """Chunks that are out, and those to be given out again."""

    out: dict[int, list[int]] = field(default_factory=dict)
    again: deque[list[int]] = field(default_factory=deque)
    lost: dict[int, int] = field(default_factory=dict)  # times, by sample
    number: int = 0


def run(
    study: Study,
    folder: Path,
    workers: Workers,
    *,
    told: Callable[[Progress], None] | None = None,
) -> Progress:
    """Compute what is missing of a study, into parts; also what was reached when interrupted.

    Raises
    ------
    KeyboardInterrupt
        Was interrupted: what came until then is written.
    """
    parts = Parts(folder)
    done = parts.done(study.count)
    begun = time.perf_counter()
    already = int(done.sum())
    progress = Progress(total=study.count, done=already, before=already)
    waiting: list[Outcome] = []
    written = begun
    given = _Given()
    missing = iter(np.flatnonzero(~done).tolist())
    rate = _Rate()
    try:
        while True:
            _give_out(study, workers, given, missing, rate, progress)
            if not given.out:
                break
            came = workers.next(0.5)
            now = time.perf_counter()
            progress.seconds = now - begun
            if came is not None:
                outcomes = _taken(study, given, came, rate)
                waiting += outcomes
                progress.done += len(outcomes)
                progress.failed += sum(o.row["status"] == FAILED for o in outcomes)
            enough = max(PART_SECONDS, PART_SHARE * (now - begun))
            if len(waiting) >= PART_SAMPLES or (waiting and now - written > enough):
                parts.write(waiting)
                waiting, written = [], now
            if told is not None:
                told(progress)
    finally:
        parts.write(waiting)
    return progress


class _Rate:
    """How many samples make a chunk, by how long they have taken."""

    def __init__(self) -> None:
        self._each: float | None = None  # s

    def learn(self, n: int, seconds: float) -> None:
        """Samples of a chunk have taken so long."""
        each = seconds / n
        self._each = each if self._each is None else 0.7 * self._each + 0.3 * each

    @property
    def known(self) -> bool:
        """Whether a chunk has been computed."""
        return self._each is not None

    def size(self, left: int, workers: int) -> int:
        """Of the next chunk; towards the end they are shorter, so that none waits for another."""
        if self._each is None:
            return 1
        most = CHUNK_SECONDS / max(self._each, 1e-9)
        return int(max(1, min(most, MOST_IN_CHUNK, left / (2 * max(workers, 1)))))


def _give_out(
    study: Study,
    workers: Workers,
    given: _Given,
    missing: Iterator[int],
    rate: _Rate,
    progress: Progress,
) -> None:
    """Give chunks to all who wait; only one before its time is known, which compiles for all."""
    free = workers.wanted()
    if not rate.known:
        free = min(free, 1 - len(given.out))
    for _ in range(free):
        out = sum(map(len, given.out.values()))
        left = progress.total - progress.done - out
        if given.again:
            chunk = given.again.popleft()
        else:
            size = rate.size(left, workers.count())
            chunk = [sample for _, sample in zip(range(size), missing, strict=False)]
        if not chunk:
            return
        given.number += 1
        given.out[given.number] = chunk
        values = [study.values_at(sample) for sample in chunk]
        workers.begin(
            given.number, ("drystone.studies.sample:compute_chunk", (study.task, chunk, values))
        )


def _taken(
    study: Study, given: _Given, came: tuple[int, str, Any], rate: _Rate
) -> tuple[Outcome, ...]:
    """What came of a chunk; one that was lost with its process is given out again, one by one."""
    number, how, value = came
    chunk = given.out.pop(number)
    if how == "done":
        assert isinstance(value, Chunk)
        rate.learn(len(chunk), value.seconds)
        return value.outcomes
    if how == "raised":
        return tuple(_without_result(study, sample, str(value)) for sample in chunk)
    outcomes = []
    for sample in chunk:
        given.lost[sample] = given.lost.get(sample, 0) + (len(chunk) == 1)
        if given.lost[sample] >= MOST_LOST:
            outcomes.append(_without_result(study, sample, str(value)))
        else:
            given.again.append([sample])
    return tuple(outcomes)


def _without_result(study: Study, sample: int, reason: str) -> Outcome:
    """The row of a sample whose process could not tell."""
    row = begun_row(study.task, sample, study.values_at(sample))
    row |= {"status": FAILED, "reason": reason, "seconds": None, "version": package_version()}
    return Outcome(row=row)
