"""Broken models: those of a user's slip, and worse.

One seed, one model: a good one with one to three things changed in it, the same on every machine.
"""

from __future__ import annotations

import copy
import json
import tomllib
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
from numpy.random import Generator

EXAMPLES = Path(__file__).parents[2] / "examples"

#: In place of any value.
ODD = (
    *(0, -1, 1, 1e-300, 1e-200, -1e-9, 1e-6, 1e3, 1e6, 1e9, 1e30, 1e200, 1e308, 10**400),
    *(True, "", "0.1", "nan", "1,5", "$a_$", "\x1b[31m", "a\0b", [], [1.0], [[0, 0]], {}, {"a": 1}),
)
#: Factors of a number: units mistaken, and values at the rim.
FACTORS = (-1.0, 1e-9, 1e-6, 1e-3, 1e-2, 0.5, 1.0 + 1e-9, 2.0, 1e2, 1e3, 1e6, 1e9)

Path_ = tuple[str | int, ...]


def model(seed: int) -> str:
    """The JSON text of a seed's model."""
    rng = np.random.default_rng(seed)
    data = copy.deepcopy(SOUND[seed % len(SOUND)])
    for _ in range(int(rng.integers(1, 4))):
        MUTATIONS[int(rng.integers(len(MUTATIONS)))](data, rng)
    return json.dumps(data)


def _places(data: Any, path: Path_ = ()) -> list[Path_]:
    """Paths of everything in nested tables and lists."""
    pairs = data.items() if isinstance(data, dict) else enumerate(data)
    found: list[Path_] = []
    for key, value in pairs:
        found.append((*path, key))
        if isinstance(value, dict | list):
            found += _places(value, (*path, key))
    return found


def _at(data: Any, path: Path_) -> Any:
    for key in path:
        data = data[key]
    return data


def _any(data: Any, rng: Generator, fits: Callable[[Any], bool] = lambda _: True) -> Path_ | None:
    """One of the places whose value fits; shallow ones as often as the many coordinates."""
    places = [path for path in _places(data) if fits(_at(data, path))]
    depths = sorted({len(path) for path in places})
    if not places:
        return None
    depth = depths[int(rng.integers(len(depths)))]
    fitting = [path for path in places if len(path) == depth]
    return fitting[int(rng.integers(len(fitting)))]


def odd_value(data: Any, rng: Generator) -> None:
    """Anything in place of a value."""
    path = _any(data, rng, lambda value: not isinstance(value, dict))
    if path:
        _at(data, path[:-1])[path[-1]] = copy.deepcopy(ODD[int(rng.integers(len(ODD)))])


def other_number(data: Any, rng: Generator) -> None:
    """A number times a factor."""
    path = _any(data, rng, lambda x: type(x) in (int, float) and abs(x) < 1e300)
    if path:
        factor = FACTORS[int(rng.integers(len(FACTORS)))]
        _at(data, path[:-1])[path[-1]] = float(_at(data, path)) * factor


def other_unit(data: Any, rng: Generator) -> None:
    """All coordinates in another unit, the rest as it was."""
    factor = (1e-3, 1e-2, 1e2, 1e3)[int(rng.integers(4))]
    for block in _blocks(data):
        vertices = block.get("vertices")
        if _is_outline(vertices):
            block["vertices"] = (factor * np.array(vertices)).tolist()


def key_removed(data: Any, rng: Generator) -> None:
    """Without a key or an entry."""
    path = _any(data, rng)
    if path:
        del _at(data, path[:-1])[path[-1]]


def key_renamed(data: Any, rng: Generator) -> None:
    """A key with a letter too many."""
    path = _any(data, rng)
    if path and isinstance(path[-1], str):
        holder = _at(data, path[:-1])
        holder[path[-1] + "x"] = holder.pop(path[-1])


