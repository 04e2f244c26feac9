"""Where steps of structures whose bonds break end, with a solver of margins alone."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np
import pytest

from drystone.common.tolerances import ENDS_FOR_BOND
from drystone.engines.base import StepReport
from drystone.engines.bonds import TOO_WEAK, BondSteps


@dataclass(frozen=True)
class Margins:
    """What `BondSteps` reads of a state without ties."""

    margin: np.ndarray
    due: np.ndarray = field(default_factory=lambda: np.zeros(0, np.int64))
    ties: Any = None


def steps(margin_after):
    """Steps whose bonds have margins that follow from the share of the increment."""

    def solve(state, share):
        return replace(state, margin=margin_after(share)), StepReport(converged=True)

    def broken(state, due):
        raise AssertionError(f"bonds {due} break, which are not at their strength")

    return BondSteps(
        solve=solve, broken=broken, laws=np.zeros((1, 20)), weight=np.ones(1), near=ENDS_FOR_BOND
    )


@pytest.mark.parametrize("strongest", [0.3, 0.9])
def test_a_step_ends_where_the_first_bond_is_at_its_strength(strongest):
    begin = Margins(np.array([0.3, strongest]))
    engine = steps(lambda share: begin.margin - share)
    new, report = engine._towards(begin, 1.0)
    assert report.converged and report.reached == pytest.approx(0.3, abs=ENDS_FOR_BOND)
    assert 0 in new.due and (1 in new.due) == (strongest == 0.3)


def test_a_step_that_leads_far_away_however_short_fails_and_breaks_no_bond():
    """The bond that exceeds its strength is not the one nearest to it where the step starts.  These
    broke one after the other, and then the step went on for ever."""
    begin = Margins(np.array([0.3, 0.9]))
    engine = steps(lambda share: np.array([0.3, -0.1]) if share else begin.margin)
    new, report = engine.advance(begin)
    assert new is begin and not report.converged
    assert report.reason == TOO_WEAK
