"""Ties and dead loads for the page: where they are, what ties carry at every point."""

from __future__ import annotations

from typing import Any

import numpy as np

from drystone.common.arrays import Array
from drystone.model.model import Model
from drystone.model.ties import TieEnd, names_of
from drystone.report.load_arrows import dead_arrows
from drystone.report.viewer.codec import Pack
from drystone.results.curve import CapacityCurve


def header_of(model: Model, origin: Array) -> dict[str, Any]:
    """Names, ends and bounds of ties; names, resultants and arrows of dead loads.

    Places are as designed, from the ``origin`` (dim,) [m].  A tie's end has the row of its block;
    -1 is the ground, which does not move.  An arrow ends at a point of its block and keeps its way.
    """
    assembly = model.assembly

    def end(given: TieEnd) -> dict[str, Any]:
        return {
            "block": -1 if given.block is None else assembly.index(given.block),
            "point": np.asarray(given.point, float) - origin,
        }

    rows, arrows = dead_arrows(assembly, model.dead_loads)
    return {
        "ties": [
            {
                "name": name,
                "from": end(tie.start),
                "to": end(tie.end),
                "strength": tie.strength,  # N; infinite ones become null
                "pretension": tie.pretension,
            }
            for name, tie in zip(names_of(model.ties), model.ties, strict=True)
        ],
        "dead_loads": [
            {
                "name": load.name or f"load {k + 1}",
                "kind": load.keys()["kind"],
                "on": load.keys().get("block") or load.keys()["group"],
                "force": load.forces(assembly).force.sum(axis=0),  # N
                "mass": load.mass,
                "stage": load.stage,
            }
            for k, load in enumerate(model.dead_loads)
        ],
        "arrows": [
            {"block": row, "tip": tip - origin, "way": tip - tail}
            for row, (tail, tip) in zip(rows, arrows, strict=True)
        ],
    }


def put_ties(pack: Pack, curve: CapacityCurve, rows: list[int]) -> None:
    """Force [N] and state of every tie at the points that are shown, (p, n_ties)."""
    if curve.ties is None:
        return
    pack.put("tie_force", curve.ties.force[rows], "f4", varying=True)
    pack.put("tie_state", curve.ties.branch[rows], "u1", varying=True)
