"""What a static step is expected to lead to, from the steps before it."""

from __future__ import annotations

import numpy as np

from drystone.common.arrays import Array
from drystone.engines.base import Demand
from drystone.geometry import motion
from drystone.model.assembly import crushes
from drystone.statics.equations import PointDisplacement
from drystone.statics.solution import StepStart
from drystone.statics.state import EquilibriumState


def prescribed_by(state: EquilibriumState, demand: Demand) -> PointDisplacement | None:
    """The control displacement of a step; None if it has none."""
    if demand.increment is None:
        return None
    control = state.prepared.problem.control_point
    designed = control.point - state.prepared.assembly.centroid[control.block]
    return PointDisplacement(
        body=control.block,
        arm=motion.rotated_vector(designed, state.pose[control.block]),
        axis=control.direction,
        axes=_axes_of(state, control.block),
        increment=demand.increment,
    )


def _axes_of(state: EquilibriumState, block: int) -> Array:
    """Principal axes of a block in the pose of a state, (dim, dim) in columns; in the plane as
    designed, because they are not used there."""
    designed: Array = state.prepared.assembly.axes[block]
    if len(designed) == 2:
        return designed
    turned = motion.rotated(designed.T, np.repeat(state.pose[block, None], len(designed), axis=0))
    return np.ascontiguousarray(turned.T)


def predicted(
    state: EquilibriumState, demand: Demand, prescribed: PointDisplacement | None
) -> tuple[Array, float]:
    """The increments (n, n_dof) that the step is expected to have, and the multiplier at its
    start.

    The last increments, rotated with the blocks, are continued if they had the same sense.
    """
    if demand.settlement is not None:
        return _follow_supports(state, demand.settlement), 0.0
    if prescribed is None:
        assert demand.multiplier is not None
        return state.prepared.assembly.no_motion(), demand.multiplier
    moved = prescribed.increment - prescribed.missing(state.last_increment)
    if moved * prescribed.increment <= 0.0:
        return state.prepared.assembly.no_motion(), state.multiplier
    share = prescribed.increment / moved
    guess = share * state.last_increment
    if guess.shape[1] == 6:
        return guess, state.multiplier
    way = motion.translations(guess)
    way[:] = motion.rotated(way, 0.5 * (1.0 + share) * state.last_increment)
    return guess, state.multiplier


def _follow_supports(state: EquilibriumState, amount: float) -> Array:
    """The last increments (n, n_dof), in proportion to the ``amount`` by which supports move
    [m or rad]; zeros if they did not move in the last step."""
    if not state.last_support_motion:
        return state.prepared.assembly.no_motion()
    return amount / state.last_support_motion * state.last_increment


def curvature_of(
    before: Array | None, after: Array | None, increment: float | None
) -> Array | None:
    """Change of the tangent in a step, (n, n_dof) per m2 of the control displacement."""
    if before is None or after is None or not increment:
        return None
    return (after - before) / increment


def along_curve(state: EquilibriumState, demand: Demand, guess: Array) -> Array | None:
    """The increments (n, n_dof) of a step along the curve; None if they are not known.

    They follow the tangent.  If supports move, they are those of the last step, which are the
    ``guess`` (n, n_dof).
    """
    if demand.increment and state.tangent is not None:
        return demand.increment * state.tangent
    return guess if demand.settlement and state.last_support_motion else None


def begins(
    state: EquilibriumState,
    multiplier: float,
    increment: float | None,
    guess: Array,
    along: Array | None,
) -> StepStart:
    """Where a step from a state begins.

    It may end near the ``guess`` (n, n_dof), near ``along`` (n, n_dof) if the tangent is known, and
    near a parabola if the curvature is known too.
    """
    guesses = [guess]
    if along is not None and increment is not None:
        guesses.append(along)
        if state.curvature is not None:
            guesses.append(along + 0.5 * increment**2 * state.curvature)
    return StepStart(
        guesses=guesses,
        along=along,
        multiplier=multiplier,
        reaction=state.reaction,
        slope=np.nan if state.softened else state.slope,
        unstable=state.unstable,
        # A crushed joint is stiffer as soon as it unloads: a mode of the tangent holds in one sense
        # only.
        may_leave=not crushes(state.prepared.assembly.laws),
        in_vain=state.in_vain,
    )
