"""Sentences in several languages: the same keys and fields, nothing that is said past them."""

import ast
import json
import pickle
import re
import shutil
import string
from html import unescape
from pathlib import Path
from typing import get_args

import numpy as np
import pytest
from typer.testing import CliRunner

import drystone as ds
from drystone.assessment.bilinear import drop_point
from drystone.assessment.errors import AssessmentError
from drystone.cli import app
from drystone.cli.options import Language
from drystone.common.language import (
    LANGUAGES,
    Saying,
    catalogue,
    number,
    said_end,
    say,
    speaking,
    spoken,
)
from drystone.common.version import package_version
from drystone.io.modelfile.assessing import AssessmentSection
from drystone.report.document.report import render
from drystone.report.viewer.folder import Folder
from drystone.results.events import Event, EventKind, Outcome, named
from piers import piers
from sites import TABLES

ROOT = Path(__file__).parents[2]
FILES = (*catalogue.SENTENCES, catalogue.REPORT)
OTHERS = [language for language in LANGUAGES if language != "en"]


def test_languages_are_those_of_the_key_and_of_the_option():
    key = AssessmentSection.model_fields["language"].annotation
    assert set(get_args(get_args(key)[0])) == set(LANGUAGES) == set(map(str, Language))


def leaves(table, path=""):
    """Templates by their path."""
    for key, value in table.items():
        if isinstance(value, dict):
            yield from leaves(value, f"{path}{key}.")
        else:
            yield f"{path}{key}", value


def fields_of(template):
    return sorted((n, form) for _, n, form, _ in string.Formatter().parse(template) if n)


@pytest.mark.parametrize("language", OTHERS)
@pytest.mark.parametrize("name", FILES)
def test_languages_have_the_same_keys_and_fields(language, name):
    english = dict(leaves(catalogue.table("en", name)))
    other = dict(leaves(catalogue.table(language, name)))
    assert english.keys() == other.keys()
    for key, template in english.items():
        assert fields_of(template) == fields_of(other[key]), key


@pytest.mark.parametrize("language", OTHERS)
def test_sentences_are_translated(language):
    """What is alike in both has no words: signs, symbols, clauses, keys of files."""
    alike = {
        key: template
        for name in FILES
        for key, template in leaves(catalogue.table("en", name))
        if template == dict(leaves(catalogue.table(language, name)))[key]
    }
    for key, template in alike.items():
        words = re.findall(r"\b[a-zà-ù]{4,}\b", re.sub(r"{.*?}", "", template))
        assert set(words) <= {"zeta", "volume"}, (key, template)


def test_every_key_is_said_somewhere_and_there_is_none_else():
    """Keys stand whole in the source, but for those that are made of a name."""
    source = "\n".join(p.read_text() for p in (ROOT / "src/drystone").rglob("*.py"))
    made = (
        *("reading.", "status.", "named.", "ntc2018_global.", "rocking.", "screen."),
        *("laboratory.", "laboratory_head.", "study.", "study_figure.", "study_column."),
        *("study_screen.",),
    )
    given = {"named", "status"}  # the noun, and how a run ended, are names
    for key in catalogue.templates("en"):
        section, last = key.split(".")
        asked = key.startswith(made) and re.search(rf"[\"']{last}[\"']", source)
        assert section in given or asked or f'"{key}"' in source, key
    for key in re.findall(r'say\(\s*"([a-z0-9_A-Z]+\.[a-z0-9_A-Z]+)"', source):
        assert key in catalogue.templates("en"), key


