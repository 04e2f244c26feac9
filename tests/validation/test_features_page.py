"""The table of what works where is what running gives: every row, in the columns that are cheap."""

import importlib.util
from pathlib import Path

import pytest

DOCS = Path(__file__).parents[2] / "docs"


@pytest.fixture(scope="module")
def making():
    spec = importlib.util.spec_from_file_location("make_features", DOCS / "make_features.py")
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def page(making, dimension):
    return making.told((DOCS / "reference" / "features.md").read_text(), making.TITLES[dimension])


@pytest.mark.parametrize("dimension", [2, 3])
def test_rows_and_columns(making, dimension):
    from drystone.engines import engine_names

    rows = page(making, dimension)
    assert list(rows) == list(making.models(dimension))
    columns = [f"`{name}`" for name in engine_names()] + list(making.FLOWS)
    assert all(list(cells) == columns for cells in rows.values())


SLOW = pytest.mark.slow
COLUMNS = [
    (2, "`equilibrium`"),
    (2, "`distinct`"),
    (2, "`nscd`"),
    (2, "limit, associative"),
    pytest.param(2, "limit, non-associative", marks=SLOW),
    pytest.param(3, "`equilibrium`", marks=SLOW),
    pytest.param(3, "`distinct`", marks=SLOW),
    (3, "`nscd`"),
    (3, "limit, associative"),
]


@pytest.mark.parametrize(("dimension", "column"), COLUMNS)
def test_a_column_is_what_running_gives(making, dimension, column):
    told = {feature: cells[column] for feature, cells in page(making, dimension).items()}
    assert told == {
        feature: making.said(text, column) for feature, text in making.models(dimension).items()
    }
