"""Functions stay short: a screen of lines, and as many arguments as one keeps in mind."""

import ast
import re
from pathlib import Path

import pytest

import drystone
from drystone.common import kernel_cache

SOURCE = Path(drystone.__file__).parent
KERNELS = kernel_cache.sources()
#: Lines of a function, its docstring included; kernels run a whole phase per call.
MOST_LINES, MOST_LINES_OF_KERNELS = 60, 100
MOST_ARGUMENTS = 12
#: Above a function's decorators, or behind its ``def``: why it is longer, or takes more.
REASON = re.compile(r"#:? (Long|Many)\b.{12,}")


def too_large(text, most_lines):
    """Names of the functions over the limits that do not say why."""
    lines = text.splitlines()
    found = set()
    for node in ast.walk(ast.parse(text)):
        if not isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef):
            continue
        first = min([node.lineno, *(d.lineno for d in node.decorator_list)])
        arguments = node.args.posonlyargs + node.args.args + node.args.kwonlyargs
        long = node.end_lineno - node.lineno + 1 > most_lines
        reasons = (lines[first - 2] if first > 1 else "", lines[node.lineno - 1])
        if (long or len(arguments) > MOST_ARGUMENTS) and not any(map(REASON.search, reasons)):
            found.add(node.name)
    return found


@pytest.mark.parametrize("path", sorted(SOURCE.rglob("*.py")), ids=lambda p: p.stem)
def test_functions_are_short_or_say_why_not(path):
    kernel = path in KERNELS
    found = too_large(path.read_text(), MOST_LINES_OF_KERNELS if kernel else MOST_LINES)
    assert not found, "name their parts, or say why they are so (Long ..., Many ...)"


def test_what_is_too_large_and_what_is_not():
    body = "    pass\n" * 3
    many = ", ".join(f"a{i}" for i in range(MOST_ARGUMENTS + 1))
    reason = "Long by what it lists, which has no parts.\n"
    assert too_large(f"def f():\n{body}", 3) == {"f"}
    assert too_large(f"def f():\n{body}", 4) == set()
    assert too_large(f"def f({many}):\n{body}", 4) == {"f"}
    assert too_large(f"# {reason}@g\ndef f():\n{body}", 3) == set()
    assert too_large(f"def f():  # {reason}{body}", 3) == set()
    assert too_large(f"# Some function.\ndef f():\n{body}", 3) == {"f"}
    assert too_large(f"class C:\n    def f(self):\n{body.replace('    ', ' ' * 8)}", 3) == {"f"}
