"""Bilinear curves in place of a capacity curve, rule by rule."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

Array = NDArray[np.float64]

#: Rules by name.
RULES = ("ec8", "ntc2018", "eighty_percent")


@dataclass(frozen=True, kw_only=True)
class Bilinear:
    """Elastic up to the yield point, then level up to the ultimate displacement."""

    yield_displacement: float  # m
    yield_acceleration: float  # m/s2, or a multiplier where the curve was one
    ultimate_displacement: float  # m

    @property
    def period(self) -> float:
        """T* = 2 pi sqrt(m* d*_y/F*_y) [s]: EN 1998-1:2004 (B.7), Circ. 7/2019 (C7.3.6)."""
        return float(2.0 * np.pi * np.sqrt(self.yield_displacement / self.yield_acceleration))

    def at(self, displacement: ArrayLike) -> Array:
        """Ordinates at displacements."""
        d = np.asarray(displacement, dtype=np.float64)
        rising = d * (self.yield_acceleration / self.yield_displacement)
        level = np.minimum(rising, self.yield_acceleration)
        return np.where(d > self.ultimate_displacement, 0.0, level)
