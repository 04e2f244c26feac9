"""Contact forces by edge of the graph, in the layout of compas_dem's solvers."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from drystone.common.arrays import Array, IntArray
from drystone.contact.forces import OPEN, SLIDING, ContactForces

#: Distance of points over the extent of their contact under which they are one, and under which
#: they lie on a line.
SAME = 1e-6


@dataclass(frozen=True, kw_only=True)
class Edge:
    """The contact points of two blocks that touch, n of them in the order around them."""

    u: int
    v: int
    points: Array  # (n, 3) m
    forces: Array  # (n, 3) N, on u
    frames: Array  # (n, 3, 3) rows: first tangent, second tangent, normal from v to u
    gap: Array  # (n,) m, positive open
    status: tuple[str, ...]
    is_face: bool  # whether the points span an area

    def reversed(self) -> Edge:
        """The same as seen from the other block."""
        return replace(
            self,
            u=self.v,
            v=self.u,
            forces=-self.forces,
            frames=self.frames * np.array([-1.0, 1.0, -1.0])[:, None],
        )

    @property
    def frame(self) -> Array:
        """(3, 3) rows as of `frames`: that of the first point, on the mean normal."""
        normal = _unit(self.frames[:, 2].mean(axis=0))
        first = self.frames[0, 0]
        first = _unit(first - (first @ normal) * normal)
        return np.stack((first, np.cross(normal, first), normal))


def edges_of(contacts: ContactForces, nodes: Sequence[int]) -> Iterator[Edge]:
    """The pairs of blocks that touch; points that are open are left out."""
    touching = np.flatnonzero(contacts.status != OPEN)
    pairs: dict[tuple[int, int], list[int]] = {}
    for k in touching:
        pairs.setdefault((int(contacts.block_a[k]), int(contacts.block_b[k])), []).append(int(k))
    vectors, tangents = contacts.vectors(), contacts.tangents
    for (a, b), found in pairs.items():
        rows = np.array(found)
        own = Edge(
            u=nodes[b],
            v=nodes[a],
            points=contacts.position[rows],
            forces=vectors[rows],
            frames=np.stack((tangents[rows, 0], tangents[rows, 1], contacts.normal[rows]), axis=1),
            gap=contacts.gap[rows],
            status=tuple("sliding" if contacts.status[k] == SLIDING else "sticking" for k in found),
            is_face=True,
        )
        yield _around(_merged(own))


def _merged(edge: Edge) -> Edge:
    """Points that coincide as one, with the sum of their forces."""
    size = float(np.ptp(edge.points, axis=0).max())
    kept: list[int] = []
    owner = []
    for k, point in enumerate(edge.points):
        near = [i for i in kept if np.linalg.norm(edge.points[i] - point) <= SAME * size]
        if not near:
            kept.append(k)
        owner.append(kept.index(near[0] if near else k))
    forces = np.zeros((len(kept), 3))
    np.add.at(forces, np.array(owner), edge.forces)
    return _taken(replace(edge, forces=edge.forces), np.array(kept), forces)


def _taken(edge: Edge, rows: IntArray, forces: Array | None = None) -> Edge:
    """Some of the points, with other forces if these are given."""
    return replace(
        edge,
        points=edge.points[rows],
        forces=edge.forces[rows] if forces is None else forces,
        frames=edge.frames[rows],
        gap=edge.gap[rows],
        status=tuple(edge.status[i] for i in rows),
    )


def _around(edge: Edge) -> Edge:
    """Points in the order around their middle; on a line, its two ends first."""
    middle = edge.points.mean(axis=0)
    arms = edge.points - middle
    _, extents, axes = np.linalg.svd(arms, full_matrices=False)
    if len(edge.points) < 3 or extents[1] <= SAME * extents[0]:
        along = np.argsort(arms @ axes[0], kind="stable")
        ends = np.concatenate((along[:1], along[-1:], along[1:-1])) if len(along) > 2 else along
        return replace(_taken(edge, ends), is_face=False)
    first, second, _ = edge.frame
    order = np.argsort(np.arctan2(arms @ second, arms @ first), kind="stable")
    return _taken(edge, order)


def put_edge(results: Any, edge: Edge) -> None:
    """Write the attributes of an edge that compas_dem's solvers write."""
    from compas.geometry import Frame

    u_v, frame = (edge.u, edge.v), edge.frame
    local = np.einsum("nij,nj->ni", edge.frames, edge.forces)
    resultant = edge.forces.sum(axis=0)
    origins = [Frame(point, *own[:2]) for point, own in _listed(edge.points, edge.frames)]
    values = {
        "face_contact": edge.is_face,
        "edge_contact": not edge.is_face and len(edge.points) > 1,
        "point_contact": len(edge.points) == 1,
        "contact_points": edge.points.tolist(),
        "gap": edge.gap.tolist(),
        "status": list(edge.status),
        "force_tangent1": local[:, 0].tolist(),
        "force_tangent2": local[:, 1].tolist(),
        "force_normal": local[:, 2].tolist(),
        "force_vector": edge.forces.tolist(),
        "nodal_force_magnitudes": np.linalg.norm(edge.forces, axis=1).tolist(),
        "resultant_global": resultant.tolist(),
        "resultant_local": (frame @ resultant).tolist(),
        "force_magnitude": float(np.linalg.norm(resultant)),
        "contact_frames": origins,
        "contact_frame": Frame(edge.points.mean(axis=0).tolist(), *frame[:2].tolist()),
    }
    for name, value in (*values.items(), *_geometry(edge, frame).items()):
        results.set_edge(u_v, name, value)


def _geometry(edge: Edge, frame: Array) -> dict[str, Any]:
    """Contact objects of compas_dem, which its viewer draws."""
    from compas.geometry import Frame, Line, Point, Polygon
    from compas_dem.interactions import EdgeContact, FrictionContact, VertexContact

    points = [Point(*point) for point in edge.points.tolist()]
    own = Frame(edge.points.mean(axis=0).tolist(), *frame[:2].tolist())
    forces = [
        {"c_np": max(n, 0.0), "c_nn": max(-n, 0.0), "c_u": first, "c_v": second}
        for first, second, n in (edge.forces @ frame.T).tolist()
    ]
    if edge.is_face:
        contact = FrictionContact(points=points, frame=own, forces=forces)
        found = {"contact_data": contact, "contact_polygon": Polygon(points)}
    elif len(points) > 1:
        contact = EdgeContact(points=points, frame=own, forces=forces)
        found = {"contact_data": contact, "contact_geometry": Line(points[0], points[1])}
    else:
        contact = VertexContact(point=points[0], frame=own, forces=forces)
        found = {"contact_data": contact, "contact_geometry": points[0]}
    return {**found, "force_point": list(contact.resultantpoint)}


def _listed(points: Array, frames: Array) -> list[tuple[list[float], list[list[float]]]]:
    return list(zip(points.tolist(), frames.tolist(), strict=True))


def _unit(vector: Array) -> Array:
    return np.asarray(vector / np.linalg.norm(vector))
