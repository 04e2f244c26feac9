"""Walls of laboratories computed, and set beside what was measured.

Each load is computed once by what the reports say, and once for each value that they are silent
about: the least and the greatest of these curves are a band.  Cyclic walls are computed through one
cycle of each of some drifts; the envelope and the energy of a cycle are compared, by its amplitude.
"""

from __future__ import annotations

import os
import statistics
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from drystone.common.arrays import Array
from drystone.common.workers import Call, in_processes
from drystone.laboratory.figures import Figures, amplitude, figures_of, loops_of
from drystone.laboratory.models import SHEAR_SHARES, model_of
from drystone.laboratory.walls import (
    Wall,
    alike,
    crack_map,
    measured,
    series,
    wall_named,
    walls,
)

#: Variants of the model by name; the first is what the reports say.  The last one is of series
#: whose reports do not say whether the beam could turn.
REPORTED, LEVEL = "reported", "beam kept level"
VARIANTS: dict[str, dict[str, Any]] = {
    REPORTED: {},
    "soft in shear": {"shear_share": SHEAR_SHARES[0]},
    "stiff in shear": {"shear_share": SHEAR_SHARES[1]},
    LEVEL: {"level": True},
}

#: Drifts [%] of the cycles of cyclic walls; the last is about the measured end.
CYCLE_DRIFTS = (0.25, 0.5, 1.0, 2.0, 3.2)
#: Points of every computed curve of a band.
BAND_POINTS = 200


@dataclass(frozen=True, kw_only=True)
class Computed:
    """A curve of one variant."""

    displacement: Array  # (n_points,) m
    force: Array  # (n_points,) N
    status: str
    reason: str
    residual: float  # -, largest of all points
    seconds: float
    poses: Array | None = None  # (n_points, n, 3) of all blocks, see `CapacityCurve.poses`


@dataclass(frozen=True, kw_only=True)
class Compared:
    """A wall, measured and computed."""

    wall: Wall
    measured: tuple[Array, Array]  # m, N
    variants: dict[str, Computed]

    @property
    def computed(self) -> Computed:
        """By what the reports say."""
        return self.variants[REPORTED]

    @property
    def crack_map(self) -> bytes | None:
        """The drawing of the wall at the end of its test, in PNG, or None."""
        return crack_map(self.wall)

    @property
    def at_the_end(self) -> tuple[float, Array] | None:
        """Displacement [m] and poses (n, 3) of the computed point that is nearest to the measured
        end; None where poses were not kept."""
        curve = self.computed
        if curve.poses is None:
            return None
        row = int(np.abs(curve.displacement - self.measured[0][-1]).argmin())
        return float(curve.displacement[row]), curve.poses[row]

    def senses(self) -> tuple[float, ...]:
        """Those in which it was pushed."""
        return (1.0, -1.0) if self.wall.cyclic else (1.0,)

    def figures(self, sense: float) -> tuple[Figures, Figures]:
        """Of what was measured, and computed up to the same displacement."""
        found, curve = self.measured, self.computed
        end = float((sense * found[0]).max())
        within = sense * curve.displacement <= end
        return (
            figures_of(self.wall, *found, sense),
            figures_of(self.wall, curve.displacement[within], curve.force[within], sense),
        )

    def band(self, sense: float = 1.0) -> tuple[Array, Array, Array]:
        """Displacements [m], least and greatest force [N] of all variants."""
        from drystone.results.cycles import envelope

        curves = [envelope(c.displacement, c.force, sense) for c in self.variants.values()]
        end = min(float(np.abs(x).max()) for x, _ in curves)
        x = np.linspace(0.0, end, BAND_POINTS)
        y = np.array([np.interp(x, np.abs(a), np.abs(b)) for a, b in curves])
        return sense * x, sense * y.min(axis=0), sense * y.max(axis=0)

    def energies(self) -> list[tuple[float, float, float]]:
        """Amplitude [m], energy measured and computed [J] of each measured cycle within the
        computed amplitudes."""
        own = loops_of(self.computed.displacement, self.computed.force)
        known = sorted((amplitude(c), c.energy) for c in own)
        if not known:
            return []
        a, e = np.array(known).T
        return [
            (amplitude(c), c.energy, float(np.interp(amplitude(c), a, e)))
            for c in loops_of(*self.measured)
            if a[0] <= amplitude(c) <= a[-1]
        ]


#: Drifts [%] between which energies of cycles are counted together.
DRIFT_CLASSES = ((0.0, 0.5), (0.5, 1.5), (1.5, 5.0))


