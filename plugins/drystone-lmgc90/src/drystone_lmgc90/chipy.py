"""Driving a full LMGC90 through its Python package ``pylmgc90``: polygons, in the plane.

The pre-processor writes the simulation into the folder DATBOX, from which the solver reads it.  A
step is made in the two halves of `wheel`, with the same contact law.
"""

from __future__ import annotations

from collections import Counter
from typing import Any

import numpy as np
from numpy.typing import NDArray

from drystone.common.arrays import Array, IntArray
from drystone_lmgc90.messages import Outcome, Ready, Setup, Step

STORAGE = "Stored_Delassus_Loops         "  # thirty letters
NORM = "QM/16"
LAW = "ELASTIC_REPELL_CLB_adapt"
COLOUR = "BLUEx"


class Simulation:
    """The one simulation of this process."""

    def __init__(self, setup: Setup) -> None:
        from pylmgc90 import chipy

        self.setup, self.chipy = setup, chipy
        self.n = len(setup.shapes)
        write_datbox(setup)
        chipy.Initialize()
        chipy.checkDirectories()
        chipy.utilities_DisableLogMes()
        chipy.SetDimension(2, 1)
        chipy.TimeEvolution_SetTimeStep(setup.time_step)
        chipy.Integrator_InitTheta(setup.theta)
        chipy.ReadDatbox(deformable=False)
        chipy.ComputeMass()
        chipy.bulk_behav_SetGravity([0.0, 0.0, 0.0])  # the weight is among the forces
        # Else the stiffness of each point is overwritten by the law's at the first step.
        chipy.nlgs_IsInitialized(1)
        self.velocity = np.zeros((self.n, 3))
        self.pending: Array | None = None
        self.ready = Ready(program=f"pylmgc90 {getattr(chipy, '__version__', '')}".strip())

    def step(self, request: Step) -> Outcome:
        """The first half of a step, after the second half of the last one if that is accepted."""
        chipy, h = self.chipy, request.time_step
        if request.accept:
            assert self.pending is not None
            chipy.StockRloc()
            chipy.UpdateStep()
            self.velocity, self.pending = self.pending, None
        chipy.TimeEvolution_SetTimeStep(h)
        start = np.zeros((self.n, 3)) if request.stop_blocks else self.velocity
        for i in range(self.n):
            chipy.RBDY2_PutBodyVector("Vbeg_", i + 1, start[i])
        chipy.IncrementStep()
        chipy.ComputeFext()
        for i in np.flatnonzero(~self.setup.fixed).tolist():
            chipy.RBDY2_PutBodyVector("Fext_", i + 1, request.force[i])
        chipy.ComputeBulk()
        chipy.ComputeFreeVelocity()
        chipy.SelectProxTactors()
        chipy.RecupRloc()
        stiffness, bodies = self._share()
        n_sweeps, converged = self._solve()
        chipy.UpdateTactBehav()
        chipy.ComputeDof()
        self.pending = self._vectors("V____")
        return Outcome(
            converged=converged and bool(np.all(np.isfinite(self.pending))),
            n_sweeps=n_sweeps,
            pose=self._vectors("X____"),
            velocity=self.pending,
            contact_force=self._vectors("Reac_"),
            **self._contacts(h, stiffness, bodies),
        )

    def _share(self) -> tuple[Array, IntArray]:
        """Stiffness [N/m] and bodies (b, a) of each contact; the former is handed to LMGC90."""
        chipy, kind, setup = self.chipy, self.chipy.PLPLx_ID, self.setup
        n = chipy.inter_handler_2D_tgetNb(kind)
        data = [chipy.inter_handler_2D_tgetIData(kind, k + 1) for k in range(n)]
        bodies = np.array(data, dtype=np.int64).reshape(n, -1)[:, 2:4] - 1
        pairs = [tuple(pair) for pair in np.sort(bodies, axis=1).tolist()]
        found = Counter(pairs)
        stiffness = np.array(
            [setup.joints.get(pair, setup.spare_stiffness) / found[pair] for pair in pairs]
        )
        for k in range(n):
            chipy.inter_handler_2D_tsetInternal(kind, k + 1, 1, stiffness[k])
        return stiffness, bodies

    def _solve(self) -> tuple[int, bool]:
        chipy, setup = self.chipy, self.setup
        chipy.nlgs_SetCheckType(NORM, setup.tolerance, 1.0)
        chipy.nlgs_ExPrep(STORAGE)
        n_sweeps, state = 0, 1
        while state > 0 and n_sweeps < setup.max_sweeps:
            chipy.nlgs_ExIter(setup.sweeps_per_check)
            n_sweeps += setup.sweeps_per_check
            state = chipy.nlgs_AfterIterCheck()
        chipy.nlgs_ExPost()
        return n_sweeps, state == 0

    def _vectors(self, name: str) -> Array:
        """A vector of every body, (n, 3)."""
        get = self.chipy.RBDY2_GetBodyVector
        return np.array([get(name, i + 1) for i in range(self.n)], dtype=float)

    def _contacts(self, h: float, stiffness: Array, bodies: IntArray) -> dict[str, NDArray[Any]]:
        chipy = self.chipy
        # Place, tangent, normal, impulses and velocities along both, gap at the end.
        data = [
            chipy.inter_handler_2D_tgetRData(chipy.PLPLx_ID, k + 1) for k in range(len(stiffness))
        ]
        row = np.array(data, dtype=float).reshape(-1, 11)
        normal = row[:, 4:6]
        force = (row[:, 6:7] * row[:, 2:4] + row[:, 7:8] * normal) / h
        body_b, body_a = bodies.T
        return {
            "body_a": body_a,
            "body_b": body_b,
            "position": row[:, :2],
            "normal": normal,
            "tangent": np.zeros((len(normal), 0)),
            "gap": row[:, 10] - h * row[:, 9],
            "reaction": np.column_stack(
                (
                    np.sum(force * normal, axis=1),
                    force[:, 0] * normal[:, 1] - force[:, 1] * normal[:, 0],
                )
            ),
            "stiffness": stiffness,
        }


