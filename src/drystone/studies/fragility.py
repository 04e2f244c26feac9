"""Fragility curves: how probable it is that a limit state is exceeded, by the intensity.

A curve is the lognormal distribution function of a median and a dispersion beta, which are fitted
to capacities, to counts at some intensities (stripes), or to demands over intensities (a cloud).
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

import numpy as np

from drystone.common.arrays import Array, BoolArray
from drystone.common.language import Saying, say
from drystone.studies.errors import StudyError

#: Level of the intervals, and resamples where they are by bootstrap.
LEVEL, RESAMPLES = 0.95, 1000


def of_capacities(capacity: Array) -> dict[str, Any]:
    """Median and beta of capacities, (n,), all positive.

    Intervals are those of a normal sample: Student's t for the median, chi-squared for beta.
    """
    from scipy.stats import chi2, t

    logs = np.log(capacity)
    n = len(logs)
    mean, beta = float(logs.mean()), float(logs.std(ddof=1))
    half = float(t.ppf(0.5 + 0.5 * LEVEL, n - 1)) * beta / math.sqrt(n)
    low, high = chi2.ppf([0.5 + 0.5 * LEVEL, 0.5 - 0.5 * LEVEL], n - 1)
    return _fit(
        mean,
        beta,
        (mean - half, mean + half),
        (beta * math.sqrt((n - 1) / low), beta * math.sqrt((n - 1) / high)),
        n,
    )


def of_stripes(intensity: Array, exceeded: BoolArray) -> dict[str, Any]:
    """Median and beta of greatest likelihood, for runs at some intensities.

    Intervals are those of the observed information.

    Parameters
    ----------
    intensity
        (n,) of each run.
    exceeded
        (n,) whether the limit state was exceeded in it.
    """
    from scipy.optimize import minimize
    from scipy.special import log_ndtr, ndtri

    levels, row = np.unique(intensity, return_inverse=True)
    tried = np.bincount(row).astype(float)
    failed = np.bincount(row, weights=exceeded)
    logs = np.log(levels)

    def unlikely(x: Array) -> float:
        z = (logs - x[0]) / math.exp(x[1])
        return -float(failed @ log_ndtr(z) + (tried - failed) @ log_ndtr(-z))

    if not 0.0 < failed.sum() < tried.sum():
        raise StudyError([say("study.one_sided")])
    begin = np.array([np.average(logs, weights=tried), math.log(0.4)])
    found = minimize(
        unlikely, begin, method="Nelder-Mead", options={"xatol": 1e-10, "fatol": 1e-12}
    )
    if not np.isfinite(found.x).all() or not -8.0 < found.x[1] < 4.0:
        raise StudyError([say("study.open_beta")])
    sigma = np.sqrt(np.diag(np.linalg.inv(_hessian(unlikely, found.x))))
    z = float(ndtri(0.5 + 0.5 * LEVEL))
    mean, log_beta = map(float, found.x)
    return {
        **_fit(
            mean,
            math.exp(log_beta),
            (mean - z * sigma[0], mean + z * sigma[0]),
            (math.exp(log_beta - z * sigma[1]), math.exp(log_beta + z * sigma[1])),
            len(intensity),
        ),
        "stripes": [
            [float(level), int(n), int(k)]
            for level, n, k in zip(levels, tried, failed, strict=True)
        ],
    }


def of_cloud(intensity: Array, demand: Array, threshold: float, seed: int) -> dict[str, Any]:
    """Median and beta by the regression ln(demand) = a + b ln(intensity); intervals by bootstrap.

    Parameters
    ----------
    intensity, demand
        (n,), all positive.
    threshold
        Of the demand.
    """
    x, y = np.log(intensity), np.log(demand)
    n = len(x)

    def fitted(rows: Any) -> tuple[Array, Array, Array]:
        u, v = x[rows], y[rows]
        du, dv = u - u.mean(axis=-1, keepdims=True), v - v.mean(axis=-1, keepdims=True)
        slope = (du * dv).sum(axis=-1) / (du * du).sum(axis=-1)
        left = dv - slope[..., np.newaxis] * du
        deviation = np.sqrt((left**2).sum(axis=-1) / (n - 2))
        middle = u.mean(axis=-1) + (math.log(threshold) - v.mean(axis=-1)) / slope
        return middle, deviation / np.abs(slope), slope

    if not np.ptp(x) > 0.0:
        raise StudyError([say("study.one_intensity")])
    middle, beta, slope = fitted(np.arange(n))
    again = np.random.default_rng(seed).integers(n, size=(RESAMPLES, n))
    middles, betas, _ = fitted(again)
    shares = [0.5 - 0.5 * LEVEL, 0.5 + 0.5 * LEVEL]
    return {
        **_fit(
            float(middle),
            float(beta),
            tuple(np.quantile(middles, shares)),
            tuple(np.quantile(betas, shares)),
            n,
        ),
        "slope": float(slope),
    }


def fitted(one: Mapping[str, Any], frame: Any, seed: int) -> dict[str, Any]:
    """What a table [[fragility]] asks for, from the samples of a study.

    Samples without a number are left out and counted; what is wrong is told in ``reason``.
    """
    method = one["method"]
    names = [one["capacity"]] if method == "capacity" else [one["intensity"], one["demand"]]
    told: dict[str, Any] = {
        "name": one["name"] or f"{method} of {names[-1]}",
        "method": method,
        "columns": names,
        "threshold": one["threshold"],
    }
    missing = [name for name in names if name not in frame]
    if missing:
        return {**told, **_not_fitted(say("study.no_column", name=missing[0]))}
    numbers = [frame[name].to_numpy(dtype=float, na_value=np.nan) for name in names]
    known = np.logical_and.reduce([np.isfinite(column) for column in numbers])
    if method != "stripes":
        known &= np.logical_and.reduce([column > 0.0 for column in numbers])
    numbers = [column[known] for column in numbers]
    told["n_left_out"] = int((~known).sum())
    if known.sum() < 5:
        return {**told, **_not_fitted(say("study.few"))}
    try:
        if method == "capacity":
            return {**told, **of_capacities(numbers[0])}
        if method == "cloud":
            return {**told, **of_cloud(numbers[0], numbers[1], one["threshold"], seed)}
        above = numbers[1] > one["threshold"]
        exceeded = above if one["exceeded"] == "above" else ~above
        return {**told, **of_stripes(numbers[0], exceeded)}
    except StudyError as error:
        return {**told, **_not_fitted(*error.problems)}


def _not_fitted(why: str) -> dict[str, Any]:
    """Why there is no curve, in English and so that it can be said in every language."""
    said = why.as_dict() if isinstance(why, Saying) else None
    return {"reason": str(why), "said": said}


def _fit(
    mean: float, beta: float, means: tuple[float, ...], betas: tuple[float, ...], n: int
) -> dict[str, Any]:
    return {
        "median": math.exp(mean),
        "beta": beta,
        "median_confidence": [math.exp(value) for value in means],
        "beta_confidence": [float(value) for value in betas],
        "n": n,
    }


def _hessian(function: Any, x: Array, h: float = 1e-4) -> Array:
    """By central differences."""
    steps = h * np.eye(len(x))
    return np.array(
        [
            [
                (function(x + a + b) - function(x + a - b) - function(x - a + b)
                 + function(x - a - b)) / (4.0 * h * h)
                for b in steps
            ]
            for a in steps
        ]
    )  # fmt: skip
