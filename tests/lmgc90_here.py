"""Whether the engine `lmgc90` can be asked for: its package, and LMGC90 itself."""

import importlib.util
from importlib.metadata import entry_points

import pytest

from drystone.engines import ENGINES

PACKAGE = any(entry.name == "lmgc90" for entry in entry_points(group=ENGINES.group))
PROGRAM = importlib.util.find_spec("compas_lmgc90") is not None

needs_lmgc90 = pytest.mark.skipif(
    not (PACKAGE and PROGRAM),
    reason="pip install ./plugins/drystone-lmgc90; pip install --no-deps compas-lmgc90==0.1.11 "
    "(Linux, Python 3.11)",
)
