"""Files changed at random, a seeded part of what ``tests/fuzz.py`` looks at."""

from __future__ import annotations

import pytest

from fuzzing import judging, readers, workers
from fuzzing.readers import Case, cases

SEED = 1


def finds(count: int, seed: int) -> list[str]:
    """What of so many files became of them that should not."""
    return [
        f"{ended.case.reader} {ended.case.seed} {ended.case.number}: {ended.kind}: {ended.what}"
        for ended in workers.judged(cases(readers.available(), seed, count), seconds=60.0)
        if ended.kind not in judging.GOOD
    ]


def test_sixty():
    assert finds(60, SEED) == []


@pytest.mark.slow
def test_a_thousand():
    assert finds(1000, SEED) == []


def test_a_case_is_the_same_every_time():
    for name in readers.available():
        case = Case(name, 5, 7)
        assert case.files() == case.files()


class TestFaultsAreFound:
    """What should not become of a file is told, and the next one is looked at."""

    @pytest.fixture
    def told(self, monkeypatch):
        def told(look, seconds=20.0):
            reader = readers.Reader(file="a", made=lambda draw: b"", look=look)
            monkeypatch.setitem(readers.READERS, "spectrum", reader)
            both = cases(["spectrum"], 1, 2)
            ended = list(workers.judged(both, processes=1, seconds=seconds))
            assert len(ended) == 2  # the next one, too
            return ended[0].kind

        return told

    def test_an_error_that_is_not_for_users(self, told):
        assert told(lambda path, draw: {}["a"]) == judging.TRACEBACK

    def test_no_end(self, told):
        def look(path, draw):
            while True:
                pass

        assert told(look, seconds=0.3) == workers.HANG

    def test_a_process_that_dies(self, told):
        import faulthandler
        import os
        import signal

        def die(path, draw):
            faulthandler.disable()  # this one is meant: no page of its calls
            os.kill(os.getpid(), signal.SIGSEGV)

        assert told(die) == workers.KILLED

    def test_too_much_memory(self, told):
        assert told(lambda path, draw: bytearray(2 * workers.MEMORY)) == judging.TRACEBACK

    def test_a_warning(self, told):
        import numpy as np

        assert told(lambda path, draw: np.float64(1e308) * 10.0) == judging.WARNING

    def test_no_number(self, told):
        def look(path, draw):
            judging.finite("x", [1.0, float("nan")])

        assert told(look) == judging.NOT_FINITE

    @pytest.mark.parametrize("said", ["", "ab\x1b[2Jcdefghijkl", "x" * 3000])
    def test_an_error_that_nobody_can_read(self, told, said):
        assert told(lambda path, draw: judging.clear([said])) == judging.UNCLEAR
