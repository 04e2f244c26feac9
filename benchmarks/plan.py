"""What many curves cost on many machines: a plan from what is measured on this one.

    python benchmarks/plan.py [--seconds 0.3] [--curves 1000000] [--workers 100] [--chunks 2000]

Measured: processor time of the process of `drystone study` and of Dask's scheduler for a chunk,
with two workers of Dask and a function in place of curves.  Simulated: so many workers, each with
one chunk under way and one that waits, behind a process and a scheduler that handle one chunk at a
time.
"""

from __future__ import annotations

import argparse
import heapq
import math
import os
import re
import resource
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import numpy as np
from harness import machine

STUB = "def stub(x):\n    return {'peak_multiplier': 2.0 * x['a']}\n"
#: Samples of a chunk of the measurement, as many as there are curves of wall 1 in two seconds.
IN_CHUNK = 7
STUDY = """
function = "stub_of_benchmark:stub"
design = "random"
samples = {n}
[[parameter]]
path = "a"
range = [0.0, 1.0]
"""
#: Share of the workers' time that is computing, below which they wait too often.
ENOUGH = 0.9
#: Chunks that are simulated at least for each worker, beyond which the share does not move.
LONG = 50
SCHEDULER, DRIVER = "scheduler", "driver"


@contextmanager
def cluster(folder: Path) -> Iterator[tuple[str, subprocess.Popen[bytes]]]:
    """Address and process of a scheduler with two workers of one thread."""
    log = folder / "scheduler.log"

    def started(*arguments: str) -> subprocess.Popen[bytes]:
        with (folder / f"{arguments[0]}.log").open("ab") as file:
            return subprocess.Popen(
                [sys.executable, "-m", f"distributed.cli.dask_{arguments[0]}", *arguments[1:],
                 "--no-dashboard"],
                stdout=file, stderr=file, cwd=folder,
            )  # fmt: skip

    scheduler = started("scheduler", "--host", "127.0.0.1", "--port", "0")
    processes = [scheduler]
    try:
        found = None
        while found is None:
            time.sleep(0.1)
            found = re.search(r"tcp://127\.0\.0\.1:\d+", log.read_text() if log.exists() else "")
            if scheduler.poll() is not None:
                raise SystemExit(f"the scheduler has ended: {log.read_text()}")
        processes += [started("worker", found[0], "--nthreads", "1", "--no-nanny") for _ in "ab"]
        yield found[0], scheduler
    finally:
        for process in processes:
            process.kill()
            process.wait()


def processor_time(process: int) -> float:
    """Of a process that runs [s], by Linux."""
    fields = Path(f"/proc/{process}/stat").read_text().rsplit(")", 1)[1].split()
    return sum(map(int, fields[11:13])) / os.sysconf("SC_CLK_TCK")


def for_a_chunk(chunks: int) -> tuple[float, float]:
    """Processor time for a chunk [s]: of the process of the study, and of the scheduler."""
    from drystone.studies import running
    from drystone.studies.conduct import conduct
    from drystone.studies.read import read_study

    running.MOST_IN_CHUNK = IN_CHUNK
    with tempfile.TemporaryDirectory() as place:
        folder = Path(place)
        (folder / "stub_of_benchmark.py").write_text(STUB)
        file = folder / "study.toml"
        file.write_text(STUDY.format(n=chunks * IN_CHUNK))
        with cluster(folder) as (address, scheduler):
            begun = processor_time(scheduler.pid)
            used = resource.getrusage(resource.RUSAGE_SELF)
            conduct(read_study(file), folder / "out", scheduler=address)
            after = resource.getrusage(resource.RUSAGE_SELF)
            theirs = processor_time(scheduler.pid) - begun
    ours = after.ru_utime + after.ru_stime - used.ru_utime - used.ru_stime
    return ours / chunks, theirs / chunks


