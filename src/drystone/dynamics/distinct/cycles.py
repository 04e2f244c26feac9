"""Cycles with searches for contacts between them, until all forces balance, a block runs away, or
their number is reached."""

from __future__ import annotations

import numpy as np

from drystone.common.tolerances import BETWEEN_POINTS, BY_ITSELF, MAY_HAVE_LEFT
from drystone.dynamics import explicit
from drystone.dynamics.distinct.arrival import on_the_way
from drystone.dynamics.distinct.search import drop_departed, others_separate, search
from drystone.dynamics.distinct.state import RunAwayError
from drystone.dynamics.distinct.workspace import Workspace
from drystone.engines.base import OVERSHOOT_PARTS
from drystone.engines.measures import LoadArrays
from drystone.model.tie_kernels import PRETENSION

#: Number of parts in which the dead load is applied, so that each part excites little vibration.
RAMP = 100

#: Largest number of cycles in one call, which cannot be interrupted; the same if loads change with
#: the poses.
ROUND, SHORT_ROUND = 1000, 100


def run(
    work: Workspace,
    n_cycles: int,
    *,
    guided: bool = False,
    rate: float = 0.0,
    combined: bool = False,
    tolerance: float = -1.0,
) -> bool:
    """Run cycles with searches between them; whether they ended because all forces balance.

    For the other arguments see `explicit.Drive`.  Raises `RunAwayError`.
    """
    last, steady = work.n_cycles + n_cycles, work.acting.acting.steady
    drive = work.drive(
        keep_bonds=not work.real_masses,
        guided=guided,
        rate=rate,
        combined=combined,
        tolerance=tolerance,
        reach=work.search_reach,
    )
    while work.n_cycles < last:
        if not steady:
            now = work.now
            work.loads = work.loads._replace(dead=now.dead, pattern=now.pattern)
        why = work.cycle(min(last - work.n_cycles, ROUND if steady else SHORT_ROUND), drive)
        if why == explicit.MOVED:
            _note(work)
            _stop_runaways(work)
            search(work)
        elif why == explicit.BALANCED:
            return True
    return False


def _note(work: Workspace) -> None:
    """Store a dynamic state if a block has moved far by itself since the last one."""
    asked, assembly = work.bounds.asked, work.prepared.assembly
    if asked is None:
        return
    work.on_the_way.append(work.multiplier)
    far = np.maximum(
        BETWEEN_POINTS * assembly.extents, 0.0 if work.dynamic_states else BY_ITSELF * asked
    )
    travel = np.where(assembly.fixed, 0.0, work.travel(work.noted))
    if (travel > far).any() and not np.isinf(travel).any():
        work.dynamic_states.append(on_the_way(work))
        work.noted = work.motion.pose.copy()
        work.on_the_way.clear()


def _stop_runaways(work: Workspace) -> None:
    travel, assembly, bounds = work.travel(), work.prepared.assembly, work.bounds
    if bounds.may_lose and MAY_HAVE_LEFT * assembly.smallest_extent < travel.max() < np.inf:
        drop_departed(work)
        travel = work.travel()
    if not travel.max() <= bounds.farthest or np.isinf(travel).any():
        raise RunAwayError(assembly.ids[int(travel.argmax())], travel)


def load_gradually(work: Workspace, before: LoadArrays | None) -> None:
    """Increase the dead load gradually from that ``before`` (None: from zero).  Each part has
    enough cycles for a wave to pass.

    Ties are pretensioned together with the weight.  Before it, they would pull blocks along.
    """
    whole, drawn = work.acting, work.ties.value[:, PRETENSION].copy()
    for part in range(1, RAMP):
        if before is None:
            work.ties.value[:, PRETENSION] = part / RAMP * drawn
        work.acting = whole.scaled(part / RAMP, before)
        work.loads = work.loads._replace(dead=work.acting.dead)
        run(work, max(work.settings.drive_cycles // OVERSHOOT_PARTS, 1))
    work.acting, work.ties.value[:, PRETENSION] = whole, drawn
    work.loads = work.loads._replace(dead=whole.dead)


def relax(work: Workspace, *, guided: bool) -> bool:
    """Run cycles until all forces balance; whether they do.  Raises `RunAwayError`.

    If blocks do not come to rest soon, they jump to another shape, slowly at first.  Local damping
    would hold them back, because they vibrate as well; so damping is then combined.  If the blocks
    rest on faces that no longer separate them most, contacts are searched again, and the blocks
    are relaxed once more.
    """
    if not _relaxed(work, guided=guided):
        return False
    if not others_separate(work):
        return True
    search(work)
    return _relaxed(work, guided=guided)


def _relaxed(work: Workspace, *, guided: bool) -> bool:
    s = work.settings
    if run(work, s.rest_cycles, guided=guided, tolerance=s.tolerance):
        return True
    return run(work, s.jump_cycles, guided=guided, combined=True, tolerance=s.tolerance)
