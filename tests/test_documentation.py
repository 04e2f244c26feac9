"""The documentation keeps its promises: what it shows is run, what it names is defined."""

from __future__ import annotations

import contextlib
import importlib.util
import io
import os
import re
import subprocess
import sys
import tomllib
from pathlib import Path
from types import ModuleType

import pytest
from pydantic import ValidationError

from documentation import (
    PAGES,
    ROOT,
    CodeBlock,
    agrees,
    code_blocks,
    missing,
    shown_by_prints,
)

LANGUAGES = {"sh", "python", "toml", "text"}
GLOSSARY = ROOT / "docs" / "glossary.md"
#: Pages whose commands take more than some seconds.
SLOW = {
    "docs/coming-from/3muri.md",
    "docs/coming-from/compas.md",
    "docs/explanation/assessment.md",
    "docs/howto/compare.md",
    "docs/howto/engine.md",
    "docs/howto/stopped.md",
    "docs/reference/drawings.md",
    "docs/reference/viewer.md",
    "docs/tutorials/certificate.md",
    "docs/tutorials/dxf-to-verdict.md",
    "docs/tutorials/study.md",
    "docs/tutorials/tied-facade.md",
}


def name_of(page: Path) -> str:
    return page.relative_to(ROOT).as_posix()


def read(page: Path) -> str:
    return page.read_text(encoding="utf-8")


# ---- what is shown is run ---------------------------------------------------------------------


class Reader:
    """Somebody who does what a page says, in an empty folder beside the examples."""

    def __init__(self, folder: Path) -> None:
        self.folder, self.names = folder, {"__name__": "__main__"}
        bin_ = folder / ".bin"
        bin_.mkdir()
        command = bin_ / "drystone"
        call = "from drystone.cli import main; main()"
        command.write_text(f"#!/bin/sh\nexec '{sys.executable}' -c '{call}' \"$@\"\n")
        command.chmod(0o755)
        for shared in ("examples", "benchmarks"):
            (folder / shared).symlink_to(ROOT / shared, target_is_directory=True)
        path = os.pathsep.join((str(bin_), str(Path(sys.executable).parent), os.environ["PATH"]))
        self.environment = {**os.environ, "PATH": path, "MPLBACKEND": "Agg", "COLUMNS": "200"}

    def shell(self, text: str) -> list[str]:
        done = subprocess.run(
            ["bash", "-euo", "pipefail", "-c", text],
            cwd=self.folder, env=self.environment, capture_output=True, text=True, check=False,
        )  # fmt: skip
        assert done.returncode == 0, f"{text}\n{done.stdout}{done.stderr}"
        return (done.stdout + "\n" + done.stderr).splitlines()

    def python(self, code: str) -> list[str]:
        printed = io.StringIO()
        with contextlib.redirect_stdout(printed):
            exec(compile(code, "<page>", "exec"), self.names)
        return printed.getvalue().splitlines()

    def write(self, block: CodeBlock) -> None:
        if (named := block.remark("file")) is not None:
            name, _, same_as = named.partition(" = ")
            if same_as:
                assert block.text.strip() in read(ROOT / same_as), f"it is not {same_as}"
            (self.folder / name).write_text(block.text, encoding="utf-8")
        if (name := block.remark("append")) is not None:
            with (self.folder / name).open("a", encoding="utf-8") as file:
                file.write(block.text)

    def does(self, blocks: list[CodeBlock]) -> None:
        printed: list[str] = []
        for block in blocks:
            if block.remark("not run") is not None:
                continue
            if (before := block.remark("run")) is not None:
                self.shell(before)
            if block.language == "sh":
                printed = self.shell(block.text)
            elif block.language == "text":
                lost = missing([line for line in block.text.splitlines() if line], printed)
                assert not lost, f"line {block.line}: {lost} is not in {printed}"
            elif block.language == "python":
                printed = self.python(block.text)
                lost = missing(shown_by_prints(block.text), printed)
                assert not lost, f"line {block.line}: {lost} is not in {printed}"
            elif block.language == "toml":
                self.write(block)


def runnable(page: Path) -> bool:
    return any(
        block.language in ("sh", "python") and block.remark("not run") is None
        for block in code_blocks(read(page))
    )


RUN = [
    pytest.param(page, marks=pytest.mark.slow if name_of(page) in SLOW else (), id=name_of(page))
    for page in PAGES
    if runnable(page)
]


