"""``drystone verify``: bounds, exit statuses, and the page, which is what the command writes."""

import json
import math
import re
from dataclasses import replace
from pathlib import Path

import pytest
from typer.testing import CliRunner

from drystone.cli import app
from drystone.verification import page
from drystone.verification.case import CLOSED_FORM, FAILS, KNOWN, OK, Case, Checked, checked
from drystone.verification.cases import cases, introductions

PAGE = Path(__file__).parents[2] / "docs" / "reference" / "verification.md"
CASE = Case(
    name="one half",
    section="A block that slides",
    kind=CLOSED_FORM,
    source="1 / 2",
    expected=0.5,
    compute=lambda: 0.5001,
    bound=1e-3,
    reason="two digits",
)


def rows_of_the_page():
    """Cells of every row, by the section and the name of the case and what it is compared with."""
    found, section = {}, ""
    for line in PAGE.read_text(encoding="utf-8").splitlines():
        if line.startswith("## "):
            section = line[3:]
        elif line.startswith("| ") and not line.startswith("| case "):
            cells = [cell.strip() for cell in line.strip("|").split("|")]
            found[section, cells[0], cells[1]] = cells[2:]
    return found


def key(case):
    return case.section, case.name, case.source


def test_an_error_is_judged_by_its_bound():
    (row,) = checked([CASE])
    assert row.error == pytest.approx(2e-4) and row.outcome == OK
    assert replace(row, got=0.6).outcome == FAILS
    assert replace(row, got=math.nan).outcome == FAILS
    known = replace(CASE, known="the wall was cracked before")
    assert replace(row, case=known, got=0.6).outcome == KNOWN
    assert replace(row, case=known, got=math.nan).outcome == FAILS
    none = replace(CASE, expected=0.0)  # then it is the difference itself
    assert replace(row, case=none, got=5e-4).error == 5e-4


def verify(monkeypatch, found, *arguments):
    monkeypatch.setattr("drystone.verification.cases.cases", lambda *, everything: found)
    return CliRunner().invoke(app, ["verify", *arguments])


def test_the_exit_status_is_one_where_a_case_fails(monkeypatch):
    done = verify(monkeypatch, [CASE])
    assert done.exit_code == 0 and "1 cases: 1 within their bound 0 beyond it" in done.output
    wrong = replace(CASE, name="wrong", compute=lambda: 0.6)
    done = verify(monkeypatch, [CASE, wrong])
    assert done.exit_code == 1 and "beyond its bound: wrong (two digits)" in done.output
    done = verify(monkeypatch, [replace(wrong, known="of old")])
    assert done.exit_code == 0 and "wrong: of old" in done.output


def test_json_says_what_failed(monkeypatch):
    done = verify(monkeypatch, [CASE, replace(CASE, compute=lambda: 0.6)], "--json", "--quiet")
    told = json.loads(done.stdout)
    assert done.exit_code == 1 and told["failed"] == 1
    assert [row["outcome"] for row in told["rows"]] == [OK, FAILS]
    assert {"case", "source", "expected", "got", "error", "bound", "reason", "seconds"} <= set(
        told["rows"][0]
    )


def test_a_page_can_be_written(monkeypatch, tmp_path):
    file = tmp_path / "page.md"
    verify(monkeypatch, [CASE, replace(CASE, compute=lambda: 0.6, known="of old")], "--out", file)
    text = file.read_text()
    assert "| one half | 1 / 2 | 0.5 | 0.5001 | +2.0e-04 | 1.0e-03 a | ok |" in text
    assert "- Bound a: two digits." in text and "- Known miss (1): of old." in text


def test_the_quick_set_has_all_kinds():
    quick, everything = cases(), cases(everything=True)
    assert {case.kind for case in quick} == {"closed form", "program", "laboratory"}
    assert len(quick) < len(everything)
    assert len({(*key(case),) for case in everything}) == len(everything)
    assert all(case.bound > 0.0 and case.reason for case in everything)
    assert {case.section for case in everything} == set(introductions())


def test_the_page_has_all_cases():
    """Names, sources, what is expected, bounds; no case of the page is beyond its bound."""
    told = rows_of_the_page()
    everything = cases(everything=True)
    assert list(told) == [key(case) for case in everything]
    for case in everything:
        expected, _, _, bound, outcome, _, quick = told[key(case)]
        shown = page.numbers(Checked(case=case, got=case.expected, seconds=0.0))
        assert expected == shown[0] and bound.split()[0] == shown[3]
        assert outcome.split(" (")[0] in (OK, KNOWN) and (quick == "•") == case.quick
    assert "FAILS" not in PAGE.read_text(encoding="utf-8")


@pytest.mark.slow
@pytest.mark.gate
def test_the_page_is_what_the_quick_set_gives():
    """To a tenth of the bound: digits beyond are of the machine."""
    told = rows_of_the_page()
    for row in checked(cases()):
        _, got, _, _, outcome, _, _ = told[key(row.case)]
        scale = row.case.expected or 1.0
        assert outcome.split(" (")[0] == row.outcome, row.case.name
        printed = 0.5 * 10.0 ** (math.floor(math.log10(abs(float(got)) or 1.0)) - 4)
        near = 0.1 * row.case.bound * abs(scale) + printed
        assert row.got == pytest.approx(float(got), abs=near), row.case.name


def test_every_engine_has_a_closed_form_in_the_quick_set():
    names = " ".join(case.name for case in cases() if case.kind == CLOSED_FORM)
    assert all(re.search(engine, names) for engine in ("equilibrium", "nscd", "distinct"))
