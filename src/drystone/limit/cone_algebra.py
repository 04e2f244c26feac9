"""Vectors in a product of cones, and what an interior-point method does with them.

A cone of size d holds the vectors whose first component is no less than the length of the others;
of size 1 it holds the numbers that are not negative.  The product of two vectors of a cone is

    x o z = (x.z, x0 z1 + z0 x1)

with e = (1, 0, ...) for unity.  Every pair of vectors inside has a scaling W that takes both to the
same point (Nesterov and Todd, 1997), W z = W^-1 x, with

    W = eta [[w0, w1^T], [w1, I + w1 w1^T / (1 + w0)]],      W^2 = eta^2 (2 w w^T - J)

and J = diag(1, -1, ..., -1).  Of size 1, W^2 is x / z.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np
from scipy.sparse import csr_array

from drystone.common.arrays import Array, IntArray


def dot(a: Array, b: Array) -> Array:
    """Products of the rows of two arrays, (n,)."""
    return np.asarray(np.einsum("ij,ij->i", a, b))


def _length(v: Array) -> Array:
    """Of what follows the first component."""
    return np.asarray(np.sqrt(dot(v[:, 1:], v[:, 1:])))


class Cones:
    """A product of cones and the scaling of a pair of its vectors.

    Parameters
    ----------
    groups
        How many cones of which size, in the order of the components.
    """

    def __init__(self, groups: Sequence[tuple[int, int]]) -> None:
        self._groups = []
        self.size = 0
        for count, size in groups:
            last = self.size + count * size
            self._groups.append((slice(self.size, last), count, size))
            self.size = last
        self.degree = sum(count for count, _ in groups)
        self.unity = np.zeros(self.size)
        for (v,) in self._views(self.unity):
            v[:, 0] = 1.0
        self._w = list(v.copy() for (v,) in self._views(self.unity))
        self._eta = [np.ones(count) for count, _ in groups]
        self._pattern = self._block_pattern()

    def _views(self, *vectors: Array) -> Iterator[tuple[Array, ...]]:
        for part, count, size in self._groups:
            yield tuple(v[part].reshape(count, size) for v in vectors)

    def _block_pattern(self) -> tuple[IntArray, IntArray]:
        """Columns and row starts of a matrix with one block to every cone."""
        columns, counts = [np.zeros(0, np.int64)], [np.zeros(1, np.int64)]
        for part, count, size in self._groups:
            row = part.start + np.arange(count * size).reshape(count, 1, size)
            columns.append(np.broadcast_to(row, (count, size, size)).ravel())
            counts.append(np.full(count * size, size))
        return np.concatenate(columns), np.cumsum(np.concatenate(counts))

    def depth(self, x: Array) -> float:
        """How far inside x is: its least eigenvalue."""
        least = [np.min(v[:, 0] - _length(v), initial=np.inf) for (v,) in self._views(x)]
        return float(min(least, default=np.inf))

    def scale(self, x: Array, z: Array) -> None:
        """Make the scaling that of x and z, both inside."""
        for k, (a, b) in enumerate(self._views(x, z)):
            la, lb = _length(a), _length(b)
            ra, rb = (
                np.sqrt((a[:, 0] - la) * (a[:, 0] + la)),
                np.sqrt((b[:, 0] - lb) * (b[:, 0] + lb)),
            )
            a, b = a / ra[:, None], b / rb[:, None]
            w = (a - b) / np.sqrt(2.0 + 2.0 * dot(a, b))[:, None]
            w[:, 0] = np.sqrt(1.0 + dot(w[:, 1:], w[:, 1:]))
            self._w[k], self._eta[k] = w, np.sqrt(ra / rb)

    def scaled(self, v: Array, *, inverse: bool = False) -> Array:
        """W v, or W^-1 v."""
        out = np.empty_like(v)
        sign = -1.0 if inverse else 1.0
        for (a, to), w, eta in zip(self._views(v, out), self._w, self._eta, strict=True):
            along = dot(w[:, 1:], a[:, 1:])
            to[:, 0] = w[:, 0] * a[:, 0] + sign * along
            to[:, 1:] = a[:, 1:] + (sign * a[:, 0] + along / (1.0 + w[:, 0]))[:, None] * w[:, 1:]
            to *= (1.0 / eta if inverse else eta)[:, None]
        return out

    def squared(self, v: Array) -> Array:
        """W^2 v."""
        out = np.empty_like(v)
        for (a, to), w, eta in zip(self._views(v, out), self._w, self._eta, strict=True):
            to[:] = a
            to[:, 0] *= -1.0
            to += 2.0 * dot(w, a)[:, None] * w
            to *= (eta * eta)[:, None]
        return out

    def matrix(self) -> csr_array:
        """W^2, (size, size)."""
        blocks = [np.zeros(0)]
        for w, eta in zip(self._w, self._eta, strict=True):
            block = 2.0 * w[:, :, None] * w[:, None, :] + np.eye(w.shape[1])
            block[:, 0, 0] -= 2.0
            blocks.append((block * (eta * eta)[:, None, None]).ravel())
        columns, starts = self._pattern
        return csr_array((np.concatenate(blocks), columns, starts), shape=(self.size, self.size))

    def product(self, x: Array, z: Array) -> Array:
        """x o z."""
        out = np.empty_like(x)
        for a, b, to in self._views(x, z, out):
            to[:, 0] = dot(a, b)
            to[:, 1:] = a[:, :1] * b[:, 1:] + b[:, :1] * a[:, 1:]
        return out

    def quotient(self, x: Array, product: Array) -> Array:
        """The vector that makes the product with x."""
        out = np.empty_like(x)
        for a, b, to in self._views(x, product, out):
            length = _length(a)
            determinant = (a[:, 0] - length) * (a[:, 0] + length)
            to[:, 0] = (a[:, 0] * b[:, 0] - dot(a[:, 1:], b[:, 1:])) / determinant
            to[:, 1:] = (b[:, 1:] - to[:, :1] * a[:, 1:]) / a[:, :1]
        return out

    def towards(self, x: Array, low: float, high: float) -> Array:
        """What brings the eigenvalues of x between two bounds, none down by more than ``high``."""
        out = np.empty_like(x)
        for a, to in self._views(x, out):
            length = _length(a)
            more = []
            for value in (a[:, 0] + length, a[:, 0] - length):
                more.append(np.maximum(np.clip(value, low, high) - value, -high))
            half = 0.5 * (more[0] - more[1])
            to[:, 0] = 0.5 * (more[0] + more[1])
            to[:, 1:] = (half / np.where(length > 0.0, length, 1.0))[:, None] * a[:, 1:]
        return out

    def reach(self, x: Array, step: Array, most: float) -> float:
        """Largest share of the step, up to ``most``, that keeps x from leaving."""
        reach = most
        for a, d in self._views(x, step):
            with np.errstate(all="ignore"):
                shares = [-a[:, 0] / d[:, 0]]
            if a.shape[1] > 1:
                shares += _roots(a, d)
            for share in shares:
                reach = float(np.min(share[share > 0.0], initial=reach))
        return reach


def _roots(a: Array, d: Array) -> list[Array]:
    """Where det(a + s d) = c + 2 b s + square s^2, (n,) each; nan where nowhere."""
    length = _length(a)
    c = (a[:, 0] - length) * (a[:, 0] + length)
    b = a[:, 0] * d[:, 0] - dot(a[:, 1:], d[:, 1:])
    square = d[:, 0] ** 2 - dot(d[:, 1:], d[:, 1:])
    with np.errstate(all="ignore"):
        q = -(b + np.copysign(np.sqrt(b * b - square * c), b))
        return [q / square, c / q]
