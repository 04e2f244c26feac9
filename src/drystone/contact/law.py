"""Joint laws as the table that the kernels read."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from drystone.assembly import Assembly
from drystone.kernels import joint

Array = NDArray[np.float64]


def law_table(assembly: Assembly) -> Array:
    """One row per joint law, (n_laws, N_LAW); see the columns in `kernels.joint`.

    Raises `ValueError` where a stiffness is missing (a model read for limit analysis only).
    """
    table = np.zeros((len(assembly.laws), joint.N_LAW))
    for row, law in zip(table, assembly.laws, strict=True):
        if law.normal_stiffness is None or law.shear_stiffness is None:
            raise ValueError("[joint] normal_stiffness and shear_stiffness are needed here")
        row[joint.MU] = law.friction_coefficient
        row[joint.KN] = law.normal_stiffness
        row[joint.KS] = law.shear_stiffness
        row[joint.TAN_PSI] = math.tan(math.radians(law.dilatancy_angle))
        row[joint.COHESION] = law.cohesion
        row[joint.TENSION] = law.tensile_strength
        row[joint.DILATANCY_END] = law.dilatancy_end
    return table
