"""``report.html``: everything that is known of a folder of results, on one page to hand over."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from datetime import UTC, datetime
from importlib import resources
from pathlib import Path
from typing import Any

import numpy as np

from drystone.assessment.verdict import sense_words
from drystone.common.language import number, speaking, spoken, words
from drystone.common.version import package_version
from drystone.io.results.folder import whole_file
from drystone.io.results.names import RESULTS
from drystone.io.results.results_reader import ResultsReader
from drystone.model.assembly import GRAVITY
from drystone.report import Mechanism
from drystone.report.document import carried, facts, figures, supports
from drystone.report.document.judged import Judged
from drystone.report.document.template import template
from drystone.report.mechanism import readable_magnification
from drystone.report.quantities import Quantities
from drystone.report.viewer import Mark, page
from drystone.report.viewer.contents import marks_of, nearest
from drystone.report.viewer.folder import Folder
from drystone.results.curve import STATIC, CapacityCurve

#: Figures of an assessment that the report lists, with their units.
FIGURES = (
    ("activation_multiplier", ""),
    ("activation_acceleration", "m/s²"),
    ("mechanism_mass", "kg"),
    ("participating_mass", "kg"),
    ("participating_mass_ratio", ""),
    ("participation_factor", ""),
    ("collapse_displacement", "m"),
    ("control_collapse_displacement", "m"),
    ("yield_displacement", "m"),
    ("yield_acceleration", "m/s²"),
    ("confidence_factor", ""),
    ("safety_index", ""),
)


def write_report(
    path: Path, found: Folder, *, language: str | None = None, date: datetime | None = None
) -> None:
    """Write the report of a folder; whole or not at all.

    Parameters
    ----------
    path
        File to write.
    language
        One of `drystone.common.language.LANGUAGES`; what the model or its assessment asks for,
        where nothing is said.
    date
        That stands in the report; now, where nothing is said.
    """
    text = render(found, language=language, date=date)
    with whole_file(path) as draft:
        draft.write_text(text, encoding="utf-8")


def render(found: Folder, *, language: str | None = None, date: datetime | None = None) -> str:
    """The report as text, see `write_report`."""
    document = template("drystone.report.document", "report.html.j2")
    with speaking(language or _language_asked(found)):
        return document.render(context(found, date))


def _language_asked(found: Folder) -> str:
    """The language of the folder's assessment, or of its model."""
    model = found.results.model
    asked = {} if model is None or model.assessment is None else model.assessment.values
    return str(found.assessment.get("language") or asked.get("language") or "en")


# Long: a line for each part of the page.
def context(found: Folder, date: datetime | None) -> dict[str, Any]:
    """What the template is given, in the language that is spoken."""
    t = words()
    results = found.results
    curve, model = results.curve, results.model
    judged = Judged.of(found)
    tell = judged.tell
    marks = [*marks_of(curve), *judged.folder.limit_marks]
    contents = judged.folder.contents()
    ground = judged.drawn_spectra(t["text"]["all_states"])
    shown = _states_shown(judged)
    mechanisms = [_mechanism(mark, folder) for mark, folder in shown]
    coloured = any(mechanism.bodies is not None for mechanism in mechanisms)
    signs = figures.legend(mechanisms) if mechanisms else []
    moves_supports = curve.moves_supports
    return {
        "t": t,
        "style": _own("report.css"),
        "name": t["name_supports" if moves_supports else "name"],
        "moves_supports": moves_supports,
        "title": str(contents.header["title"]) or t["name_supports" if moves_supports else "name"],
        "problem": _problem(curve, model is None, t["text"]),
        "verdict": tell(judged.verdict),
        "satisfied": judged.data.get("satisfied"),
        "caution": bool(judged.data.get("caution")),
        "no_verdict": tell(judged.reason),
        "outcome": supports.outcome(curve, model, t["text"]) if moves_supports else "",
        "curve": figures.curve_picture(judged.curves, marks, t["plot"]),
        "sense": "" if moves_supports else judged.sense_sentence(t["text"]),
        "analysis": supports.of_analysis(curve, model, t["facts"])
        if moves_supports
        else facts.of_analysis(curve, model, results.summary, t["facts"]),
        "cycles": facts.of_cycles(curve, t["cycles"]),
        "certificate": facts.of_certificate(curve, model, t["facts"]),
        "states": [_shown(s, mechanism, t) for s, mechanism in zip(shown, mechanisms, strict=True)],
        "legend": [(sign, t["legend"][key]) for sign, key in signs],
        "coloured": coloured,
        "ties_at": _ties_at(shown, t),
        "assessment": _figures(judged.data, t["facts"]),
        "limit_states": limit_table(judged, t["table"]),
        "asked": _asked(judged.data.get("hazard") or [], t["table"]),
        "readings": _readings(judged, t["table"]),
        "reading": judged.data.get("reading"),
        "adrs": _adrs(judged, t["plot"]),
        "hazard": figures.spectra_picture(ground, t["plot"]) if ground else "",
        "hazard_rows": [(name, spoken(spectrum.label)) for name, (spectrum, _) in ground.items()],
        "assumptions": [tell(said) for said in judged.data.get("assumptions") or []],
        "uncertain": [tell(said) for said in judged.data.get("uncertain") or []],
        "model": facts.of_model(model, t["facts"]) if model else [],
        "materials": facts.of_materials(model.assembly) if model else [],
        "laws": facts.of_laws(model.assembly, t["table"]) if model else [],
        "ties": carried.of_ties(model.ties, t["ties"]) if model else [],
        "dead_loads": carried.of_dead_loads(model, t["loads"]) if model else [],
        "notes": list(model.notes) if model else [],
        "validity": facts.validity(
            curve, model, bool(judged.data.get("collapse_extrapolated")), t["validity"]
        ),
        "software": _software(contents.header, results.path, date, t["facts"]),
        "source": _source(results.path),
        "viewer": json.dumps(page(contents)).replace("<", "\\u003c"),
    }


