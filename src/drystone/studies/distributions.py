"""Values of a parameter by their probability: lists, ranges and distributions of scipy."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from drystone.common.arrays import Array
from drystone.common.names import suggestion


class DistributionError(ValueError):
    """There is no such distribution; the message is the end of a sentence."""


@dataclass(frozen=True, kw_only=True)
class Choices:
    """One of some values, each as likely as the others."""

    values: tuple[Any, ...]

    def at(self, probability: Array) -> list[Any]:
        """The values at probabilities between 0 and 1, (n,)."""
        n = len(self.values)
        rows = np.minimum((probability * n).astype(int), n - 1)
        return [self.values[row] for row in rows]

    def spread(self, steps: int) -> list[Any]:
        """All values: a list says how many there are."""
        return list(self.values)


@dataclass(frozen=True, kw_only=True)
class Uniform:
    """Numbers between two bounds; whole numbers, both bounds included, where they are asked for."""

    low: float
    high: float
    whole: bool = False

    def at(self, probability: Array) -> list[Any]:
        """See `Choices`."""
        if self.whole:
            n = math.floor(self.high) - math.ceil(self.low) + 1
            return [int(math.ceil(self.low) + min(int(p * n), n - 1)) for p in probability]
        return (self.low + probability * (self.high - self.low)).tolist()

    def spread(self, steps: int) -> list[Any]:
        """As many values, from bound to bound."""
        values = np.linspace(self.low, self.high, steps).tolist()
        return list(dict.fromkeys(map(round, values))) if self.whole else values


@dataclass(frozen=True, kw_only=True)
class Continuous:
    """A distribution of `scipy.stats`, cut off at bounds where there are any."""

    name: str
    arguments: Mapping[str, float] = field(default_factory=dict)
    low: float = -math.inf
    high: float = math.inf

    def _frozen(self) -> Any:
        from scipy import stats

        return getattr(stats, self.name)(**self.arguments)

    def at(self, probability: Array) -> list[Any]:
        """See `Choices`."""
        law = self._frozen()
        with np.errstate(over="ignore"):  # of widths near the least number
            below, above = law.cdf(self.low), law.cdf(self.high)
            values = law.ppf(below + probability * (above - below))
        return np.clip(values, self.low, self.high).tolist()

    def spread(self, steps: int) -> list[Any]:
        """As many values of equal probability, each in the middle of its share."""
        return self.at((np.arange(steps) + 0.5) / steps)

    @property
    def is_bounded(self) -> bool:
        """Whether its lowest and its highest value are finite."""
        low, high = self._frozen().support()
        return math.isfinite(max(low, self.low)) and math.isfinite(min(high, self.high))


Law = Choices | Uniform | Continuous


def continuous(
    name: str,
    *,
    mean: float | None = None,
    std: float | None = None,
    shapes: Mapping[str, float],
    bounds: Sequence[float] | None,
) -> Continuous:
    """A distribution of `scipy.stats` by its name, checked; raises `DistributionError`.

    Parameters
    ----------
    mean, std
        Of the distribution before it is cut off at the bounds.  They stand for `loc` and `scale`;
        of "lognorm" they are those of the values themselves, which begin at zero.
    shapes
        Arguments of scipy by name: ``loc``, ``scale`` and those of the shape.
    bounds
        Lowest and highest value.
    """
    from scipy import stats

    known = sorted(n for n in dir(stats) if isinstance(getattr(stats, n), stats.rv_continuous))
    if name not in known:
        raise DistributionError(
            f"must not be {name!r}: {suggestion(name, known)}".replace("'", '"')
        )
    own = (getattr(stats, name).shapes or "").replace(" ", "").split(",")
    own = [shape for shape in own if shape]
    if (mean is None) != (std is None):
        raise DistributionError("has one of mean and std: give both, or loc and scale")
    arguments = dict(shapes)
    if mean is not None and std is not None:
        arguments |= _of_moments(name, mean, std, arguments)
    unknown = [key for key in arguments if key not in (*own, "loc", "scale")]
    missing = [key for key in own if key not in arguments]
    if unknown:
        names = [*own, "loc", "scale"]
        raise DistributionError(f'has "{unknown[0]}": {suggestion(unknown[0], names)}')
    if missing:
        raise DistributionError(f"needs {' and '.join(missing)} in shapes, as scipy.stats.{name}")
    low, high = bounds if bounds is not None else (-math.inf, math.inf)
    law = Continuous(name=name, arguments=arguments, low=float(low), high=float(high))
    middle = law.at(np.array([0.5]))[0]
    if not math.isfinite(middle):
        raise DistributionError("has no median: check its numbers, and that bounds lie in it")
    return law


def _of_moments(
    name: str, mean: float, std: float, shapes: Mapping[str, float]
) -> dict[str, float]:
    """Arguments of scipy by mean and standard deviation."""
    from scipy import stats

    if std <= 0.0:
        raise DistributionError(f"has std = {std:g}: it must be greater than 0")
    if name == "lognorm" and "s" not in shapes:
        if mean <= 0.0:
            raise DistributionError(f"has mean = {mean:g}: it must be greater than 0")
        s = math.sqrt(math.log1p((std / mean) ** 2))
        return {"s": s, "scale": mean * math.exp(-0.5 * s * s)}
    try:
        own_mean, variance = getattr(stats, name)(**shapes).stats("mv")
    except TypeError:
        raise DistributionError("needs its shapes beside mean and std") from None
    if not (math.isfinite(own_mean) and math.isfinite(variance) and variance > 0.0):
        raise DistributionError("has no mean or no standard deviation: give loc and scale")
    scale = std / math.sqrt(variance)
    return {"loc": mean - scale * float(own_mean), "scale": scale}
