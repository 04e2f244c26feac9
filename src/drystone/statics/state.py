"""The state between two static steps."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from drystone.common.arrays import Array, BoolArray, IntArray
from drystone.contact.contacts import Pairs, Slots
from drystone.contact.forces import ActedContacts
from drystone.engines.prepared import Prepared
from drystone.model.ties import TieState


@dataclass(frozen=True, kw_only=True)
class EquilibriumState:
    """Poses, histories of joints, and what the next step is predicted from."""

    prepared: Prepared
    stage: int  # of the dead loads, see `Problem.stages`
    pose: Array  # (n, n_pose) m, rad
    multiplier: float
    pairs: Pairs
    paired_at: Array  # (n, n_pose) where the pairs were found, or last found to be complete
    slots: Slots  # contacts in `pose`
    history: Array  # (n_slots, N_HISTORY + dim - 2)
    reaction: Array  # (n_slots, dim) N
    branch: IntArray  # (n_slots,) of the joint law, see `law.branches`
    last_increment: Array  # (n, n_dof) m, rad; zeros if there is nothing to predict from
    margin: Array  # (n_slots + n_ties,) of bonds, see `law.bonds`, and ties
    due: IntArray  # rows of `margin` of the bonds and ties that break next
    departed: BoolArray  # (n,) blocks that have left
    ties: TieState
    support_motion: float = 0.0  # m or rad, by which supports have moved
    last_support_motion: float = 0.0  # the same in the last step
    kept: IntArray | None = None  # (n_pairs,) steps for which features stay; in the plane only
    slope: float = np.nan  # 1/m, of the curve, if it is known
    softened: bool = False  # whether joints soften, and the slope allows for that
    tangent: Array | None = None  # (n, n_dof) per m of the control displacement, if it is known
    curvature: Array | None = None  # (n, n_dof) per m2, change of the tangent in the last step
    unstable: int = 0  # unstable equilibria in a row, this one included
    in_vain: int = 0  # steps in a row that Newton's method along the curve has not completed
    acted: ActedContacts | None = None  # contacts whose reactions are in balance