def _own(name: str) -> str:
    return (resources.files("drystone.report.document") / "templates" / name).read_text(
        encoding="utf-8"
    )


def _problem(curve: CapacityCurve, unreadable: bool, text: Mapping[str, str]) -> list[str]:
    """What the reader has to know before all else."""
    problems = [text["unreadable"]] if unreadable else []
    if not curve.points:
        problems.append(text["no_points"])
    if curve.status == "running":
        problems.append(text["running"])
    return problems


def _states_shown(judged: Judged) -> list[tuple[Mark, Folder]]:
    """Peak, limit states, the last point at rest, each with the folder whose curve it is on.

    Of supports that move their first, least, greatest and last reaction.
    """
    folder = judged.governing
    curve = folder.results.curve
    if not curve.points or folder.results.model is None:
        return []
    if curve.moves_supports:
        return [(mark, folder) for mark in marks_of(curve) if mark.kind == "rest"]
    last = [point for point in curve.points if point.status == STATIC][-1]
    end = Mark(
        name="end",
        control_displacement=last.control_displacement,
        load_multiplier=last.load_multiplier,
        kind="end",
    )
    peak = [mark for mark in marks_of(curve) if mark.kind == "peak"]
    chosen = [*peak, *folder.limit_marks, end]
    rows = [nearest(curve, mark) for mark in chosen]
    return [(m, folder) for i, m in enumerate(chosen) if rows[i] not in rows[:i]]


def _mechanism(mark: Mark, folder: Folder) -> Mechanism:
    """The structure at a mark, as it is drawn."""
    results = folder.results
    model, curve, poses = results.model, results.curve, results.poses
    assert model is not None
    row = nearest(curve, mark)
    departed = curve.departed(model.assembly.ids, curve.points[row].step)
    pose = np.where(departed[:, None], poses[0], poses[row])
    return Mechanism(
        assembly=model.assembly,
        pose=pose,
        initial=poses[0],
        departed=departed,
        load_direction=model.load_shown,
        control_point=None if model.settlement is not None else model.control_point,
        ties=model.ties,
        tie_branch=curve.ties.branch[row] if curve.ties else None,
        dead_loads=model.dead_loads,
        magnification=readable_magnification(model.assembly, pose, poses[0]),
        bodies=None if folder.labels is None else np.array(folder.labels, np.int64),
    )


def _named(mark: Mark, text: Mapping[str, str]) -> str:
    """What a mark is called in the language of the report."""
    known = {"peak": "peak", "highest so far": "highest", "end": "end"}
    if mark.name in known:
        return text[known[mark.name]]
    return spoken(mark.name)


def _shown(
    shown: tuple[Mark, Folder], mechanism: Mechanism, t: Mapping[str, Any]
) -> dict[str, str]:
    """A picture of the structure at a mark, with its words."""
    mark, folder = shown
    curve = folder.results.curve
    point = curve.points[nearest(curve, mark)]
    name, quantities = _named(mark, t["text"]), Quantities.of(curve)
    if curve.moves_supports:
        caption = t["plot"]["supports_state"].format(
            name=name,
            motion=quantities.motion_text(point.control_displacement),
            reaction=quantities.force_text(point),
        )
    else:
        caption = t["plot"]["state"].format(
            name=name,
            displacement=facts.number(point.control_displacement, "m"),
            multiplier=facts.number(point.load_multiplier),
        )
    text, factor = t["text"], mechanism.magnification
    scale = text["true"] if factor == 1.0 else text["magnified"].format(factor=number(factor, "g"))
    return {
        "picture": figures.state_picture(mechanism, caption),
        "caption": caption,
        "scale": scale,
    }


