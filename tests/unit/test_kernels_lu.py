"""The block factorisation solves what a dense one solves, whatever the graph of pairs."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import pytest

from drystone.linear import numeric as lu_numeric
from drystone.linear import symbolic as lu_symbolic
from drystone.linear.symbolic import BORDER, CHILD, ENTRY, FIRST, N_RUNS, PANEL, SIBLING

pytestmark = pytest.mark.kernels


def wall(rows, columns, n_dof=3):
    """Running bond on a fixed base: pairs (not all a < b), fixed bodies and places."""
    place = [(0.5 * columns, -1.0)]
    for row in range(rows):
        place += [(column + 0.5 * (row % 2), float(row)) for column in range(columns)]
    place = np.array(place)
    n = len(place)
    i, j = np.triu_indices(n, 1)
    apart = np.abs(place[i] - place[j])
    joined = (apart[:, 0] <= 1.0) & (apart[:, 1] <= 1.0)
    joined |= (i == 0) & (place[j, 1] == 0.0)
    a, b = i[joined], j[joined]
    a[::3], b[::3] = b[::3].copy(), a[::3].copy()
    return a, b, np.arange(n) == 0, place


def random_graph(seed):
    """Bodies anywhere, some on the same place, some alone, several fixed; pairs far and near."""
    rng = np.random.default_rng(seed)
    n = int(rng.integers(2, 60))
    place = rng.integers(0, 6, (n, int(rng.integers(2, 4)))).astype(float)
    i, j = np.triu_indices(n, 1)
    joined = rng.random(len(i)) < rng.choice([0.02, 0.05, 0.2])
    return i[joined], j[joined], rng.random(n) < 0.1, place


def blocks(rng, a, b, n, n_dof=3):
    """Nonsymmetric blocks, of which diagonal ones need an exchange of rows."""
    upper, lower = rng.normal(size=(2, len(a), n_dof, n_dof))
    joints = np.bincount(a, minlength=n) + np.bincount(b, minlength=n)
    strong = (2.0 * n_dof * (joints + 1))[:, None, None] * np.roll(np.eye(n_dof), 1, axis=0)
    return rng.normal(size=(n, n_dof, n_dof)) + strong, upper, lower


def dense(a, b, fixed, diagonal, upper, lower):
    n, nd, _ = diagonal.shape
    matrix = np.zeros((n, n, nd, nd))
    matrix[np.arange(n), np.arange(n)] = diagonal
    both = ~fixed[a] & ~fixed[b]
    np.add.at(matrix, (a[both], b[both]), upper[both])
    np.add.at(matrix, (b[both], a[both]), lower[both])
    matrix = matrix[np.ix_(~fixed, ~fixed)]
    return matrix.transpose(0, 2, 1, 3).reshape(nd * len(matrix), nd * len(matrix))


def check(a, b, fixed, place, n_dof=3, n_sides=2, seed=0):
    rng = np.random.default_rng(seed)
    structure = lu_symbolic.analyse(a, b, fixed, place, n_dof)
    factors = lu_numeric.allocate(structure)
    factors.panels[:] = factors.work[:] = np.nan  # whatever was there before
    for _ in range(2):  # the second time with other numbers in the same memory
        matrix = blocks(rng, a, b, len(fixed), n_dof)
        pivot = lu_numeric.factorise(structure, *matrix, factors, *NO_HOLD)
        assert 1e-3 < abs(pivot) <= 1.0
        assert np.sign(pivot) == np.linalg.slogdet(dense(a, b, fixed, *matrix)).sign
        rhs = rng.normal(size=(n_sides, len(fixed), n_dof))
        x = rhs.copy()
        lu_numeric.solve(structure, factors, x)
        expected = np.linalg.solve(
            dense(a, b, fixed, *matrix), rhs[:, ~fixed].reshape(n_sides, -1, 1)
        )
        assert x[:, ~fixed].ravel() == pytest.approx(expected.ravel(), rel=1e-9, abs=1e-12)
        assert not x[:, fixed].any()
        rhs[:, fixed] = 0.0
        lu_numeric.residual(structure, a, b, fixed, *matrix, x, rhs)
        assert np.abs(rhs).max(initial=0.0) < 1e-12


#: No body is held.
NO_HOLD = np.zeros((1, 1)), np.zeros(1), 0.0


def no_pairs():
    return np.zeros(0, np.int64), np.zeros(0, np.int64)


class TestSolution:
    @pytest.mark.parametrize("n_dof", [3, 6])
    @pytest.mark.parametrize("size", [(1, 1), (1, 2), (2, 2), (6, 5), (3, 40)])
    def test_walls(self, size, n_dof):
        check(*wall(*size), n_dof=n_dof)

    @pytest.mark.compiled
    @pytest.mark.parametrize("n_dof", [3, 6])
    def test_a_wall_of_many_blocks(self, n_dof):
        check(*wall(15, 16), n_dof=n_dof)

    @pytest.mark.parametrize("seed", range(40))
    def test_any_graph(self, seed):
        check(*random_graph(seed), seed=seed)

    @pytest.mark.parametrize("n_sides", [1, 3])
    def test_right_hand_sides(self, n_sides):
        check(*wall(4, 4), n_sides=n_sides)

    @pytest.mark.parametrize("seed", range(40, 50))
    def test_any_graph_of_bodies_in_space(self, seed):
        check(*random_graph(seed), n_dof=6, seed=seed)

    def test_bodies_without_pairs(self):
        check(*no_pairs(), np.zeros(1, np.bool_), np.zeros((1, 2)))
        check(*no_pairs(), np.zeros(7, np.bool_), np.zeros((7, 2)))

    def test_nothing_movable(self):
        check(*no_pairs(), np.ones(3, np.bool_), np.zeros((3, 2)))

    def test_everything_joined_in_one_place(self):
        a, b = np.triu_indices(30, 1)
        check(a, b, np.zeros(30, np.bool_), np.zeros((30, 2)))

    def test_a_pair_listed_twice_counts_twice(self):
        a, b, fixed, place = wall(3, 3)
        check(np.concatenate((a, a[:4])), np.concatenate((b, b[:4])), fixed, place)


class TestPivots:
    @staticmethod
    def ratio(change):
        a, b, fixed, place = wall(4, 5)
        matrix = blocks(np.random.default_rng(0), a, b, len(fixed))
        change(a, b, *matrix)
        structure = lu_symbolic.analyse(a, b, fixed, place, 3)
        return lu_numeric.factorise(structure, *matrix, lu_numeric.allocate(structure), *NO_HOLD)

    def test_bodies_with_negative_pivots_are_held(self):
        """Of a symmetric matrix, as many as it has negative eigenvalues; with what is added to
        their diagonals the solution is that of the matrix they then have."""
        a, b, fixed, place = wall(6, 7)
        n = len(fixed)
        upper = np.tile(-np.eye(3), (len(a), 1, 1))
        joints = np.bincount(a, minlength=n) + np.bincount(b, minlength=n)
        diagonal = joints[:, None, None] * np.eye(3)
        loose = np.array([9, 20, 31])
        diagonal[loose, 2, 2] = -7.0
        matrix = diagonal, upper, upper
        eigenvalues = np.linalg.eigvalsh(dense(a, b, fixed, *matrix))
        assert (eigenvalues < 0.0).sum() == 3
        structure = lu_symbolic.analyse(a, b, fixed, place, 3)
        factors, hold = lu_numeric.allocate(structure), np.zeros(n)
        weight = np.linspace(1.0, 2.0, 3 * n).reshape(n, 3)
        pivot = lu_numeric.factorise(structure, *matrix, factors, weight, hold, 0.5)
        assert pivot > 0.0
        assert np.flatnonzero(hold).tolist() == loose.tolist()
        rhs = np.random.default_rng(0).normal(size=(1, n, 3))
        x = rhs.copy()
        lu_numeric.solve(structure, factors, x)
        held = diagonal + hold[:, None, None] * weight[:, :, None] * np.eye(3)
        expected = np.linalg.solve(dense(a, b, fixed, held, upper, upper), rhs[0, ~fixed].ravel())
        assert x[0, ~fixed].ravel() == pytest.approx(expected, rel=1e-9)

    def test_a_body_that_nothing_holds(self):
        def free(a, b, diagonal, upper, lower):
            diagonal[7] = 0.0
            upper[(a == 7) | (b == 7)] = lower[(a == 7) | (b == 7)] = 0.0

        assert self.ratio(free) == 0.0

    def test_a_wall_that_nothing_holds(self):
        def free(a, b, diagonal, upper, lower):
            upper[:] = lower[:] = -np.eye(3)
            diagonal[:] = 0.0
            inside = (a > 0) & (b > 0)
            np.add.at(diagonal, np.concatenate((a[inside], b[inside])), np.eye(3))

        assert self.ratio(free) < 1e-14

    def test_a_direction_that_is_hardly_held(self):
        def hardly(a, b, diagonal, upper, lower):
            upper[(a == 7) | (b == 7)] = lower[(a == 7) | (b == 7)] = 0.0
            diagonal[7] = [[1.0, 1.0, 0.0], [1.0, 1.0 + 1e-10, 0.0], [0.0, 0.0, 1.0]]

        assert self.ratio(hardly) == pytest.approx(1e-10, rel=1e-5)

    @pytest.mark.parametrize("value", [np.nan, np.inf])
    def test_what_is_not_a_number(self, value):
        def spoil(a, b, diagonal, upper, lower):
            diagonal[3, 1, 1] = value

        assert self.ratio(spoil) == 0.0

    def test_units_do_not_matter(self):
        def small(a, b, diagonal, upper, lower):
            for block in (diagonal, upper, lower):
                block *= 1e-9

        assert self.ratio(small) == pytest.approx(self.ratio(lambda *_: None))


class TestStructure:
    @pytest.mark.parametrize("case", [wall(6, 5), wall(12, 12), *map(random_graph, range(5))])
    def test_holds_every_body_and_every_pair_once(self, case):
        a, b, fixed, place = case
        structure = lu_symbolic.analyse(a, b, fixed, place, 3)
        order, fronts = structure.order, structure.fronts
        assert sorted(order) == list(range(len(fixed)))
        assert fixed[order[fronts[-1, FIRST] :]].all()
        assert (np.diff(fronts[:, [FIRST, BORDER, ENTRY, PANEL]], axis=0) >= 0).all()
        both = np.flatnonzero(~fixed[a] & ~fixed[b])
        assert sorted(structure.entries[:, 0]) == list(both)

        position = np.argsort(order)
        for s, (front, end) in enumerate(pairwise(fronts)):
            bodies = order[front[FIRST] : end[FIRST]]
            border = structure.border[front[BORDER] : end[BORDER]]
            assert (np.diff(position[border]) > 0).all()
            assert (position[border] >= end[FIRST]).all()
            members = np.concatenate((bodies, border))
            for pair, i, j, first in structure.entries[front[ENTRY] : end[ENTRY]]:
                ends = (a[pair], b[pair]) if first else (b[pair], a[pair])
                assert ends == (bodies[i], members[j])
            child = front[CHILD]
            while child != -1:
                below = fronts[child]
                assert child < s
                kept = structure.border[below[BORDER] : fronts[child + 1, BORDER]]
                n_runs = below[N_RUNS]
                runs = structure.runs[below[BORDER] : below[BORDER] + n_runs]
                placed = np.concatenate([members[t : t + n] for _, t, n in runs])
                assert (placed == kept).all()
                child = below[SIBLING]

    def test_fill_stays_near_that_of_the_best_orders(self):
        """Blocks of the factors per body; nested dissection of a square has some 8 log2(n) / 2."""
        a, b, fixed, place = wall(40, 40)
        n = len(fixed)
        structure = lu_symbolic.analyse(a, b, fixed, place, 3)
        assert structure.fronts[-1, PANEL] / 9 < 8 * n * np.log2(n) / 2
