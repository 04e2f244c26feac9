"""Places above geometry, narrow phase and joint law that ask whether a model is of the plane.

A place asks where what is done depends on which of the two dimensions it is.  Counted are, by the
syntax tree, with a *number of the dimension* being a name or an attribute called ``dim``,
``dimension``, ``n_dof``, ``n_pose`` or ``nd``, the length of such a tuple as ``dof``, and the last
or second entry of an array's ``shape``:

- a comparison of a number of the dimension with 2, 3, 6 or 7, or with the length of `IN_PLANE` or
  `IN_SPACE`; whether an array's ``ndim`` is some number,
- a table of answers: ``TABLE[dimension]`` or ``TABLE.get(dimension)``, its name in capitals,
- differences and quotients of a number of the dimension and 2, 3, 6 or 7 (``dim - 2``; not
  ``dim - 1``, nor ``2 * n_dof``, which is of two bodies),
- `isinstance` with a class of outlines or solids, or of the steps of the plane or of space,
- a truth value that says it: a name or an attribute in a condition that is called ``in_plane``,
  ``in_space``, ``of_plane``, ``of_space``, ``is_plane``, ``is_space``, ``plane``, ``space``,
  ``flat`` or ``solid``, where it was not assigned from a comparison in the same function, which is
  counted by itself.

Not counted: lengths.  ``np.zeros((n, dim))``, "must have {dimension} entries" and a refusal of an
array whose shape is not as wanted do the same in both.  Of geometry, of the narrow phase and the
law, and of the folders ``plane/`` and ``space/``, nothing is counted: they are what knows it.
"""

from __future__ import annotations

import ast
from pathlib import Path

import pytest

SOURCE = Path(__file__).parents[2] / "src" / "drystone"

#: Who knows the dimension.
KNOWS = ("geometry", "law", "contact/plane", "contact/space", "dynamics/plane", "dynamics/space")

NUMBERS = {"dim", "_dim", "dimension", "n_dof", "n_pose", "nd", "n_coordinates"}
OF_EITHER = {2, 3, 6, 7}
WORDS = {
    "in_plane", "in_space", "of_plane", "of_space", "is_plane", "is_space", "plane", "space",
    "flat", "solid",
}  # fmt: skip
TUPLES = {"IN_PLANE", "IN_SPACE"}
CLASSES = {"Solid", "Outline", "Polygon", "Polyhedra", "SolidCore", "ConeStep", "ConeEquations"}


def _name(node: ast.AST) -> str:
    """The last part of a name or of an attribute."""
    return getattr(node, "attr", None) or getattr(node, "id", "")


def _is_number(node: ast.AST) -> bool:
    """Whether it is a number of the dimension."""
    if _name(node) in NUMBERS:
        return True
    if isinstance(node, ast.Subscript) and _name(node.value) == "shape":
        return ast.unparse(node.slice) in ("1", "-1")
    if isinstance(node, ast.Call) and _name(node.func) == "len" and node.args:
        return _name(node.args[0]) in {"dof", "pose", "motion", "vector", "normal", "spin"}
    return False


def _is_either(node: ast.AST) -> bool:
    """Whether it is a number that one of the dimensions has."""
    if isinstance(node, ast.Constant):
        return type(node.value) is int and node.value in OF_EITHER
    if isinstance(node, ast.Call) and _name(node.func) == "len" and node.args:
        return _name(node.args[0]) in TUPLES
    return _name(node) in TUPLES or _name(node).startswith("N_VALUES")


def asks(tree: ast.AST) -> list[int]:
    """Lines of the places in a module."""
    found = []
    answered = {
        _name(target)
        for node in ast.walk(tree)
        if isinstance(node, ast.Assign) and isinstance(node.value, ast.Compare)
        for target in node.targets
    }
    for node in ast.walk(tree):
        if isinstance(node, ast.Compare):
            sides = [node.left, *node.comparators]
            same = not isinstance(node.ops[0], ast.NotEq)
            shape = any(_name(getattr(s, "value", s)) == "shape" for s in sides)
            if any(_name(s) == "ndim" for s in sides):
                found += [node.lineno] * same
            elif any(map(_is_number, sides)) and any(map(_is_either, sides)):
                found += [node.lineno] * (same or not shape)
        elif isinstance(node, ast.BinOp) and isinstance(node.op, (ast.Sub, ast.FloorDiv, ast.Mod)):
            sides = [node.left, node.right]
            if any(map(_is_number, sides)) and any(map(_is_either, sides)):
                found.append(node.lineno)
        elif isinstance(node, ast.Subscript):
            if _name(node.value).isupper() and _is_number(node.slice):
                found.append(node.lineno)
        elif isinstance(node, ast.Call):
            called = _name(node.func)
            if called == "isinstance" and any(_name(n) in CLASSES for n in ast.walk(node.args[1])):
                found.append(node.lineno)
            if called == "get" and _name(node.func.value).isupper() and _is_number(node.args[0]):
                found.append(node.lineno)
        if isinstance(node, (ast.If, ast.IfExp, ast.While, ast.comprehension)):
            tests = node.ifs if isinstance(node, ast.comprehension) else [node.test]
            for test in tests:
                found += [
                    part.lineno for part in _conditions(test) if _name(part) in WORDS - answered
                ]
    return sorted(found)


def _conditions(test: ast.AST) -> list[ast.AST]:
    """What a condition is made of by and, or and not."""
    if isinstance(test, ast.BoolOp):
        return [part for value in test.values for part in _conditions(value)]
    if isinstance(test, ast.UnaryOp):
        return _conditions(test.operand)
    return [test]


def places() -> list[str]:
    """``file:line`` of every place."""
    found = []
    for file in sorted(SOURCE.rglob("*.py")):
        name = file.relative_to(SOURCE).as_posix()
        if not name.startswith(KNOWS):
            found += [f"{name}:{line}" for line in asks(ast.parse(file.read_text()))]
    return found


#: What equations of a static step are made of: there a step of the plane is another than in space.
STATICS = ("statics/", "engines/tie_forces.py")

#: Counted now, of these and of all others; in brackets at the start of the count.  A number here
#: may only fall.
MOST = {"statics": 10, "all others": 59}  # (17, 172)


def test_dimension_is_asked_for_in_no_more_places():
    found = places()
    counted = {"statics": 0, "all others": 0}
    for place in found:
        counted["statics" if place.startswith(STATICS) else "all others"] += 1
    assert all(counted[margin] <= most for margin, most in MOST.items()), "\n".join(found)


@pytest.mark.parametrize(
    ("source", "n"),
    [
        ("if assembly.dimension == 2: pass", 1),
        ("kind = A if corners.shape[1] == 2 else B", 1),
        ("most = MOST_BLOCKS[model.assembly.dimension]", 1),
        ("width = dim - 2", 1),
        ("if isinstance(packed, Polyhedra): pass", 1),
        ("if drawing.in_plane and not done: pass", 1),
        ("solid = assembly.dimension == 3\nif solid: pass", 1),
        ("field = np.zeros((n, assembly.dimension - 1))", 0),
        ("if given.shape != (assembly.dimension,): pass", 0),
        ("rows = np.zeros((n, 2 * dim - 1, 2 * n_dof))", 0),
    ],
)
def test_what_counts(source, n):
    assert len(asks(ast.parse(source))) == n