class TestSaying:
    def test_is_english_text_and_knows_more(self):
        said = say("mechanism.straight", end=0.4961, place=0.4962)
        assert "straight line to 0.4961 m" in said and isinstance(said, str)
        assert "retta fino a 0,4961 m" in said.in_language("it")
        with speaking("it"):
            assert spoken(said) == said.in_language("it")
            assert spoken("words of nobody") == "words of nobody"
        assert spoken(said) == said

    def test_sayings_in_sayings_and_lists(self):
        inner = say("verdict.motion", state="SLD", years=50.3)
        said = say("verdict.missing_motions", states=[inner], tables=["[site.SLD]"])
        assert "SLD (50 years)" in said and "SLD (50 anni)" in said.in_language("it")

    def test_numbers_in_a_list_are_told_apart(self):
        said = say("load.along", pattern="mass", direction=[0.5, -1.0])
        assert said == "mass along (0.5, -1)"
        assert said.in_language("it") == "mass in direzione (0,5; -1)"

    def test_keys_and_fields_survive_a_file_and_a_process(self):
        inner = say("verdict.index", index=0.5, more=say("verdict.nothing"))
        said = say("verdict.weight", what=inner)
        for again in (
            Saying.from_dict(json.loads(json.dumps(said.as_dict()))),
            pickle.loads(pickle.dumps(said)),
        ):
            assert again == said and again.in_language("it") == said.in_language("it")

    def test_what_a_file_says_of_another_version_stays(self):
        assert spoken("text", {"text": {"key": "no.such", "fields": {}}}) == "text"

    def test_an_unknown_language_is_refused(self):
        with pytest.raises(ValueError, match='no words in "xx"'), speaking("xx"):
            pass

    def test_numbers(self):
        with speaking("it"):
            assert number(0.25) == "0,25" and number(1e-5, ".2g") == "1e-05"
            assert number(1.5e10, ".2g") == "1,5e+10"
        assert number(0.25) == "0.25"


def spoken_in_italian(text):
    with speaking("it"):
        return spoken(text)


