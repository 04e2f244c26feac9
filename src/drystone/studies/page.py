"""``report.html`` of a study: its numbers and figures on one page to hand over."""

from __future__ import annotations

import json
from collections.abc import Mapping
from importlib import resources
from pathlib import Path
from typing import Any

from drystone.io.results.folder import whole_file
from drystone.report.canvas import image
from drystone.report.document.template import template
from drystone.studies.conduct import record_of
from drystone.studies.findings import on_peaks

#: Figures with what they show.
FIGURES = {
    "target.png": "runs of the search, and the value looked for",
    "bands.png": "curves: median, 5 % to 95 %, and some of them",
    "tornado.png": "effect of each parameter",
    "indices.png": "indices with 95 % confidence",
    "scatter.png": "peak and ultimate displacement",
    "fragility.png": "fragility with 95 % confidence",
    "convergence.png": "estimates with more and more samples",
}
_INTERVAL = "± 95 %"
_QUANTILES = ("mean", "std", "least", "p05", "median", "p95", "greatest")


def write_page(folder: Path, path: Path) -> None:
    """Write the page of a study's folder; whole or not at all."""
    text = render(record_of(folder) or {}, folder)
    with whole_file(path) as draft:
        draft.write_text(text, encoding="utf-8")


def render(record: Mapping[str, Any], folder: Path) -> str:
    """The page as text."""
    style = resources.files("drystone.report.document") / "templates" / "report.css"
    return template("drystone.studies", "study.html.j2").render(
        title=record.get("title", ""),
        status=record.get("status", "unknown"),
        sentence=record.get("sentence"),
        style=style.read_text(encoding="utf-8"),
        facts=_facts(record),
        reasons=list((record.get("reasons") or {}).items()),
        tables=list(_tables(record)),
        figures=[
            (what, image((folder / name).read_bytes(), what, "png"))
            for name, what in FIGURES.items()
            if (folder / name).is_file()
        ],
        study=json.dumps(record.get("study", {}), indent=2, ensure_ascii=False),
    )  # fmt: skip


def _facts(record: Mapping[str, Any]) -> list[tuple[str, str]]:
    counts = ", ".join(f"{n} {status}" for status, n in (record.get("statuses") or {}).items())
    runs = record.get("n_runs")
    found = [
        ("design", f"{record.get('design')}, seed {record.get('seed')}"),
        ("samples", f"{record.get('n_samples')}: {counts}" if counts else f"{runs} runs"),
        ("parameters", ", ".join(record.get("parameters", []))),
        ("outputs", ", ".join(record.get("outputs", []))),
        ("version", str(record.get("version"))),
        ("fingerprint", str(record.get("fingerprint"))),
    ]  # fmt: skip
    if record.get("n_certified") is not None:
        within = f"{record['n_certified']} complete, every point at rest within its engine's bound"
        found.insert(2, ("certified", within))
    return found + [("peak", note) for note in on_peaks(record)]


def _tables(record: Mapping[str, Any]) -> Any:
    """Heading, head and rows of each table."""
    if columns := record.get("columns"):
        rows = [[name, *(_number(own[key]) for key in _QUANTILES)] for name, own in columns.items()]
        yield (
            "Results",
            ("", "mean", "deviation", "least", "5 %", "median", "95 %", "greatest"),
            rows,
        )
    for output, own in (record.get("effects") or {}).items():
        rows = [
            [name, *(_number(one[key]) for key in
                     ("low_value", "low", "high_value", "high", "rank_correlation"))]
            for name, one in own.items()
        ]  # fmt: skip
        if rows:
            head = (
                "parameter",
                "low at",
                "mean there",
                "high at",
                "mean there",
                "rank correlation",
            )
            yield f"Effects on {output}", head, rows
    for output, own in (record.get("indices") or {}).items():
        if own:
            keys = list(next(iter(own["parameters"].values())))
            rows = [
                [name, *(_number(one[key]) for key in keys)]
                for name, one in own["parameters"].items()
            ]
            yield f"Indices of {output}", ("parameter", *map(_index_words, keys)), rows
        if own and own.get("second"):
            rows = [[f"{a} with {b}", _number(s), _number(c)] for a, b, s, c in own["second"]]
            yield f"Second-order indices of {output}", ("parameters", "second", _INTERVAL), rows
    told = [one for one in record.get("fragility") or [] if one.get("median") is not None]
    if told:
        rows = [
            [one["name"], one["method"], one["n"], _number(one["median"]),
             _pair(one["median_confidence"]), _number(one["beta"]), _pair(one["beta_confidence"])]
            for one in told
        ]  # fmt: skip
        yield "Fragility", ("", "method", "samples", "median", "95 %", "beta", "95 %"), rows


def _index_words(key: str) -> str:
    """A column of indices; one of a confidence holds half the interval of the one before."""
    return _INTERVAL if key.endswith("_confidence") else key.replace("mu_star", "mean absolute")


def _number(value: Any) -> str:
    return "" if value is None else f"{value:.5g}" if isinstance(value, float) else str(value)


def _pair(values: Any) -> str:
    return " to ".join(map(_number, values))
