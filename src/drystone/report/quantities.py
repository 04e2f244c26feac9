"""What stands on the axes of a curve, for people: a load's multiplier, or a support's reaction."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from drystone.common.arrays import Array
from drystone.common.language import number
from drystone.results.curve import CapacityCurve, CurvePoint

#: Control displacements below this [m] are written in millimetres.
MILLIMETRES_BELOW = 0.05


@dataclass(frozen=True, kw_only=True)
class Quantities:
    """Names and units of both axes."""

    motion: str  # of the abscissa
    motion_unit: str
    per_unit: float  # of the abscissa, over that of the results
    force: str  # of the ordinate
    force_unit: str  # "" of a multiplier
    column: str  # of `CurvePoint`

    @classmethod
    def of(cls, curve: CapacityCurve) -> Quantities:
        """Those of a curve."""
        if not curve.moves_supports:
            return LOAD
        return ROTATION if curve.motion_unit == "rad" else SETTLEMENT

    @property
    def moves_supports(self) -> bool:
        """Whether supports move, in place of a load."""
        return bool(self.force_unit)

    def x(self, curve: CapacityCurve) -> Array:
        """Abscissae of all points, (n_points,) [motion_unit]."""
        return self.per_unit * curve.control_displacement

    def y(self, curve: CapacityCurve) -> Array:
        """Ordinates of all points, (n_points,) [force_unit]."""
        return curve.column(self.column)

    def motion_text(self, value: float) -> str:
        """An abscissa as results have it [m, rad], with its unit."""
        if self is ROTATION:
            return f"{number(self.per_unit * value)}°"
        return length_text(value)

    def force_text(self, point: CurvePoint) -> str:
        """The ordinate of a point with its unit."""
        value = float(getattr(point, self.column))
        if not self.moves_supports:
            return number(value, ".3f")
        four = number(float(f"{value:.4g}"), ".10g")  # digits, without an exponent
        return f"{four} {self.force_unit}"


def length_text(metres: float) -> str:
    """A length in metres, or in millimetres where it is small."""
    if metres == 0.0:
        return "0 m"
    if abs(metres) >= MILLIMETRES_BELOW:
        return f"{number(metres, '.3f')} m"
    return f"{number(metres * 1e3, '.2f')} mm"


def state_text(curve: CapacityCurve, point: CurvePoint) -> str:
    """Where a point is on its curve, as a title of pictures."""
    if not curve.moves_supports:
        displacement = f"{point.control_displacement:.4g} m"
        return f"$δ_c$ = {displacement}, $λ$ = {point.load_multiplier:.3f}"
    shown = Quantities.of(curve)
    motion = shown.motion_text(point.control_displacement)
    return f"{shown.motion} {motion}, reaction {shown.force_text(point)}"


LOAD = Quantities(
    motion="control displacement",
    motion_unit="m",
    per_unit=1.0,
    force="load multiplier",
    force_unit="",
    column="load_multiplier",
)
SETTLEMENT = Quantities(
    motion="displacement of the supports",
    motion_unit="m",
    per_unit=1.0,
    force="support reaction",
    force_unit="N",
    column="reaction",
)
ROTATION = Quantities(
    motion="rotation of the supports",
    motion_unit="°",
    per_unit=180.0 / np.pi,
    force="support reaction",
    force_unit="N m",
    column="reaction",
)
