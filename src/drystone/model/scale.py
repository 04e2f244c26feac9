"""What takes a model to other coordinates and units, such as its own; see `engines.frame`."""

from __future__ import annotations

from typing import Protocol

from drystone.common.arrays import Array


class Scale(Protocol):
    """Takes points and quantities from metres and newtons to other units."""

    def place(self, points: Array) -> Array:
        """Points (..., dim) [m]."""
        ...

    def forces(self, forces: Array) -> Array:
        """Forces (...) or (..., dim) [N]."""
        ...

    def extension(self, extension: float) -> float:
        """A length [m]."""
        ...

    def height(self, height: float) -> float:
        """A height [m], along gravity."""
        ...

    def spring(self, stiffness: float) -> float:
        """A force over a length [N/m]."""
        ...

    def pressure(self, pressure: float) -> float:
        """A pressure [Pa]."""
        ...

    def weight(self, unit_weight: float) -> float:
        """A unit weight [N/m3]."""
        ...
