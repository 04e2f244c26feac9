"""Which parameter matters: Sobol and Morris indices by SALib, and effects of each parameter."""

from __future__ import annotations

from typing import Any

import numpy as np

from drystone.common.arrays import Array
from drystone.studies.designs import problem_of, unit_cube
from drystone.studies.errors import needed
from drystone.studies.study import Study

#: Resamples of confidence intervals, and their level.
RESAMPLES, LEVEL = 200, 0.95
#: Share of the samples at either end of a parameter whose means its effect is between.
TAIL = 0.1


def sobol(asked: Study, values: Array) -> dict[str, Any] | None:
    """First and total indices of an output of a "saltelli" design, each with its half interval.

    Base samples of which one run has no number are left out, and counted.

    Parameters
    ----------
    values
        (count,) of the samples in their order, NaN where there is none.
    """
    names = list(asked.task.names)
    block = asked.count // asked.n
    whole = np.isfinite(values.reshape(asked.n, block)).all(axis=1)
    kept = values.reshape(asked.n, block)[whole].ravel()
    if whole.sum() < 2 or not np.ptp(kept) > 0.0:
        return None
    found = needed("SALib.analyze.sobol").analyze(
        problem_of(names),
        kept,
        calc_second_order=asked.second_order,
        num_resamples=RESAMPLES,
        conf_level=LEVEL,
        seed=asked.seed,
    )
    indices: dict[str, Any] = {
        name: {
            "first": float(found["S1"][k]),
            "first_confidence": float(found["S1_conf"][k]),
            "total": float(found["ST"][k]),
            "total_confidence": float(found["ST_conf"][k]),
        }
        for k, name in enumerate(names)
    }
    told: dict[str, Any] = {"parameters": indices, "n_left_out": int((~whole).sum())}
    if asked.second_order:
        told["second"] = [
            [names[i], names[j], float(found["S2"][i, j]), float(found["S2_conf"][i, j])]
            for i in range(len(names))
            for j in range(i + 1, len(names))
        ]
    return told


def morris(asked: Study, values: Array) -> dict[str, Any] | None:
    """Mean absolute elementary effect and deviation of effects of a "morris" design.

    Effects are those of a parameter over the whole of its range, in the unit of the output.
    """
    names = list(asked.task.names)
    block = len(names) + 1
    whole = np.isfinite(values.reshape(asked.n, block)).all(axis=1)
    if whole.sum() < 2:
        return None
    points = unit_cube(asked.design, asked.n, asked.laws, asked.seed, asked.levels, False)
    points = points.reshape(asked.n, block, len(names))[whole].reshape(-1, len(names))
    found = needed("SALib.analyze.morris").analyze(
        problem_of(names),
        points,
        values.reshape(asked.n, block)[whole].ravel(),
        num_levels=asked.levels,
        num_resamples=RESAMPLES,
        conf_level=LEVEL,
        seed=asked.seed,
    )
    return {
        "parameters": {
            name: {
                "mu_star": float(found["mu_star"][k]),
                "mu_star_confidence": float(found["mu_star_conf"][k]),
                "mu": float(found["mu"][k]),
                "sigma": float(found["sigma"][k]),
            }
            for k, name in enumerate(names)
        },
        "n_left_out": int((~whole).sum()),
    }


def effects(asked: Study, frame: Any, column: str) -> dict[str, Any]:
    """Mean of an output where a parameter is low and where it is high, and the rank correlation.

    Low and high are the lowest and the highest tenth of the samples, or the least and the greatest
    value of a parameter of few values.
    """
    from scipy.stats import spearmanr

    found: dict[str, Any] = {}
    types = needed("pandas").api.types
    y = frame[column].to_numpy(dtype=float, na_value=np.nan)
    for name in asked.task.names:
        if not types.is_numeric_dtype(frame[name]):
            continue
        x = frame[name].to_numpy(dtype=float)
        known = np.isfinite(y) & np.isfinite(x)
        if known.sum() < 2 or not np.ptp(x[known]) > 0.0:
            continue
        a, b = np.quantile(x[known], [TAIL, 1.0 - TAIL])
        low, high = known & (x <= a), known & (x >= b)
        rank = float(spearmanr(x[known], y[known]).statistic) if np.ptp(y[known]) > 0.0 else 0.0
        found[name] = {
            "low_value": float(x[low].mean()),
            "high_value": float(x[high].mean()),
            "low": float(y[low].mean()),
            "high": float(y[high].mean()),
            "rank_correlation": rank,
        }
    return found


def convergence(values: Array, points: int = 40) -> dict[str, Any] | None:
    """Mean and quantiles of the first samples of a study, for more and more of them.

    ``error`` is the standard error of the mean.
    """
    known = values[np.isfinite(values)]
    if len(known) < 8:
        return None
    counts = np.unique(np.geomspace(8, len(known), points).astype(int))
    rows = [
        (len(part), part.mean(), part.std(ddof=1) / np.sqrt(len(part)), *np.quantile(part, _SHARES))
        for part in (known[:n] for n in counts)
    ]
    names = ("n", "mean", "error", "p05", "median", "p95")
    return {name: list(column) for name, column in zip(names, zip(*rows, strict=True), strict=True)}


_SHARES = [0.05, 0.5, 0.95]
