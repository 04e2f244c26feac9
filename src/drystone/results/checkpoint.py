"""What is kept of a run so that another process goes on with it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from drystone.common.arrays import Array
from drystone.common.codec import Packed
from drystone.contact.forces import ContactForces
from drystone.model.model import Model
from drystone.results.curve import BlockLeft, CurvePoint
from drystone.results.forces import TieRecord


@dataclass(frozen=True, kw_only=True)
class Standing:
    """Where a run stands between two steps."""

    state: Any  # of the engine
    memory: Any  # of the control
    demand: Any  # of the step that comes next


@dataclass(frozen=True, kw_only=True)
class Checkpoint:
    """A run between two steps; its model and points are kept apart."""

    standing: Packed  # a `Standing`, which only the engine's records make whole
    n_points: int  # before the step that comes next
    engine: str
    strategy: str
    stops: bool  # whether the run stops where a part that may not fall collapses
    settlement: float  # m, of the control point before the load
    left: tuple[BlockLeft, ...] = ()
    notes: tuple[str, ...] = ()  # of the engine, see `Engine.notes`
    seconds: float = 0.0  # that the run has taken


@dataclass(frozen=True, kw_only=True, eq=False)
class Past:
    """A run that stopped, as far as it was kept."""

    model: Model
    checkpoint: Checkpoint
    points: tuple[CurvePoint, ...]  # as many as the checkpoint says, as all that follows
    poses: Array  # (n_points, n, n_pose) m, rad
    contacts: Sequence[ContactForces]
    ties: TieRecord | None
