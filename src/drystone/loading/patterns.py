"""All patterns by their names in model files."""

from __future__ import annotations

from drystone.loading.acceleration import AccelerationPattern
from drystone.loading.base import Directed
from drystone.loading.forces import ForcesPattern
from drystone.loading.mass import MassPattern
from drystone.loading.modal import ModalPattern
from drystone.loading.tilt import TiltPattern
from drystone.loading.triangular import TriangularPattern
from drystone.loading.uniform import UniformPattern

#: Patterns along one direction.
DIRECTED: dict[str, type[Directed]] = {
    kind.name: kind
    for kind in (MassPattern, UniformPattern, TriangularPattern, ModalPattern, TiltPattern)
}
#: Patterns of entries, each with directions of their own.
LISTED = {kind.name: kind for kind in (ForcesPattern, AccelerationPattern)}

PATTERNS = (*DIRECTED, *LISTED)