class TestEnds:
    """Results keep why a curve ended as English text."""

    @pytest.mark.parametrize(
        ("english", "italian"),
        [
            (
                "the load multiplier fell below 0.01",
                "il moltiplicatore delle azioni è sceso sotto 0,01",
            ),
            (
                'the control displacement reached 0.25 m; the block "a.1" left the structure at '
                "0.05 m (step 7)",
                'lo spostamento di controllo ha raggiunto 0,25 m; il blocco "a.1" ha lasciato la '
                "struttura a 0,05 m (passo 7)",
            ),
            (
                '2 blocks ("a", "b") have collapsed: the analysis ends there, [analysis] falling '
                'is "stop"',
                '2 blocchi ("a", "b") sono crollati: lì termina l\'analisi, [analysis] falling è '
                '"stop"',
            ),
        ],
    )
    def test_is_recognised(self, english, italian):
        assert said_end(english) == english
        assert spoken_in_italian(said_end(english)) == italian

    @pytest.mark.parametrize(
        "end",
        [
            say("end.low_peak", peak=0.005, stop=0.01),
            say("end.in_leg", leg="displacement 2 of 3", how=say("end.no_rest", n=4)),
            say("end.control_moved", block="b1"),
            say("end.nothing_found", why=say("end.no_rest", n=4)),
            say("end.collapsed", how=say("end.no_rest_found", why=say("end.no_load"))),
            say("end.collapsed", how=say("end.falls_back")),
            say("end.runs_away"),
            say("end.supports_fall", why=say("end.moves_on")),
            say("end.supports_fall", why=say("end.one_runs_away", block="b3")),
            say("end.supports_unsolved", why=say("end.sweeps", residual=1.4e4, n=300)),
            say("end.no_rest_found", why=say("end.unbalanced", residual=2e-3, n=100)),
            say("end.supports_fall", why=say("end.too_far")),
            say("end.not_in_this_sense", most=0.12),
            say("end.jump_lost", why=say("end.no_equilibrium", n=50)),
            say("end.nothing_found", why=say("end.met")),
            say("end.no_rest_found", why=say("end.too_weak")),
            say("end.no_rest_found", why=say("end.inexact", residual=1.3e-5, limit=1e-9)),
            say("end.supports_fall", why=say("end.blocks_left", blocks=named(["a"], "block"))),
            say("end.cycles", seconds=1e-9, cycles=1.5, most=100_000),
            say("end.pressed", a="a", b="b", depth=0.01, percent=5.0, most=2.0),
            say("end.not_at_rest", why=say("end.bonds_break")),
            say("end.not_whole", results="results.h5", summary="summary.json", n=3, most=4),
            say("end.too_stiff"),
            say("end.timeout", seconds=0.5),
            say("end.no_verdict", why=say("refused.short", last=0.1, end=0.2)),
            say("end.does_not_stand_one", weight=say("end.own_weight"), blocks='"b" (388 mm)'),
            say(
                "end.does_not_stand",
                weight=say("end.own_weight"),
                blocks='"b" (388 mm), "c" (9 mm)',
            ),
            say(
                "end.does_not_stand_more",
                weight=say("end.with_loads_of", stage=1),
                blocks='"b" (388 mm), "c" (9 mm)',
                n=2,
            ),
            say("end.none_found", weight=say("end.weight_before", stage=1)),
            say("end.opposite", how=say("refused.not_past", end=0.5, left=0.9, share=0.8)),
        ],
    )
    def test_is_recognised_whole(self, end):
        assert end.in_language("it") != str(end)
        assert spoken_in_italian(said_end(str(end))) == end.in_language("it")

    @pytest.mark.parametrize("package", ["statics", "dynamics", "engines", "control", "analysis"])
    def test_no_reason_is_a_text_of_the_source(self, package):
        """Why a step was not solved, or a curve ends, is a saying: no literal is called a reason or
        given as one."""
        found = []
        for path in (ROOT / "src/drystone" / package).rglob("*.py"):
            for node in ast.walk(ast.parse(path.read_text())):
                if isinstance(node, ast.keyword):
                    name, value = node.arg, node.value
                elif isinstance(node, ast.Assign) and isinstance(node.targets[0], ast.Name):
                    name, value = node.targets[0].id, node.value
                else:
                    continue
                words = [part.value for part in ast.walk(value) if isinstance(part, ast.Constant)]
                text = isinstance(value, ast.Constant | ast.JoinedStr)
                if name in ("reason", "why") and text and any(words):
                    found.append((path.name, node.lineno if hasattr(node, "lineno") else 0, words))
        assert not found

    def test_none_holds_the_mark_between_two(self):
        ends = {key: text for key, text in catalogue.templates("en").items() if key[:4] == "end."}
        assert [key for key, text in ends.items() if "; " in text] == ["end.and"]

    def test_one_with_a_semicolon_of_its_own_is_recognised_between_others(self):
        refused = say("refused.not_past", end=0.5, left=0.9, share=0.8)
        assert "; " in refused
        ends = [say("end.steps", n=9), say("end.no_verdict", why=refused), say("end.runs_away")]
        told = spoken_in_italian(said_end("; ".join(ends)))
        assert told == "; ".join(end.in_language("it") for end in ends)

    def test_else_it_stays(self):
        with speaking("it"):
            assert spoken(said_end("something else; altogether")) == "something else; altogether"


def test_why_a_curve_gives_no_verdict():
    with pytest.raises(AssessmentError, match="with 95% of its peak: it is not past 80%") as caught:
        drop_point([0.0, 1.0, 2.0], [0.0, 1.0, 0.95], 0.8)
    assert "non è scesa sotto il 80%" in caught.value.said.in_language("it")
    assert AssessmentError("in words").said == "in words"


