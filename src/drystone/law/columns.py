"""Columns of the tables of the joint law: of laws and of histories."""

from __future__ import annotations

#: Columns of the history of a contact: dilation less closure by crushing [m]; slip so far [m]; 1 if
#: the bond is broken; softening of the bond; inelastic opening [m]; and shear [N], one column for
#: each tangent.
DILATION, SLID, BROKEN, SOFTENED, OPENED, SHEAR = 0, 1, 2, 3, 4, 5


N_HISTORY = 6  # in the plane


#: Columns of the table of joint laws: mu; k_n, k_s [Pa/m]; tan psi; c, f_t [Pa] of brittle bonds;
#: slip at which dilatancy ends [m].
MU, KN, KS, TAN_PSI, COHESION, TENSION, DILATANCY_END = 0, 1, 2, 3, 4, 5, 6


#: For laws that yield: 1; c, f_t [Pa]; softening per opening and per slip [1/m]; residual mu, and
#: its rate per slip [1/m]; f_c [Pa], and its rate per crushing [1/m]; 1 if friction softens with
#: the bond.
YIELDS, COHESIVE, PULLS, BY_OPENING, BY_SLIP, LEAST_MU, PER_SLIP, CRUSHES, BY_CRUSHING = range(
    7, 16
)


SOFTENS = 16


N_LAW = 17


#: Columns that are multiplied by the area of a contact.
PER_AREA = (KN, KS, COHESION, TENSION, COHESIVE, PULLS, CRUSHES)
