"""What an engine has not is refused with the names of those that have it, from the registry."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

import drystone
from drystone.engines import BUILT_IN, able
from drystone.engines.refusal import others
from drystone.model.joint_law import Yielding

SOURCE = Path(drystone.__file__).parent


@pytest.mark.parametrize(
    ("can", "told"),
    [
        (lambda c: c.moves_supports, "take the equilibrium, the nscd or the distinct engine"),
        (lambda c: c.rollers, "take the equilibrium or the nscd engine"),
        (lambda c: Yielding.CLOSE in c.yielding, "take the equilibrium engine"),
        (lambda c: False, "no engine has them"),
    ],
)
def test_engines_that_can_are_named(can, told):
    assert others(can) == told


def test_every_engine_of_ours_says_what_it_can():
    assert able(lambda c: c.residual_limit is not None) == BUILT_IN


@pytest.mark.parametrize("place", ["engines/base.py", "analysis", "io/modelfile"])
def test_no_engine_is_named_above_or_below_the_registry(place):
    """Neither as a word in quotation marks nor in a sentence; the tables of a paper apart, and
    the word equilibrium, which has a meaning of its own."""
    top = SOURCE / place
    files = [top] if top.is_file() else sorted(top.rglob("*.py"))
    assert files
    for file in files:
        text = file.read_text(encoding="utf-8")
        assert not re.search(r'"(equilibrium|nscd|distinct|lmgc90)"', text), file
        assert not re.search(r"\b(nscd|lmgc90|(distinct|equilibrium) engine)\b", text), file