def test_events():
    event = Event(
        kind=EventKind.BLOCK_FALLEN, step=3, control_displacement=0.1, load_multiplier=0.25,
        blocks=("a", "b"), motion=0.5, outcome=Outcome.HANGING,
    )  # fmt: skip
    english = (
        'at 0.1 m, multiplier 0.2500: 2 blocks ("a", "b") fall by up to 0.5 m and hang on ties '
        "without a contact"
    )
    assert str(event) == english and type(str(event)) is str
    assert event.said.in_language("it") == (
        'a 0,1 m, moltiplicatore 0,2500: 2 blocchi ("a", "b") cadono, fino a 0,5 m e restano '
        "appesi ai tiranti senza contatti"
    )


@pytest.fixture(scope="module")
def assessed(tmp_path_factory) -> Path:
    """A block on a base, assessed in both senses, in English."""
    folder = tmp_path_factory.mktemp("language")
    file = folder / "model.toml"
    life = 'nominal_life = 50\nuse = "II"\n[assessment]'
    tables = TABLES.replace("[assessment]", life)
    file.write_text((ROOT / "examples/two_blocks.toml").read_text() + tables)
    result = CliRunner().invoke(app, ["assess", str(file), "--out", str(folder / "out"), "-q"])
    assert result.exit_code == 0, result.output
    return folder / "out"


def seen(page):
    """What a reader sees, without the source of the model and what is hidden."""
    page = re.sub(r"<(script|style|pre)\b.*?</\1>", " ", page, flags=re.S)
    return re.sub(r"\s+", " ", unescape(re.sub(r"<[^>]+>", " ", page)))


def spreading(settlement):
    """A block on two supports, of which one moves."""
    corners = {
        "g1": [[-1.0, -0.5], [1.0, -0.5], [1.0, 0.0], [-1.0, 0.0]],
        "g2": [[1.0, -0.5], [3.0, -0.5], [3.0, 0.0], [1.0, 0.0]],
        "b": [[0.5, 0.0], [1.5, 0.0], [1.5, 0.5], [0.5, 0.5]],
    }
    blocks = [
        ds.Block(id=name, vertices=np.array(v), unit_weight=2e4, support=name != "b")
        for name, v in corners.items()
    ]
    joint = ds.JointLaw(friction_coefficient=0.6, normal_stiffness=1e9, shear_stiffness=1e9)
    return ds.make_model(blocks, joint=joint, thickness=1.0, settlement=settlement)


#: Names that are no words: of methods, engines, strategies, patterns, readings, keys of files, the
#: program; of the model itself.
NAMES = {
    "ntc2018", "local", "equilibrium", "displacement", "mass", "base_shear", "energy", "site",
    "literal_ec8", "drystone", "stone", "blocks", "Circ", "title", "Two",
}  # fmt: skip


@pytest.fixture
def masked(monkeypatch):
    """Italian with marks in place of letters and figures."""

    def marked(template):
        parts = []
        for text, name, form, _ in string.Formatter().parse(template):
            parts.append(re.sub(r"[^\W_]", "§", text))
            parts.append("" if name is None else f"{{{name}:{form}}}" if form else f"{{{name}}}")
        return "".join(parts)

    def every(value):
        if isinstance(value, dict):
            return {key: every(item) for key, item in value.items()}
        return marked(value)

    own = catalogue.table.__wrapped__

    def table(language, name):
        return every(own(language, name)) if language == "it" else own(language, name)

    monkeypatch.setattr(catalogue, "table", table)
    catalogue.templates.cache_clear()
    yield
    monkeypatch.undo()
    catalogue.templates.cache_clear()


def read_past_the_marks(page, names):
    """Words and decimal points of a page that come from no table of a language."""
    page = seen(page).replace(package_version(), "")
    letters = re.findall(r"[A-Za-z_0-9]*[a-zà-ù]{3,}[a-z_0-9]*", page)
    words = {word for word in letters if not re.fullmatch(r"[0-9a-f]{64}", word)}
    # Decimal points are those of clauses and of tables alone.
    rest = re.sub(r"C[0-9.]+|[0-9]+\.[0-9]+\.[0-9]+|\[site\.\w+\]", "", page)
    return words - NAMES - set(names), re.findall(r".{20}\d\.\d.{9}", rest)


