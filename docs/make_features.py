"""Run every feature in every engine and in limit analysis, and write docs/reference/features.md.

    python docs/make_features.py [--engine NAME ...]

A small wall on a base is pushed for a few steps with one feature at a time, in the plane and in
space, or its base is moved.  What works is a dot, what an engine cannot do are the words with which
it says so.
"""

from __future__ import annotations

import argparse
from pathlib import Path

import drystone as ds
from drystone.engines import engine_names
from drystone.engines.base import EngineError
from drystone.io.modelfile.read import model_from_text
from drystone.limit import ASSOCIATIVE, NON_ASSOCIATIVE

PAGE = Path(__file__).parent / "reference" / "features.md"
WORKS = "●"
TITLES = {2: "In the plane", 3: "In space"}
STEPS = 3  # points after the first: enough for every part of a step to have been asked

HEAD = """# What works where

This page is written by `docs/make_features.py`. The script pushes a small wall on a base for
three steps, or moves its base, with one feature at a time. A dot means that the feature works.
A number leads to the message, below the table, with which drystone refuses the feature. A dot
does not mean that the results are right. The accuracy is the subject of
[verification](verification.md) and of the pages about [loads](../explanation/loads.md),
[ties](../explanation/ties.md), [support displacements](../explanation/settlements.md) and
[joints](../explanation/joints.md).
"""

#: Blocks, by dimension.
BLOCKS = {
    2: """
[[block]]
id = "base"
vertices = [[-1.0, -0.2], [1.0, -0.2], [1.0, 0.0], [-1.0, 0.0]]
support = true
[[block]]
id = "low"
vertices = [[-0.2, 0.0], [0.2, 0.0], [0.2, 0.3], [-0.2, 0.3]]
[[block]]
id = "high"
vertices = [[-0.2, 0.3], [0.2, 0.3], [0.2, 0.6], [-0.2, 0.6]]
""",
    3: """
[[block]]
id = "base"
box = [[-1.0, -1.0, -0.2], [1.0, 1.0, 0.0]]
support = true
[[block]]
id = "low"
box = [[-0.2, -0.3, 0.0], [0.2, 0.3, 0.3]]
[[block]]
id = "high"
box = [[-0.2, -0.3, 0.3], [0.2, 0.3, 0.6]]
""",
}
JOINT = {
    "friction_coefficient": "0.7",
    "normal_stiffness": "1e9",
    "shear_stiffness": "1e9",
}


def vector(x: float, z: float, dimension: int) -> str:
    """A vector in the plane of the load, as in a model file."""
    return str([x, z] if dimension == 2 else [x, 0.0, z])


def text_of(
    dimension: int,
    joint: dict[str, str] | None = None,
    load: str | None = None,
    more: str = "",
    block: str = "",
) -> str:
    """A model file of the wall with more keys of its joint, another load, and other tables.

    With an empty ``load`` there is none; ``block`` are more keys of the highest one.
    """
    law = {**JOINT, **(joint or {})}
    keys = [f"{key} = {value}" for key, value in law.items() if value]
    along = f"direction = {vector(1.0, 0.0, dimension)}"
    given = load if load is not None else f'pattern = "mass"\n{along}'
    lines = [
        f"dimension = {dimension}",
        "thickness = 0.6" if dimension == 2 else "",
        "[material.stone]",
        "unit_weight = 20e3",
        "[joint]",
        *keys,
        f"[load]\n{given}" if given else "",
    ]
    return "\n".join(lines) + BLOCKS[dimension] + block + more


def patterns(dimension: int) -> dict[str, str]:
    """Models, by the pattern of the load."""
    along = f"direction = {vector(1.0, 0.0, dimension)}"
    found = {}
    for name in ("mass", "uniform", "triangular", "modal", "tilt"):
        found[f"pattern `{name}`"] = text_of(dimension, load=f'pattern = "{name}"\n{along}')
    force = f'[[load.force]]\nblock = "high"\nforce = {vector(1e3, 0.0, dimension)}\npoint = "top"'
    found["pattern `forces`"] = text_of(dimension, load=f'pattern = "forces"\n{force}')
    field = f'[[load.acceleration]]\nblock = "high"\nacceleration = {vector(1.0, 0.0, dimension)}'
    found["pattern `acceleration`"] = text_of(dimension, load=f'pattern = "acceleration"\n{field}')
    return found


def dead_loads(dimension: int) -> dict[str, str]:
    """Models, by the dead load."""
    kinds = {
        "force": f'block = "high"\nforce = {vector(0.0, -500.0, dimension)}',
        "surcharge": 'block = "high"\nweight = 500.0',
        "face": f'block = "high"\nside = {vector(0.0, 1.0, dimension)}\n'
        f"pressure = {vector(0.0, -1e3, dimension)}",
        "fill": f'block = "low"\nside = {vector(-1.0, 0.0, dimension)}\nunit_weight = 16e3\n'
        "level = 0.3\nat_rest = 0.5",
    }
    return {
        f"dead load `{kind}`": text_of(
            dimension, more=f'[[dead_load]]\nkind = "{kind}"\nmass = false\n{keys}\n'
        )
        for kind, keys in kinds.items()
    }


