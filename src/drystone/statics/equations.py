"""The equations of a static step: for the blocks that are there, and the pairs that may touch.

They are made anew when blocks have left, when a stage of the dead loads begins, and when other
pairs are near.  Between, all steps use them.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from drystone.common.tolerances import LIES, PRESSED, TOLD_APART
from drystone.contact.contacts import Pairs, Slots
from drystone.engines.measures import LoadArrays
from drystone.engines.prepared import Prepared
from drystone.geometry import motion
from drystone.law.bonds import built_open
from drystone.law.branches import BONDED, OPEN, STICKING
from drystone.law.columns import BROKEN, COHESION, KN, KS, N_HISTORY, TENSION
from drystone.statics.constants import Accuracy, Constants, Loads
from drystone.statics.plane.plane_step import PlaneStep
from drystone.statics.space.space_step import SpaceStep
from drystone.statics.static_step import StaticStep
from drystone.statics.tie_forces import TieForces

Array = NDArray[np.float64]
IntArray = NDArray[np.int64]
BoolArray = NDArray[np.bool_]


@dataclass(frozen=True, kw_only=True, eq=False)
class Loaded:
    """What equations are written with: loads up to a stage, without those on departed blocks."""

    prepared: Prepared
    stage: int
    departed: BoolArray  # (n,)
    loads: LoadArrays
    ties: TieForces | None
    constants: Constants

    @classmethod
    def of(cls, prepared: Prepared, stage: int, departed: BoolArray) -> Loaded:
        """Those of a stage, without the blocks that are ``departed`` (n,)."""
        assembly, bars = prepared.assembly, prepared.bars
        loads = LoadArrays.of(prepared.problem, departed, stage)
        ties = TieForces(bars, assembly, departed) if bars.n_ties else None
        constants = Constants(
            detector=prepared.detector,
            laws=prepared.laws,
            thickness=assembly.thickness,
            loads=Loads(
                dead=loads.dead,
                pattern=loads.pattern,
                mass=loads.mass,
                extent=prepared.extent,
                fixed=loads.fixed,
                acting=None if loads.acting.steady else loads.acting,
                ties=ties,
            ),
        )
        return cls(
            prepared=prepared,
            stage=stage,
            departed=departed,
            loads=loads,
            ties=ties,
            constants=constants,
        )


@dataclass(frozen=True, kw_only=True, eq=False)
class Equations:
    """The equations of some pairs; `step` is worked in."""

    loaded: Loaded
    pairs: Pairs
    accuracy: Accuracy
    step: StaticStep

    @classmethod
    def of(cls, loaded: Loaded, pairs: Pairs, accuracy: Accuracy) -> Equations:
        """Those of some pairs, to be solved as accurately as said."""
        kind = SpaceStep if loaded.prepared.assembly.dimension == 3 else PlaneStep
        return cls(
            loaded=loaded, pairs=pairs, accuracy=accuracy, step=kind(loaded.constants, pairs)
        )

    @property
    def loads(self) -> LoadArrays:
        """Loads and masses, as designed."""
        return self.loaded.loads

    @property
    def ties(self) -> TieForces | None:
        """Ties, if there are any."""
        return self.loaded.ties

    @property
    def constants(self) -> Constants:
        """What the step was made of."""
        return self.loaded.constants


def accuracy_of(prepared: Prepared, tolerance: float, coarsest: float) -> Accuracy:
    """What steps are solved to, from shares of the heaviest weight; how far a block may move is
    for each to say."""
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
        coarsest=coarsest * scale,
        depth=max(TOLD_APART * (tolerance * scale) / stiffest, of_gaps),
        pressed=PRESSED * scale,
        farthest=np.inf,
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
    touches = (np.abs(slots.normal @ prepared.assembly.up) > LIES) | bonded
    return np.where(touches & ~_apart(prepared, slots), touching, OPEN)


def first_history(prepared: Prepared, slots: Slots) -> Array:
    """Nothing but that joints which are open when built have no bond; (n_slots, n_history)."""
    history = np.zeros((len(slots.kind), N_HISTORY + slots.dim - 2))
    history[_apart(prepared, slots), BROKEN] = 1.0
    return history


def _apart(prepared: Prepared, slots: Slots) -> BoolArray:
    return built_open(slots, prepared.assembly.smallest_extent)
