"""Which of a problem's boundary conditions grows, and under which gravity."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from drystone.common.errors import ModelError
from drystone.model.assembly import GRAVITY

#: Lists of a `BoundaryConditionGroup` that hold what acts.
KINDS = ("body_forces", "point_loads", "surface_loads", "displacements")


def group_name(problem: Any, group: Any) -> str:
    """What messages call a boundary condition."""
    number = next(k for k, one in enumerate(problem.boundary_conditions) if one is group)
    return f'boundary condition "{group.name}"' if group.name else f"boundary condition {number}"


def gravity_of(problem: Any) -> float:
    """Acceleration of gravity [m/s2]; raises `ModelError` where groups have different ones."""
    values = {float(group.g) for group in problem.boundary_conditions}
    if len(values) > 1:
        found = ", ".join(f"{value:g}" for value in sorted(values))
        raise ModelError(
            [f"gravity: the boundary conditions have different ones ({found} m/s2): give one"]
        )
    gravity = values.pop() if values else GRAVITY
    if not gravity > 0.0:
        raise ModelError(
            [f"gravity: is {gravity:g} m/s2: drystone's structures stand under weight that pulls"]
        )
    return gravity


def growing_group(problem: Any, load: Any, direction: Sequence[float] | None) -> Any:
    """The boundary condition that the multiplier scales; None where masses are pushed."""
    groups = problem.boundary_conditions
    if direction is not None:
        if load is not None:
            raise ModelError(["load and direction: give one of the two, both push"])
        return None
    if load is not None:
        return _named(problem, load)
    acting = [group for group in groups if any(getattr(group, kind) for kind in KINDS)]
    if not acting:
        raise ModelError(
            [
                "boundary conditions: none holds a load: give solve a direction=(1.0, 0.0, 0.0) to "
                "push masses along, or add loads"
            ]
        )
    if len(acting) > 1:
        names = ", ".join(f'"{group.name}"' for group in acting)
        raise ModelError(
            [f"boundary conditions: say which of {names} grows, as in load={acting[-1].name!r}"]
        )
    return acting[0]


def _named(problem: Any, load: Any) -> Any:
    groups = problem.boundary_conditions
    for number, group in enumerate(groups):
        same_name = isinstance(load, str) and group.name == load
        same_number = isinstance(load, int) and not isinstance(load, bool) and load == number
        if group is load or same_name or same_number:
            return group
    names = ", ".join(f'"{group.name}"' for group in groups) or "none"
    raise ModelError([f"load: there is no boundary condition {load!r}: the problem has {names}"])
