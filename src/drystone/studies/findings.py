"""What the samples of a study say together: numbers for ``study.json`` and figures."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np

from drystone.common.arrays import Array
from drystone.io.results.summary import plain
from drystone.studies import indices
from drystone.studies.errors import needed
from drystone.studies.fragility import fitted
from drystone.studies.study import ABOUT, Study
from drystone.studies.tables import column_names, read_samples
from drystone.studies.words import word

#: Columns that indices and effects are told of; of a function all.
MAIN = (
    "peak_multiplier", "ultimate_displacement", "capacity_multiplier", "limit_associative",
    "limit_non_associative", "safety_index", "safety_index_against", "governing_safety_index",
    "least_reaction", "greatest_reaction", "largest_motion",
)  # fmt: skip


def findings(asked: Study, folder: Path) -> dict[str, Any]:
    """Counts by status, quantiles of every number, and what the design is for."""
    frame = read_samples(folder)
    columns = numbers(asked, folder, frame)
    values = _distinct(
        {name: _array(frame, name) for name in columns if asked.task.function or name in MAIN}
    )
    main = list(values)
    wrong = frame["status"] != "finished"
    found: dict[str, Any] = {
        "statuses": frame["status"].value_counts().to_dict(),
        "reasons": frame["reason"][wrong].value_counts()[:10].to_dict(),
        "n_certified": _count(frame, "certified", True),
        "n_peaks_not_passed": _count(frame, "peak_passed", False),
        "n_peaks_after_collapse": _after_collapse(frame),
        "columns": {name: _summary(_array(frame, name)) for name in columns},
        "effects": {name: indices.effects(asked, frame, name) for name in main},
        "convergence": {name: indices.convergence(values[name]) for name in main},
        "fragility": [fitted(one, frame, asked.seed) for one in asked.fragility],
        "extremes": _extremes(values),
    }
    judge = {"saltelli": indices.sobol, "morris": indices.morris}.get(asked.design)
    if judge is not None:
        found["indices"] = {name: judge(asked, values[name]) for name in main}
    return plain(found)  # type: ignore[no-any-return]


def on_peaks(found: Mapping[str, Any]) -> list[str]:
    """Sentences, in the language that is spoken, where the greatest multiplier of samples is not
    the one that their structure bears."""
    many, said = found.get("n_samples"), []
    if number := found.get("n_peaks_not_passed"):
        said.append(word("not_passed", n=number, many=many))
    if number := found.get("n_peaks_after_collapse"):
        said.append(word("after_collapse", n=number, many=many))
    return said


def _distinct(values: dict[str, Array]) -> dict[str, Array]:
    """Without columns that are the same as one before, as the capacity is where nothing falls."""
    found: dict[str, Array] = {}
    for name, own in values.items():
        if not any(np.array_equal(own, other, equal_nan=True) for other in found.values()):
            found[name] = own
    return found


def numbers(asked: Study, folder: Path, frame: Any) -> list[str]:
    """Names of the columns of results that hold numbers."""
    own = [n for n in column_names(folder) if n not in (*ABOUT, *asked.task.names)]
    types = needed("pandas").api.types
    numeric = [
        n for n in own if types.is_numeric_dtype(frame[n]) and not types.is_bool_dtype(frame[n])
    ]
    return [n for n in numeric if frame[n].notna().any()]


def _array(frame: Any, name: str) -> Array:
    """A column as numbers, NaN where there is none."""
    return frame[name].to_numpy(dtype=float, na_value=np.nan)  # type: ignore[no-any-return]


def _count(frame: Any, name: str, value: bool) -> int | None:
    """Samples of which a column is true, or false; None where there is no such column."""
    return int((frame[name] == value).sum()) if name in frame else None


def _after_collapse(frame: Any) -> int | None:
    """Samples that bear more after a part of them has collapsed; None without such columns."""
    if not {"peak_multiplier", "capacity_multiplier"} <= set(frame):
        return None
    return int((_array(frame, "peak_multiplier") > _array(frame, "capacity_multiplier")).sum())


def _extremes(values: dict[str, Array]) -> dict[str, Any]:
    """Samples of the least and the greatest value of each output."""
    return {
        name: {"least": int(np.nanargmin(own)), "greatest": int(np.nanargmax(own))}
        for name, own in values.items()
    }


def _summary(column: Array) -> dict[str, float]:
    known = column[np.isfinite(column)]
    q = np.quantile(known, [0.05, 0.16, 0.5, 0.84, 0.95])
    return {
        "n": len(known), "mean": known.mean(), "std": known.std(ddof=1) if len(known) > 1 else 0.0,
        "least": known.min(), "p05": q[0], "p16": q[1], "median": q[2], "p84": q[3], "p95": q[4],
        "greatest": known.max(),
    }  # fmt: skip
