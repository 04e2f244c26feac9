"""A point of a capacity curve as `compas_dem.problem.Results`."""

from __future__ import annotations

from typing import Any

import numpy as np

import drystone
from drystone.common.arrays import Array
from drystone.common.errors import ModelError
from drystone.compas.contacts import edges_of, put_edge
from drystone.geometry import motion
from drystone.model.model import Model
from drystone.results.curve import CapacityCurve

MISSING = "COMPAS needs compas_dem, which is not installed: pip install drystone[compas]"

#: Names of points of a curve.
REST, PEAK, CAPACITY, END = "rest", "peak", "capacity", "end"


def check_installed() -> None:
    """Raise `ModelError` where compas_dem is missing."""
    try:
        import compas_dem.problem  # noqa: F401
    except ImportError:
        raise ModelError([MISSING]) from None


def results_of(problem: Any, model: Model, curve: CapacityCurve, *, at: str | int = PEAK) -> Any:
    """The `Results` of a problem at one point of its curve.

    Nodes have a ``transformation``, edges the contact forces, in the layout of the solvers of
    compas_dem: the force on the first node of an edge, in a frame whose z-axis is the normal.
    ``metadata`` holds the curve.

    Parameters
    ----------
    problem
        What was solved.
    model, curve
        As of `solve`, the curve with its poses and contacts.
    at
        "peak", "capacity" (the peak before a part collapses), "rest" (under dead loads alone),
        "end", or the number of a point.

    Raises
    ------
    ModelError
        There is no such point, the curve has no poses or contacts, or compas_dem is missing.
    """
    check_installed()
    from compas.geometry import Transformation
    from compas_dem.problem import Results

    if curve.poses is None or curve.contacts is None:
        raise ModelError(["curve: has no poses or contacts: trace it with keep_poses=True"])
    step = _step(curve, at)
    results = Results(model_id=str(problem.model.guid), problem_id=str(problem.guid))
    nodes = [int(name) for name in model.assembly.ids]
    for node, matrix in zip(nodes, _matrices(model, curve.poses[step]), strict=True):
        if np.isfinite(matrix).all():
            results.set_node(node, "transformation", Transformation(matrix.tolist()))
    graph = problem.model.graph
    for edge in edges_of(curve.contacts[step], nodes):
        known = graph.has_edge((edge.u, edge.v)) or not graph.has_edge((edge.v, edge.u))
        put_edge(results, edge if known else edge.reversed())
        if not (graph.has_edge((edge.u, edge.v)) or graph.has_edge((edge.v, edge.u))):
            results.metadata.setdefault("added_edges", []).append([edge.u, edge.v])
    results.metadata.update(_about(model, curve, step))
    return results


def _step(curve: CapacityCurve, at: str | int) -> int:
    """The number of a point."""
    if isinstance(at, str):
        named = {
            REST: lambda: 0,
            PEAK: lambda: curve.peak.step,
            CAPACITY: lambda: curve.capacity.step,
            END: lambda: len(curve.points) - 1,
        }
        if at not in named:
            raise ModelError([f'at: there is no point "{at}": take one of {", ".join(named)}'])
        return int(named[at]())
    if not -len(curve.points) <= at < len(curve.points):
        raise ModelError([f"at: there is no point {at}: the curve has {len(curve.points)}"])
    return at % len(curve.points)


def _matrices(model: Model, pose: Array) -> Array:
    """Matrices (n, 4, 4) that take blocks from where they are designed to poses (n, 7)."""
    centroid = model.assembly.centroid
    matrices = np.tile(np.eye(4), (len(centroid), 1, 1))
    for column in range(3):
        unit = np.broadcast_to(np.eye(3)[column], centroid.shape)
        matrices[:, :3, column] = motion.rotated(unit, pose)
    carried = np.einsum("nij,nj->ni", matrices[:, :3, :3], centroid)
    matrices[:, :3, 3] = centroid + motion.translations(pose) - carried
    return matrices


def _about(model: Model, curve: CapacityCurve, step: int) -> dict[str, Any]:
    """The curve, in numbers and words that JSON can hold."""
    return {
        "solver": "drystone",
        "version": drystone.__version__,
        "engine": curve.engine,
        "status": curve.status,
        "reason": str(curve.reason),
        "mu": model.assembly.joint.friction_coefficient,
        "point": step,
        "load_multiplier": curve.points[step].load_multiplier,
        "peak_multiplier": curve.peak.load_multiplier,
        "capacity_multiplier": curve.capacity.load_multiplier,
        "control_displacement": curve.control_displacement.tolist(),
        "load_multipliers": curve.load_multiplier.tolist(),
        "residual": float(curve.points[step].residual),
        "blocks_left": [int(left.block) for left in curve.blocks_left if left.step <= step],
        "notes": [str(note) for note in model.notes],
    }
