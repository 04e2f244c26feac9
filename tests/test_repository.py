"""The repository's own promises: commands, versions, links, no traces of a machine."""

import ast
import os
import re
import subprocess
import sys
import tomllib
from pathlib import Path
from typing import get_args
from urllib.parse import urlsplit

import pytest

import drystone
from conftest import SLOW
from drystone.common import kernel_cache

ROOT = Path(__file__).resolve().parents[1]
PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
README = (ROOT / "README.md").read_text(encoding="utf-8")
#: Endings of the files that are text.
TEXT = {".cff", ".json", ".md", ".py", ".toml", ".csv", ""}


def tracked() -> list[Path]:
    """Files of the repository; of what git would add, where it is a repository at all."""
    listed = subprocess.run(
        ["git", "ls-files", "--cached", "--others", "--exclude-standard"],
        cwd=ROOT, capture_output=True, text=True, check=False,
    )  # fmt: skip
    if listed.returncode != 0:
        pytest.skip("not a git repository")
    return [path for line in listed.stdout.splitlines() if (path := ROOT / line).is_file()]


def shell_blocks(text: str) -> list[str]:
    return re.findall(r"```sh\n(.*?)```", text, flags=re.DOTALL)


def test_versions_agree():
    """The version is that of the last tag; without tags, that of CITATION.cff."""
    citation = (ROOT / "CITATION.cff").read_text(encoding="utf-8")
    text = (ROOT / "pyproject.toml").read_text(encoding="utf-8")
    fallback = tomllib.loads(text)["tool"]["hatch"]["version"]["fallback-version"]
    assert re.search(r"^version: (.+)$", citation, re.MULTILINE).group(1) == fallback
    assert "version" in PROJECT["dynamic"]
    assert re.match(r"\d+\.\d+", drystone.__version__)


def test_citation_has_what_the_format_asks_for():
    lines = (ROOT / "CITATION.cff").read_text(encoding="utf-8").splitlines()
    keys = [line.split(":", 1)[0] for line in lines if re.match(r"[a-z-]+:", line)]
    assert {"cff-version", "message", "title", "authors"} <= set(keys)
    assert len(keys) == len(set(keys))
    assert not any("\t" in line for line in lines)


def test_licence_is_there():
    assert "MIT License" in (ROOT / "LICENSE").read_text(encoding="utf-8")
    assert PROJECT["license"] == "MIT"


def test_changelog_has_results():
    text = (ROOT / "CHANGELOG.md").read_text(encoding="utf-8")
    unreleased = text.split("## [Unreleased]", 1)[1].split("\n## [", 1)[0]
    assert "### Results" in unreleased


def test_readme_sets_up_and_runs():
    run, check = shell_blocks(README)[:2]
    assert ".venv/bin/pip install -e ." in run
    arguments = re.search(r"\.venv/bin/drystone (run .*)", run).group(1).split()
    assert "drystone" in PROJECT["scripts"]
    assert (ROOT / arguments[1]).is_file()
    assert "./check" in check and "'.[test]'" in check


def test_ci_runs_the_command_of_the_readme():
    script = (ROOT / ".ci" / "run").read_text(encoding="utf-8")
    assert "./check" in script
    for path in (ROOT / "check", ROOT / ".ci" / "run"):
        assert path.stat().st_mode & 0o111, f"{path} is not executable"
        subprocess.run(["bash", "-n", path], check=True)


def test_ci_fails_where_a_test_marked_gate_does():
    """The part on which it fails has all of them, whatever the share and the seed."""
    script = (ROOT / ".ci" / "run").read_text(encoding="utf-8")
    assert "set -euo pipefail" in script
    seeded = re.search(r"DRYSTONE_ONE_IN=.*\n +(python -m pytest -p seeded .*)", script).group(1)
    assert "||" not in seeded
    file = "tests/validation/test_robustness.py"
    asked = ["--collect-only", "-p", "no:cacheprovider", "-m"]

    def collected(which: str, *more: str, **env: str) -> set[str]:
        found = subprocess.run(
            [sys.executable, "-m", "pytest", *asked, which, *more, file],
            cwd=ROOT, env={**os.environ, **env}, capture_output=True, text=True, check=True,
        )  # fmt: skip
        return {line for line in found.stdout.splitlines() if "::" in line}

    path = os.pathsep.join(filter(None, (str(ROOT / ".ci"), os.environ.get("PYTHONPATH"))))
    none = {"PYTHONPATH": path, "DRYSTONE_ONE_IN": str(10**15)}
    assert collected("slow", "-p", "seeded", **none) == collected("gate") != set()


