"""Names and titles do nothing in any file that is written: paths, XML, HTML, tables, scripts."""

from __future__ import annotations

import ast
import csv
import json
import re
from pathlib import Path
from xml.etree import ElementTree

import numpy as np
import pytest

import chromium
import drystone as ds
from drystone.cli import main
from drystone.io.convert import targets
from drystone.io.convert.from_drawing import from_drawing
from drystone.io.drawings import ImportSettings, Shape, obj
from drystone.io.modelfile.parse import parse
from drystone.model.construction.words import FORMULA
from drystone.report.document import report as document
from drystone.report.viewer import write_page
from drystone.report.viewer.folder import Folder

#: What runs in a page leaves a mark there.
RUN = "window.ran = 1"
NAMES = (
    "../../outside",
    "/outside",
    f"</script><script>{RUN}</script>",
    f'"><img src=x onerror="{RUN}">',
    f"<svg onload='{RUN}'>",
    f"${{{RUN}}} {{{{7*7}}}} {{% raw %}} `",
    "=1+1",
    '@SUM(1) "a", b',
    "-2+3;calc",
    "+cmd|' /C calc'!A0",
    '""" ; import os #',
    "' ; new ; quit & ",
    "]]> --> <!-- &amp; &#x3c;",
    "con",
    "nul.txt",
    "..",
    "~",
    "C:\\outside",
    "\\ & \\n %s %n $(touch outside) |",
)
TITLE = "".join(f"{name}\n\r\t; quit\n#" for name in NAMES)


def model(dimension: int, names: tuple[str, ...] = NAMES, title: str = TITLE) -> ds.Model:
    """A stack of stones with such names, tied to each other; of one joint law."""
    n = len(names)
    data = {
        "title": title,
        "dimension": dimension,
        **({"thickness": 1.0} if dimension == 2 else {}),
        "material": {name: {"unit_weight": 2e4} for name in names},
        "joint": {"friction_coefficient": 0.6, "normal_stiffness": 1e9, "shear_stiffness": 1e9},
        "load": {"pattern": "mass", "direction": [1.0, 0.0, 0.0][:dimension]},
        "block": [
            {
                "id": names[k],
                "material": names[-k - 1],
                "groups": [names[(k + 1) % n]],
                "support": k == 0,
                **(
                    {
                        "vertices": [
                            [0, 0.1 * k],
                            [1, 0.1 * k],
                            [1, 0.1 * k + 0.1],
                            [0, 0.1 * k + 0.1],
                        ]
                    }
                    if dimension == 2
                    else {"box": [[0, 0, 0.1 * k], [1, 1, 0.1 * k + 0.1]]}
                ),
            }
            for k in range(n)
        ],
    }
    return _of(data)


def _of(data) -> ds.Model:
    from drystone.io.modelfile.read import model_from_text

    return model_from_text(json.dumps(data), source=None, sha256="")


def tied() -> ds.Model:
    """Two stones, the ties of which have the names."""
    data = {
        "title": TITLE,
        "dimension": 2,
        "thickness": 1.0,
        "material": {"stone": {"unit_weight": 2e4}},
        "joint": {"friction_coefficient": 0.6, "normal_stiffness": 1e9, "shear_stiffness": 1e9},
        "load": {"pattern": "mass", "direction": [1.0, 0.0]},
        "block": [
            {"id": NAMES[2], "support": True, "vertices": [[-1, -1], [2, -1], [2, 0], [-1, 0]]},
            {"id": NAMES[3], "groups": [NAMES[4]], "vertices": [[0, 0], [1, 0], [1, 2], [0, 2]]},
        ],
        "spring": [
            {
                "name": name,
                "from": {"block": NAMES[3], "point": [0.5, 1.0]},
                "to": {"block": "ground", "point": [-2.0, 1.0]},
                "stiffness": 1e3,
            }
            for name in NAMES
        ],
        "dead_load": [
            {"kind": "surcharge", "mass": False, "block": NAMES[3], "weight": 10.0, "name": name}
            for name in NAMES
        ],
    }
    return _of(data)


@pytest.fixture(scope="module")
def written(tmp_path_factory) -> Path:
    """A folder of results with a report and a viewer."""
    around = tmp_path_factory.mktemp("around")
    folder = around / "inner" / "results"
    traced = tied()
    ds.save_results(ds.pushover(traced, max_steps=4), traced, folder)
    found = Folder.read(folder)
    write_page(found.contents(), folder / "view.html")
    (folder / "report.html").write_text(document.render(found), encoding="utf-8")
    return folder


def test_nothing_is_written_outside_of_the_folder(written):
    around = written.parents[1]
    assert [path.name for path in around.iterdir()] == ["inner"]
    assert [path.name for path in (around / "inner").iterdir()] == ["results"]
    known = {"summary.json", "curve.csv", "ties.csv", "results.h5", "paraview", "curve.png",
             "mechanism.png", "view.html", "report.html"}  # fmt: skip
    assert {path.name for path in written.iterdir()} == known
    names = {path.name for path in (written / "paraview").iterdir()}
    assert all(re.fullmatch(r"(blocks|contacts)(_\d{4}\.vtu|\.pvd)", name) for name in names)


def test_xml_is_what_it_is_with_plain_names(written):
    for path in (written / "paraview").iterdir():
        root = ElementTree.parse(path).getroot()
        assert {element.tag for element in root.iter()} <= {
            "VTKFile", "Collection", "DataSet", "UnstructuredGrid", "FieldData", "Piece", "Points",
            "Cells", "PointData", "CellData", "DataArray",
        }  # fmt: skip


