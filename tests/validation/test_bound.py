"""No capacity lies above the associative multiplier, or its cause is told: random structures.

DRYSTONE_BOUNDS says how many of each dimension (default 4); DRYSTONE_SEED the first of them.  A
curve is followed to a tenth of the smallest block, in at most MOST_STEPS steps: peaks come before.
Run as a script it prints a line for every structure, and the cause of each that lies above:

    python tests/validation/test_bound.py plane 0 150
"""

from __future__ import annotations

import os
import sys
from pathlib import Path

import pytest

import drystone as ds
from drystone.engines.base import UnstableError
from drystone.limit import limits_beside
from drystone.limit.excess import exceeds
from drystone.model.model import Model
from random_solids import random_solids
from structures import structure

FIRST = int(os.environ.get("DRYSTONE_SEED", "0"))
SEEDS = range(FIRST, FIRST + int(os.environ.get("DRYSTONE_BOUNDS", "4")))
MADE = {"plane": structure, "space": random_solids}
MOST_STEPS = 400
CASES = Path(__file__).parents[1] / "cases"
#: What a sentence on a multiplier above the bound names.
CAUSES = (
    "what is left bears it",
    "because it is read off a motion",
    "because load is carried between",
    "because blocks have moved",
)

pytestmark = pytest.mark.slow


def followed(model: Model) -> ds.CapacityCurve:
    """The curve, with what the cause of an excess is read from."""
    return ds.pushover(
        model,
        keep_poses=True,
        keep_contacts=True,
        max_displacement=0.1 * model.assembly.smallest_extent,
        max_steps=MOST_STEPS,
    )


def above(made: str, seed: int) -> tuple[float, float, float, str | None] | None:
    """Associative multiplier, upper bound, capacity and what is told; None where it falls."""
    model = MADE[made](seed)
    beside = limits_beside(model)
    if beside.associative is None or beside.upper_bound is None:
        return None
    try:
        curve = followed(model)
    except UnstableError:
        return None
    capacity = curve.capacity.load_multiplier
    return beside.associative, beside.upper_bound, capacity, beside.warning(curve, model)


@pytest.mark.parametrize("made", MADE)
@pytest.mark.parametrize("seed", SEEDS)
def test_no_capacity_lies_above_the_bound_untold(made, seed):
    found = above(made, seed)
    if found is None:
        return
    associative, _, capacity, told = found
    assert exceeds(capacity, associative) == (told is not None)
    assert told is None or any(cause in told for cause in CAUSES), told


#: With steps of 6, 20, 60 and 200 s it lies 0.14, 0.012, 0.036 and 0.06 % above.
ABOVE_WITH_LONGER_STEPS = pytest.param(116, marks=pytest.mark.xfail(strict=True))


@pytest.mark.parametrize("seed", [61, 76, 81, 106, ABOVE_WITH_LONGER_STEPS, 141])
def test_what_a_motion_carries_against_the_mechanism_is_below_the_bound(seed):
    """They lie above by 4e-4 to 1.6e-2: excesses set more in motion than has to move."""
    *_, told = above("space", seed)
    assert told is not None and "because it is read off a motion" in told
    model = random_solids(seed)
    size = model.assembly.smallest_extent
    # Longer time steps need a smaller excess for the same motion.
    slower = ds.pushover(model, max_displacement=0.1 * size, max_steps=MOST_STEPS, time_step=6.0)
    assert not limits_beside(model).is_exceeded(slower)


def test_a_vault_with_near_joints_does_not_exceed_its_bound():
    """Of warped stones, many meet along an edge of a face: the bound had been 0.2099."""
    model = ds.read_model(CASES / "warped_vault.toml")
    beside = limits_beside(model)
    curve = followed(model)
    assert 0.23 < curve.capacity.load_multiplier < beside.associative
    assert beside.warning(curve, model) is None


def test_a_dome_whose_joints_run_through_tells_what_it_carries_across_corners():
    model = ds.read_model(CASES / "corbelled_dome.toml")
    beside = limits_beside(model)
    curve = ds.pushover(model, keep_poses=True, keep_contacts=True, max_displacement=0.03)
    peak = curve.capacity.load_multiplier
    assert beside.associative < peak < beside.upper_bound
    told = beside.warning(curve, model)
    assert "across a corner" in told and "with these contacts limit analysis gives" in told


def _main(made: str, first: int, last: int) -> None:
    """A line for every structure."""
    for seed in range(first, last):
        found = above(made, seed)
        if found is None:
            print(f"{made} {seed}: does not stand or has no multiplier")
            continue
        associative, bound, capacity, told = found
        print(
            f"{made} {seed}: {associative:.6f} {bound:.6f} {capacity:.6f} {told or ''}", flush=True
        )


if __name__ == "__main__":
    _main(sys.argv[1], int(sys.argv[2]), int(sys.argv[3]))
