"""The first run on a machine: a notice that kernels are compiled, and a second process that helps.

The compiler does one kernel at a time.  The analysis compiles what it needs when it needs it; the
second process compiles the same kernels from the other end, and what it has put into the cache on
disk the analysis finds there.  They meet in the middle.
"""

from __future__ import annotations

import os
import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from typing import Any, NamedTuple

from drystone.cli.outcome import tell

#: Engines that are interpreted fast enough to be rehearsed, and that start no other program.
REHEARSED = ("equilibrium", "nscd")


class Rehearsal(NamedTuple):
    """A run that needs the kernels of most others of its dimension."""

    forecast: str  # what is said of how long compiling takes
    extruded: bool  # whether the wall is made of solids
    options: dict[str, Any]


#: By dimension.  In the plane steps that joints slide in are solved by other kernels than the first
#: ones: these are reached after some fifteen steps of 0.15 of a block.  In space the first step
#: needs them all.
REHEARSALS = {
    2: Rehearsal("half a minute or so", False, {"max_steps": 20, "displacement_step": 0.03}),
    3: Rehearsal("a minute or so", True, {"max_steps": 4}),
}


@contextmanager
def compiling(engine: str, dimension: int, *, quiet: bool) -> Iterator[None]:
    """Say on standard error that kernels are compiled, once, and how long it took.

    ``engine`` is the one that is going to run on a structure of so many dimensions; a process that
    helps is started for some.
    """
    from drystone.common import kernel_cache
    from drystone.common.compilation import Compilation

    helpers: list[subprocess.Popen[bytes]] = []
    told = False

    def begun() -> None:
        nonlocal told
        if told:
            return
        told = True
        if not quiet:
            forecast = REHEARSALS[dimension].forecast
            tell([f"compiling, once on this machine: {forecast} where nothing else runs"])
        if engine in REHEARSED and _processors() > 1:
            with suppress(OSError):  # it is only a help
                helpers.append(_helper(engine, dimension))

    try:
        if kernel_cache.is_empty():  # known before the first kernel is asked for
            begun()
        with Compilation(begun) as compilation:
            yield
    finally:
        for helper in helpers:
            helper.terminate()
            helper.wait()
    if compilation.n_kernels and not quiet:
        tell([f"compiled in {compilation.seconds:.1f} s"])


def _helper(engine: str, dimension: int) -> subprocess.Popen[bytes]:
    return subprocess.Popen(
        [sys.executable, "-m", __name__, engine, str(dimension)],
        stdin=subprocess.DEVNULL,
        stdout=subprocess.DEVNULL,
        stderr=subprocess.DEVNULL,
    )


def _processors() -> int:
    """Processors that this process may use."""
    try:
        return len(os.sched_getaffinity(0))
    except AttributeError:  # not on every system
        return os.cpu_count() or 1


def compile_backwards(engine: str, dimension: int) -> None:
    """Compile what a run needs, what is needed last first."""
    from drystone.common.compilation import Compilation, rehearse

    with Compilation():
        for kernel, types in reversed(rehearse(lambda: _small_run(engine, dimension))):
            kernel.compile(types)


def _small_run(engine: str, dimension: int) -> None:
    """A run as `drystone run` makes it, of five blocks and a few steps."""
    import drystone as ds
    from drystone.limit import limits_beside
    from drystone.model.builders import extruded

    model = ds.make_model(
        ds.wall(unit=(0.4, 0.2), courses=("11", "h1h"), base=True, unit_weight=2e4),
        joint=ds.JointLaw(friction_coefficient=0.6, normal_stiffness=1e9, shear_stiffness=1e9),
        thickness=0.5,
        load_direction=(1.0, 0.0),
    )
    rehearsal = REHEARSALS[dimension]
    if rehearsal.extruded:
        model = extruded(model)
    limits_beside(model)
    ds.pushover(model, engine=engine, progress=False, **rehearsal.options)


if __name__ == "__main__":
    compile_backwards(sys.argv[1], int(sys.argv[2]))
