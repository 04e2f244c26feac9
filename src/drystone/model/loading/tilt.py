"""``pattern = "tilt"``: gravity itself turned, as on a tilting table.

On a table tilted by the angle a, as seen from the table, gravity has g cos a against the table's
upright and g sin a along the direction in which it falls.  With the multiplier l = tan a that is
(W + l F) / sqrt(1 + l^2), W being the weight and F as large, along the direction.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

from drystone.model.loading.mass import MassPattern


@dataclass(frozen=True, kw_only=True, eq=False)
class TiltPattern(MassPattern):
    """Gravity turned towards a horizontal direction; the multiplier is the tangent of the angle."""

    name: ClassVar[str] = "tilt"
    turns_gravity: ClassVar[bool] = True
    horizontal: ClassVar[bool] = True