def joints(dimension: int) -> dict[str, str]:
    """Models, by the law of their joints."""
    bond = {"cohesion": "2e4", "tensile_strength": "1e4"}
    soft = {**bond, "tensile_fracture_energy": "1.0", "shear_fracture_energy": "5.0"}
    laws = {
        "dilatancy": {"dilatancy_angle": "5.0"},
        "cohesion and tension, brittle": bond,
        "cohesion and tension, softening": soft,
        "residual friction": {"residual_friction_coefficient": "0.5", "residual_slip": "0.01"},
        "crushing": {"compressive_strength": "1e6"},
        "crushing, softening": {
            "compressive_strength": "1e6",
            "compressive_fracture_energy": "5e3",
        },
        "hyperbolic closure": {"greatest_closure": "1e-3"},
        "logarithmic closure": {"logarithmic_closure": "1e-3"},
    }
    found = {f"joint: {name}": text_of(dimension, joint=law) for name, law in laws.items()}
    bare = {"normal_stiffness": "", "shear_stiffness": ""}
    mortar = "[joint.mortar]\nthickness = 0.01\nyoung_modulus = 1e9\nshear_modulus = 4e8\n"
    found["joint: bed of mortar"] = text_of(dimension, joint=bare, more=mortar)
    return found


def supports(dimension: int) -> dict[str, str]:
    """Models, by how supports move, or hold."""
    moves = {
        "settlement": f"direction = {vector(0.0, -1.0, dimension)}\nmax = 0.01",
        "spreading": f"direction = {vector(1.0, 0.0, dimension)}\nmax = 0.01",
        "rotation": f"centre = {vector(-1.0, 0.0, dimension)}\nmax = 1.0"
        + ("\naxis = [0.0, 1.0, 0.0]" if dimension == 3 else ""),
    }
    found = {
        f"supports that move: {name}": text_of(
            dimension, load="", more=f'[settlement]\nblocks = ["base"]\n{keys}\n'
        )
        for name, keys in moves.items()
    }
    found["rollers"] = text_of(dimension, block='held = ["turn"]\n')
    return found


def others(dimension: int) -> dict[str, str]:
    """Models, by what else there is."""
    high, ground = vector(-0.2, 0.5, dimension), vector(-1.0, 0.5, dimension)
    bar = (
        f'from = {{ block = "high", point = {high} }}\n'
        f'to = {{ block = "ground", point = {ground} }}\n'
        "stiffness = 1e7\n"
    )
    chamfer = "[corner]\nchamfer = 0.02\n"
    rounded = "[corner]\nradius = 0.02\n"
    return {
        "corners, chamfered": text_of(dimension, more=chamfer),
        "corners, rounded": text_of(dimension, more=rounded),
        "tie": text_of(dimension, more=f"[[tie]]\n{bar}yield_force = 1e4\ncompression = false\n"),
        "spring": text_of(dimension, more=f"[[spring]]\n{bar}"),
    }


def models(dimension: int) -> dict[str, str]:
    """All models of a dimension, by feature."""
    return {
        **patterns(dimension),
        **dead_loads(dimension),
        **joints(dimension),
        **supports(dimension),
        **others(dimension),
    }


def in_engine(text: str, engine: str) -> str:
    """What an engine says to a model file."""
    model = model_from_text(text, source=None, sha256="")
    try:
        curve = ds.pushover(model, engine=engine, max_steps=STEPS)
    except EngineError as error:
        return str(error)
    return WORKS if len(curve.points) > 1 else curve.reason


def in_limit_analysis(text: str, flow: str) -> str:
    """What limit analysis says to a model file."""
    model = model_from_text(text, source=None, sha256="")
    try:
        found = ds.collapse_load(model, flow=flow)
    except (EngineError, ValueError) as error:
        return str(error)
    return WORKS if found.status == "finished" else found.reason


FLOWS = {f"limit, {flow}": flow for flow in (ASSOCIATIVE, NON_ASSOCIATIVE)}


def said(text: str, column: str) -> str:
    """What an engine, or limit analysis, says to a model file in one line."""
    if column in FLOWS:
        words = in_limit_analysis(text, FLOWS[column])
    else:
        words = in_engine(text, column.strip("`"))
    return " ".join(words.split())


def table(dimension: int, engines: list[str]) -> list[str]:
    """The table of a dimension, in lines."""
    columns = [f"`{name}`" for name in engines] + list(FLOWS)
    lines = [f"| | {' | '.join(columns)} |", "|---" * (len(columns) + 1) + "|"]
    notes: dict[str, int] = {}
    for feature, text in models(dimension).items():
        cells = [
            word if word == WORKS else f"[{notes.setdefault(word, len(notes) + 1)}]"
            for word in (said(text, column) for column in columns)
        ]
        lines.append(f"| {feature} | {' | '.join(cells)} |")
        print(lines[-1], flush=True)
    lines.append("")
    lines += [f"[{number}] {word}  " for word, number in notes.items()]
    return lines


def told(page: str, title: str) -> dict[str, dict[str, str]]:
    """What the page says under a title: by feature and column, a dot or words."""
    part = page.split(f"## {title}\n")[1].split("\n## ")[0].splitlines()
    rows = [[cell.strip() for cell in line.split("|")[1:-1]] for line in part if line[:1] == "|"]
    notes = dict(line.strip().split(" ", 1) for line in part if line[:1] == "[")
    columns = rows[0][1:]
    return {
        row[0]: {
            column: notes.get(cell, cell) for column, cell in zip(columns, row[1:], strict=True)
        }
        for row in rows[2:]
    }


def main() -> None:
    """Run everything and write the page."""
    parser = argparse.ArgumentParser(description=__doc__.split("\n\n")[0])
    parser.add_argument("--engine", action="append", choices=engine_names())
    engines = parser.parse_args().engine or list(engine_names())
    lines = [HEAD]
    for dimension, title in TITLES.items():
        lines += [f"## {title}", "", *table(dimension, engines), ""]
    PAGE.write_text("\n".join(lines).rstrip() + "\n")


if __name__ == "__main__":
    main()
