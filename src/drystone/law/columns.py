"""Columns of the tables of the joint law: of laws and of histories."""

from __future__ import annotations

#: Columns of the history of a contact: dilation, less what crushed it [m], slid distance [m],
#: broken bond, how far its bond has softened, what it was torn open by [m], and shear [N], one for
#: each tangent.
DILATION, SLID, BROKEN, SOFTENED, OPENED, SHEAR = 0, 1, 2, 3, 4, 5


N_HISTORY = 6  # in the plane


#: Columns of the table of joint laws: mu, k_n, k_s [Pa/m], tan psi, c, f_t [Pa] of brittle bonds,
#: slide at which dilatancy ends [m].
MU, KN, KS, TAN_PSI, COHESION, TENSION, DILATANCY_END = 0, 1, 2, 3, 4, 5, 6


#: Of laws that yield: 1, c, f_t, what they soften by opening and by slip [1/m], mu in the end, how
#: it falls by slip [1/m], f_c [Pa] and how that falls by crushing [1/m], 1 where friction falls
#: with the bond.
YIELDS, COHESIVE, PULLS, BY_OPENING, BY_SLIP, LEAST_MU, PER_SLIP, CRUSHES, BY_CRUSHING = range(
    7, 16
)


SOFTENS = 16


N_LAW = 17


#: Those that contacts have times their area, in newtons.
PER_AREA = (KN, KS, COHESION, TENSION, COHESIVE, PULLS, CRUSHES)