def share_of_computing(workers: int, chunk: float, driver: float, scheduler: float) -> float:
    """Share of the workers' time that is computing, by a simulation of chunks that come and go.

    A worker ends a chunk: the scheduler and then the process of the study handle it, one at a time,
    in the order of arrival, and so the next one reaches the worker.  Meanwhile it computes the one
    that waited.  Chunks take a time of their mean times 0.5 to 1.5.

    Parameters
    ----------
    chunk
        Mean time of a chunk [s].
    driver, scheduler
        Time that they take for one [s], half of it as it goes out and half as it comes back.
    """
    chance = np.random.default_rng(1)
    stages = ((SCHEDULER, 0.5 * scheduler), (DRIVER, driver), (SCHEDULER, 0.5 * scheduler))
    free_at = {SCHEDULER: 0.0, DRIVER: 0.0}
    at_hand = [1] * workers  # chunks that wait at each worker
    idle_since: list[float | None] = [None] * workers
    events: list[tuple[float, int, int]] = []  # time, stage that a chunk comes to, worker
    idle, ended, now = 0.0, 0, 0.0

    def begin(worker: int) -> None:
        heapq.heappush(events, (now + chunk * chance.uniform(0.5, 1.5), 0, worker))

    for worker in range(workers):
        begin(worker)
    while ended < LONG * workers:
        now, stage, worker = heapq.heappop(events)
        if stage == 0:  # it has computed one, and takes the one that waits
            ended += 1
            if at_hand[worker]:
                at_hand[worker] -= 1
                begin(worker)
            else:
                idle_since[worker] = now
        if stage < len(stages):
            server, takes = stages[stage]
            free_at[server] = max(now, free_at[server]) + takes
            heapq.heappush(events, (free_at[server], stage + 1, worker))
        elif (since := idle_since[worker]) is not None:
            idle, idle_since[worker] = idle + now - since, None
            begin(worker)
        else:
            at_hand[worker] += 1
    idle += sum(now - since for since in idle_since if since is not None)
    return 1.0 - idle / (workers * now)


def most_workers(chunk: float, driver: float, scheduler: float) -> int:
    """Workers up to which computing takes `ENOUGH` of their time, to 2 %."""
    low, high = 1, 2
    while share_of_computing(high, chunk, driver, scheduler) >= ENOUGH:
        low, high = high, 2 * high
    while high > math.ceil(1.02 * low):
        middle = (low + high) // 2
        if share_of_computing(middle, chunk, driver, scheduler) >= ENOUGH:
            low = middle
        else:
            high = middle
    return low


def main() -> None:
    """Print a table."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--seconds", type=float, default=0.3, help="of a curve, on one processor")
    parser.add_argument("--curves", type=int, default=1_000_000)
    parser.add_argument("--workers", type=int, default=100)
    parser.add_argument("--chunks", type=int, default=2000)
    asked = parser.parse_args()
    from drystone.studies.running import CHUNK_SECONDS

    driver, scheduler = for_a_chunk(asked.chunks)
    each = max(1, int(CHUNK_SECONDS / asked.seconds))
    chunk = each * asked.seconds
    share = share_of_computing(asked.workers, chunk, driver, scheduler)
    rate = share * asked.workers / chunk
    for name, value in machine().items():
        print(f"{name}: {value}")
    print("| what | found |\n|---|---|")
    print(f"| process of the study, a chunk [ms] | {1e3 * driver:.2f} |")
    print(f"| scheduler, a chunk [ms] | {1e3 * scheduler:.2f} |")
    print(f"| a chunk | {each} curves, {chunk:.2f} s |")
    print(f"| {asked.curves:,} curves on {asked.workers} workers [minutes] | "
          f"{asked.curves / each / rate / 60.0:.1f} |")  # fmt: skip
    print(f"| share of the workers' time that is computing | {share:.3f} |")
    print(f"| chunks a second | {rate:.0f} |")
    print(
        f"| process of the study, scheduler: busy | {rate * driver:.2f}, {rate * scheduler:.2f} |"
    )
    for seconds in (CHUNK_SECONDS, 10.0 * CHUNK_SECONDS):
        own = max(1, int(seconds / asked.seconds)) * asked.seconds
        print(f"| workers that compute {ENOUGH:.0%} of their time, chunks of {own:.1f} s | "
              f"{most_workers(own, driver, scheduler)} |")  # fmt: skip


if __name__ == "__main__":
    main()
