"""Vectors as users give them: lists, tuples or arrays of numbers."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import ArrayLike

from drystone.common.arrays import Array
from drystone.common.errors import ModelError

#: A length that differs from one by less is one: directions stay as they were computed.
ONE = 1e-9


def vector(values: ArrayLike, key: str) -> Array:
    """An array of two or three finite numbers; raises `ModelError`, in which ``key`` names it."""
    try:
        found = np.asarray(values, dtype=np.float64)
    except (TypeError, ValueError):
        found = np.empty(0)
    if found.shape not in ((2,), (3,)) or not np.all(np.isfinite(found)):
        raise ModelError([f"{key}: must be two finite numbers, in space three, as in (1.0, 0.0)"])
    return found


def direction_of(values: ArrayLike, key: str) -> Array:
    """The same, scaled to length one unless it has that length."""
    found = vector(values, key)
    if abs(float(np.linalg.norm(found)) - 1.0) <= ONE:
        return found
    return unit_vector(found, key, len(found))


def unit_vector(direction: Sequence[float] | Array, key: str, dimension: int) -> Array:
    """Direction scaled to length one; ``key`` names it in the error if it has none."""
    words = ("no", "one", "two", "three")[dimension]
    example = [1.0] + (dimension - 1) * [0.0]
    vector = np.array(direction, dtype=np.float64)
    if vector.shape != (dimension,) or not np.all(np.isfinite(vector)):
        raise ModelError([f"{key}: must be {words} finite numbers, as in {example}"])
    largest = np.abs(vector).max()
    if largest == 0.0:
        raise ModelError([f"{key}: has no length: give a direction, as in {example}"])
    length = largest * np.linalg.norm(vector / largest)  # neither overflows nor vanishes
    if abs(length - 1.0) < 4.0 * np.finfo(float).eps:
        return vector  # so that what was written is read bit by bit
    return vector / length