def test_what_is_called_slow_is_there():
    """A test that has another name now would be run with the quick ones."""
    named = {name.split("[")[0] for name in SLOW}
    there: dict[str, set[str]] = {}
    for file in {name.split("::")[0] for name in named}:
        tree = ast.parse((ROOT / file).read_text(encoding="utf-8"))
        functions = (node.name for node in ast.walk(tree) if isinstance(node, ast.FunctionDef))
        there[file] = set(functions)
    assert not {n for n in named if n.split("::")[-1] not in there[n.split("::")[0]]}


def test_every_command_in_the_documentation_exists():
    from drystone.cli import app

    known = {command.name or command.callback.__name__ for command in app.registered_commands}
    pages = [ROOT / "README.md", *(ROOT / "docs").rglob("*.md")]
    for page in pages:
        for block in shell_blocks(page.read_text(encoding="utf-8")):
            used = re.findall(r"(?:^|[ /])drystone ([a-z]+)", block)
            assert set(used) <= known, page.name


#: Texts with links: those of the site, and those that only a forge or a registry shows.
LINKED = [*ROOT.glob("*.md"), *ROOT.glob("plugins/*/README.md"), *ROOT.glob("docs/**/*.md")]


def test_links_lead_somewhere():
    for page in LINKED:
        for target in re.findall(r"\]\(([^)#]+)[^)]*\)", page.read_text(encoding="utf-8")):
            if "://" not in target:
                assert (page.parent / target).exists(), f"{page.name} links to {target}"


def addresses(text: str) -> list[str]:
    """Addresses of the web that a text names, without the marks that end a sentence or a link."""
    found = re.findall(r"https?:/[^\s<>\"'`\])]*", text)
    return [address.rstrip(".,;:") for address in found]


def well_formed(address: str) -> bool:
    """Whether an address can lead somewhere: encrypted, to a host with a domain, without traces
    of Markdown.  Whether it does lead somewhere takes a network (docs/howto/release.md)."""
    parts = urlsplit(address)
    host = re.fullmatch(r"[a-z0-9-]+(\.[a-z0-9-]+)*\.[a-z]{2,}", parts.netloc)
    path = re.fullmatch(r"(/[\w.~%+@=-]+)*/?", parts.path)
    return parts.scheme == "https" and host is not None and path is not None


def test_addresses_of_the_web_are_well_formed():
    own = [ROOT / "CITATION.cff", ROOT / "pyproject.toml", *ROOT.glob("plugins/*/pyproject.toml")]
    files = [*LINKED, *own]
    found = {
        (file.name, address)
        for file in files
        for address in addresses(file.read_text(encoding="utf-8"))
    }
    assert len(found) >= 3
    assert not [one for one in found if not well_formed(one[1])]


@pytest.mark.parametrize(
    ("text", "same"),
    [
        ("[a](https://pypi.org/project/compas-dem/)", True),
        ("see https://block.arch.ethz.ch/eq/drawing/view/17.", True),
        ("[a](http://pypi.org/project/compas-dem/)", False),
        ("[a](https:/pypi.org/project)", False),
        ("[a](https://pypi/project)", False),
        ("https://pypi.org//project", False),
    ],
)
def test_a_wrong_address_is_found(text, same):
    assert [well_formed(address) for address in addresses(text)] == [same]


def test_every_key_of_the_model_file_is_documented():
    from drystone.io.modelfile.declared import sections_in
    from drystone.io.modelfile.schema import ModelSection, Section

    page = (ROOT / "docs" / "reference" / "model-file.md").read_text(encoding="utf-8")

    def sections(annotation: object) -> list[type[Section]]:
        """Sections that a key's type is made of."""
        if isinstance(annotation, type) and issubclass(annotation, Section):
            return [annotation]
        return [found for part in get_args(annotation) for found in sections(part)]

    def check(section: type[Section]) -> None:
        for key, field in section.keys().items():
            inner = sections(field.annotation)
            named = (f"`{key}`", f"[{key}]", f"[{key}.", f".{key}.")
            assert any(text in page for text in named), f"{section.__name__}: {key}"
            for found in inner:
                for one in sections_in(found):
                    check(one)

    check(ModelSection)


