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

    def __post_init__(self) -> None:
        if self.whole and self._ends[1] < self._ends[0]:
            raise DistributionError("has no whole number in its range")

    @property
    def _ends(self) -> tuple[int, int]:
        """The lowest and the highest whole number."""
        return math.ceil(self.low), math.floor(self.high)

    def at(self, probability: Array) -> list[Any]:
        """See `Choices`."""
        if self.whole:
            low, high = self._ends
            n = high - low + 1
            return [low + min(int(p * n), n - 1) for p in probability]
        return (self.low + probability * (self.high - self.low)).tolist()

    def spread(self, steps: int) -> list[Any]:
        """As many values, from bound to bound."""
        low, high = self._ends if self.whole else (self.low, self.high)
        values = np.linspace(low, high, steps).tolist()
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
        law, (first, last) = self._frozen(), self._shares()
        share = first + probability * (last - first)
        with np.errstate(over="ignore"):  # of widths near the least number
            values = law.isf(share) if self._is_upper else law.ppf(share)
        return np.clip(values, self.low, self.high).tolist()

    @property
    def _is_upper(self) -> bool:
        """Whether the bounds lie above the median, where shares of what is above have more digits:
        that of what is below rounds to 1 beyond 8.3 standard deviations of a normal law."""
        with np.errstate(over="ignore"):
            return bool(self._frozen().cdf(self.low) > 0.5)

    def _shares(self) -> tuple[float, float]:
        """Probabilities at both bounds: of what is below, or of what is above where they lie above
        the median."""
        law = self._frozen()
        with np.errstate(over="ignore"):
            found = law.sf if self._is_upper else law.cdf
            return float(found(self.low)), float(found(self.high))

    @property
    def is_empty(self) -> bool:
        """Whether no number has a probability between the bounds."""
        first, last = self._shares()
        return first == last

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
    if law.is_empty:
        raise DistributionError(
            "has no probability between its bounds: choose bounds that lie in it"
        )
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
