"""Study files: what is wrong with them is said with its place and its mend."""

from __future__ import annotations

import subprocess
import sys

import pytest

from drystone.studies import digests, paths
from drystone.studies.errors import StudyError
from drystone.studies.read import read_study
from studied import BASE, written

WALL = (
    BASE
    + """
[[block]]
id = "b1"
vertices = [[-0.2, 0.0], [0.2, 0.0], [0.2, 0.9], [-0.2, 0.9]]
groups = ["top"]
[load]
pattern = "mass"
direction = [1.0, 0.0]
"""
)
GOOD = """
    model = "wall.toml"
    design = "lhs"
    samples = 8
    [[parameter]]
    path = "joint.friction_coefficient"
    range = [0.4, 0.8]
"""


@pytest.fixture
def read(tmp_path):
    (tmp_path / "wall.toml").write_text(WALL)
    return lambda text: read_study(written(tmp_path, text))


def test_a_study_is_read(read):
    study = read(GOOD)
    assert study.count == 8 and study.design == "lhs"
    assert study.task.parameters[0].paths == (("joint", "friction_coefficient"),)


@pytest.mark.parametrize(
    ("old", "new", "said"),
    [
        ("joint.friction_coefficient", "joint.friction", 'did you mean "joint.friction_coeff'),
        ("joint.friction_coefficient", "frction_coefficient", 'did you mean "joint.friction_coe'),
        ("joint.friction_coefficient", "block.b2.vertices", "parameter[1] path"),
        ("joint.friction_coefficient", "joint..cohesion", "is no place of a model file"),
        ("joint.friction_coefficient", "load.direction[0]", "counts entries from 1"),
        ('"wall.toml"', '"wal.toml"', "there is no such file"),
        ("range = [0.4, 0.8]", "range = [0.8, 0.4]", "the first must be the lower"),
        ("range = [0.4, 0.8]", "", "has none of values, range and distribution"),
        ("range = [0.4, 0.8]", "values = [1.0]\n range = [0.4, 0.8]", "has values and range"),
        (
            "range = [0.4, 0.8]",
            "range = [0.4, 0.8]\n mean = 1.0",
            "has mean, which belongs to a",
        ),
        ("range = [0.4, 0.8]", "range = [0.4, 0.8]\n whole = true", "range: has no whole number"),
        (
            "range = [0.4, 0.8]",
            'distribution = "norm"\n mean = 0.6\n std = 0.1\n bounds = [9.0, 10.0]',
            "has no probability between its bounds",
        ),
        ("range = [0.4, 0.8]", 'distribution = "normal"', 'did you mean "norm"'),
        ("range = [0.4, 0.8]", 'distribution = "norm"\n mean = 0.6', "one of mean and std"),
        ("range = [0.4, 0.8]", 'distribution = "gamma"', "needs a in shapes"),
        ("range = [0.4, 0.8]", 'distribution = "norm"\n shapes = {s = 1.0}', 'has "s"'),
        ("range = [0.4, 0.8]", "rnage = [0.4, 0.8]", 'unknown key "rnage": did you mean "range"'),
        ("samples = 8", "", "samples is missing"),
        ("samples = 8", "samples = 0", "at least 1"),
        ('design = "lhs"', 'design = "sobel"', 'did you mean "sobol"'),
        ('design = "lhs"\n    samples = 8', 'design = "sobol"\n    samples = 9', "take 8 or 16"),
        ('design = "lhs"', 'design = "grid"', "has as many as its values"),
        ('model = "wall.toml"', "", "neither of model and function"),
        ("samples = 8", 'samples = 8\n engine = "equilibrum"', 'did you mean "equilibrium"'),
        ("samples = 8", 'samples = 8\n outputs = ["curves"]', 'did you mean "curve"'),
        ("samples = 8", "samples = 8\n [imperfection]\n loose = 0.1", "one of loose and loose_gap"),
    ],
)
def test_what_is_wrong_is_said(read, old, new, said):
    assert old in GOOD
    with pytest.raises(StudyError) as error:
        read(GOOD.replace(old, new))
    assert said in str(error.value)
    assert all("study.toml: " in problem for problem in error.value.problems)


NAMING = """
[site]
code = "table"
[site.SLV.spectrum]
file = "spectrum.csv"
[[import]]
file = "arch.stl"
[control]
history = "history.txt"
"""
NAMED = {
    "spectrum.csv": "0, 1",
    "arch.stl": "solid",
    "history.txt": "0.01",
    "first.txt": "1",
    "second.txt": "2",
}
HISTORIES = GOOD.replace("joint.friction_coefficient", "control.history").replace(
    "range = [0.4, 0.8]", 'values = ["first.txt", "second.txt"]'
)


def test_a_study_is_the_same_in_another_folder_and_another_with_another_file(tmp_path):
    """Of the model itself, of what it names, and of what values of a parameter name."""
    prints = {}
    for changed in ("", "copied", *NAMED, "wall.toml"):
        folder = tmp_path / (changed or "first")
        folder.mkdir()
        files = {"wall.toml": WALL + NAMING, **NAMED}
        for name, text in files.items():
            more = {"wall.toml": "[analysis]\nmax_displacement = 0.1\n"}.get(name, "3\n")
            (folder / name).write_text(text + (more if name == changed else ""))
        prints[changed] = read_study(written(folder, HISTORIES)).fingerprint
    assert prints.pop("") == (copied := prints.pop("copied"))
    assert copied not in prints.values() and len(set(prints.values())) == len(prints) == 6


