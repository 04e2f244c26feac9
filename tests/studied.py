"""Studies for tests: functions in place of a wall, and what two studies have in common."""

from __future__ import annotations

import os
import subprocess
import sys
import textwrap
from pathlib import Path

import pandas as pd

#: What a model file begins with: all but blocks and load.
HEAD = """
title = "Wall"
dimension = 2
thickness = 1.0
[material.stone]
unit_weight = 10e3
[joint]
friction_coefficient = 0.65
normal_stiffness = 1e8
shear_stiffness = 1e11
"""

#: The same, with a support that is 2 m long.
BASE = (
    HEAD
    + """
[[block]]
id = "base"
vertices = [[-1.0, -0.2], [1.0, -0.2], [1.0, 0.0], [-1.0, 0.0]]
support = true
"""
)

#: Functions that a study file names; some tests let them take their time.
FUNCTIONS = """
import math, os, time

def wave(x):
    time.sleep(float(os.environ.get("WAVE_SECONDS", "0")))
    return {"y": math.sin(3.0 * x["a"]) + (x["seed"] % 1000) / 1000.0, "z": x["a"] ** 2}

def ishigami(x):
    a, b, c = (x[k] for k in ("a", "b", "c"))
    return {"y": math.sin(a) + 7.0 * math.sin(b) ** 2 + 0.1 * c**4 * math.sin(a)}

def linear(x):
    return {"y": 3.0 * x["a"] + 1.0 * x["b"] + 0.0 * x["c"]}

def sometimes(x):
    if x["a"] > 0.75:
        raise ValueError("too much")
    return {"y": x["a"]}

def dies(x):
    if 0.5 < x["a"] < 0.55:
        os._exit(9)
    return {"y": x["a"]}

def line(x):
    return {"y": 2.0 * x["a"] + x.get("b", 0.0)}

def cube(x):
    return {"y": x["a"] ** 3}

def step(x):
    return {"y": 5.0 * (x["a"] >= 4.0)}

def noisy(x):
    return {"y": x["a"] * (x["seed"] % 2**20) / 2**20}

def capacity(x):
    return {"capacity": x["a"]}

def demand(x):
    return {"demand": x["im"] ** 1.2 * x["noise"]}
"""


def written(folder: Path, text: str, name: str = "study.toml") -> Path:
    """A study file beside the functions, in a folder."""
    (folder / "functions_of_tests.py").write_text(FUNCTIONS)
    path = folder / name
    path.write_text(textwrap.dedent(text).replace("FUNCTIONS", "functions_of_tests"))
    return path


def command(*arguments: object, **environment: str) -> subprocess.Popen[str]:
    """``drystone study`` in a process of its own."""
    code = "from drystone.cli import main; main()"
    return subprocess.Popen(
        [sys.executable, "-c", code, "study", *map(str, arguments)],
        env={**os.environ, **environment},
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
    )


def rows(folder: Path) -> pd.DataFrame:
    """Samples of a finished study, but for how long each has taken."""
    return pd.read_parquet(folder / "samples.parquet").drop(columns="seconds")


def assert_same(one: Path, other: Path) -> None:
    """Two studies have the same samples and curves, bit for bit."""
    pd.testing.assert_frame_equal(rows(one), rows(other), check_exact=True)
    if (one / "curves.parquet").exists() or (other / "curves.parquet").exists():
        curves = [pd.read_parquet(folder / "curves.parquet") for folder in (one, other)]
        pd.testing.assert_frame_equal(*curves, check_exact=True)
