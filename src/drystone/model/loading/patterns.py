"""All patterns by their names in model files."""

from __future__ import annotations

from drystone.model.loading.acceleration import AccelerationPattern
from drystone.model.loading.base import Directed
from drystone.model.loading.forces import ForcesPattern
from drystone.model.loading.mass import MassPattern
from drystone.model.loading.modal import ModalPattern
from drystone.model.loading.tilt import TiltPattern
from drystone.model.loading.triangular import TriangularPattern
from drystone.model.loading.uniform import UniformPattern

#: Patterns along one direction.
DIRECTED: dict[str, type[Directed]] = {
    kind.name: kind
    for kind in (MassPattern, UniformPattern, TriangularPattern, ModalPattern, TiltPattern)
}
#: Patterns of entries, each with directions of their own.
LISTED = {kind.name: kind for kind in (ForcesPattern, AccelerationPattern)}

PATTERNS = (*DIRECTED, *LISTED)