@pytest.mark.usefixtures("masked")
def test_no_word_of_a_report_comes_from_elsewhere(assessed):
    """With marks in place of a language's words, what can still be read is none of it."""
    page = render(Folder.read(assessed), language="it")
    assert read_past_the_marks(page, {assessed.name}) == (set(), [])


@pytest.mark.usefixtures("masked")
@pytest.mark.parametrize("kind", ["carried", "moved"])
def test_nor_where_ties_and_loads_are_carried_or_supports_move(kind, tmp_path):
    if kind == "carried":
        model = piers(title="", control_block="left").with_analysis(max_displacement=0.02)
        names = {"left", "right", "anchor", "roof", "material1", "max_displacement"}
    else:
        down = ds.Settlement(blocks=("g2",), direction=np.array([0.0, -1.0]), max=0.05)
        model = spreading(down)
        names = {"settlement", "material1"}
    ds.save_results(ds.pushover(model), model, tmp_path / "out")
    page = render(Folder.read(tmp_path / "out"), language="it")
    assert read_past_the_marks(page, {"out", *names}) == (set(), [])


def test_a_report_of_an_english_assessment_in_italian(assessed):
    page = seen(render(Folder.read(assessed), language="it"))
    for words in (
        "moltiplicatore di attivazione",
        "spostamento di controllo",
        "fattore di confidenza",
        "frazione di massa partecipante",
        "fattore di partecipazione",
        "indice di sicurezza ζE",
        "stato limite determinante SLV",
        "il moltiplicatore delle azioni è sceso sotto 0,01",
        "Il cinematismo è la tangente subito dopo il picco",
        "non data: [site.SLD]",
    ):
        assert words in page, words
    assert 'lang="it"' in render(Folder.read(assessed), language="it")
    assert "activation multiplier" in seen(render(Folder.read(assessed)))


def test_the_commands_in_italian(assessed, tmp_path):
    folder = shutil.copytree(assessed, tmp_path / "out")

    def run(*arguments):
        result = CliRunner().invoke(app, [*map(str, arguments)])
        assert result.exit_code == 0, result.output
        return result.stdout

    told = run("assess", folder, "--language", "it")
    assert "zeta_E per lettura" in told and "nota: Il cinematismo è" in told
    assert re.search(r"SLV (sì|NO) +0,\d", told) and "stato limite determinante SLV" in told
    assert "domanda SLV, smorzamento 8 %" in (folder / "adrs.svg").read_text()
    stored = json.loads((folder / "assessment.json").read_text())
    assert stored["language"] == "it" and "verifica" in stored["sentence"]
    # Keys, status and numbers are those of English.
    assert stored["status"] == "assessed" and stored["governing_sense"] in stored["senses"]
    assert 0.0 < stored["limit_states"]["SLV"]["limit_displacement"] < 1.0
    # A report of it is Italian unless another language is asked for.
    run("report", folder)
    assert "Curva di capacità" in (folder / "report.html").read_text()
    run("report", folder, "--language", "en")
    page = seen((folder / "report.html").read_text())
    assert "Capacity curve" in page and "SLV governs, safety index zeta_E" in page
    assert "Il cinematismo" not in page


def test_a_model_may_ask_for_its_language(assessed, tmp_path):
    file = tmp_path / "model.toml"
    found = ds.load_results(assessed)
    file.write_text((assessed.parent / "model.toml").read_text() + 'language = "it"\n')
    model = ds.read_model(file)
    ds.save_results(found.curve, model, tmp_path / "out")
    assert "Curva di capacità" in render(Folder.read(tmp_path / "out"))
    with pytest.raises(ds.ModelError, match=r"assessment\.language"):
        file.write_text(file.read_text().replace('"it"', '"fr"'))
        ds.read_model(file)
