"""Broken drawings end in a sentence or in blocks: no traceback, no hang, no warning.

``DRYSTONE_DRAWINGS`` says how many of each format are read; one seed, one file.
"""

from __future__ import annotations

import json
import os
import random
import re
import signal
import warnings
from functools import cache

import numpy as np
import pytest
from test_mutations import limited

from drawn import bent_dome, brick_wall, obj_text
from drystone.geometry import GeometryError
from drystone.io.drawings import ImportSettings, Shape, compas, dxf, imported, ply, stl
from drystone.model.assembly import Assembly
from drystone.model.builders import ModelError
from drystone.model.joint_law import JointLaw

N_DRAWINGS = int(os.environ.get("DRYSTONE_DRAWINGS", "200"))
#: Two blocks take a hundredth of it; a busy machine a few times as much.
SECONDS = 30

pytestmark = [
    pytest.mark.slow,
    pytest.mark.skipif(not hasattr(signal, "SIGALRM"), reason="no time limit to be had"),
]

ODD = (
    "0",
    "-1",
    "1",
    "nan",
    "inf",
    "1e308",
    "-1e30",
    "999999999",
    "",
    "abc",
    "1,5",
    "\0",
    "1e-300",
)


@cache
def sound(ending: str) -> str:
    """A small drawing: some bricks with three decimals and two bent blocks."""
    blocks = [*brick_wall(np.random.default_rng(5), noise=4e-4, decimals=3)[:3]]
    blocks += [(n, np.round(v, 3), f) for n, v, f in bent_dome(rings=1)[:2]]
    shapes = [
        Shape(name=n, vertices=v, faces=tuple(f), layer="stone", support=k == 0)
        for k, (n, v, f) in enumerate(blocks)
    ]
    if ending == "obj":
        return obj_text(blocks, decimals=3, twice=True)
    if ending == "dxf":
        pytest.importorskip("ezdxf")
        text = dxf.write(shapes, "a wall", (0.0, 0.0, 1.0))
        return text
    return {"json": compas.write, "ply": ply.write, "stl": stl.write}[ending](shapes, "a wall")


def mutated(ending: str, seed: int) -> bytes:
    """The sound file with one to four things changed in it."""
    draw = random.Random(f"{ending} {seed}")
    text = sound(ending)
    # A third are but drawn badly: what is to be mended, not refused.
    changes = CHANGES if seed % 3 else (_nudged,)
    for _ in range(draw.randint(1, 4)):
        text = changes[draw.randrange(len(changes))](text, draw)
    if seed % 2 and ending == "json":
        return json_changed(sound(ending), draw).encode("utf-8", "replace")
    return text.encode("utf-8", "replace")


def _number(text, draw):
    """A number becomes another one, a digit more, or something odd; most are near the end."""
    places = list(re.finditer(r"-?\d+(\.\d+)?", text))
    if not places:
        return text
    place = places[min(draw.randrange(len(places)), draw.randrange(2 * len(places)))]
    value = draw.choice((*ODD, place[0] + "7", str(float(place[0]) * 1.001), str(-float(place[0]))))
    return text[: place.start()] + value + text[place.end() :]


def _nudged(text, draw):
    """A coordinate is off by a millimetre, a centimetre or a decimetre."""
    places = list(re.finditer(r"-?\d+\.\d+", text))
    place = draw.choice(places)
    value = float(place[0]) + draw.choice((-1, 1)) * 10.0 ** -draw.randint(1, 5)
    return text[: place.start()] + repr(value) + text[place.end() :]


def _line_out(text, draw):
    lines = text.split("\n")
    del lines[draw.randrange(len(lines))]
    return "\n".join(lines)


def _line_twice(text, draw):
    lines = text.split("\n")
    k = draw.randrange(len(lines))
    return "\n".join([*lines[:k], lines[k], *lines[k:]])


def _lines_swapped(text, draw):
    lines = text.split("\n")
    i, j = draw.randrange(len(lines)), draw.randrange(len(lines))
    lines[i], lines[j] = lines[j], lines[i]
    return "\n".join(lines)


def _torn(text, draw):
    return text[: draw.randrange(len(text))]


def _letter(text, draw):
    k = draw.randrange(len(text))
    return text[:k] + chr(draw.randrange(1, 300)) + text[k + 1 :]


def _piece_out(text, draw):
    k = draw.randrange(len(text))
    return text[:k] + text[k + draw.randrange(1, 200) :]


CHANGES = (
    *(_number, _number, _number, _line_out, _line_twice),
    *(_lines_swapped, _torn, _letter, _piece_out),
)


def json_changed(text: str, draw: random.Random) -> str:
    """A valid JSON with values changed, taken out, or put elsewhere."""
    data = json.loads(text)
    places = []

    def walk(value):
        items = value.items() if isinstance(value, dict) else enumerate(value)
        for key, inner in items:
            places.append((value, key))
            if isinstance(inner, dict | list):
                walk(inner)

    walk(data)
    for _ in range(draw.randint(1, 4)):
        holder, key = draw.choice(places)
        new = draw.choice((None, True, -1, 10**30, 1e300, 0, "a", [], {}, [[1]], "nan", 3.7))
        try:
            if draw.random() < 0.3:
                del holder[key]
            else:
                holder[key] = new
        except (KeyError, IndexError):
            pass
    return json.dumps(data)


@pytest.mark.parametrize("ending", ["obj", "dxf", "json", "ply", "stl"])
def test_broken_drawings(tmp_path, ending):
    path = tmp_path / f"a.{ending}"
    law = JointLaw(friction_coefficient=0.6, normal_stiffness=1e9, shear_stiffness=1e9)
    refused = 0
    for seed in range(N_DRAWINGS):
        path.write_bytes(mutated(ending, seed))
        up = "z" if ending in ("obj", "ply", "stl") else None
        settings = ImportSettings(file=path, unit="m", up=up)
        with limited(SECONDS), warnings.catch_warnings():
            warnings.simplefilter("error")
            try:
                made = imported(settings, lambda layer: ("stone", 2e4))
                Assembly.build(made.blocks, joint=law)
            except ModelError as error:
                refused += 1
                assert error.problems, f"seed {seed}"
                assert all("\n" not in problem for problem in error.problems), f"seed {seed}"
                continue
            except GeometryError as error:
                assert 'block "' in str(error), f"seed {seed}"
                continue
            except Exception as error:
                raise AssertionError(f"seed {seed}: {error!r}") from error
        assert all(np.isfinite(block.vertices).all() for block in made.blocks), f"seed {seed}"
    # As many files come through as are refused, about: both cases occur.
    assert 0.1 * N_DRAWINGS < refused < 0.95 * N_DRAWINGS
