"""No load but the dead load: of analyses in which supports move."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

from drystone.common.language import say
from drystone.model.assembly import Assembly
from drystone.model.loading.base import NO_MASSES, Directed, Masses
from drystone.model.loading.dead_forces import DeadForces


@dataclass(frozen=True, kw_only=True, eq=False)
class NoPattern(Directed):
    """Nothing; its direction is that from which pictures are seen."""

    name: ClassVar[str] = "none"

    def forces(self, assembly: Assembly, masses: Masses = NO_MASSES) -> DeadForces:
        """See `LoadPattern`."""
        return DeadForces.none(assembly)

    @property
    def words(self) -> str:
        """See `LoadPattern`."""
        return say("load.none")
