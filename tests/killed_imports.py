"""What a run imports, for the process that runs to be killed are forked from (`killed`)."""

import importlib
import pkgutil
from itertools import product
from pathlib import Path

import drystone
from drystone.limit import limits_beside

LEFT_OUT = ("drystone.compas", "drystone.io.drawings", "drystone.laboratory", "drystone.viewer")

for module in pkgutil.walk_packages(drystone.__path__, "drystone."):
    if not module.name.startswith(LEFT_OUT) and not module.name.endswith("__main__"):
        importlib.import_module(module.name)

# Kernels are read from where they are kept when they are called first.
EXAMPLES = Path(__file__).parents[1] / "examples"
for name, engine in product(("two_blocks", "solids"), ("equilibrium", "nscd", "distinct")):
    model = drystone.read_model(EXAMPLES / f"{name}.toml").with_analysis(max_points=2)
    drystone.pushover(model, engine=engine, threads=1, progress=False)
    limits_beside(model)
