"""Broken models end in a sentence or in a curve: no traceback, no hang, no NaN, no warning.

``DRYSTONE_MUTATIONS`` says how many models are run with every engine; twice as many are read.
"""

from __future__ import annotations

import os
import signal
import warnings
from collections.abc import Iterator
from contextlib import contextmanager

import mutations
import numpy as np
import pytest

from builders import stack
from drystone.analysis.driver import pushover
from drystone.engines.base import EngineError
from drystone.io.modelfile import read_model
from drystone.model.builders import ModelError

N_MODELS = int(os.environ.get("DRYSTONE_MUTATIONS", "60"))
ENGINES = ("equilibrium", "nscd", "distinct")
#: A model of a few blocks takes less than a second for 30 steps; a busy machine a few.
SECONDS = 60

pytestmark = [
    pytest.mark.slow,
    pytest.mark.skipif(not hasattr(signal, "SIGALRM"), reason="no time limit to be had"),
]


class Hangs(BaseException):
    """Not to be caught by what runs."""


@contextmanager
def limited(seconds: int) -> Iterator[None]:
    """Raise `Hangs` in what takes longer."""

    def stop(*_: object) -> None:
        raise Hangs(f"more than {seconds} s")

    before = signal.signal(signal.SIGALRM, stop)
    signal.alarm(seconds)
    try:
        yield
    finally:
        signal.alarm(0)
        signal.signal(signal.SIGALRM, before)


def read(seed, folder):
    """The model of a seed, or None where it was refused, in sentences of one line each."""
    path = folder / f"{seed}.json"
    path.write_text(mutations.model(seed))
    try:
        return read_model(path)
    except ModelError as error:
        assert error.problems
        assert all(p.startswith(f"{path}: ") and "\n" not in p for p in error.problems)
        return None


def faults(seeds, check):
    """Seeds for which a check raises, with what it raised."""
    found = {}
    for seed in seeds:
        try:
            with limited(SECONDS), warnings.catch_warnings():
                warnings.simplefilter("error")
                check(seed)
        except (Exception, Hangs) as error:
            place = error.__traceback__
            while place is not None and place.tb_next is not None:
                place = place.tb_next
            where = f"{place.tb_frame.f_code.co_filename}:{place.tb_lineno}" if place else ""
            found[seed] = f"{type(error).__name__}: {str(error)[:150]} ({where})"
    return found


def test_reading(tmp_path):
    assert faults(range(2 * N_MODELS), lambda seed: read(seed, tmp_path)) == {}


@pytest.mark.parametrize("engine", ENGINES)
def test_thirty_steps(tmp_path, engine):
    n_curves = 0
    sound = stack((0.4, 0.9))
    pushover(sound, engine=engine, max_steps=5)  # compiles, which no time limit is for

    def check(seed):
        nonlocal n_curves
        model = read(seed, tmp_path)
        if model is None:
            return
        try:
            curve = pushover(model, engine=engine, max_steps=30)
        except EngineError as error:
            assert str(error)
            return
        n_curves += 1
        for name in ("control_displacement", "load_multiplier", "residual", "penetration"):
            assert np.all(np.isfinite(curve.column(name))), name
        assert curve.status in ("finished", "stopped") and curve.reason

    assert faults(range(N_MODELS), check) == {}
    assert n_curves > 0.05 * N_MODELS  # some survive what was done to them