def entry_twice(data: Any, rng: Generator) -> None:
    """A block, a vertex or a course twice."""
    path = _any(data, rng, lambda value: isinstance(value, list) and len(value) > 0)
    if path:
        entries = _at(data, path)
        k = int(rng.integers(len(entries)))
        entries.insert(k, copy.deepcopy(entries[k]))


def vertices_shuffled(data: Any, rng: Generator) -> None:
    """The outline of a block in another order."""
    block = _block(data, rng)
    if block:
        block["vertices"] = [block["vertices"][k] for k in rng.permutation(len(block["vertices"]))]


def vertex_moved(data: Any, rng: Generator) -> None:
    """A vertex by as little as rounding, or by as much as the block."""
    block = _block(data, rng)
    if block:
        vertex = block["vertices"][int(rng.integers(len(block["vertices"])))]
        vertex[int(rng.integers(2))] += float(10.0 ** rng.uniform(-16, 0) * rng.choice([-1, 1]))


def block_moved(data: Any, rng: Generator) -> None:
    """A block into another, or away from all."""
    block = _block(data, rng)
    if block:
        move = 10.0 ** rng.uniform(-12, 1) * rng.normal(size=2)
        block["vertices"] = (np.array(block["vertices"]) + move).tolist()


def odd_course(data: Any, rng: Generator) -> None:
    """A course of other letters."""
    wall = data.get("wall")
    if isinstance(wall, dict) and isinstance(wall.get("courses"), list):
        letters = rng.choice(list("1h. x2"), size=int(rng.integers(0, 9)))
        wall["courses"].append("".join(letters))


def setting(data: Any, rng: Generator) -> None:
    """A setting of the analysis at or beyond the rim of its range."""
    names = ("increment", "overshoot", "patience", "displacement_step", "time_step", "max_steps")
    if isinstance(data.get("analysis"), dict):
        value = float(10.0 ** rng.uniform(-12, 9))
        data["analysis"][names[int(rng.integers(len(names)))]] = value
        if rng.random() < 0.3:
            data["analysis"]["strategy"] = "published"


MUTATIONS = (
    *(odd_value, other_number, other_number, other_unit, key_removed, key_renamed, entry_twice),
    *(vertices_shuffled, vertex_moved, block_moved, odd_course, setting),
)


def _blocks(data: Any) -> list[dict[str, Any]]:
    blocks = data.get("block")
    return [b for b in blocks if isinstance(b, dict)] if isinstance(blocks, list) else []


def _is_outline(vertices: Any) -> bool:
    return (
        isinstance(vertices, list)
        and len(vertices) > 0
        and all(
            isinstance(v, list)
            and len(v) == 2
            and all(type(x) in (int, float) and abs(x) < 1e300 for x in v)
            for v in vertices
        )
    )


def _block(data: Any, rng: Generator) -> dict[str, Any] | None:
    blocks = [block for block in _blocks(data) if _is_outline(block.get("vertices"))]
    return blocks[int(rng.integers(len(blocks)))] if blocks else None


def _two_blocks() -> dict[str, Any]:
    return tomllib.loads((EXAMPLES / "two_blocks.toml").read_text(encoding="utf-8"))


def _wall() -> dict[str, Any]:
    wall = {"unit": [0.4, 0.2], "courses": ["h11", "11h"], "base": True}
    return {
        **{k: v for k, v in _two_blocks().items() if k not in ("block", "control")},
        "wall": wall,
    }


def _cohesive() -> dict[str, Any]:
    """Two stones, with a law between them."""
    data = _two_blocks()
    data["joint"] |= {"dilatancy_angle": 5.0, "dilatancy_end": 0.01}
    data["material"]["brick"] = {"density": 1800.0}
    for block in data["block"]:
        block["material"] = "brick" if block.get("support") else next(iter(data["material"]))
    pair = " ".join(data["material"])
    data["joint"]["between"] = {pair: {"cohesion": 1e3, "tensile_strength": 1e2}}
    return data


SOUND = (_two_blocks(), _wall(), _cohesive())
