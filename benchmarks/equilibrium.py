"""What the equilibrium engine shows on the published walls, in one table.

    python benchmarks/equilibrium.py [--wall N ...] [--repeats N]

Certificates, refinement, other engines, limit analysis and time, the latter against a floor: as
many factorisations and solutions of a tangent of the curve as it has points.  Writes
``results/equilibrium.json`` and ``.md``.
"""

from __future__ import annotations

import argparse
from dataclasses import dataclass, replace
from typing import Any

import harness  # first: it holds the libraries' threads to one
import numpy as np
from scipy.sparse import csc_matrix
from scipy.sparse.linalg import splu

import drystone as ds
from drystone.common.arrays import Array, BoolArray
from drystone.linear import numeric as lu_numeric
from drystone.model.assembly import Assembly
from drystone.results.curve import DYNAMIC, CapacityCurve
from drystone.statics.equilibrium import EquilibriumEngine
from drystone.statics.plane.plane_step import PlaneStep

#: Normal stiffnesses whose peaks are set against limit analysis [Pa/m].
STIFFNESSES = (1e7, 1e8, 1e9, 1e10, 1e11)

#: Fine displacement per step of the first-order engine [m].
NSCD_STEP = 5e-4


@dataclass(frozen=True, kw_only=True)
class Figures:
    """One wall; curves are apart by a share of the peak or of the end, whichever is more."""

    wall: int
    points: int
    dynamic_points: int
    peak: float
    end: float  # m
    largest_residual: float  # of the heaviest block's weight, static points
    largest_inertia: float  # of the applied force, static points
    halved_median: float  # distance from the curve of half the increments
    halved_largest: float
    nscd_median: float  # difference of multipliers from that engine's curve
    nscd_fine_median: float  # with steps of NSCD_STEP
    limit: float  # first-order multiplier with contact points set back
    peaks: tuple[float, ...]  # for STIFFNESSES
    seconds: float
    superlu: float  # s, of one factorisation and solution
    own: float

    @property
    def ratios(self) -> tuple[float, float]:
        """Time of the curve over that of as many factorisations: SuperLU's, and our own."""
        return self.seconds / (self.points * self.superlu), self.seconds / (self.points * self.own)


def static(curve: CapacityCurve) -> BoolArray:
    return np.array([p.status != DYNAMIC for p in curve.points])


def distances(curve: CapacityCurve, reference: CapacityCurve) -> Array:
    """Distance of each static point of a curve from another curve, the axes made dimensionless."""
    scale = np.array([reference.control_displacement.max(), reference.peak.load_multiplier])
    p = np.column_stack((curve.control_displacement, curve.load_multiplier))[static(curve)] / scale
    q = np.column_stack((reference.control_displacement, reference.load_multiplier)) / scale
    a, d = q[:-1], np.diff(q, axis=0)
    share = ((p[:, None] - a) * d).sum(axis=2) / np.maximum((d**2).sum(axis=1), 1e-300)
    nearest = a + np.clip(share, 0.0, 1.0)[..., None] * d
    return np.abs(p[:, None] - nearest).max(axis=2).min(axis=1)


def difference(curve: CapacityCurve, other: CapacityCurve) -> float:
    """Median difference of multipliers at the same displacement, up to near the curve's end."""
    up_to = 0.95 * (curve.ultimate_displacement or 0.0)
    at = np.linspace(0.01 * up_to, up_to, 400)
    ours, theirs = (
        np.interp(at, c.control_displacement, c.load_multiplier) for c in (curve, other)
    )
    return float(np.median(np.abs(ours - theirs)))


def with_stiffness(model: ds.Model, normal: float) -> ds.Model:
    """The same model with joints of another stiffness, the shear stiffness a thousand times it."""
    assembly = model.assembly
    joint = replace(assembly.joint, normal_stiffness=normal, shear_stiffness=1000.0 * normal)
    again = Assembly.build(
        list(assembly.blocks), joint=joint, corner=assembly.corner, thickness=assembly.thickness
    )
    return replace(model, assembly=again)


