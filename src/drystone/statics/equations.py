"""Loads, ties and tolerances that the static steps of one stage share.

They are made anew when blocks have left and when a stage of the dead loads begins.  In between, all
steps share them.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from drystone.common import tolerances
from drystone.common.arrays import Array, BoolArray, IntArray
from drystone.common.language import say
from drystone.contact.contacts import Pairs, Slots
from drystone.engines.measures import LoadArrays
from drystone.engines.prepared import Prepared
from drystone.engines.tie_forces import TieForces
from drystone.geometry import motion
from drystone.law.bonds import built_open
from drystone.law.branches import BONDED, OPEN, STICKING
from drystone.law.columns import BROKEN, COHESION, KN, KS, N_HISTORY, TENSION

#: The reason of a step that fails because rounding hides whether its forces balance.
TOO_STIFF = say("end.too_stiff")


@dataclass(frozen=True, kw_only=True)
class PointDisplacement:
    """The displacement c(x) of a point of one body, which a step prescribes."""

    body: int  # a spring restrains it, so that the matrix is regular at the peak
    arm: Array  # (dim,) m from the centroid to the point, where the step starts
    axis: Array  # (dim,) direction of the displacement
    axes: Array  # (dim, dim) the body's principal axes where the step starts, in columns; in space
    increment: float  # m, by which the displacement is to increase

    def missing(self, x: Array) -> float:
        """The part of the increment [m] that is still missing at increments ``x`` (n, n_dof)."""
        return self.increment - motion.advance(self.arm, x[self.body], self.axis, self.axes)

    def gradient(self, x: Array) -> Array:
        """The gradient (n, n_dof) of c by the increments, at increments ``x`` (n, n_dof)."""
        gradient = np.zeros(x.shape)
        at = self.arm, x[self.body], self.axis, self.axes
        gradient[self.body] = motion.gradient_of_advance(*at)
        return gradient


@dataclass(frozen=True, kw_only=True)
class Accuracy:
    """Tolerances of a step, in the units of a model."""

    tolerance: float  # N, largest unbalanced force
    rounding: float  # N/m, rounding of a normal reaction per metre of its blocks' motion
    sliding_rounding: float  # N/m, of a shear reaction, per metre of motion within the step
    coarsest: float  # N, largest unbalanced force that is tolerated as rounding
    lag: float = tolerances.MISSING  # m, of the prescribed displacement that may be missing
    depth: float  # m, penetration too small to tell two contacts apart
    pressed: float  # N, force above which a contact that was not followed is added; in space
    farthest: float = np.inf  # m, motion of a block above which the step has failed


@dataclass(frozen=True, kw_only=True, eq=False)
class Loaded:
    """Loads, ties and tolerances of steps: up to a stage of the dead loads, without loads on
    departed blocks."""

    prepared: Prepared
    stage: int
    departed: BoolArray  # (n,)
    loads: LoadArrays  # as designed
    ties: TieForces | None
    accuracy: Accuracy

    @classmethod
    def of(cls, prepared: Prepared, stage: int, departed: BoolArray, tolerance: float) -> Loaded:
        """Make them for a stage, without the blocks that are ``departed`` (n,); ``tolerance`` is
        the unbalanced force over the heaviest weight."""
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
    """The tolerances of steps, but for the farthest motion, which each step sets; ``tolerance`` is
    the unbalanced force over the heaviest weight."""
    assembly, laws = prepared.assembly, prepared.laws
    scale = assembly.heaviest_weight
    # Stiffness [N/m] of a joint as long as the smallest block, of the stiffest law.
    stiffest, stiffest_in_shear = (
        float(laws[:, column].max()) * assembly.smallest_extent * assembly.thickness
        for column in (KN, KS)
    )
    #: Rounding of designed gaps [m], which are differences of coordinates.
    of_gaps = 2.0 * 4.0 * np.finfo(float).eps * float(np.ptp(assembly.centroid, axis=0).max())
    rounding = 4.0 * np.finfo(float).eps  # of a gap, over the motions whose sum it is
    return Accuracy(
        tolerance=tolerance * scale,
        rounding=rounding * stiffest,
        sliding_rounding=rounding * stiffest_in_shear,
        coarsest=tolerances.COARSEST * scale,
        depth=max(tolerances.TOLD_APART * (tolerance * scale) / stiffest, of_gaps),
        pressed=tolerances.PRESSED * scale,
    )


def sinking(prepared: Prepared, loads: LoadArrays) -> float:
    """Displacement [m] of the top of a column as high as the structure under its dead load, with
    the softest joint law."""
    assembly = prepared.assembly
    free = ~assembly.fixed
    area = assembly.smallest_extent * assembly.thickness
    heaviest = float(np.abs(motion.translations(loads.dead)[free]).max())
    n = 1.0 + float(np.ptp(assembly.centroid[free] @ assembly.up)) / assembly.smallest_extent
    return 0.5 * n**2 * heaviest / (float(prepared.laws[:, KN].min()) * area)


def first_branches(prepared: Prepared, pairs: Pairs, slots: Slots) -> IntArray:
    """Branches (n_slots,) before the first step: contacts that touch stick, and are bonded if they
    have a bond."""
    laws = prepared.laws[pairs.law_of_slot]
    bonded = (laws[:, COHESION] > 0.0) | (laws[:, TENSION] > 0.0)
    touching = np.where(bonded, BONDED, STICKING)
    bonded = bonded | prepared.strengths.bonded[pairs.law_of_slot]
    # Weight presses on bed joints.  Head joints are shut, but carry only by a bond.
    touches = (np.abs(slots.normal @ prepared.assembly.up) > tolerances.LIES) | bonded
    return np.where(touches & ~_apart(prepared, slots), touching, OPEN)


def first_history(prepared: Prepared, slots: Slots) -> Array:
    """History (n_slots, N_HISTORY + dim - 2) before the first step: zeros, except that joints which
    are built open have no bond."""
    history = np.zeros((len(slots.kind), N_HISTORY + slots.dim - 2))
    history[_apart(prepared, slots), BROKEN] = 1.0
    return history


def _apart(prepared: Prepared, slots: Slots) -> BoolArray:
    return built_open(slots, prepared.assembly.smallest_extent)
