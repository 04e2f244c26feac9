"""What the samples of a study say together: numbers for ``study.json`` and figures."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

from drystone.io.results.summary import plain
from drystone.studies.study import Study
from drystone.studies.tables import column_names, needed, read_samples

#: Columns of samples that are no results of theirs.
_ABOUT = ("sample", "seed", "status", "reason", "seconds", "version", "digest")


def findings(asked: Study, folder: Path) -> dict[str, Any]:
    """Counts by status, quantiles of every number, and what the design is for."""
    frame = read_samples(folder)
    found: dict[str, Any] = {
        "statuses": frame["status"].value_counts().to_dict(),
        "reasons": frame["reason"][frame["status"] != "finished"].value_counts()[:10].to_dict(),
        "n_certified": int(frame["certified"].fillna(False).sum())
        if "certified" in frame
        else None,
        "columns": {name: _summary(frame[name]) for name in numbers(asked, folder, frame)},
    }
    return plain(found)


def numbers(asked: Study, folder: Path, frame: Any) -> list[str]:
    """Names of the columns of results that hold numbers which vary."""
    own = [n for n in column_names(folder) if n not in (*_ABOUT, *asked.task.names)]
    types = needed("pandas").api.types
    numeric = [
        n for n in own if types.is_numeric_dtype(frame[n]) and not types.is_bool_dtype(frame[n])
    ]
    return [n for n in numeric if frame[n].notna().any()]


def _summary(column: Any) -> dict[str, float]:
    known = column.dropna().to_numpy(dtype=float)
    q = np.quantile(known, [0.05, 0.16, 0.5, 0.84, 0.95])
    return {
        "n": len(known), "mean": known.mean(), "std": known.std(ddof=1) if len(known) > 1 else 0.0,
        "least": known.min(), "p05": q[0], "p16": q[1], "median": q[2], "p84": q[3], "p95": q[4],
        "greatest": known.max(),
    }  # fmt: skip
