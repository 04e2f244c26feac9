"""The joint law as a map from trial reactions to reactions, their derivatives, branch and slip.

Its arguments are numbers: the normal trial reaction r_n, counted from the tension on (see
`law.limits`), and the size T of the trial shear.  So it holds for one tangential component and for
two.  With shear stiffness k_s, friction mu, lift L = k_n tan psi, cohesion intercept k (the shear
without pressure) and crushing reaction C:

| branch | r_n' | shear |
|---|---|---|
| open | 0 | 0 |
| sticking, or with an intact bond | r_n | T |
| sliding by gamma = (T - k - mu r_n) / (k_s + mu L) | r_n + L gamma | mu r_n' + k |
| torn, sticking or sliding | 0 | T, or k |
| crushed, sticking or sliding | C | T, or mu C + k |

Sliding is non-associative unless tan psi = mu.  Joints that dilate are neither torn nor crushed.
"""

from __future__ import annotations

from drystone.common.compiled import njit
from drystone.common.tolerances import BRANCH_TIE
from drystone.law.branches import (
    BONDED,
    CRUSHED,
    OPEN,
    STICKING,
    TORN,
    WITHIN,
    across_joint,
    along_joint,
    both,
)


@njit(cache=True, error_model="numpy")
def branch_for(rn, shear, ks, mu, lift, intercept, crush, hint, sliding):
    """Branch for trial reactions.

    Parameters
    ----------
    rn, shear
        Normal trial reaction, counted from the tension on, and size of the trial shear [N].
    ks, mu, lift, intercept, crush
        Shear stiffness [N/m], friction, lift [N/m], cohesion intercept [N] and crushing reaction
        [N], which is infinite if the joint is not crushed.
    hint
        The present branch, any but BONDED.  The contact stays in it if another branch fits better
        only by rounding.
    sliding
        The branch if it slides: FORWARD or BACKWARD.
    """
    was = along_joint(hint)
    if not (intercept > 0.0 or rn > crush * (1.0 - BRANCH_TIE)):
        # The slip of a joint that dilates keeps it closed.
        closed = ks * rn + lift * shear
        if closed < 0.0 or (closed == 0.0 and hint != STICKING):
            return OPEN
        over, near = shear - mu * rn, BRANCH_TIE * (shear + mu * abs(rn))
        if abs(over) <= near and (hint == STICKING or hint == sliding):
            return hint
        return STICKING if over <= 0.0 else sliding
    across, normal = WITHIN, rn
    if rn <= 0.0 or (rn <= BRANCH_TIE * intercept and across_joint(hint) == TORN):
        if intercept == 0.0:
            return OPEN
        across, normal = TORN, 0.0
    elif rn > crush * (1.0 + BRANCH_TIE) or (
        rn >= crush * (1.0 - BRANCH_TIE) and across_joint(hint) == CRUSHED
    ):
        across, normal = CRUSHED, crush
    most = mu * normal + intercept
    over, near = shear - most, BRANCH_TIE * (shear + most)
    if abs(over) <= near and (was == STICKING or was == sliding):
        return both(across, was)
    return both(across, STICKING if over <= 0.0 else sliding)


@njit(cache=True, error_model="numpy")
def reactions_in(branch, rn, shear, ks, mu, lift, intercept, crush):
    """Normal reaction, counted from the tension on, and shear [N] in a branch; and the slip [m].

    ``shear`` [N] is the trial shear, positive in the sense of the sliding branch.  The trial
    reactions need not belong to the branch.
    """
    if branch == OPEN:
        return 0.0, 0.0, 0.0
    if branch == STICKING or branch == BONDED:
        return rn, shear, 0.0
    if across_joint(branch) != WITHIN:
        normal = crush if across_joint(branch) == CRUSHED else 0.0
        if along_joint(branch) == STICKING:
            return normal, shear, 0.0
        most = mu * normal + intercept
        return normal, most, (shear - most) / ks
    gamma = (shear - intercept - mu * rn) / (ks + mu * lift)
    rn += lift * gamma
    return rn, mu * rn + intercept, gamma


@njit(cache=True, error_model="numpy")
def derivatives_in(branch, ks, mu, lift):
    """Derivatives of the reactions of `reactions_in` by the trial reactions: of the normal reaction
    by the normal and by the shear, then of the shear by both."""
    if branch == OPEN:
        return 0.0, 0.0, 0.0, 0.0
    if branch == STICKING or branch == BONDED:
        return 1.0, 0.0, 0.0, 1.0
    if across_joint(branch) != WITHIN:
        return 0.0, 0.0, 0.0, 1.0 if along_joint(branch) == STICKING else 0.0
    raised = lift / (ks + mu * lift)
    nn = 1.0 - raised * mu
    return nn, raised, mu * nn, mu * raised
