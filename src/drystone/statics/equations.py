"""Loads, ties and tolerances that the static steps of one stage share.

They are made anew when blocks have left, when a stage of the dead loads begins, and when other
pairs are near.  Between, all steps use them.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from drystone.common import tolerances
from drystone.common.arrays import Array, BoolArray, IntArray
from drystone.contact.contacts import Pairs, Slots
from drystone.engines.measures import LoadArrays
from drystone.engines.prepared import Prepared
from drystone.engines.tie_forces import TieForces
from drystone.geometry import motion
from drystone.law.bonds import built_open
from drystone.law.branches import BONDED, OPEN, STICKING
from drystone.law.columns import BROKEN, COHESION, KN, KS, N_HISTORY, TENSION

#: Why no equilibrium can be told from others near it.
TOO_STIFF = (
    "the joints are too stiff for the blocks' weight: the rounding of a displacement, times their "
    "stiffness, exceeds the unbalanced force that may be left; lower the joint's stiffness"
)


@dataclass(frozen=True, kw_only=True)
class PointDisplacement:
    """The displacement c(x) of a point of one body, which a step prescribes."""

    body: int  # that a spring restrains where the matrix may be singular
    arm: Array  # (dim,) m from the centroid to the point, where the step starts
    axis: Array  # (dim,) direction the displacement is read in
    axes: Array  # (dim, dim) the body's principal axes there, in columns; of space only
    increment: float  # m, by which it is to increase

    def missing(self, x: Array) -> float:
        """What is missing of the increment [m]."""
        return self.increment - motion.advance(self.arm, x[self.body], self.axis, self.axes)

    def gradient(self, x: Array) -> Array:
        """The gradient of c, (n, n_dof)."""
        gradient = np.zeros(x.shape)
        at = self.arm, x[self.body], self.axis, self.axes
        gradient[self.body] = motion.gradient_of_advance(*at)
        return gradient


@dataclass(frozen=True, kw_only=True)
class Accuracy:
    """What a step is solved to, on the scales of a model."""

    tolerance: float  # N, largest unbalanced force
    rounding: float  # N/m, of a reaction, by metre of its blocks' motion: normal to the joint
    sliding_rounding: float  # N/m, and along it, where only the motion within the step counts
    coarsest: float  # N, largest unbalanced force that may be left to rounding
    lag: float = tolerances.MISSING  # m, what may be missing of the increment
    depth: float  # m, penetration too small to tell two contacts apart
    pressed: float  # N, force above which a contact that was not followed is added; in space
    farthest: float = np.inf  # m, motion of a block over which the step has failed


@dataclass(frozen=True, kw_only=True, eq=False)
class Loaded:
    """What equations are written with: loads up to a stage, without those on departed blocks."""

    prepared: Prepared
    stage: int
    departed: BoolArray  # (n,)
    loads: LoadArrays  # as designed
    ties: TieForces | None
    accuracy: Accuracy

    @classmethod
    def of(cls, prepared: Prepared, stage: int, departed: BoolArray, tolerance: float) -> Loaded:
        """Those of a stage, without the blocks that are ``departed`` (n,)."""
        bars = prepared.bars
        return cls(
            prepared=prepared,
            stage=stage,
            departed=departed,
            loads=LoadArrays.of(prepared.problem, departed, stage),
            ties=TieForces(bars, prepared.assembly, departed) if bars.n_ties else None,
            accuracy=accuracy_of(prepared, tolerance),
        )


def accuracy_of(prepared: Prepared, tolerance: float) -> Accuracy:
    """What steps are solved to; how far a block may move is for each to say."""
    assembly, laws = prepared.assembly, prepared.laws
    scale = assembly.heaviest_weight
    # Stiffness [N/m] of a joint as long as the smallest block, of the stiffest law.
    stiffest, stiffest_in_shear = (
        float(laws[:, column].max()) * assembly.smallest_extent * assembly.thickness
        for column in (KN, KS)
    )
    #: Of designed gaps [m], which are differences of coordinates.
    of_gaps = 2.0 * 4.0 * np.finfo(float).eps * float(np.ptp(assembly.centroid, axis=0).max())
    rounding = 4.0 * np.finfo(float).eps  # of a gap, over the motions that it is a sum of
    return Accuracy(
        tolerance=tolerance * scale,
        rounding=rounding * stiffest,
        sliding_rounding=rounding * stiffest_in_shear,
        coarsest=tolerances.COARSEST * scale,
        depth=max(tolerances.TOLD_APART * (tolerance * scale) / stiffest, of_gaps),
        pressed=tolerances.PRESSED * scale,
    )


def sinking(prepared: Prepared, loads: LoadArrays) -> float:
    """By how much the top of a column as high as the structure sinks in its soft joints [m]."""
    assembly = prepared.assembly
    free = ~assembly.fixed
    area = assembly.smallest_extent * assembly.thickness
    heaviest = float(np.abs(motion.translations(loads.dead)[free]).max())
    n = 1.0 + float(np.ptp(assembly.centroid[free] @ assembly.up)) / assembly.smallest_extent
    return 0.5 * n**2 * heaviest / (float(prepared.laws[:, KN].min()) * area)


def first_branches(prepared: Prepared, pairs: Pairs, slots: Slots) -> IntArray:
    """Contacts that touch stick, by a bond where there is one; (n_slots,)."""
    laws = prepared.laws[pairs.law_of_slot]
    bonded = (laws[:, COHESION] > 0.0) | (laws[:, TENSION] > 0.0)
    touching = np.where(bonded, BONDED, STICKING)
    bonded = bonded | prepared.strengths.bonded[pairs.law_of_slot]
    # Weight presses on joints that lie.  Those that stand are shut, and carry by a bond only.
    touches = (np.abs(slots.normal @ prepared.assembly.up) > tolerances.LIES) | bonded
    return np.where(touches & ~_apart(prepared, slots), touching, OPEN)


def first_history(prepared: Prepared, slots: Slots) -> Array:
    """Nothing but that joints which are open when built have no bond; (n_slots, n_history)."""
    history = np.zeros((len(slots.kind), N_HISTORY + slots.dim - 2))
    history[_apart(prepared, slots), BROKEN] = 1.0
    return history


def _apart(prepared: Prepared, slots: Slots) -> BoolArray:
    return built_open(slots, prepared.assembly.smallest_extent)