def write_datbox(setup: Setup) -> None:
    """Write the folder DATBOX where the process stands."""
    from pathlib import Path

    from pylmgc90 import pre

    Path("DATBOX").mkdir(exist_ok=True)
    bodies, materials = pre.avatars(), pre.materials()
    laws, sees = pre.tact_behavs(), pre.see_tables()
    rigid = pre.model(name="rigid", physics="MECAx", element="Rxx2D", dimension=2)
    density = setup.density * setup.thickness  # a polygon's mass is its area times this
    distinct, kind = np.unique(density, return_inverse=True)
    stuff = [
        pre.material(name=f"s{k + 1:04d}", materialType="RIGID", density=float(value))
        for k, value in enumerate(distinct)
    ]
    for material in stuff:
        materials.addMaterial(material)
    for i, shape in enumerate(setup.shapes):
        body = pre.rigidPolygon(
            model=rigid,
            material=stuff[int(kind.ravel()[i])],
            center=np.zeros(2),
            color=COLOUR,
            generation_type="full",
            vertices=np.array(shape.vertices),
        )
        if setup.fixed[i]:
            body.imposeDrivenDof(component=[1, 2, 3], dofty="vlocy")
        bodies.addAvatar(body)
    law = pre.tact_behav(
        name="joint", law=LAW, stiffness=setup.spare_stiffness, fric=setup.friction
    )
    laws.addBehav(law)
    sees.addSeeTable(
        pre.see_table(
            CorpsCandidat="RBDY2",
            candidat="POLYG",
            colorCandidat=COLOUR,
            CorpsAntagoniste="RBDY2",
            antagoniste="POLYG",
            colorAntagoniste=COLOUR,
            behav=law,
            alert=setup.reach,
        )
    )
    pre.writeDatbox(
        dim=2, mats=materials, mods=pre.models(), bodies=bodies, tacts=laws, sees=sees, post=None
    )
