"""The same model gives the same curve to the last bit: in any process, just compiled or not."""

from __future__ import annotations

import os
import subprocess
import sys
from importlib import import_module
from pathlib import Path

import pytest
from numba.core.dispatcher import Dispatcher

from drystone.common import kernel_cache

KERNELS = kernel_cache.modules()

CURVES = """
import hashlib
import drystone as ds
model = ds.read_model("{model}")
for _ in range(2):
    curve = ds.pushover(model, engine="equilibrium", keep_poses=True)
    print(hashlib.sha256(curve.poses.tobytes()).hexdigest())
"""


@pytest.mark.parametrize("name", KERNELS)
def test_no_kernel_leaves_the_order_of_sums_to_the_compiler(name):
    """Which copy of an inlined function runs depends on whether it came from the disk; copies with
    the same order of sums agree."""
    for kernel in vars(import_module(name)).values():
        if isinstance(kernel, Dispatcher):  # else compilation is switched off
            assert not kernel.targetoptions.get("fastmath", False)


@pytest.mark.slow
def test_compiled_now_or_before_the_curve_is_the_same(tmp_path):
    """The first run's tail was another than that of all later ones: jumps magnify rounding."""
    model = Path(__file__).parents[2] / "examples" / "wall1.toml"
    environment = {**os.environ, "NUMBA_CACHE_DIR": str(tmp_path)}
    digests = []
    for _ in ("compiled", "from the disk"):
        told = subprocess.run(
            [sys.executable, "-c", CURVES.format(model=model)],
            env=environment,
            capture_output=True,
            text=True,
            check=True,
        )
        digests += told.stdout.split()
    assert len(digests) == 4 and len(set(digests)) == 1
