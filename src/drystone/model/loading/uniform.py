"""``pattern = "uniform"``: the same sideways acceleration at every height, as codes define it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

from drystone.model.loading.mass import MassPattern


@dataclass(frozen=True, kw_only=True, eq=False)
class UniformPattern(MassPattern):
    """Sideways forces in proportion to mass, whatever its height (EN 1998-1, 4.3.3.4.2.2).

    Those of `MassPattern`, which may also lead upwards or down.
    """

    name: ClassVar[str] = "uniform"
    horizontal: ClassVar[bool] = True