def test_architecture_shows_the_loop_that_is_run():
    page = (ROOT / "docs" / "explanation" / "architecture.md").read_text(encoding="utf-8")
    source = (ROOT / "examples" / "driver_loop.py").read_text(encoding="utf-8")
    (shown,) = re.findall(r"```python\n(.*?)```", page, flags=re.DOTALL)
    assert shown in source


def test_architecture_names_every_module():
    page = (ROOT / "docs" / "explanation" / "architecture.md").read_text(encoding="utf-8")
    for path in (ROOT / "src" / "drystone").iterdir():
        if path.name.startswith("_") or path.name == "py.typed":
            continue
        name = f"`{path.name}/`" if path.is_dir() else f"`{path.name}`"
        assert name in page, f"{name} is not in docs/explanation/architecture.md"


def test_files_to_change_are_there_and_are_few():
    page = (ROOT / "docs" / "explanation" / "architecture.md").read_text(encoding="utf-8")
    section = page.split("## Where to change what")[1].split("\n## ")[0]
    rows = [line.split("|")[1:3] for line in section.splitlines() if line.startswith("| ")][1:]
    assert len(rows) > 10
    for change, files in rows:
        if "its line in" in files:  # `tests/unit/test_registries.py` adds one with no line at all
            continue
        named = re.findall(r"`([a-z_0-9/]+(?:\.py|/))`", files)  # a folder stands for a new file
        assert len(named) <= 3, change
        for name in named:
            assert (ROOT / "src" / "drystone" / name).exists(), f"{change}: {name}"


def test_every_registry_is_on_the_page_and_is_tried_from_outside():
    page = (ROOT / "docs" / "explanation" / "architecture.md").read_text(encoding="utf-8")
    tried = (ROOT / "tests" / "unit" / "test_registries.py").read_text(encoding="utf-8")
    source = ROOT / "src" / "drystone"
    found = {}
    for path in source.rglob("*.py"):
        text = path.read_text(encoding="utf-8")
        found |= dict.fromkeys(re.findall(r'group="(drystone\.\w+)"', text), path)
    assert len(found) >= 5
    for group, path in found.items():
        assert f"its line in `{path.relative_to(source)}` |" in page, group
        assert f"| `{group}` |" in page and f'"{group}"' in tried, group


def test_public_names_stay_what_they_are():
    # In a process of its own: a submodule of the same name must not take the place of a function.
    code = """
import importlib, pkgutil
import drystone as ds
names = [n for n in ds.__all__ if n != "__version__"]
before = {n: getattr(ds, n) for n in names}
for found in pkgutil.iter_modules(ds.__path__, "drystone."):
    importlib.import_module(found.name)
changed = [n for n in names if getattr(ds, n) is not before[n]]
assert not changed, changed
"""
    subprocess.run([sys.executable, "-c", code], check=True)


def test_no_paths_of_a_machine():
    # Built from parts, so that this file does not find itself.
    folders = ("home", "Users", "root", "work", "tmp")
    pattern = re.compile(r"(?<![\w.$}~])/(?:" + "|".join(folders) + r")/\w")
    for path in tracked():
        if path.suffix in TEXT and path != Path(__file__):
            found = pattern.search(path.read_text(encoding="utf-8"))
            assert not found, f"{path.relative_to(ROOT)}: {found.group(0)}"


def imported(text):
    """Names of all that a file imports, with those of their modules."""
    names = set()
    for node in ast.walk(ast.parse(text)):
        if isinstance(node, ast.ImportFrom) and node.module:
            names |= {node.module, *(f"{node.module}.{alias.name}" for alias in node.names)}
    return names


def test_unit_tests_of_kernels_also_run_interpreted():
    """All that import kernels, but tests of the compiler itself."""
    kernels = set(kernel_cache.modules())
    own = ("cli", "compiler", "kernel_cache", "lengths", "reproducible")
    compiler = {f"test_{name}.py" for name in own}
    for path in (ROOT / "tests" / "unit").glob("test_*.py"):
        text = path.read_text(encoding="utf-8")
        if kernels & imported(text) and path.name not in compiler:
            assert "pytestmark = pytest.mark.kernels" in text, path.name
    assert (
        'NUMBA_DISABLE_JIT=1 python -m pytest -n 2 --dist worksteal -m "kernels'
        in (ROOT / "check").read_text()
    )
