"""What no structure does, whatever the engine: an analysis that shows it ends, and says so."""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np

from drystone.common import tolerances
from drystone.common.language import say
from drystone.contact.forces import ContactForces
from drystone.engines.base import EngineError, StepReport
from drystone.engines.frame import Frame
from drystone.model.model import Model

#: Load over the weight of the blocks it acts on from which on it is asked whether it locks the
#: structure.  Friction up to 1 and blocks up to four times as wide as high carry less; a linear
#: program tells of the rest.
PLAUSIBLE_LOAD = 5.0

LOCKED = say("end.locked")


class Plausibility:
    """Judges the points of one analysis before they become part of its curve."""

    def __init__(self, model: Model) -> None:
        self.model = model
        self.size = Frame.of(model.assembly).size
        self.deepest = model.analysis.max_penetration * self.size  # m
        self._plausible = _plausible_multiplier(model)
        self._asked = False  # whether the load locks the structure

    def falls_through(
        self, report: StepReport, contacts: Callable[[], ContactForces]
    ) -> str | None:
        """How the structure collapses in motion where a joint is crushed to nothing, or None.

        A block moves without end through a joint that softens as it is crushed: no stone stands
        behind its mortar in the model.
        """
        if not (report.dynamic and report.penetration > self._allowed(report)):
            return None
        found = contacts()
        a, b = _deepest(found)
        assembly = self.model.assembly
        law = assembly.laws[int(assembly.law_index(np.array([a]), np.array([b]))[0])]
        if law.compressive_fracture_energy is None:
            return None
        return say("end.crushed", a=assembly.ids[a], b=assembly.ids[b])

    def _allowed(self, report: StepReport) -> float:
        """Penetration [m] up to which two blocks may press each other.

        An impact presses joints for an instant, the more the softer they are.
        """
        moving = tolerances.PASSED_THROUGH * self.size if report.dynamic else self.deepest
        return max(moving, self.deepest)

    def check(
        self, report: StepReport, multiplier: float, contacts: Callable[[], ContactForces]
    ) -> None:
        """Raise `EngineError` for a point that no structure reaches.

        Parameters
        ----------
        multiplier
            Of the load, at the point.
        contacts
            Gives the contact points there; asked where a sentence needs them.
        """
        if abs(multiplier) > self._plausible and not self._asked:
            self._asked = True
            from drystone.limit import is_locked  # takes long to import

            if is_locked(self.model):
                raise EngineError(LOCKED)
        if report.penetration > self._allowed(report):
            raise EngineError(self._crushed(report.penetration, contacts()))

    def _crushed(self, penetration: float, contacts: ContactForces) -> str:
        share = penetration / self.size
        a, b = (self.model.assembly.ids[row] for row in _deepest(contacts))
        most = 100.0 * self.model.analysis.max_penetration
        return say("end.pressed", a=a, b=b, depth=penetration, percent=100.0 * share, most=most)


def _plausible_multiplier(model: Model) -> float:
    """Multiplier at which the load is `PLAUSIBLE_LOAD`; none where supports move in its place."""
    if model.settlement is not None:
        return math.inf
    loaded = model.acting.pattern.wrenches(model.assembly).any(axis=1)
    weight = model.assembly.weight[loaded].sum()
    return PLAUSIBLE_LOAD * float(weight) / model.load_force


def _deepest(contacts: ContactForces) -> tuple[int, int]:
    """Rows of the two blocks that overlap most."""
    deepest = int(np.argmin(contacts.gap))
    return int(contacts.block_a[deepest]), int(contacts.block_b[deepest])
