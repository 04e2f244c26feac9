"""A stand-in for the package pylmgc90: one degree of freedom behind LMGC90's names.

Supports carry the weight and up to ``capacity`` of it sideways, less as the wall moves; what is
applied beyond that moves every block by 10 mm to the right in a step.  Every call is kept.  In
space sideways is along x, too, and up is z; ``turn`` is by how much the control block has turned
then, about y.
"""

from __future__ import annotations

import sys
from types import ModuleType
from typing import Any

import numpy as np


class Chipy:
    """The solver's side."""

    PLPLx_ID = PRPRx_ID = 7

    def __init__(
        self,
        weight: np.ndarray,
        fixed: np.ndarray,
        contacts: list[tuple[int, int]],
        *,
        dimension: int = 2,
        turn: float = 0.0,
    ):
        self.up, self.n_dof, self.turn = dimension - 1, 3 * dimension - 3, turn
        self.weight, self.fixed, self.contacts = weight, fixed, contacts
        self.capacity = 0.1
        self.moved = 0.0  # m, accepted
        self.gravity = 0.0
        self.calls: list[tuple[str, tuple[Any, ...]]] = []
        self.internal: dict[int, float] = {}

    def __getattr__(self, name: str):
        if name.startswith("__"):
            raise AttributeError(name)
        return lambda *arguments, **named: self.calls.append((name, arguments))

    def names(self) -> list[str]:
        return [name for name, _ in self.calls]

    def bulk_behav_SetGravity(self, vector):
        self.gravity = -vector[self.up]

    def IncrementStep(self):
        self.calls.append(("IncrementStep", ()))
        self.force = np.zeros((len(self.weight), self.n_dof))
        self.force[:, self.up] = -self.weight * self.gravity / 9.81

    def RBDY2_PutBodyVector(self, name, body, vector):
        self.calls.append((name, (body, tuple(vector))))
        if name == "Fext_":
            self.force[body - 1] += vector

    def ComputeDof(self):
        self.calls.append(("ComputeDof", ()))
        sideways, total = self.force[~self.fixed, 0].sum(), self.weight[~self.fixed].sum()
        held = self.capacity * (1.0 - self.moved) * total
        self.pending = self.moved + (0.01 if sideways > held else 0.0)
        self.carried = np.zeros(self.n_dof)
        self.carried[0] = min(sideways, held)
        self.carried[self.up] = self.force[~self.fixed, self.up].sum()
        self.carried /= np.count_nonzero(self.fixed)

    def UpdateStep(self):
        self.calls.append(("UpdateStep", ()))
        self.moved = self.pending

    def RBDY2_GetBodyVector(self, name, body):
        if name == "Reac_":
            return self.carried if self.fixed[body - 1] else -self.force[body - 1]
        if name == "X____" and not self.fixed[body - 1]:
            return np.array([self.pending, *[0.0] * (self.n_dof - 1)])
        return np.zeros(self.n_dof)

    def RBDY3_GetBodyMatrix(self, name, body):
        """Axes of inertia in rows; as designed any ones, here turned about x."""
        designed = np.array([[1.0, 0.0, 0.0], [0.0, 0.6, 0.8], [0.0, -0.8, 0.6]])
        if name == "IFref" or self.moved == 0.0:
            return designed
        c, s = np.cos(self.turn), np.sin(self.turn)
        about_y = np.array([[c, 0.0, s], [0.0, 1.0, 0.0], [-s, 0.0, c]])
        return designed @ about_y.T

    def __getattribute__(self, name: str):
        """What is called alike in both dimensions is one method."""
        return super().__getattribute__(
            name.replace("RBDY3_PutBodyV", "RBDY2_PutBodyV")
            .replace("RBDY3_GetBodyV", "RBDY2_GetBodyV")
            .replace("inter_handler_3D", "inter_handler_2D")
        )

    def inter_handler_2D_tgetNb(self, kind):
        return len(self.contacts)

    def inter_handler_2D_tgetIData(self, kind, k):
        candidate, antagonist = self.contacts[k - 1]
        return np.array([1, 1, candidate + 1, antagonist + 1, *[0] * 9])

    def inter_handler_2D_tgetRData(self, kind, k):
        # Place, tangent, normal from antagonist to candidate, impulses and velocities, gap.
        return np.array([0.1 * k, 0.0, 1.0, 0.0, 0.0, 1.0, 2.0, 50.0, 0.0, -1e-3, -1e-4])

    def inter_handler_2D_tsetInternal(self, kind, k, index, value):
        self.internal[k] = value

    def nlgs_AfterIterCheck(self):
        return 0


class Recorder:
    """The pre-processor's side: remembers what it is told, answers with more of itself."""

    def __init__(self) -> None:
        self.calls: list[tuple[str, dict[str, Any]]] = []

    def __getattr__(self, name: str):
        def call(*arguments: Any, **named: Any) -> Recorder:
            self.calls.append((name, {**named, "arguments": arguments}))
            return self

        return call

    def told(self, name: str) -> list[dict[str, Any]]:
        return [named for called, named in self.calls if called == name]


def install(monkeypatch, chipy: Chipy) -> Recorder:
    """Make ``import pylmgc90`` find the stand-in; gives its pre-processor."""
    package = ModuleType("pylmgc90")
    package.chipy, package.pre = chipy, Recorder()
    monkeypatch.setitem(sys.modules, "pylmgc90", package)
    return package.pre
