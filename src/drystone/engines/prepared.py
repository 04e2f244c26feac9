"""The data that our engines derive from a problem once, when they start; states refer to it."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Any, Self

import numpy as np

from drystone.common.arrays import Array, IntArray
from drystone.common.codec import Derived
from drystone.common.tolerances import TINY
from drystone.contact.detection import Detector
from drystone.engines.base import Engine, EngineError, Problem
from drystone.engines.refusal import refuse
from drystone.law.bonds import brittle, margins
from drystone.law.certificate import JudgedContacts
from drystone.law.columns import DILATANCY_END
from drystone.law.strengths import Strengths
from drystone.law.table import law_table
from drystone.model.assembly import Assembly
from drystone.model.ties import Bars


@dataclass(frozen=True, kw_only=True, eq=False)
class Prepared(Derived):
    """A problem with the data derived from it."""

    problem: Problem
    detector: Detector
    laws: Array  # table of `law.table`
    bars: Bars

    @classmethod
    def of(cls, problem: Problem, engine: Engine[Any], *, shear: bool = True) -> Self:
        """Prepare a problem; raises `EngineError` if the engine cannot treat it.

        Without ``shear``, joints need no stiffness in shear.
        """
        refuse(problem, engine)
        assembly = problem.assembly
        try:
            laws = law_table(assembly, shear=shear)
        except ValueError as error:
            raise EngineError(f"{error}: the {engine.name} engine cannot do without") from None
        moving = problem.settlement.rows(assembly) if problem.settlement else None
        return cls(
            problem=problem,
            detector=Detector(assembly),
            laws=laws,
            bars=Bars.of(assembly, problem.ties, moving),
        )

    @property
    def assembly(self) -> Assembly:
        """The assembly of the problem."""
        return self.problem.assembly

    @cached_property
    def extent(self) -> Array:
        """Largest distance of a vertex from the centroid of each block [m], (n,), never zero."""
        return np.maximum(self.detector.extent, TINY)

    @cached_property
    def strengths(self) -> Strengths:
        """The strengths of joints that soften or crush."""
        return Strengths(self.assembly)

    @cached_property
    def brittle(self) -> bool:
        """Whether bonds break."""
        return brittle(self.laws) or bool(self.strengths.tears.any())

    def bond_margins(self, judged: JudgedContacts, law: IntArray) -> Array:
        """Margins of contacts with joint laws ``law``, (n_contacts,); see `law.bonds.margins`."""
        return margins(judged, self.strengths.tears[law])

    @cached_property
    def movable_weight(self) -> Array:
        """Weight of each block [N], (n,), by which forces on it are measured; infinite for
        supports."""
        return np.where(self.assembly.fixed, np.inf, self.assembly.weight)

    @cached_property
    def gives_way(self) -> bool:
        """Whether steps end where a bond or a tie yields or breaks, or dilatancy ends."""
        return self.brittle or self.bars.give_way or bool(np.isfinite(self.dilates_until).any())

    @cached_property
    def dilates_until(self) -> Array:
        """Slip [m] at which joints of each law stop dilating, (n_laws,); infinite if the model
        gives none, because the default end is never reached."""
        laws = self.assembly.laws
        given = [law.dilatancy_angle > 0.0 and law.dilatancy_end < np.inf for law in laws]
        return np.where(given, self.laws[:, DILATANCY_END], np.inf)