def _ties_at(shown: list[tuple[Mark, Folder]], t: Mapping[str, Any]) -> dict[str, Any] | None:
    """What ties carry in the states that are drawn: a head and a row for each; None without."""
    if not shown:
        return None
    curve = shown[0][1].results.curve
    if curve.ties is None:
        return None
    rows = [nearest(curve, mark) for mark, _ in shown]
    head = [t["ties"]["tie"], *(_named(mark, t["text"]) for mark, _ in shown)]
    return {"head": head, "rows": carried.ties_at(curve.ties, rows, t["ties"])}


def _figures(data: Mapping[str, Any], t: Mapping[str, str]) -> list[facts.Row]:
    if not data:
        return []
    rows = [(t["method"], str(data.get("method"))), (t["reading"], str(data.get("reading")))]
    mechanism = data.get("mechanism") or {}
    if "n_bodies" in mechanism:
        rows.append((t["bodies"], facts.number(mechanism["n_bodies"])))
    if data.get("governing_sense"):
        rows.append((t["sense"], spoken(sense_words(str(data["governing_sense"])))))
    for key, unit in FIGURES:
        if data.get(key) is not None:
            rows.append((t[key], facts.number(float(data[key]), unit)))
    return rows


def limit_table(judged: Judged, t: Mapping[str, str]) -> list[dict[str, Any]]:
    """A row for each limit state: capacity, demand, verdict, clause."""

    def shown(state: Mapping[str, Any], key: str, factor: float = 1.0) -> str:
        value = state.get(key)
        return facts.number(None if value is None else factor * float(value))

    holds = {True: t["yes"], False: t["no"], None: facts.NOTHING}
    return [
        {
            "name": name,
            "cells": [
                shown(state, "limit_displacement"),
                shown(state, "limit_acceleration"),
                shown(state, "limit_period"),
                shown(state, "equivalent_damping", 100.0),
                shown(state, "displacement_demand"),
                shown(state, "ground_acceleration_capacity", 1.0 / GRAVITY),
                shown(state, "ground_acceleration_demand", 1.0 / GRAVITY),
                shown(state, "safety_index"),
            ],
            "holds": holds[state.get("satisfied") if state.get("verified", True) else None],
            "satisfied": state.get("satisfied") if state.get("verified", True) else None,
            "verified": state.get("verified", True),
            "clause": judged.tell(state.get("clause", "")),
            "governed_by": judged.tell(state.get("governed_by", "")),
        }
        for name, state in (judged.data.get("limit_states") or {}).items()
    ]


def _asked(motions: Sequence[Mapping[str, Any]], t: Mapping[str, str]) -> list[tuple[str, ...]]:
    """What the code asks of the site for each limit state."""
    return [
        (
            str(motion["state"]),
            facts.number(100.0 * float(motion["probability"]), "%"),
            facts.number(float(motion["reference_life"]), t["years"]),
            facts.number(float(motion["return_period"]), t["years"]),
            t["not_given"].format(state=motion["state"])
            if motion["ground_acceleration"] is None
            else facts.number(float(motion["ground_acceleration"]) / GRAVITY, "g"),
        )
        for motion in motions
    ]


def _readings(judged: Judged, t: Mapping[str, str]) -> list[tuple[str, ...]]:
    readings = judged.data.get("readings") or {}
    if len(readings) < 2:
        return []
    return [
        (
            name,
            t["of_the_code"] if found.get("of_the_code") else t["beside"],
            facts.number(found.get("activation_acceleration")),
            facts.number(found.get("collapse_displacement")),
            facts.number(found.get("safety_index")),
        )
        if "reason" not in found
        else (name, judged.tell(str(found["reason"])), "", "", "")
        for name, found in readings.items()
    ]


def _adrs(judged: Judged, t: Mapping[str, str]) -> str:
    """Capacity against demand; empty where there is no assessment."""
    d, a = (judged.data.get(f"spectral_{name}") for name in ("displacement", "acceleration"))
    if not d or not a:
        return ""
    factor = judged.data.get("confidence_factor") or 1.0
    states = {
        name: (float(state["limit_displacement"]), float(state["limit_acceleration"]))
        for name, state in (judged.data.get("limit_states") or {}).items()
        if state.get("limit_displacement") and state.get("limit_acceleration")
    }
    capacity = np.asarray(d, float), np.asarray(a, float) / factor
    return figures.adrs_picture(capacity, judged.demand_spectra, states, t)


def _software(
    header: Mapping[str, Any], folder: Path, date: datetime | None, t: Mapping[str, str]
) -> list[facts.Row]:
    day = (date or datetime.now(UTC)).strftime("%Y-%m-%d %H:%M %Z").strip()
    return [
        (t["version_run"], str(header["version"])),
        (t["version_report"], package_version()),
        (t["digest"], str(header["model_sha256"])),
        (t["folder"], folder.resolve().name),
        (t["date"], day),
    ]


def _source(folder: Path) -> str:
    """The model file's text, as the results keep it."""
    with ResultsReader(folder / RESULTS) as reader:
        return str(reader.attribute("model"))
