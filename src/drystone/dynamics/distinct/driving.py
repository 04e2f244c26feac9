"""The drive of the control displacement: from rest, at a constant rate, to a stop."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from drystone.common.tolerances import BY_ITSELF, ONWARDS, SLOWER
from drystone.dynamics import explicit
from drystone.dynamics.distinct.cycles import run
from drystone.dynamics.distinct.state import DistinctState
from drystone.dynamics.distinct.workspace import Workspace
from drystone.engines.base import OVERSHOOT_PARTS

#: Stages in which a driven increment ends, each slower than the one before.
STAGES = 4


class Parts(NamedTuple):
    """The multiplier along a driven increment, in the sense of the increment."""

    share: tuple[float, ...]  # of the increment at which each part begins
    multiplier: tuple[float, ...]  # means over the parts

    @property
    def highest(self) -> float:
        """The highest mean."""
        return max(self.multiplier, default=-np.inf)

    def rise(self, start: float, end: float) -> float | None:
        """The share before a part in which the multiplier rises by more than half of its rise from
        ``start`` to ``end``; None if none does."""
        means = np.array([start, *self.multiplier, end])
        if not end > start:
            return None
        within = means[2:] - means[:-2]  # the mean of a part with a rise tells but a share of it
        steepest = int(np.argmax(within))
        return self.share[steepest] if within[steepest] > 0.5 * (end - start) else None


def drive_on(state: DistinctState, work: Workspace, increment: float) -> Parts:
    """Move on at a constant rate of F.x until the control displacement has advanced by the
    ``increment`` [m], then stop.

    Returns the multiplier along the step.

    The step begins with the motion of the last step, scaled to the rate of this one, so that it
    excites no vibrations.  It ends in stages, each slower than the one before, so that joints go on
    sliding while vibrations fade, and come to rest with fully used friction.
    """
    prepared, s, pose = state.prepared, work.settings, work.motion.pose
    control, assembly = prepared.problem.control_point, prepared.assembly
    begin = control.displacement(assembly, state.pose)
    rate = _start_drive(state, work, increment, begin)
    # Share of the increment at which the first stage begins.
    left = 1.0 - SLOWER / (1.0 - SLOWER) * s.stage_cycles / s.drive_cycles
    way, advanced = 1.0 if increment > 0.0 else -1.0, 0.0
    begun: list[float] = []
    means: list[float] = []
    for _ in range(10 * OVERSHOOT_PARTS):
        begun.append(advanced / increment)
        means.append(way * _part(work, max(s.drive_cycles // OVERSHOOT_PARTS, 1), rate))
        advanced = control.displacement(assembly, pose) - begin
        if advanced / increment > left - 0.5 / OVERSHOOT_PARTS:
            break
        moved = prepared.detector.farthest(assembly.difference(pose, state.pose))
        if moved > BY_ITSELF * abs(increment):
            break  # other blocks move, which the control displacement does not show
    for _ in range(STAGES):
        work.motion.velocity[:] *= SLOWER
        rate *= SLOWER
        run(work, s.stage_cycles, guided=True, rate=rate, combined=True)
    work.motion.velocity[:] = 0.0
    return Parts(tuple(begun), tuple(means))


def _start_drive(state: DistinctState, work: Workspace, increment: float, begin: float) -> float:
    """Set the velocities at the beginning of the drive; returns the corresponding rate of F.x
    [N m/s].

    ``begin`` is the control displacement of the state [m].
    """
    prepared, s, acting, last = state.prepared, work.settings, work.now, state.increment
    control, assembly = prepared.problem.control_point, prepared.assembly
    duration = s.drive_cycles * work.dt
    sense = 1.0 if acting.along @ control.direction >= 0.0 else -1.0
    came = begin - control.displacement(assembly, assembly.moved(state.pose, -last))
    pushed, farthest = float(np.sum(acting.pattern * last)), prepared.detector.farthest(last)
    onwards = came * increment > ONWARDS * farthest * abs(increment)  # more than rounding
    if onwards and pushed * increment * sense > 0.0:
        share = min(increment / came, 2.0 * abs(increment) / farthest) / duration
        work.motion.velocity[:] = share * last
        return share * pushed
    rate = 0.5 * sense * acting.total * increment / duration
    for stage in range(STAGES, 0, -1):  # from rest, begin in stages as well
        run(work, s.stage_cycles, guided=True, rate=rate * SLOWER**stage, combined=True)
        work.motion.velocity[:] /= SLOWER
    return rate


def _part(work: Workspace, n_cycles: int, rate: float) -> float:
    """Run guided cycles; returns their mean multiplier, from the work of the loads."""
    pose, done = work.motion.pose.copy(), float(work.meter[explicit.LOAD_WORK])
    run(work, n_cycles, guided=True, rate=rate, combined=True)
    moved = work.prepared.assembly.difference(work.motion.pose, pose)
    done = float(work.meter[explicit.LOAD_WORK]) - done
    now = work.now
    pushed = float(np.sum(now.pattern * moved))
    return (done - float(np.sum(now.dead * moved))) / pushed if pushed else 0.0
