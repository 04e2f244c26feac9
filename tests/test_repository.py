"""The repository's own promises: commands of the README, versions, links, no traces of a machine."""

import re
import subprocess
import tomllib
from pathlib import Path

import pytest

import drystone

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
    citation = (ROOT / "CITATION.cff").read_text(encoding="utf-8")
    assert PROJECT["version"] == drystone.__version__
    assert re.search(r"^version: (.+)$", citation, re.MULTILINE).group(1) == PROJECT["version"]


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


def test_every_command_in_the_documentation_exists():
    from drystone.cli import app

    known = {command.name or command.callback.__name__ for command in app.registered_commands}
    pages = [ROOT / "README.md", *(ROOT / "docs").glob("*.md")]
    for page in pages:
        for block in shell_blocks(page.read_text(encoding="utf-8")):
            used = re.findall(r"(?:^|[ /])drystone ([a-z]+)", block)
            assert set(used) <= known, page.name


def test_links_lead_somewhere():
    for page in [ROOT / "README.md", *(ROOT / "docs").glob("*.md")]:
        for target in re.findall(r"\]\(([^)#]+)[^)]*\)", page.read_text(encoding="utf-8")):
            if "://" not in target:
                assert (page.parent / target).exists(), f"{page.name} links to {target}"


def test_no_paths_of_a_machine():
    # Built from parts, so that this file does not find itself.
    folders = ("home", "Users", "root", "work", "tmp")
    pattern = re.compile(r"(?<![\w.$}~])/(?:" + "|".join(folders) + r")/\w")
    for path in tracked():
        if path.suffix in TEXT and path != Path(__file__):
            found = pattern.search(path.read_text(encoding="utf-8"))
            assert not found, f"{path.relative_to(ROOT)}: {found.group(0)}"
