"""Parts of a structure in space that fall to where they rest.

On the way of a step a stone may lose its hold: it rocks over its edge, or drops onto the one below.
No equilibrium then lies beside where it stood, and the search for one goes nowhere, although all
but that stone is balanced.  The stone and what it touches are followed alone, with all around them
standing still: held back by so much inertia that each step is a small one, they go on until they
rest.  As a part is small, that costs next to nothing; then the whole is balanced again.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from drystone.statics.space.cone_search import Attempt, ConeSearch


@dataclass(frozen=True, kw_only=True)
class FallSettings:
    """Numbers of falls."""

    #: Damping [1/s2] that says that something has lost its hold, how often it may in an attempt.
    damping: float = 3e3
    times: int = 6
    #: What falls: what has a negative pivot, and so much of the largest unbalanced force; rings of
    #: neighbours around it.
    loose: float = 0.5
    rings: int = 2
    #: How hard it is held at first, over that damping; factor of more where a step fails, and of
    #: less where it took few iterations; the hold [1/s2] at which it is given up.
    hold: float = 4.0
    more: float = 4.0
    less: float = 0.5
    easy: int = 4
    most_hold: float = 1e8
    #: How far it may go, over the smallest block, and with how many iterations, as dear as those of
    #: the whole.
    room: float = 0.1
    effort: float = 12.0
    #: Of each step: iterations of Newton's method, and by how much it must gain in how many; the
    #: barrier of the interior, and its iterations.
    newton: int = 6
    gain: float = 3.0
    patience: int = 3
    barrier: float = 1e-4
    interior: int = 30
    #: The same where it is let go.
    free_gain: float = 10.0
    free_patience: int = 2


def come_to_rest(
    search: ConeSearch, attempt: Attempt, settings: FallSettings, hold: float, most: float
) -> bool:
    """Go on to an equilibrium, be it far, with blocks held back in each step by ``hold`` [1/s2]
    times their mass, less as far as that goes.

    Returned is whether one is found within about ``most`` iterations; the step of the search is
    there then.  ``attempt`` says how a step is solved that Newton's method does not.
    """
    step, s = search.step, settings
    here, start = step.place, step.x.copy()
    detector = step.constants.detector
    room = s.room * detector.assembly.smallest_extent
    while search.iterations < most:
        before = search.iterations
        step.anchor(hold)
        found = search.newton(s.newton, patience=s.patience, gain=s.gain)
        if not found:
            step.come_back(here)
            found = search.interior(attempt)
        step.anchor(0.0)
        if found:
            if detector.farthest(step.x - start) > room:
                return False
            here = step.place
            if _stays(search, s):
                return True
            if search.iterations - before <= s.easy:
                hold *= s.less
        else:
            hold *= s.more
        step.come_back(here)
        if hold > s.most_hold:
            return False
    return False


def _stays(search: ConeSearch, settings: FallSettings) -> bool:
    """Whether there is an equilibrium near that the blocks would not leave again."""
    s, step = settings, search.step
    if not search.newton(s.newton, patience=s.free_patience, gain=s.free_gain):
        return False
    search.iterations += 1
    return step.factorise(step.reaction, 0.0) and bool(step.frame.sign[0] > 0.0)
