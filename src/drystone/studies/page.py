"""``report.html`` of a study: its numbers and figures on one page to hand over."""

from __future__ import annotations

import json
import shutil
from collections.abc import Mapping
from importlib import resources
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

from drystone.common.language import current, number, speaking
from drystone.io.results.folder import whole_file
from drystone.report.canvas import image
from drystone.report.document.template import template
from drystone.studies.conduct import record_of
from drystone.studies.findings import on_peaks
from drystone.studies.words import (
    SEARCHED,
    in_figure,
    language_of,
    of_reason,
    of_sentence,
    of_status,
    why_not_fitted,
    word,
)

#: Figures; what they show is ``study_figure`` of the languages.
FIGURES = ("target", "bands", "tornado", "indices", "scatter", "fragility", "convergence")
_QUANTILES = ("mean", "std", "least", "p05", "median", "p95", "greatest")
#: Heads of tables, see ``study`` of the languages.
_RESULTS = ("mean", "deviation", "least", "p05", "median", "p95", "greatest")
_EFFECTS = ("parameter", "low", "mean_there", "high", "mean_there", "rank")
_FRAGILITY = ("method", "n_samples", "left_out", "median", "p95", "beta", "p95")


def write_page(folder: Path, path: Path, *, language: str | None = None) -> None:
    """Write the page of a study's folder; whole or not at all.

    Parameters
    ----------
    language
        One of `drystone.common.language.LANGUAGES`; by default what the model asks for.
    """
    text = render(record_of(folder) or {}, folder, language=language)
    with whole_file(path) as draft:
        draft.write_text(text, encoding="utf-8")


def render(record: Mapping[str, Any], folder: Path, *, language: str | None = None) -> str:
    """The page as text."""
    drawn = language_of((record.get("study") or {}).get("model"))
    with speaking(language or drawn), TemporaryDirectory() as again:
        figures = folder if current() == drawn else _drawn(record, folder, Path(again))
        return _rendered(record, figures)


def _drawn(record: Mapping[str, Any], folder: Path, into: Path) -> Path:
    """A folder with the figures of a study in the language that is spoken."""
    from drystone.studies.figures import draw_all, target

    if "curve" in record:  # of a search
        target(record["study"]["target"], record["parameters"][0], record, into)
    elif "effects" in record:
        draw_all(record["title"], folder, record, into)
    for name in FIGURES:  # the map of two parameters stays as it is
        file = folder / f"{name}.png"
        if file.is_file() and not (into / file.name).is_file():
            shutil.copy(file, into)
    return into


def _rendered(record: Mapping[str, Any], folder: Path) -> str:
    """The page in the language that is spoken, with the figures of a folder."""
    style = resources.files("drystone.report.document") / "templates" / "report.css"
    status = record.get("status")
    return template("drystone.studies", "study.html.j2").render(
        language=current(),
        word=word,
        title=record.get("title", ""),
        unfinished=None if status in SEARCHED else of_status(status) if status else word("unknown"),
        sentence=of_sentence(record),
        style=style.read_text(encoding="utf-8"),
        facts=_facts(record),
        reasons=[(of_reason(why), n) for why, n in (record.get("reasons") or {}).items()],
        tables=list(_tables(record)),
        figures=[
            (in_figure(name), image((folder / f"{name}.png").read_bytes(), in_figure(name), "png"))
            for name in FIGURES
            if (folder / f"{name}.png").is_file()
        ],
        study=json.dumps(record.get("study", {}), indent=2, ensure_ascii=False),
    )  # fmt: skip


def counts_of(record: Mapping[str, Any]) -> str:
    """How many samples have which status."""
    known = record.get("statuses") or {}
    return ", ".join(word("count", n=n, status=of_status(status)) for status, n in known.items())


def _facts(record: Mapping[str, Any]) -> list[tuple[str, str]]:
    counts, n, runs = counts_of(record), record.get("n_samples"), record.get("n_runs")
    found = [
        ("design", word("designed", design=str(record.get("design")), seed=record.get("seed"))),
        ("n_samples", word("counted", n=n, counts=counts) if counts else word("runs", n=runs)),
        ("parameters", ", ".join(record.get("parameters", []))),
        ("outputs", ", ".join(record.get("outputs", []))),
        ("version", str(record.get("version"))),
        ("fingerprint", str(record.get("fingerprint"))),
    ]  # fmt: skip
    if record.get("n_certified") is not None:
        found.insert(2, ("certified", word("within", n=record["n_certified"])))
    found += [("peak", note) for note in on_peaks(record)]
    return [(word(name), value) for name, value in found]


def _head(*keys: str) -> list[str]:
    return [word(key) if key else "" for key in keys]


def _tables(record: Mapping[str, Any]) -> Any:
    """Heading, head and rows of each table."""
    if columns := record.get("columns"):
        rows = [[name, *(_number(own[key]) for key in _QUANTILES)] for name, own in columns.items()]
        yield word("results"), _head("", *_RESULTS), rows
    for output, own in (record.get("effects") or {}).items():
        rows = [
            [name, *(_number(one[key]) for key in
                     ("low_value", "low", "high_value", "high", "rank_correlation"))]
            for name, one in own.items()
        ]  # fmt: skip
        if rows:
            yield word("effects", output=output), _head(*_EFFECTS), rows
    for output, own in (record.get("indices") or {}).items():
        if own:
            keys = list(next(iter(own["parameters"].values())))
            rows = [
                [name, *(_number(one[key]) for key in keys)]
                for name, one in own["parameters"].items()
            ]
            head = _head("parameter", *map(_index_key, keys))
            yield word("indices", output=output), head, rows
        if own and own.get("second"):
            rows = [
                [word("pair", a=a, b=b), _number(s), _number(c)] for a, b, s, c in own["second"]
            ]
            head = _head("parameters", "second", "interval")
            yield word("second_order", output=output), head, rows
    if curves := record.get("fragility"):
        yield word("fragility"), _head("", *_FRAGILITY), [_fragility(one) for one in curves]


def _fragility(one: Mapping[str, Any]) -> list[str]:
    """The row of a fragility curve, or of why there is none."""
    begun = [one["name"], one["method"]]
    if one.get("median") is None:
        why = word("not_fitted", why=why_not_fitted(one))
        return [*begun, why, _number(one.get("n_left_out")), *[""] * 4]
    return [
        *begun, str(one["n"]), _number(one.get("n_left_out")), _number(one["median"]),
        _pair(one["median_confidence"]), _number(one["beta"]), _pair(one["beta_confidence"]),
    ]  # fmt: skip


def _index_key(key: str) -> str:
    """The word of a column of indices; one of a confidence holds half the interval of the one
    before."""
    return "interval" if key.endswith("_confidence") else key


def _number(value: Any) -> str:
    if isinstance(value, float):
        return number(value, ".5g")
    return "" if value is None else str(value)


def _pair(values: Any) -> str:
    low, high = map(_number, values)
    return word("between", low=low, high=high)