def is_inert(cell: str) -> bool:
    """Whether a spreadsheet shows a cell as it stands: a number, or what begins like no formula."""
    try:
        float(cell)
    except ValueError:
        return not cell.startswith(FORMULA)
    return True


def test_tables_hold_no_formulas(written):
    for path in written.glob("*.csv"):
        with path.open(newline="", encoding="utf-8") as file:
            rows = list(csv.reader(file))
        assert len({len(row) for row in rows}) == 1
        assert all(is_inert(cell) for row in rows for cell in row), path.name
        if path.name == "ties.csv":
            assert "'=1+1" in {row[2] for row in rows}


def plain(count: int) -> tuple[str, ...]:
    return tuple(f"n{k}" for k in range(count))


@pytest.mark.parametrize("dimension", [2, 3])
def test_scripts_do_what_they_do_with_plain_names(dimension):
    """Commands are the same to the letter, whatever stands in comments and texts."""
    few = NAMES[:6] if dimension == 3 else NAMES
    for name, target in targets().items():
        if name == "udec" and dimension == 3:
            continue
        try:
            hostile = target.write(model(dimension, few), f"a{target.endings[0]}").text
            tame = target.write(
                model(dimension, plain(len(few)), "t"), f"a{target.endings[0]}"
            ).text
        except ds.ModelError as error:
            pytest.fail(f"{name}: {error}")
        assert skeleton(name, hostile) == skeleton(name, tame), name


def skeleton(name: str, text: str) -> object:
    """What a program makes of a file, without comments and names."""
    if name in ("udec", "3dec"):
        return [line.partition(";")[0].rstrip() for line in text.split("\n")]
    if name == "lmgc90":
        tree = ast.parse(text)
        for node in ast.walk(tree):
            if isinstance(node, ast.Constant) and isinstance(node.value, str):
                node.value = ""
        return ast.dump(tree)
    if name == "compas":
        data = json.loads(text)["data"]["graph"]["data"]
        return len(data["node"]), len(data["edge"])
    if name == "dxf":
        return len(re.findall(r"\n(LWPOLYLINE|MESH|INSERT|POLYLINE)\r?\n", text))
    lines = [line.split() or [""] for line in text.splitlines()]
    return [
        line[:1] if line[0] in ("#", "o", "usemtl", "comment", "solid", "endsolid") else line
        for k, line in enumerate(lines)
        if not (name == "vtk" and k == 1)  # the title
    ]


def test_a_model_file_of_a_drawing_holds_its_blocks_and_nothing_else(tmp_path):
    box = np.array([(x, y, z) for z in (0, 1) for x, y in ((0, 0), (1, 0), (1, 1), (0, 1))], float)
    faces = ((0, 3, 2, 1), (4, 5, 6, 7), (0, 1, 5, 4), (1, 2, 6, 5), (2, 3, 7, 6), (3, 0, 4, 7))
    shapes = [
        Shape(name=name, vertices=box + [0, 0, k], faces=faces, layer=name, groups=(name,))
        for k, name in enumerate(NAMES)
    ]
    path = tmp_path / 'a"]\n[x] "b.obj'
    path.write_text(obj.write(shapes, TITLE), encoding="utf-8")
    made = from_drawing(ImportSettings(file=path, unit="m", up="z"))
    data = parse(made.text.encode(), is_json=False)
    assert set(data) == {"title", "dimension", "block"}
    assert len(data["block"]) == len(NAMES)
    for line in made.text.splitlines():
        assert "import os" not in line or line.startswith(("#", "id", "material", "groups"))


def test_terminals_are_not_steered(tmp_path, capsys, monkeypatch):
    path = tmp_path / "m.toml"
    text = 'title = "\\u001b[31m\\u0007\\n\\u202e"\ndimension = 2\nthickness = 1.0\n'
    path.write_text(
        text + "[material.stone]\nunit_weight = 2e4\n[joint]\nfriction_coefficient = 0.6\n"
        '[load]\npattern = "mass"\ndirection = [1.0, 0.0]\n[[block]]\nid = "a"\nsupport = true\n'
        'vertices = [[0, 0], [1, 0], [1, 1], [0, 1]]\n[[block]]\nid = "b"\n'
        "vertices = [[0, 1], [1, 1], [1, 2], [0, 2]]\n"
    )
    monkeypatch.setattr("sys.argv", ["drystone", "check", str(path)])
    with pytest.raises(SystemExit):
        main()
    told = capsys.readouterr()
    assert (told.out + told.err).replace("\n", "").isprintable()


@pytest.mark.skipif(chromium.executable() is None, reason="no Chromium: apt-get install chromium")
@pytest.mark.parametrize("page", ["view.html", "report.html"])
def test_nothing_runs_in_a_browser(written, page):
    with chromium.Browser() as browser:
        browser.open(written / page)
        browser.wait("document.readyState === 'complete'")
        browser.run("new Promise(r => setTimeout(() => r(1), 1000))")
        # Names are shown where they are pointed at and searched for, too.
        for x in range(100, 1200, 100):
            for y in range(100, 800, 100):
                browser.mouse("mouseMoved", x, y)
        browser.click(600, 400)
        browser.run(
            "document.querySelectorAll('button, summary, option, input').forEach(e => e.click())"
        )
        browser.run("new Promise(r => setTimeout(() => r(1), 500))")
        assert browser.run("window.ran") is None
        assert browser.run("document.querySelectorAll('img[src=x], svg[onload]').length") == 0
        assert browser.requests == []
        assert NAMES[3] in browser.run("document.documentElement.textContent")
