"""Numbers of the register for one run: ``--set tolerances.NAME=VALUE`` on a command line.

To be called before anything of drystone is imported but its name: modules take the numbers when
they are imported, and kernels when they are compiled.  What follows from a number that is changed
follows.  Where kernels have such numbers, they are compiled anew, into a folder of their own.
"""

from __future__ import annotations

import ast
import hashlib
import os
import re
import sys
import tempfile
from collections.abc import Mapping, Sequence
from importlib.util import find_spec, module_from_spec
from itertools import pairwise
from pathlib import Path
from types import ModuleType

REGISTER = "drystone.common.tolerances"
PREFIX = "tolerances."


def asked(arguments: Sequence[str]) -> dict[str, float]:
    """The numbers that a command line asks for, by name."""
    texts = [b for a, b in pairwise(arguments) if a == "--set"]
    texts += [a.removeprefix("--set=") for a in arguments if a.startswith("--set=")]
    pairs = [text.removeprefix(PREFIX).split("=") for text in texts if text.startswith(PREFIX)]
    return {name: float(value) for name, value in pairs}


def change(numbers: Mapping[str, float]) -> None:
    """Make the register have these numbers, and kernels that have them be compiled apart."""
    if not numbers:
        return
    spec = find_spec(REGISTER)
    if spec is None or spec.origin is None:
        raise SystemExit(f"there is no {REGISTER}")
    tree = ast.parse(Path(spec.origin).read_text())
    as_written = module_from_spec(spec)
    exec(compile(tree, spec.origin, "exec"), vars(as_written))
    lines = {ast.unparse(n.targets[0]): n for n in tree.body if isinstance(n, ast.Assign)}
    for name, value in numbers.items():
        if name not in lines:
            raise SystemExit(f"there is no number {name} in {spec.origin}")
        lines[name].value = ast.copy_location(ast.Constant(value), lines[name].value)
    register = module_from_spec(spec)
    exec(compile(ast.fix_missing_locations(tree), spec.origin, "exec"), vars(register))
    sys.modules[REGISTER] = register
    sys.modules[REGISTER.rpartition(".")[0]].tolerances = register  # type: ignore[attr-defined]
    others = [n for n in lines if getattr(register, n) != getattr(as_written, n)]
    if in_kernels(others, Path(spec.origin).parents[1]):
        os.environ["NUMBA_CACHE_DIR"] = str(_folder(others, register))


def in_kernels(names: Sequence[str], package: Path) -> bool:
    """Whether a file with kernels names one of these numbers."""
    named = re.compile(r"\b(" + "|".join(names) + r")\b") if names else None
    texts = (file.read_text() for file in package.rglob("*.py"))
    return named is not None and any(
        "compiled import njit" in text and named.search(text) for text in texts
    )


def _folder(names: Sequence[str], register: ModuleType) -> Path:
    text = ";".join(f"{name}={getattr(register, name)!r}" for name in names)
    digest = hashlib.sha256(text.encode()).hexdigest()[:16]
    folder = Path(tempfile.gettempdir()) / f"drystone-numbers-{os.getuid()}" / digest
    folder.mkdir(parents=True, exist_ok=True, mode=0o700)
    return folder


change(asked(sys.argv))
