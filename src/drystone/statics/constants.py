"""What a static step is given: loads, a prescribed displacement, and the accuracy asked for."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from drystone.common.tolerances import MISSING
from drystone.contact.detection import Detector
from drystone.geometry import motion
from drystone.model.loading import Acting
from drystone.statics.tie_forces import TieForces

Array = NDArray[np.float64]
BoolArray = NDArray[np.bool_]


#: Why no equilibrium can be told from others near it.
TOO_STIFF = (
    "the joints are too stiff for the blocks' weight: the rounding of a displacement, times their "
    "stiffness, exceeds the unbalanced force that may be left; lower the joint's stiffness"
)


class PrescribedDisplacement(Protocol):
    """The displacement c(x) that a step prescribes."""

    @property
    def body(self) -> int:
        """The body that a spring restrains where the matrix may be singular."""
        ...

    @property
    def increment(self) -> float:
        """By how much it is to increase [m]."""
        ...

    def missing(self, x: Array) -> float:
        """What is missing of the increment [m]."""
        ...

    def gradient(self, x: Array) -> Array:
        """The gradient of c, (n, n_dof)."""
        ...


@dataclass(frozen=True, kw_only=True)
class PointDisplacement:
    """The displacement of a point of one body."""

    body: int
    arm: Array  # (dim,) m from the centroid to the point, where the step starts
    axis: Array  # (dim,) direction the displacement is read in
    axes: Array  # (dim, dim) the body's principal axes there, in columns; of space only
    increment: float  # m

    def missing(self, x: Array) -> float:
        """See `PrescribedDisplacement.missing`."""
        return self.increment - motion.advance(self.arm, x[self.body], self.axis, self.axes)

    def gradient(self, x: Array) -> Array:
        """See `PrescribedDisplacement.gradient`."""
        gradient = np.zeros(x.shape)
        at = self.arm, x[self.body], self.axis, self.axes
        gradient[self.body] = motion.gradient_of_advance(*at)
        return gradient


@dataclass(frozen=True, kw_only=True)
class Loads:
    """What acts on the bodies of an analysis besides contacts; arrays are (n, n_dof)."""

    dead: Array  # N, N m
    pattern: Array  # N, N m, at multiplier one
    mass: Array  # kg, kg m2; zero on fixed bodies
    extent: Array  # (n,) m, by which moments are divided
    fixed: BoolArray  # (n,)
    acting: Acting | None = None  # what they are near a place and a multiplier; None: the same
    ties: TieForces | None = None

    def near(self, pose: Array, multiplier: float) -> tuple[Array, Array]:
        """Dead load and pattern in a pose (n, n_pose), near a multiplier; see `Acting.near`."""
        return self.acting.near(pose, multiplier) if self.acting else (self.dead, self.pattern)


@dataclass(frozen=True, kw_only=True)
class Constants:
    """What stays the same over an analysis."""

    detector: Detector
    laws: Array  # (n_laws, N_LAW)
    thickness: float  # m
    loads: Loads


@dataclass(frozen=True, kw_only=True)
class Accuracy:
    """What a step is solved to, on the scales of a model."""

    tolerance: float  # N, largest unbalanced force
    rounding: float  # N/m, of a reaction, by metre of its blocks' motion: normal to the joint
    sliding_rounding: float  # N/m, and along it, where only the motion within the step counts
    coarsest: float  # N, largest unbalanced force that may be left to rounding
    lag: float = MISSING  # m, what may be missing of the increment
    depth: float  # m, penetration too small to tell two contacts apart
    pressed: float  # N, force above which a contact that was not followed is added; in space
    farthest: float  # m, motion of a block over which the step has failed