def test_titles_and_models_of_another_name_are_the_same_study(read, tmp_path):
    first = read(GOOD).fingerprint
    (tmp_path / "other.toml").write_text(WALL)
    other = GOOD.replace("wall.toml", "other.toml").replace("design", 'title = "x"\n    design')
    assert read(other).fingerprint == first
    assert read(GOOD.replace("0.8", "0.9")).fingerprint != first


@pytest.mark.parametrize(
    ("text", "package", "names"),
    [
        ("import a.b, c", "", {"a.b", "c"}),
        ("from a import b as x", "", {"a", "a.b"}),
        ("from . import b", "p.q", {"p.q", "p.q.b"}),
        ("from ..a import b", "p.q", {"p.a", "p.a.b"}),
        ("def f(): import d", "", {"d"}),
        ("no python", "", set()),
    ],
)
def test_imports_of_a_module_are_read_from_its_text(text, package, names):
    assert set(digests._imported(text.encode(), package)) == names


def test_modules_of_the_folder_count_wherever_the_function_is_named(tmp_path, monkeypatch):
    """A module by Python's path with a package beside the study, read without importing it."""
    (tmp_path / "path").mkdir()
    (tmp_path / "path" / "mine.py").write_text("from beside.deep import x\nraise RuntimeError\n")
    (tmp_path / "beside").mkdir()
    (tmp_path / "beside" / "__init__.py").write_text("")
    (tmp_path / "beside" / "deep.py").write_text("from . import other\nimport numpy\n")
    (tmp_path / "beside" / "other.py").write_text("import beside.deep\n")
    monkeypatch.syspath_prepend(str(tmp_path / "path"))
    study = read_study(written(tmp_path, GOOD), function="mine:f")
    assert [name for name in study.digests if name.startswith('"')] == [
        '"beside/__init__.py"', '"beside/deep.py"', '"beside/other.py"', '"mine.py"'
    ]  # fmt: skip


def test_correlations_are_checked(read):
    second = GOOD + '[[parameter]]\n path = "joint.cohesion"\n range = [0.0, 1.0]\n'
    between = '[[correlation]]\n between = ["joint.friction_coefficient", "{}"]\n value = 0.5\n'
    assert read(second + between.format("joint.cohesion")).correlation[0, 1] == 0.5
    with pytest.raises(StudyError, match=r'did you mean "joint\.cohesion"'):
        read(second + between.format("joint.cohesio"))
    with pytest.raises(StudyError, match="takes parameters as independent"):
        read(second.replace('"lhs"', '"saltelli"') + between.format("joint.cohesion"))


def test_a_missing_extra_names_the_command(tmp_path):
    """In a process that has no pyarrow."""
    file = written(tmp_path, 'function = "FUNCTIONS:wave"')
    code = (
        "import importlib.util as u, sys; f = u.find_spec\n"
        "u.find_spec = lambda n, *a: None if n == 'pyarrow' else f(n, *a)\n"
        "from drystone.cli import main; main()"
    )
    done = subprocess.run(
        [sys.executable, "-c", code, "study", str(file)], capture_output=True, text=True
    )
    assert done.returncode == 2
    assert "pyarrow is not installed: pip install 'drystone[study]'" in done.stderr


DOCUMENT = {
    "wall": {"unit": [0.4, 0.2]},
    "joint": {"friction_coefficient": 0.6, "between": {"a b": {"cohesion": 1.0}}},
    "group": {"low": {"blocks": ["c1*"]}},
    "block": [
        {"id": "c1u1", "vertices": [[0, 0], [1, 0]]},
        {"id": "c1u2", "vertices": [[1, 0], [2, 0]], "groups": ["edge"]},
        {"id": "c2u1", "vertices": [[0, 1], [1, 1]]},
    ],
    "tie": [{"name": "rod", "yield_force": 1.0}],
}


@pytest.mark.parametrize(
    ("text", "n"),
    [
        ("joint.friction_coefficient", 1),
        ('joint.between."a b".cohesion', 1),
        ('joint.between."a b".tensile_strength', 1),
        ("wall.unit[2]", 1),
        ("tie.rod.yield_force", 1),
        ("tie[1].yield_force", 1),
        ('block."c1*".material', 2),
        ("block.edge.material", 1),
        ("block.low.material", 2),
        ('block."c2u1".vertices[1][2]', 1),
        ("load.direction", 1),
    ],
)
def test_places_lead_where_they_say(text, n):
    import copy

    document = copy.deepcopy(DOCUMENT)
    paths.put(document, paths.keys_of(text), lambda old: "new")
    assert str(document).count("new") == n


def test_changes_of_what_is_there():
    assert paths.changed([0.4, 0.2], "multiply", 2.0) == [0.8, 0.4]
    assert paths.changed(0.4, "add", 0.1) == 0.5
    assert paths.changed([1, 2], "set", "x") == "x"
    with pytest.raises(paths.PathError):
        paths.changed(None, "multiply", 2.0)
