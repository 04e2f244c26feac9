"""Joint laws as the table that the kernels read."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from drystone.law import law as joint_law
from drystone.law.strengths import yielding_row
from drystone.model.assembly import Assembly, JointLaw

Array = NDArray[np.float64]


def law_table(assembly: Assembly, *, shear: bool = True) -> Array:
    """One row per joint law, (n_laws, N_LAW); see the columns in `law.law`.

    Raises `ValueError` where a stiffness is missing (a model read for limit analysis only); that in
    ``shear`` is not asked for by a formulation without it.
    """
    keys = ("normal_stiffness", "shear_stiffness") if shear else ("normal_stiffness",)
    table = np.zeros((len(assembly.laws), joint_law.N_LAW))
    for row, law in zip(table, assembly.laws, strict=True):
        if any(getattr(law, key) is None for key in keys):
            raise ValueError(f"[joint] {' and '.join(keys)} {'are' if shear else 'is'} needed here")
        row[joint_law.MU] = law.friction_coefficient
        row[joint_law.KN] = law.normal_stiffness
        row[joint_law.KS] = law.shear_stiffness if shear else 0.0
        row[joint_law.TAN_PSI] = math.tan(math.radians(law.dilatancy_angle))
        if not law.softens:
            row[joint_law.COHESION] = law.cohesion
            row[joint_law.TENSION] = law.tensile_strength
        row[joint_law.DILATANCY_END] = law.dilatancy_end
        if law.yields:
            row[joint_law.YIELDS :] = _yielding(law)
    return table


def _yielding(law: JointLaw) -> tuple[float, ...]:
    """Columns from `law.law.YIELDS` on."""
    row = yielding_row(law)
    return (
        1.0, row.cohesion, row.tension, row.by_opening, row.by_slip, row.residual, row.per_slip,
        row.crush, row.by_crushing,
    )  # fmt: skip
