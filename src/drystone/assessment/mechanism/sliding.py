"""Whether a mechanism slides: what of the work of its load friction takes.

Where blocks rock, the load lifts their weight, and the multiplier falls as they lean.  Where they
slide, friction takes the work, and the multiplier stays until they fall off what bears them.
"""

from __future__ import annotations

from itertools import pairwise

from drystone.assessment.mechanism.field import VelocityField, chord
from drystone.assessment.mechanism.shapes import activation_row
from drystone.common.arrays import Array
from drystone.model.assembly import crushes
from drystone.model.loading import Acting
from drystone.model.loading.dead_forces import DeadForces
from drystone.model.model import Model
from drystone.results.curve import STATIC, CapacityCurve


def share_of_friction(curve: CapacityCurve, model: Model) -> float | None:
    """Share of the work of the load that lifts no weight, from the start to the first jump, to the
    end, or to where the structure bears more than at its first peak.

    None where ties, springs or crushing take part of it, or the load does no work.  What bonds take
    before they break, and joints store, is next to nothing.
    """
    if model.ties or crushes(model.assembly.laws) or curve.poses is None:
        return None
    top = curve.points[activation_row(curve)]
    acting = Acting.of(model.assembly, model.load, model.dead_loads, model.ties)
    dead = acting.dead if acting.tilted is None else acting.dead + acting.tilted
    done, lifted = 0.0, 0.0
    for before, after in pairwise(curve.points):
        higher = after.step > top.step and after.load_multiplier > top.load_multiplier
        if after.status != STATIC or after.jumped or higher:
            break
        poses = curve.poses[before.step], curve.poses[after.step]
        field = chord(model.assembly, *poses)
        mean = 0.5 * (before.load_multiplier + after.load_multiplier)
        done += mean * _work(acting.pattern, field, poses)
        lifted -= _work(dead, field, poses)
    # Dead loads may work along with the load, as earth does behind a wall: friction takes it all.
    return 1.0 - max(lifted, 0.0) / done if done > 0.0 else None


def _work(forces: DeadForces, field: VelocityField, poses: tuple[Array, Array]) -> float:
    """Of forces on all blocks along the chord between two poses (n, n_pose) [J]."""
    turning = 0.5 * (forces.moments(poses[0]) + forces.moments(poses[1]))
    return float((forces.force * field.velocity).sum() + (turning * field.spin).sum())
