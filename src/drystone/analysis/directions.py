"""A structure pushed in several directions: both senses, or all around."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from drystone.common.arrays import Array
from drystone.common.progress import counted
from drystone.common.threads import available
from drystone.common.workers import in_processes
from drystone.engines.base import EngineError
from drystone.model.model import Model
from drystone.results.curve import CapacityCurve, CurvePoint

if TYPE_CHECKING:
    from matplotlib.axes import Axes

#: Most directions: every degree.
MOST = 360


@dataclass(frozen=True, kw_only=True, eq=False)
class Polar:
    """Curves of a model along several directions."""

    angles: tuple[float, ...]  # degrees about the upright axis, from the model's own direction
    directions: Array  # (n, dim) unit vectors
    curves: tuple[CapacityCurve | None, ...]  # None where interrupted before

    @property
    def peaks(self) -> Array:
        """Highest multiplier of each curve, (n,); nan where there is none."""
        return self._multipliers(lambda curve: curve.peak)

    @property
    def capacities(self) -> Array:
        """Highest multiplier of each curve before a part of the structure collapses, (n,); nan
        where there is none."""
        return self._multipliers(lambda curve: curve.capacity)

    def _multipliers(self, of: Callable[[CapacityCurve], CurvePoint]) -> Array:
        """Of a point of each curve, (n,)."""
        return np.array(
            [of(c).load_multiplier if c is not None and c.points else np.nan for c in self.curves]
        )

    @property
    def weakest(self) -> int:
        """Row of the direction with the lowest of the `capacities`."""
        return int(np.nanargmin(self.capacities))

    def plot(self, ax: Axes | None = None) -> Axes:
        """Draw the `capacities` on polar axes, those of a new figure by default; of two directions
        the curves on plain ones."""
        from drystone.report.plots import plot_polar

        return plot_polar(self, ax)


def polar(
    model: Model,
    n: int | Sequence[float] = 24,
    *,
    engine: str | None = None,
    strategy: str | None = None,
    processes: int | None = None,
    progress: bool | None = None,
    **options: Any,
) -> Polar:
    """Capacity curves along directions around a structure, in parallel.

    Parameters
    ----------
    model
        Its load is the first direction. The control point and its direction follow the load.
    n
        Number of directions, at equal angles; in the plane 2, both senses. Or a list of angles
        [degrees].
    engine, strategy, options
        As of `pushover`; the engine by its name.
    processes
        Number of processes at a time, by default one for each processor; each has one thread.
    progress
        Whether a bar counts the directions; by default on a terminal and in a notebook.

    Raises
    ------
    EngineError
        The model has no such directions, or an engine cannot do what is asked.
    """
    angles = tuple(map(float, n)) if not isinstance(n, int) else evenly(model, n)
    models = around(model, angles)
    calls = [(f"{__name__}:curve_of", (each, engine, strategy, dict(options))) for each in models]
    with counted(model.title or "polar", len(calls), progress) as told:
        curves = in_processes(calls, processes or available(), told)
    return Polar(
        angles=angles,
        directions=np.array([each.load_along for each in models]),
        curves=tuple(curves),
    )


def around(model: Model, angles: Sequence[float]) -> list[Model]:
    """The model pushed in directions turned by angles [degrees], see `towards`.

    In space, where it is pushed in more than both senses, another part of it may fall in each: a
    control point that the model leaves open is then where the mechanism of limit analysis moves
    fastest along the load.
    """
    from drystone.limit import watched
    from drystone.model.construction.vary import control_beside_default

    if model.settlement is not None:
        raise EngineError("directions: supports move, and no load grows")
    models = [towards(model, angle) for angle in angles]
    given = control_beside_default(model)
    if (
        model.assembly.kind.angles is not None
        or len(angles) == 2
        or any(v is not None for v in given.values())
    ):
        return models
    return [watched(each) for each in models]


def curve_of(
    model: Model, engine: str | None, strategy: str | None, options: dict[str, Any]
) -> CapacityCurve:
    """One curve, as a worker traces it."""
    from drystone.analysis.driver import pushover

    return pushover(
        model, engine=engine, strategy=strategy, keep_poses=False, keep_contacts=False, threads=1,
        progress=False, **options,
    )  # fmt: skip


def evenly(model: Model, n: int) -> tuple[float, ...]:
    """Angles [degrees] of so many directions; raises `EngineError`."""
    if not 2 <= n <= MOST:
        raise EngineError(f"directions: must be from 2 to {MOST}, it is {n}")
    if n > len(model.assembly.kind.angles or range(MOST)):
        raise EngineError(f"directions: a plane model has two, both senses, and not {n}")
    return tuple(360.0 * k / n for k in range(n))


def towards(model: Model, angle: float) -> Model:
    """The model pushed in a direction turned by an angle [degrees] about the upright axis.

    Raises
    ------
    EngineError
        The load has no direction of its own, and the angle is not half a turn.
    """
    if angle == 0.0:
        return model
    if angle not in (model.assembly.kind.angles or (angle,)):
        raise EngineError(f"directions: a plane model has 0 and 180 degrees, and not {angle:g}")
    rotation = _rotation(model.assembly.up, angle)
    if angle == 180.0:
        load = model.load.opposite(model.assembly)
    else:
        try:
            load = model.load.towards(rotation @ model.load_along)
        except ValueError as error:
            raise EngineError(f"directions: {error}, or take both senses") from None
    from drystone.model.construction.vary import control_beside_default, remade

    control = control_beside_default(model)
    if control["control_direction"] is not None:
        control["control_direction"] = rotation @ np.asarray(control["control_direction"])
    return remade(model, load=load, **control)


def _rotation(up: Array, angle: float) -> Array:
    """Rotation about the upright axis; in the plane half a turn about it."""
    dim, upright = len(up), np.outer(up, up)
    if angle == 180.0:
        return np.asarray(2.0 * upright - np.eye(dim))
    cosine, sine = np.cos(np.radians(angle)), np.sin(np.radians(angle))
    cross = np.cross(np.eye(3), up)
    return np.asarray(upright + cosine * (np.eye(3) - upright) + sine * cross)
