"""The least value of one parameter at which a structure still stands under its own weight."""

from __future__ import annotations

from collections.abc import Callable

from drystone.limit.collapse import stands
from drystone.model.model import Model


def least_standing(
    make: Callable[[float], Model], low: float, high: float, *, tolerance: float = 1e-9
) -> float:
    """Halve the interval until it is within ``tolerance``; gives the end that stands.

    Parameters
    ----------
    make
        Makes the model for a value of the parameter, such as a thickness over a radius.
    low, high
        A value at which it falls and one at which it stands.
    tolerance
        Of the parameter.

    Raises
    ------
    ValueError
        It stands at ``low`` already, or does not at ``high``.
    """
    if stands(make(low).assembly):
        raise ValueError(f"it stands at {low:g} already: begin lower")
    if not stands(make(high).assembly):
        raise ValueError(f"it does not stand at {high:g}: begin higher")
    while high - low > tolerance:
        middle = 0.5 * (low + high)
        if middle in (low, high):
            break
        if stands(make(middle).assembly):
            high = middle
        else:
            low = middle
    return high
