"""Forces of contacts and ties at the points of a curve."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import Any, overload

import numpy as np

from drystone.common.arrays import Array, IntArray
from drystone.contact.forces import ContactForces
from drystone.model.ties import STATES, TieState


@dataclass(frozen=True, kw_only=True, eq=False)
class TieRecord:
    """What every tie carried at every point; arrays (n_points, n_ties)."""

    names: tuple[str, ...]
    force: Array  # N, tension positive
    elongation: Array  # m, beyond the length as designed
    branch: IntArray  # row of `ties.STATES`

    @classmethod
    def of(cls, names: tuple[str, ...], states: Sequence[TieState]) -> TieRecord:
        """Of the states of all points."""
        shape = len(states), len(names)
        return cls(
            names=names,
            force=np.array([state.force for state in states]).reshape(shape),
            elongation=np.array([state.elongation for state in states]).reshape(shape),
            branch=np.array([state.branch for state in states], np.int64).reshape(shape),
        )

    def at(self, point: int) -> TieState:
        """Forces, elongations and branches at a point."""
        n = len(self.names)
        return TieState(
            plastic=np.full(n, np.nan),
            branch=self.branch[point],
            force=self.force[point],
            elongation=self.elongation[point],
            margin=np.full(n, np.inf),
        )

    def until(self, n: int) -> TieRecord:
        """That of the first ``n`` points."""
        return self.at_rows(slice(n))

    def at_rows(self, rows: slice | IntArray) -> TieRecord:
        """That of some points."""
        return replace(
            self,
            force=self.force[rows],
            elongation=self.elongation[rows],
            branch=self.branch[rows],
        )

    def state(self, point: int, tie: int | str) -> str:
        """What a tie does at a point: "slack", "elastic", "yielding" or "broken"."""
        column = self.names.index(tie) if isinstance(tie, str) else tie
        return STATES[self.branch[point, column]]


class KeptContacts(Sequence[ContactForces]):
    """Contact forces of every point, made from an engine's states when they are asked for.

    Parameters
    ----------
    states
        One per point, as the engine gave them.
    contacts
        Makes contact forces of a state; the engine is nobody else's.
    """

    def __init__(self, states: Sequence[Any], contacts: Callable[[Any], ContactForces]) -> None:
        self._states, self._contacts = tuple(states), contacts

    def __len__(self) -> int:
        return len(self._states)

    @overload
    def __getitem__(self, index: int) -> ContactForces: ...

    @overload
    def __getitem__(self, index: slice) -> KeptContacts: ...

    def __getitem__(self, index: int | slice) -> ContactForces | KeptContacts:
        if isinstance(index, slice):
            return KeptContacts(self._states[index], self._contacts)
        return self._contacts(self._states[index])

    def __reduce__(self) -> tuple[Any, ...]:
        """Copies and pickles have the forces, not the engine."""
        return tuple, (tuple(self),)