def one_solution(model: ds.Model) -> tuple[float, float]:
    """Seconds of a factorisation and solution of a tangent of the curve, by SuperLU and by us."""
    caught: list[tuple[PlaneStep, list[Array]]] = []
    walk = PlaneStep.walk

    def spy(self: PlaneStep, *arguments: Any, **options: Any) -> tuple[int, float, int]:
        done = walk(self, *arguments, **options)
        caught.append((self, [block.copy() for block in self.tangent]))
        return done

    PlaneStep.walk = spy
    try:
        ds.pushover(model, engine=EquilibriumEngine(), max_displacement=0.05)
    finally:
        PlaneStep.walk = walk
    step, (diagonal, upper, lower) = caught[-1]
    n, n_dof = step.loads.mass.shape
    full = np.zeros((n, n_dof, n, n_dof))
    full[np.arange(n), :, np.arange(n), :] = diagonal
    for k, (a, b) in enumerate(zip(step.pairs.a, step.pairs.b, strict=True)):
        full[a, :, b, :] = upper[k]
        full[b, :, a, :] = lower[k]
    free = np.repeat(~step.loads.fixed, n_dof)
    matrix = csc_matrix(full.reshape(n * n_dof, -1)[free][:, free])
    right = np.ones((matrix.shape[0], 2))
    fields = np.ones((2, n, n_dof))

    def own() -> None:
        lu_numeric.factorise(
            step.structure, diagonal, upper, lower, step.factors, step.loads.mass, step.damping, 0.0
        )
        lu_numeric.solve(step.structure, step.factors, fields)

    superlu = harness.median_seconds(lambda: splu(matrix).solve(right), 301)
    return superlu, harness.median_seconds(own, 301)


def figures(wall: int, repeats: int) -> Figures:
    model = ds.published_wall(wall)
    curves: list[CapacityCurve] = []
    seconds = harness.median_seconds(
        lambda: curves.append(ds.pushover(model, progress=False)), repeats
    )
    curve = curves[-1]
    step = EquilibriumEngine().preferred_steps(model.assembly).displacement_step
    apart = distances(curve, ds.pushover(model, displacement_step=0.5 * step))
    nscd = ds.pushover(model, engine="nscd")
    fine = ds.pushover(model, engine="nscd", displacement_step=NSCD_STEP)
    limit = ds.collapse_load(model, flow="non-associative").load_multiplier
    peaks = tuple(
        ds.pushover(with_stiffness(model, k), max_displacement=0.1).peak.load_multiplier
        for k in STIFFNESSES
    )
    certain = [p for p in curve.points if p.status != DYNAMIC]
    superlu, own = one_solution(model)
    return Figures(
        wall=wall,
        points=len(curve.points),
        dynamic_points=len(curve.points) - len(certain),
        peak=curve.peak.load_multiplier,
        end=curve.ultimate_displacement or float("nan"),
        largest_residual=max(p.residual for p in certain),
        largest_inertia=max(p.inertia_ratio for p in certain if p.load_multiplier > 0.0),
        halved_median=float(np.median(apart)),
        halved_largest=float(apart.max()),
        nscd_median=difference(curve, nscd),
        nscd_fine_median=difference(curve, fine),
        limit=limit,
        peaks=peaks,
        seconds=seconds,
        superlu=superlu,
        own=own,
    )


def rows(found: list[Figures]) -> list[dict[str, str]]:
    lines = {
        "points, of them dynamic": lambda f: f"{f.points}, {f.dynamic_points}",
        "peak multiplier": lambda f: f"{f.peak:.4f}",
        "end [m]": lambda f: f"{f.end:.3f}",
        "largest residual": lambda f: f"{f.largest_residual:.0e}",
        "largest inertia": lambda f: f"{f.largest_inertia:.0e}",
        "increments halved: median, largest": (
            lambda f: f"{f.halved_median:.0e}, {f.halved_largest:.1e}"
        ),
        "from nscd: median": lambda f: f"{f.nscd_median:.4f}",
        "from nscd with steps of 0.5 mm": lambda f: f"{f.nscd_fine_median:.4f}",
        "limit analysis, set back": lambda f: f"{f.limit:.5f}",
        **{
            f"peak with k_n = {k:.0e} Pa/m": (lambda f, i=i: f"{f.peaks[i]:.5f}")
            for i, k in enumerate(STIFFNESSES)
        },
        "seconds": lambda f: f"{f.seconds:.3f}",
        "over SuperLU's, over our solutions": (lambda f: f"{f.ratios[0]:.1f}, {f.ratios[1]:.0f}"),
    }
    return [
        {"": name, **{f"wall {f.wall}": text(f) for f in found}} for name, text in lines.items()
    ]


def main() -> None:
    """Measure, print and write."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--wall", action="append", type=int, choices=(1, 2, 3))
    parser.add_argument("--repeats", type=int, default=7)
    options = parser.parse_args()
    found = [figures(wall, options.repeats) for wall in options.wall or (1, 2, 3)]
    notes = (
        "Residual over the heaviest block's weight, inertia over the applied force, both of static "
        "points.\nHalved: distance of the static points from the curve of half the increments, "
        "displacements over the\nend, multipliers over the peak. Seconds: median of "
        f"{options.repeats} warm runs; below, over as many factorisations\nand solutions as the "
        "curve has points."
    )
    harness.write(
        "equilibrium",
        "The equilibrium engine on the published walls",
        notes,
        {"figures": found},
        harness.table(rows(found)),
    )


if __name__ == "__main__":
    main()
