"""All patterns by their names in model files."""

from __future__ import annotations

from drystone.common.registry import Registry
from drystone.model.loading.base import LoadPattern

#: A pattern is a class with the methods of `LoadPattern`, in a file of its own.
PATTERNS: Registry[type[LoadPattern]] = Registry(
    what="load pattern",
    group="drystone.patterns",
    ours={
        "mass": "drystone.model.loading.mass:MassPattern",
        "uniform": "drystone.model.loading.uniform:UniformPattern",
        "triangular": "drystone.model.loading.triangular:TriangularPattern",
        "modal": "drystone.model.loading.modal:ModalPattern",
        "tilt": "drystone.model.loading.tilt:TiltPattern",
        "forces": "drystone.model.loading.forces:ForcesPattern",
        "acceleration": "drystone.model.loading.acceleration:AccelerationPattern",
    },
)
