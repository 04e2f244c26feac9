"""Every number of the packages that compute stands in the register, `common.tolerances`.

A number is a float literal, wherever it stands: in an expression, as a default, as a field of
settings, as a constant of a module.  Exact ones need no reason: they are part of a formula, and
another number would make it another formula.
"""

from __future__ import annotations

import ast
import re
import subprocess
import sys
from pathlib import Path

import pytest

SOURCE = Path(__file__).parents[2] / "src" / "drystone"
REGISTER = SOURCE / "common" / "tolerances.py"

#: Of formulas: shares and multiples; coefficients of series and of integrals over segments,
#: triangles and tetrahedra (1/6, 1/9, 1/12, 1/24, 1/36, 1/48, 1/120); degrees of half a turn.
EXACT = {0.0, 0.25, 0.5, 1.0, 2.0, 3.0, 4.0, 6.0, 9.0, 12.0, 24.0, 36.0, 48.0, 120.0, 180.0}

#: Numbers that still stand elsewhere.  A number here may only fall.
MOST = {
    "contact": 0,
    "control": 0,
    "dynamics": 0,
    "engines": 0,
    "geometry": 0,
    "law": 0,
    "linear": 0,
    "statics": 0,
}

#: How the text of a number says where it is from; see the register.
FROM = re.compile(r"\b(Derived|Range|Convention|Not measured)\b|\b(derived|convention)\b")


def literals(tree: ast.AST) -> list[tuple[int, float]]:
    """Lines and values of the numbers of a module that are not exact."""
    return [
        (node.lineno, node.value)
        for node in ast.walk(tree)
        if isinstance(node, ast.Constant) and type(node.value) is float and node.value not in EXACT
    ]


def outside(package: str) -> list[str]:
    """``file:line: number`` of those of a package."""
    return [
        f"{file.relative_to(SOURCE).as_posix()}:{line}: {value:g}"
        for file in sorted((SOURCE / package).rglob("*.py"))
        for line, value in literals(ast.parse(file.read_text()))
    ]


def entries() -> dict[str, str]:
    """The text above each number of the register, also of several that share one."""
    found, text, last = {}, "", 0
    lines = REGISTER.read_text().splitlines()
    for node in ast.parse(REGISTER.read_text()).body:
        if not isinstance(node, ast.Assign):
            continue
        above = []
        for line in reversed(lines[: node.lineno - 1]):
            if not line.startswith("#:"):
                break
            above.insert(0, line.removeprefix("#:").strip())
        text = " ".join(above) if above else text if node.lineno == last + 1 else ""
        last = node.end_lineno or 0
        name = ast.unparse(node.targets[0])
        assert name not in found, f"{name} stands in the register twice"
        found[name] = text
    return found


@pytest.mark.parametrize("package", MOST)
def test_no_number_stands_outside_the_register(package):
    found = outside(package)
    assert len(found) <= MOST[package], "\n".join(found)


def test_every_number_of_the_register_says_where_it_is_from():
    assert [name for name, text in entries().items() if not FROM.search(text)] == []


def test_every_number_of_the_register_is_used():
    others = "".join(file.read_text() for file in SOURCE.rglob("*.py") if file != REGISTER)
    used = set(re.findall(r"\w+", others))
    own = REGISTER.read_text()
    names = entries()
    assert names
    unused = [name for name in names if name not in used and not re.search(rf"= .*\b{name}\b", own)]
    assert unused == []


@pytest.mark.parametrize(
    ("source", "n"),
    [
        ("near = 1e-9 * size", 1),
        ("class Settings:\n    share: float = 0.02", 1),
        ("def scaled(factor=-0.7): pass", 1),
        ("half = 0.5 * (a + b) - -1.0", 0),
        ("most = 80", 0),
        ("near = ROUNDING * size", 0),
    ],
)
def test_what_counts(source, n):
    assert len(literals(ast.parse(source))) == n


BENCHMARKS = Path(__file__).parents[2] / "benchmarks"


def changed(*arguments: str) -> subprocess.CompletedProcess[str]:
    """What a benchmark with these arguments has of the register."""
    script = (
        f"import sys; sys.path.insert(0, {str(BENCHMARKS)!r}); import os, registered\n"
        "from drystone.common import tolerances\n"
        "from drystone.common.tolerances import DEGENERATE\n"
        "print(DEGENERATE, tolerances.KINK, 'NUMBA_CACHE_DIR' in os.environ)"
    )
    command = [sys.executable, "-c", script, *arguments]
    return subprocess.run(command, capture_output=True, text=True, check=False)


def test_what_follows_from_a_number_that_a_benchmark_changes_follows(monkeypatch):
    """And kernels that have it are compiled apart."""
    monkeypatch.delenv("NUMBA_CACHE_DIR", raising=False)
    assert changed().stdout.split() == ["1e-09", "0.1", "False"]
    assert changed("--set", "tolerances.ROUNDING=2e-9").stdout.split() == ["2e-09", "0.1", "True"]
    assert changed("--set", "tolerances.KINK=0.2").stdout.split() == ["1e-09", "0.2", "False"]
    refused = changed("--set", "tolerances.NONESUCH=1")
    assert refused.returncode == 1 and "NONESUCH" in refused.stderr
