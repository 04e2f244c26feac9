"""Tables [[build]] with numbers that mean nothing: a sentence or blocks, no traceback, no hang."""

from __future__ import annotations

import json
import os
import random
import tomllib
import warnings
from pathlib import Path

import pytest

from drystone.io.modelfile import read_model
from drystone.model.builders import ModelError

EXAMPLES = Path(__file__).resolve().parents[2] / "examples" / "builders"
N_MODELS = int(os.environ.get("DRYSTONE_BUILDS", "120"))
VALUES = (0, -1, 1, 2, 3, 7, 1e-9, 1e9, 0.1, 0.25, 1.0, 2.5, True, "", "x", None, [], {}, [1.0])
FACTORS = (0.0, -1.0, 0.5, 0.99, 1.0001, 1.01, 2.0, 3.7, 10.0)


def places(node, path=()):
    """Paths of everything in nested lists and tables."""
    found = [path] if path else []
    if isinstance(node, dict | list):
        keys = node if isinstance(node, dict) else range(len(node))
        for key in keys:
            found += places(node[key], (*path, key))
    return found


def mutated(seed):
    """A model file of the examples with a value or two of its [[build]] made something else."""
    rng = random.Random(seed)
    path = rng.choice(sorted(EXAMPLES.glob("*.toml")))
    data = tomllib.loads(path.read_text())
    for _ in range(rng.choice((1, 1, 2, 3))):
        *way, last = rng.choice(places(data["build"]))
        node = data["build"]
        for key in way:
            node = node[key]
        old = node[last] if not isinstance(node, list) or last < len(node) else None
        if rng.random() < 0.1:
            del node[last]
        elif isinstance(old, int | float) and not isinstance(old, bool) and rng.random() < 0.85:
            new = old * rng.choice(FACTORS)
            node[last] = round(new) if isinstance(old, int) else new
        else:
            node[last] = rng.choice(VALUES)
        if not data["build"]:
            break
    return data


@pytest.mark.slow
def test_mutated_tables_end_in_a_sentence_or_a_model(tmp_path):
    path, refused = tmp_path / "model.json", 0
    for seed in range(N_MODELS):
        path.write_text(json.dumps(mutated(seed)))
        with warnings.catch_warnings():
            warnings.simplefilter("error")
            try:
                model = read_model(path)
            except ModelError as error:
                refused += 1
                assert error.problems
                for problem in error.problems:
                    assert problem.startswith(f"{path}: ") and "\n" not in problem, (seed, problem)
                continue
        assert model.assembly.n_blocks >= 1
    assert 0.2 * N_MODELS < refused < 0.9 * N_MODELS
