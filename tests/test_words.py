"""One vocabulary, the field's: words that the glossary bans occur nowhere, bold terms are in it."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from documentation import PAGES, ROOT
from test_documentation import GLOSSARY, name_of, read
from test_repository import tracked

#: Words of earlier versions, as names and sentences spell them: what stands for them is in the
#: glossary.  Keys of model files, such as ``settlement`` and ``held``, are none of them.
BANNED = {
    "leeway": r"leeways?",
    "swerve": r"swerv\w*",
    "crest": r"crests?",
    "push along a mode": r"push\w* along (?:a|the|an unstable) modes?",
    "let go": r"lets?[ _]go",
    "leap": r"leaps?|leapt",
    "pace": r"pac(?:e|es|ed|ing)",
    "room": r"rooms?",
    "settle": r"(?:un)?settl(?:e|es|ed|ing)",
    "probe": r"prob(?:e|es|ed|ing)",
    "calm": r"calm\w*",
    "thorough": r"thorough\w*",
    "gone": r"gone",
    "set out": r"sets?[ _]out",
}
#: Endings of files that people read.
READ = {".css", ".html", ".j2", ".js", ".json", ".md", ".py", ".toml"}
#: Files that may say these words: the record of earlier versions, and this one.
EXEMPT = ("CHANGELOG.md", "tests/test_words.py")
#: What follows in the glossary lists them.
TABLE = "## Words that are not used"


def sources() -> list[Path]:
    return [
        path
        for path in tracked()
        if path.suffix in READ and not path.relative_to(ROOT).as_posix().startswith(EXEMPT)
    ]


def found_in(text: str, word: str) -> list[str]:
    """Where a text says a banned word, also within a name: ``state.pace``, ``PointPace``."""
    apart = re.sub(r"(?<=[a-z])(?=[A-Z])", " ", text)
    pattern = rf"(?<![a-z])(?:{BANNED[word]})(?![a-z])"
    return [match[0] for match in re.finditer(pattern, apart, re.IGNORECASE)]


@pytest.mark.parametrize("word", sorted(BANNED))
def test_banned_words_occur_nowhere(word):
    lost = []
    for path in sources():
        text = read(path)
        text = text.split(TABLE)[0] if path == GLOSSARY else text
        lost += [f"{name_of(path)}: {found}" for found in found_in(text, word)]
    assert not lost


@pytest.mark.parametrize(
    ("text", "word", "said"),
    [
        ("step.pace is None", "pace", True),
        ("class PointPace:", "pace", True),
        ("in space, by a workspace", "pace", False),
        ("TURNING_LEEWAY = 10.0", "leeway", True),
        ("def let_go(work):", "let go", True),
        ("[settlement]", "settle", False),
        ("structures settle", "settle", True),
        ("classroom", "room", False),
    ],
)
def test_names_and_sentences_are_searched(text, word, said):
    assert bool(found_in(text, word)) == said


def test_the_glossary_tells_what_stands_for_banned_words():
    table = read(GLOSSARY).split(TABLE)[1]
    left = " ".join(line.split("|")[1] for line in table.splitlines() if line.startswith("|"))
    for word in BANNED:
        assert word.replace("push along a mode", "push along") in left, word


# ---- bold terms -------------------------------------------------------------------------------


def glossary_terms() -> set[str]:
    """Defined terms and those in bold within definitions, in small letters."""
    text = read(GLOSSARY).split(TABLE)[0]
    return {term.lower() for term in re.findall(r"\*\*([^*]+)\*\*", text)}


def singular(term: str) -> str:
    return re.sub(r"(?<=[a-z])s\b", "", term.lower())


def bold_terms(page: Path) -> set[str]:
    """Bold words within sentences of a page: no symbols of vectors, and no words that head a
    paragraph, an entry of a list or a cell of a table."""
    text = re.sub(r"^```.*?^```$", "", read(page), flags=re.DOTALL | re.MULTILINE)
    text = re.sub(r"(?:(?<=\n\n)|(?<=\n[-*] )|(?<=\n\d\. )|(?<=\| ))\*\*[^*]+\*\*", "", text)
    found = re.findall(r"\*\*([^*]+)\*\*", re.sub(r"(?<=\S)\n *(?=\S)", " ", text))
    return {term for term in found if len(term) > 4 and not re.search(r"[.?:]$|[`δω_⁻]", term)}


def test_every_bold_term_is_in_the_glossary():
    known = {singular(term) for term in glossary_terms()}
    lost = {
        f"{name_of(page)}: {term}"
        for page in PAGES
        for term in bold_terms(page)
        if singular(term) not in known
    }
    assert not lost


def test_the_glossary_is_in_short_sentences():
    text = read(GLOSSARY).split(TABLE)[0]
    entries = re.findall(r"^\*\*([^*\n]+)\*\*\n: (.*?)(?=\n\n|\Z)", text, re.DOTALL | re.MULTILINE)
    assert len(entries) > 60
    assert len({name.lower() for name, _ in entries}) == len(entries)
    for name, definition in entries:
        assert 1 <= len(re.findall(r"[.?](?:\s|$)", definition)) <= 3, name
