"""Joint laws as a table for kernels."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from drystone.common.arrays import Array
from drystone.law.columns import (
    COHESION,
    DILATANCY_END,
    KN,
    KS,
    MU,
    N_LAW,
    TAN_PSI,
    TENSION,
    YIELDS,
)
from drystone.model.assembly import Assembly
from drystone.model.joint_law import JointLaw


def law_table(assembly: Assembly, *, shear: bool = True) -> Array:
    """One row per joint law, (n_laws, N_LAW); see `law.columns`.

    Raises `ValueError` if a stiffness is missing, as in a model that was read for limit analysis
    only.  Formulations without shear stiffness do not need it: they pass ``shear=False``.
    """
    keys = ("normal_stiffness", "shear_stiffness") if shear else ("normal_stiffness",)
    table = np.zeros((len(assembly.laws), N_LAW))
    for row, law in zip(table, assembly.laws, strict=True):
        if any(getattr(law, key) is None for key in keys):
            raise ValueError(f"[joint] {' and '.join(keys)} {'are' if shear else 'is'} needed here")
        row[MU] = law.friction_coefficient
        row[KN] = law.normal_stiffness
        row[KS] = law.shear_stiffness if shear else 0.0
        row[TAN_PSI] = math.tan(math.radians(law.dilatancy_angle))
        if not law.softens:
            row[COHESION] = law.cohesion
            row[TENSION] = law.tensile_strength
        row[DILATANCY_END] = assembly.dilatancy_end(law) if law.dilatancy_angle > 0.0 else math.inf
        if law.yields:
            row[YIELDS:] = _yielding(law)
    return table


def _yielding(law: JointLaw) -> tuple[float, ...]:
    """Columns from `law.columns.YIELDS` on."""
    row = yielding_row(law)
    return (
        1.0, row.cohesion, row.tension, row.by_opening, row.by_slip, row.residual, row.per_slip,
        row.crush, row.by_crushing, float(law.softens),
    )  # fmt: skip


class Row(NamedTuple):
    """The parameters of a law that yields: strengths [Pa], those of bonds only if they soften;
    rates [1/m]."""

    mu: float
    residual: float
    per_slip: float
    kn: float  # Pa/m
    cohesion: float
    tension: float
    by_opening: float
    by_slip: float
    crush: float
    by_crushing: float
    closure: float  # m
    log_closure: float  # m


def yielding_row(law: JointLaw) -> Row:
    """The numbers of a law; the tensile strength is that of its cone at most."""
    mu, residual = law.friction_coefficient, law.residual_friction_coefficient
    cohesion, tension = (law.cohesion, law.tensile_strength) if law.softens else (0.0, 0.0)
    tension = min(tension, cohesion / mu) if mu > 0.0 else tension
    return Row(
        mu=mu,
        residual=mu if residual is None else residual,
        per_slip=0.0 if law.residual_slip is None else 1.0 / law.residual_slip,
        kn=law.normal_stiffness or 0.0,
        cohesion=cohesion,
        tension=tension,
        by_opening=_over(tension, law.tensile_fracture_energy),
        by_slip=_over(cohesion, law.shear_fracture_energy),
        crush=law.compressive_strength,
        by_crushing=_over(law.compressive_strength, law.compressive_fracture_energy),
        closure=law.greatest_closure,
        log_closure=law.logarithmic_closure,
    )


def _over(strength: float, energy: float | None) -> float:
    return 0.0 if energy is None else strength / energy
