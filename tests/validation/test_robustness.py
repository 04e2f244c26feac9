"""Random structures of every kind by `equilibrium`: a true end, points in balance, no exception.

DRYSTONE_ROBUST says how many of each kind (default 1); DRYSTONE_SEED the first seed.  Only small
structures are taken, for time; `benchmarks/robustness.py` runs as many as wanted, of any size.
Marked ``gate``: `.ci/run` always takes them into the part that must not fail.  They take a
minute of the processor, once kernels are compiled.
"""

from __future__ import annotations

import os
from itertools import count, islice

import pytest

import drystone as ds
from drystone.limit import stands
from random_kinds import KINDS
from true_ends import balance_of, unbalanced, why_no_end

FIRST = int(os.environ.get("DRYSTONE_SEED", "0"))
MANY = int(os.environ.get("DRYSTONE_ROBUST", "1"))
#: Blocks of a small structure: a curve takes a second or two.
MOST_BLOCKS = 50
#: Steps of a curve, by dimension: one of space costs ten of the plane.
MOST_STEPS = {2: 4000, 3: 1500}
#: What ends after long falls: one leg falls while the control point's stands; stones slide off
#: each other's rims.  The last digits decide how long that takes: the vault, 900 to 2700 steps.
LONG = [("corner", 0), ("vault", 2)]
LONG_STEPS = 5000

pytestmark = pytest.mark.slow


def small(kind: str, k: int) -> tuple[int, ds.Model]:
    """The small structure number k of a kind that stands, from the first seed on, and its seed."""
    made = ((seed, KINDS[kind](seed)) for seed in count(FIRST) if (kind, seed) not in LONG)
    fit = ((s, m) for s, m in made if m.assembly.n_blocks <= MOST_BLOCKS and stands(m.assembly))
    return next(islice(fit, k, None))


def what_is_wrong(model: ds.Model, steps: int | None = None) -> str:
    """With the curve of a model; nothing where it ends truly and rests in balance, as far as
    rounding lets it: `true_ends.balance_of` derives the bound."""
    steps, most = steps or MOST_STEPS[model.assembly.dimension], balance_of(model)
    curve = ds.pushover(model, engine="equilibrium", progress=False, max_steps=steps)
    left = {point.step: point.residual for point in unbalanced(curve, most)}
    return why_no_end(curve) or (f"residuals above {most:.1e} by step: {left}" if left else "")


@pytest.mark.gate
@pytest.mark.parametrize("k", range(MANY))
@pytest.mark.parametrize("kind", KINDS)
def test_a_curve_ends_truly_and_rests_in_balance(kind, k):
    seed, model = small(kind, k)
    wrong = what_is_wrong(model)
    assert not wrong, f"{kind} {seed}: {wrong}"


@pytest.mark.parametrize(("kind", "seed"), LONG)
def test_a_long_curve_does_so_too(kind, seed):
    wrong = what_is_wrong(KINDS[kind](seed), LONG_STEPS)
    assert not wrong, wrong