@pytest.mark.skipif(sys.platform == "win32", reason="commands of a POSIX shell")
@pytest.mark.parametrize("page", RUN)
def test_what_a_page_shows_is_what_happens(page, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("MPLBACKEND", "Agg")
    monkeypatch.syspath_prepend(str(ROOT / "examples"))
    Reader(tmp_path).does(code_blocks(read(page)))


def test_slow_pages_are_pages():
    assert {name_of(page) for page in PAGES if runnable(page)} >= SLOW


def test_what_is_not_run_says_why():
    for page in PAGES:
        for block in code_blocks(read(page)):
            assert block.language in LANGUAGES or block.language.startswith("{"), name_of(page)
            assert len(block.remark("not run") or "a reason") > 5, name_of(page)


def extension(name: str) -> ModuleType:
    """A module that the site is built with."""
    file = ROOT / "docs" / "extensions" / f"{name}.py"
    spec = importlib.util.spec_from_file_location(name, file)
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def options_of_commands() -> dict[str, set[str]]:
    """Options of each command, as the page of commands has them."""
    found: dict[str, set[str]] = {}
    for section in extension("declared").commands_page().split("\n## drystone ")[1:]:
        found[section.split("\n")[0]] = {"--help", *re.findall(r"`(-[-a-z]+)`", section)}
    return found


def test_commands_within_sentences_and_tables_have_options_that_there_are():
    pytest.importorskip("sphinx", reason="the page of commands is written for it")
    known = options_of_commands()
    assert "--out" in known["run"] and len(known) >= 10
    for page in PAGES:
        text = read(page)
        for command, rest in re.findall(r"drystone ([a-z]+)((?: [^`\n|&#]*)?)", text):
            if command in known:
                for asked in re.findall(r"(?<= )(--?[a-z][-a-z]*)", rest):
                    assert asked in known[command], f"{name_of(page)}: drystone {command}{rest}"
        for script in re.findall(r"python ((?:benchmarks|docs|examples|tests)/\w+\.py)", text):
            assert (ROOT / script).is_file(), f"{name_of(page)}: {script}"


def test_the_page_of_keys_tells_whole_numbers_from_others_and_their_bounds():
    pytest.importorskip("sphinx", reason="the page of keys is written for it")
    page = extension("declared").keys_page()
    for row in (
        "| `height` | number | 0 to 10000 | required |",  # of [site.floor]
        "| `storeys` | whole number | 1 to 200 |  |",
        "| `amplitude` | number | above 0, at most 10 | required |",
        "| `damping` | number | at least 0, less than 100 |  |",
    ):
        assert row in page


def test_the_page_of_keys_has_those_of_tables_that_differ_between_kinds():
    pytest.importorskip("sphinx", reason="the page of keys is written for it")
    _, of_plan = extension("declared").keys_page().split('`[[build.openings]]` of kind = `"plan"`')
    assert "| `storey` | whole number |" in of_plan.split("\n## ")[0]


def test_the_gallery_has_a_sentence_for_every_example():
    pytest.importorskip("sphinx", reason="the gallery is written for it")
    gallery = extension("gallery")
    models = list((ROOT / "examples").rglob("*.toml"))
    shown = re.findall(r"^```\{gallery\} (\S+)", read(ROOT / "docs" / "gallery.md"), re.MULTILINE)
    assert {path.parent for path in models} == {ROOT / folder for folder in shown}
    for path in models:
        assert re.search(r"[\w)][.?]$", gallery.described(read(path))), path


def test_the_gallery_draws_what_a_study_varies(tmp_path):
    pytest.importorskip("sphinx", reason="the gallery is written for it")
    study = ROOT / "examples" / "wall1_study.toml"
    row = extension("gallery").row(study, tmp_path, ROOT / "docs", None)
    assert "`drystone study examples/wall1_study.toml`" in row
    assert "](../examples/wall1_study.toml)" in row
    assert (tmp_path / "examples-wall1_study.png").stat().st_size > 1000


def problems(text: str, dimension: int) -> list[str]:
    """What the check of model files or studies finds in a part of one, but for what is missing."""
    from drystone.io.modelfile.schema import ModelSection
    from drystone.studies.schema import StudySection

    data = tomllib.loads(text)
    try:
        if isinstance(data.get("model"), str):  # the path of one: a study file
            StudySection.model_validate(data)
        else:
            data = {"dimension": dimension, **data}
            ModelSection.model_validate(data, context={"dimension": dimension})
    except ValidationError as error:
        return [str(one) for one in error.errors() if one["type"] != "missing"]
    return []


def test_parts_of_model_files_have_keys_that_there_are():
    for page in PAGES:
        for block in code_blocks(read(page)):
            of_model = block.language == "toml" and block.remark("not run") is None
            if of_model and "project" not in tomllib.loads(block.text):
                found = [problems(block.text, dimension) for dimension in (2, 3)]
                assert [] in found, f"{name_of(page)}, line {block.line}: {found}"


def test_a_wrong_key_of_a_study_is_found():
    study = 'model = "wall.toml"\n[[parameter]]\npath = "joint.cohesion"\nvalues = [1.0]\n'
    assert not problems(study, 2) and problems(study.replace("values", "value"), 2)


def test_a_wrong_key_is_found():
    assert problems("[joint]\nfriction = 0.6", 2) and not problems(
        "[joint]\nfriction_coefficient = 0.6", 2
    )


@pytest.mark.parametrize(
    ("shown", "printed", "same"),
    [
        ("peak 0.578", "peak 0.5781", True),
        ("peak 0.578", "peak 0.678", False),
        ("peak 0.578", "top 0.578", False),
        ("residual 1e-9", "residual 3e-11", True),
        ("zeta = ... (governs)", "zeta = 1.2 (governs)", True),
    ],
)
def test_a_line_agrees_where_words_and_numbers_do(shown, printed, same):
    assert agrees(shown, printed) == same