def energy_by_drift(found: Sequence[Compared]) -> list[dict[str, Any]]:
    """Computed over measured energy of cycles, by classes of their drift, see `spread`."""
    values = [
        (one.wall.drift(amplitude), own / measured)
        for one in found
        for amplitude, measured, own in one.energies()
    ]
    classes = []
    for low, high in DRIFT_CLASSES:
        within = spread([ratio for drift, ratio in values if low <= drift < high])
        if within is not None:
            classes.append({"drift_from": low, "drift_to": high, **within})
    return classes


def lacking_compliance(found: Sequence[Compared]) -> list[dict[str, Any]]:
    """By how much the measured wall yields more to its force than the computed one, 1 / K [m/N] at
    the first rise, of all walls of a series under the same vertical force: mean, least and
    greatest."""
    groups: dict[tuple[str, float], list[float]] = {}
    for one in found:
        measured, own = one.figures(1.0)
        group = groups.setdefault((one.wall.series, one.wall.vertical_force), [])
        group.append(1.0 / measured.stiffness - 1.0 / own.stiffness)
    return [
        {
            "series": series,
            "vertical_force": force,
            "n": len(values),
            "mean": statistics.fmean(values),
            "least": min(values),
            "greatest": max(values),
        }
        for (series, force), values in sorted(groups.items())
    ]


def ratios(values: Sequence[float]) -> tuple[float, float]:
    """Mean and coefficient of variation of computed over measured."""
    mean = statistics.fmean(values)
    scatter = statistics.stdev(values) / mean if len(values) > 1 else 0.0
    return mean, scatter


def spread(values: Sequence[float]) -> dict[str, float] | None:
    """Number, median and quartiles; None of no values."""
    if not values:
        return None
    lower, median, upper = np.quantile(values, (0.25, 0.5, 0.75)).tolist()
    return {
        "n": len(values),
        "median": median,
        "lower_quartile": lower,
        "upper_quartile": upper,
    }


def laboratory(
    *,
    names: Sequence[str] = (),
    processes: int | None = None,
    told: Callable[[str, Computed], None] | None = None,
) -> list[Compared]:
    """Compute walls, all where none is named, and set them beside what was measured.

    Parameters
    ----------
    names
        Of walls; `KeyError` for one that there is not.
    processes
        At a time; by default one a processor.
    told
        Is called with the name of a wall and its curve as it comes.
    """
    chosen = [wall_named(name) for name in names] if names else list(walls())
    first = sorted(chosen, key=lambda wall: not wall.cyclic)  # what takes longest
    keys = list(dict.fromkeys(key for wall in first for key in _keys(wall)))
    calls: list[Call] = [(f"{__name__}:computed", key) for key in keys]

    def tell(number: int, curve: Computed) -> None:
        if told is not None:
            told(f"{keys[number][0]}, {keys[number][1]}", curve)

    found = dict(
        zip(keys, in_processes(calls, processes or os.cpu_count() or 1, tell), strict=True)
    )
    return [
        Compared(
            wall=wall,
            measured=measured(wall),
            variants={key[1]: found[key] for key in _keys(wall) if found[key] is not None},
        )
        for wall in chosen
    ]


def _keys(wall: Wall) -> list[tuple[str, str]]:
    """Wall and variant of its curves: of walls that are alike, those of the first."""
    like = next(other for other in walls() if alike(other, wall))
    silent = series()["series"][wall.series]["beam_may_be_level"]
    names = [name for name in VARIANTS if name != LEVEL or silent]
    return [(like.name, name) for name in ([REPORTED] if wall.cyclic else names)]


def computed(name: str, variant: str) -> Computed:
    """The curve of a variant of a wall, as far as any wall like it was pushed."""
    from drystone.analysis.driver import pushover

    wall = wall_named(name)
    same = [other for other in walls() if alike(wall, other)]
    farthest = max(float(np.abs(measured(other)[0]).max()) for other in same)
    history = None
    if wall.cyclic:
        amplitudes = [0.01 * drift * wall.load_height for drift in CYCLE_DRIFTS]
        history = [x for a in amplitudes for x in (a, -a)] + [0.0]
    model = model_of(wall, history=history, farthest=farthest, **VARIANTS[variant])
    begun = time.perf_counter()
    mapped = variant == REPORTED and any(crack_map(other) for other in same)
    curve = pushover(model, keep_poses=mapped, keep_contacts=False)
    return Computed(
        displacement=curve.control_displacement,
        force=curve.load_force * curve.load_multiplier,
        status=curve.status,
        reason=curve.reason,
        residual=float(np.nanmax(curve.residual)),
        poses=curve.poses,
        seconds=time.perf_counter() - begun,
    )
