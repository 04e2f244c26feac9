"""Solids as drawn, put in order: closed, flat, once, and lying on each other."""

from __future__ import annotations

import numpy as np
import pytest

from drawn import BOX, bent_dome, box, brick_wall, joints_by_brute_force
from drystone.geometry import GeometryError
from drystone.geometry.figure import Figure
from drystone.geometry.interfaces import Interfaces
from drystone.geometry.space import solid
from drystone.geometry.space.bends import fan_of
from drystone.geometry.space.flatness import flat_pieces, plane_labels, triangles
from drystone.geometry.space.mend import DrawnSolid, mended_solids
from drystone.geometry.space.meshes import (
    Mesh,
    face_normals,
    once,
    oriented,
    shells,
    stitched,
    welded,
)
from drystone.geometry.space.neighbours import meeting_faces, vertices_in_faces
from drystone.geometry.space.planes import Incidences, fitted_planes, onto_planes
from drystone.geometry.space.polyhedra import Polyhedra
from drystone.geometry.space.trim import trimmed


def drawn(blocks, **values):
    return [DrawnSolid(name=n, vertices=v, faces=tuple(f), **values) for n, v, f in blocks]


def one(vertices, faces, tolerance=0.02):
    return mended_solids(drawn([("b", np.asarray(vertices, float), faces)]), tolerance)


def packed(solids):
    figures = [Figure.of(s.vertices, s.faces) for s in solids]
    return figures, Polyhedra.pack([[(p.vertices, p.faces) for p in f.parts] for f in figures])


def areas(joints):
    """Area of the joints of each pair of blocks."""
    found: dict[tuple[int, int], float] = {}
    for a, b, size in zip(joints.block_a, joints.block_b, joints.size, strict=True):
        found[int(a), int(b)] = found.get((int(a), int(b)), 0.0) + float(size)
    return found


def test_faces_without_area_lie_on_nothing():
    """Slivers that close a surface where a vertex lies on an edge of the next face."""
    meshes = []
    for low in (0.0, 1.0005):
        vertices, faces = box((0, 0, low), (1, 1, low + 1))
        a, b = faces[-1][:2]  # an edge of the last face, whose other face gets a vertex amid it
        amid = len(vertices)
        faces = tuple(_with_vertex(face, b, a, amid) for face in faces) + ((a, amid, b),)
        middle = 0.5 * (vertices[a] + vertices[b])
        meshes.append(Mesh(np.vstack((vertices, middle)), faces))
    near = np.array([0.01, 0.01])
    with np.errstate(all="raise"):
        meeting = meeting_faces(meshes, near)
        lying = vertices_in_faces(meshes, near)
    sliver = len(meshes[0].faces) - 1
    assert len(meeting) == 1  # top and bottom
    assert all(sliver not in (p, q) for _, p, _, q in meeting)
    assert all(face != sliver for *_, face in lying)


def _with_vertex(face, first, second, between):
    """A face with a vertex put in where it runs from one vertex to another."""
    k = next((k for k in range(len(face)) if (face[k - 1], face[k]) == (first, second)), None)
    return face if k is None else (*face[:k], between, *face[k:])


class TestOneSolid:
    def test_what_is_in_order_stays_to_the_last_bit(self):
        vertices, faces = box((0.1, 0.2, 0.3), (1.0, 0.7, 0.5))
        (made,), records = one(vertices, faces)
        assert made.vertices.tobytes() == vertices.tobytes()
        assert made.faces == faces
        assert records == []

    def test_faces_twice_are_taken_once(self):
        vertices, faces = box((0, 0, 0), (1, 1, 1))
        turned = tuple(face[2:] + face[:2] for face in faces)
        (made,), records = one(vertices, faces + turned)
        assert len(made.faces) == 6
        assert [(r.what, r.count) for r in records] == [("had faces that were drawn twice", 6)]

    def test_both_sides_of_every_face_are_one(self):
        vertices, faces = box((0, 0, 0), (1, 1, 1))
        both = tuple(face[::-1] for face in faces) + faces
        (made,), _ = one(vertices, both)
        assert solid.volume_of(made.vertices, made.faces) == pytest.approx(1.0, rel=1e-12)

    @pytest.mark.parametrize("wrong", [(0,), (1, 3), (0, 1, 2, 3, 4, 5), (2, 3, 4, 5)])
    def test_faces_inside_out_are_turned(self, wrong):
        vertices, faces = box((0, 0, 0), (1, 2, 3))
        faces = tuple(f[::-1] if k in wrong else f for k, f in enumerate(faces))
        (made,), records = one(vertices, faces)
        assert solid.volume_of(made.vertices, made.faces) == pytest.approx(6.0, rel=1e-12)
        assert [r.count for r in records] == [len(wrong)]

    def test_triangles_become_the_faces_that_they_are_of(self):
        vertices, faces = box((0, 0, 0), (1, 2, 3))
        cut = tuple(t for f in faces for t in ((f[0], f[1], f[2]), (f[0], f[2], f[3])))
        # As in STL: every triangle with corners of its own.
        corners = vertices[[i for t in cut for i in t]]
        loose = tuple((3 * k, 3 * k + 1, 3 * k + 2) for k in range(12))
        (made,), records = one(corners, loose)
        assert len(made.vertices) == 8
        assert sorted(map(len, made.faces)) == [4] * 6
        assert [r.what for r in records] == ["had faces in one plane that were made one"]

    def test_vertices_amid_edges_and_faces_are_dropped(self):
        vertices, faces = box((0, 0, 0), (1, 1, 1))
        vertices = np.vstack((vertices, [0.5, 0.0, 1.0], [0.5, 0.5, 1.0]))
        # The top in four triangles about a point amid it, its front edge in two.
        faces = (faces[0], (0, 1, 5, 8, 4), *faces[3:], (4, 8, 9), (8, 5, 9), (5, 6, 9), (6, 7, 9),
                 (7, 4, 9))  # fmt: skip
        (made,), _ = one(vertices, faces)
        assert len(made.vertices) == 8
        assert len(made.faces) == 6

    def test_an_edge_that_another_vertex_lies_on_is_stitched(self):
        vertices, faces = box((0, 0, 0), (1, 1, 1))
        vertices = np.vstack((vertices, [0.5, 0.0, 1.0]))
        top = ((4, 8, 7), (8, 5, 6), (8, 6, 7))
        (made,), records = one(vertices, (faces[0], *top, *faces[2:]))
        assert len(made.faces) == 6
        assert "had edges that other vertices lay on" in [r.what for r in records]

    def test_faces_that_are_bent_are_cut_along_the_bend(self):
        (name, vertices, faces), *_ = bent_dome(rings=1)
        (made,), records = mended_solids(drawn([(name, vertices, faces)]), 0.02, "bends")
        assert sorted(map(len, made.faces)) == [4] * 10
        (record,) = records
        assert record.what == "had faces that were not flat and were cut along their bends"
        assert record.count == 2
        # Fans cut the hexagons outside and inside elsewhere.
        exact = solid.volume_of(made.vertices, made.faces)
        assert record.volume == pytest.approx(exact - solid.volume_of(vertices, faces), rel=1e-9)

    def test_fans_from_the_first_corners_have_the_volume_that_programs_tell(self):
        (name, vertices, faces), *_ = bent_dome(rings=1)
        # From the middle of the lower edge outside and inside, and from a lower corner inside.
        for outer, inner in (((7, 8, 11, 10, 9, 6), (1, 0, 3, 4, 5, 2)),
                             ((7, 8, 11, 10, 9, 6), (0, 3, 4, 5, 2, 1))):  # fmt: skip
            fanned = (outer, inner, *faces[2:])
            (made,), records = mended_solids(drawn([(name, vertices, fanned)]), 0.02)
            told = solid.volume_of(vertices, fanned)  # of fans
            assert Figure.of(made.vertices, made.faces).volume == pytest.approx(told, rel=1e-9)
            record = next(r for r in records if "into fans" in r.what)
            assert record.count == 2
            (bends,), _ = mended_solids(drawn([(name, vertices, fanned)]), 0.02, "bends")
            more = told - solid.volume_of(bends.vertices, bends.faces)
            assert record.volume == pytest.approx(more, rel=1e-9, abs=1e-12)

    def test_fans_that_would_cross_other_faces_are_not_taken(self):
        # From an upper corner outside the fan has the chord over the upper beds' middle for an
        # edge, which lies above these: the solid would reach out of its own bed.
        (name, vertices, faces), *_ = bent_dome(rings=1)
        crossed = ((9, 6, 7, 8, 11, 10), *faces[1:])
        with pytest.raises(GeometryError, match="faces cross"):
            Figure.of(vertices, tuple(t for f in crossed for t in fan_of(f)))
        (made,), records = mended_solids(drawn([(name, vertices, crossed)]), 0.02)
        assert [r.what for r in records] == [
            "had faces that were not flat and were cut along their bends"
        ]
        assert sorted(map(len, made.faces)) == [4] * 10

    @pytest.mark.parametrize("lifted", [0.1, 0.6])
    def test_fans_that_fold_are_not_taken(self, lifted):
        # The top of an L, bent, begun at a corner that does not see all of it: a triangle of the
        # fan lies outside, upside down.
        outline = np.array([(0, 0), (2, 0), (2, 1), (1, 1), (1, 2), (0, 2)], float)
        top = np.array([1.0, 1.0, 1.0, 1.0, 1.0 + lifted, 1.0 + lifted])
        vertices = np.vstack([np.column_stack((outline, z)) for z in (np.zeros(6), top)])
        sides = [(k, (k + 1) % 6, (k + 1) % 6 + 6, k + 6) for k in range(6)]
        seen, unseen = (6, 7, 8, 9, 10, 11), (8, 9, 10, 11, 6, 7)
        for first, cut in ((seen, "into fans"), (unseen, "along their bends")):
            (made,), records = one(vertices, ((5, 4, 3, 2, 1, 0), *sides, first))
            assert any(cut in r.what for r in records)
            figure = Figure.of(made.vertices, made.faces)
            assert 3.0 < figure.volume < 3.0 + 1.5 * lifted

    def test_bent_faces_that_others_lie_on_are_cut_alike(self):
        # Two layers of a shell on each other, the hexagon between them begun at either corner.
        (_, low, faces), *_ = bent_dome(rings=1)
        high = low * (5.0 / 4.7)
        outer = faces[0]
        for k in range(6):
            other = (outer[k:] + outer[:k], *faces[1:])
            made, _ = mended_solids(drawn([("low", low, other), ("high", high, faces)]), 0.02)
            _, solids = packed(made)
            assert areas(Interfaces.of(solids))[0, 1] == pytest.approx(
                sum(
                    0.5 * np.linalg.norm(np.cross(*(low[list(t[1:])] - low[t[0]])))
                    for half in ((6, 7, 10, 9), (7, 8, 11, 10))
                    for t in fan_of(half)
                ),
                rel=1e-9,
            )
            assert solids.overlap_depths(*solids.near_pairs()).max() < 1e-9

    def test_rounded_faces_are_made_flat_by_no_more_than_the_rounding_asks(self):
        rng = np.random.default_rng(1)
        vertices, faces = box((0, 0, 0), (1.0, 0.5, 0.3))
        angle = np.radians(33.0)
        turn = np.array(
            [[np.cos(angle), 0, np.sin(angle)], [0, 1, 0], [-np.sin(angle), 0, np.cos(angle)]]
        )
        rounded = np.round(vertices @ turn.T + rng.uniform(0, 1, 3), 3)
        (made,), _ = one(rounded, faces)
        normal, offset = solid.face_planes(made.vertices, made.faces)
        for k, face in enumerate(made.faces):
            off = made.vertices[list(face)] @ normal[k] - offset[k]
            assert np.abs(off).max() < 1e-12  # of the solver's iterations, quadratic at the end
        # Half a millimetre in each coordinate: nothing needs to move farther than its rounding.
        assert np.linalg.norm(made.vertices - rounded, axis=1).max() < 0.5e-3 * np.sqrt(3.0)

    def test_connected_surfaces_are_solids_of_their_own(self):
        a, b = box((0, 0, 0), (1, 1, 1)), box((2, 0, 0), (3, 1, 1))
        faces = a[1] + tuple(tuple(i + 8 for i in f) for f in b[1])
        made, _ = one(np.vstack((a[0], b[0])), faces)
        assert [s.name for s in made] == ["b/1", "b/2"]

    def test_cubes_that_share_an_edge_or_a_face_are_two(self):
        for shift in ((1, 1, 0), (1, 0, 0), (0, 0, 1)):
            a, b = box((0, 0, 0), (1, 1, 1)), box(shift, np.array(shift) + 1)
            corners = np.vstack([v[list(f)] for v, faces in (a, b) for f in faces])
            loose = tuple(tuple(range(4 * k, 4 * k + 4)) for k in range(12))
            made, _ = one(corners, loose)
            assert [round(solid.volume_of(s.vertices, s.faces), 9) for s in made] == [1.0, 1.0]

    @pytest.mark.parametrize(
        ("vertices", "faces", "said"),
        [
            (box((0, 0, 0), (1, 1, 1))[0], BOX[:5], r"open along .*\(0, 0, 0\) to \(0, 0, 1\)"),
            (box((0, 0, 0), (1, 1, 1))[0], (), "no faces"),
            (box((0, 0, 0), (1, 1, 1))[0], (BOX[0],), "it is flat"),
            (np.zeros((4, 3)), ((0, 1, 2), (0, 2, 3)), "points or lines"),
            (np.full((8, 3), np.nan), BOX, "finite"),
        ],
    )
    def test_what_is_no_solid_is_refused(self, vertices, faces, said):
        with pytest.raises(GeometryError, match=said):
            one(vertices, faces)

    def test_a_band_of_one_side_is_refused(self):
        # Closed, but no outside: the faces of a projective plane of six vertices.
        faces = ((0, 1, 2), (0, 2, 3), (0, 3, 4), (0, 4, 5), (0, 5, 1), (1, 2, 4), (2, 3, 5),
                 (3, 4, 1), (4, 5, 2), (5, 1, 3))  # fmt: skip
        vertices = np.random.default_rng(0).uniform(0, 1, (6, 3))
        with pytest.raises(GeometryError, match="only one side"):
            one(vertices, faces)


class TestTogether:
    def test_joints_of_a_rounded_wall_are_closed(self):
        rng = np.random.default_rng(2)
        for _ in range(5):
            made, _ = mended_solids(drawn(brick_wall(rng, noise=1e-3, decimals=3)), 0.02)
            figures, solids = packed(made)
            exact, _ = packed(mended_solids(drawn(brick_wall()), 0.0)[0])
            joints = areas(Interfaces.of(solids))
            # Six blocks, each beside one, over and under one or two: 3 heads, 6 beds.
            assert len(joints) == 9
            depth = solids.overlap_depths(*solids.near_pairs())
            assert depth.max() < 1e-9
            assert sum(f.volume for f in figures) == pytest.approx(
                sum(f.volume for f in exact),
                rel=0.02,  # 1.5 mm of 0.15 m
            )

    def test_bent_blocks_with_three_decimals_fit_again(self):
        blocks = bent_dome(rings=3, around=6)
        rounded = [(n, np.round(v, 3), f + f) for n, v, f in blocks]
        made, records = mended_solids(drawn(rounded), 0.02)
        figures, solids = packed(made)
        assert len(made) == 18
        # Two sides in each ring, two blocks above each of the lower rings' blocks.
        joints = areas(Interfaces.of(solids))
        assert len(joints) == 18 + 2 * 12
        exact, _ = mended_solids(drawn(blocks), 0.0)
        flat = [
            [s.vertices[list(t)] for f in s.faces for t in triangles(s.vertices, f)] for s in exact
        ]
        wanted = joints_by_brute_force(flat, off=1e-6)
        assert joints.keys() == wanted.keys()
        for pair, area in wanted.items():
            assert joints[pair] == pytest.approx(area, rel=0.01)  # 1 mm of 0.3 m, twice
        volume = sum(solid.volume_of(s.vertices, s.faces) for s in exact)
        assert sum(f.volume for f in figures) == pytest.approx(volume, rel=1e-3)
        assert solids.overlap_depths(*solids.near_pairs()).max() < 1e-7
        assert max(r.how_much for r in records) < 2e-3

    def test_supports_stay(self):
        low, high = box((0, 0, 0), (1, 1, 1)), box((0, 0, 1.004), (1, 1, 2))
        made, _ = mended_solids(
            [
                DrawnSolid(name="low", vertices=low[0], faces=low[1], support=True),
                DrawnSolid(name="high", vertices=high[0], faces=high[1]),
            ],
            0.02,
        )
        assert np.abs(made[0].vertices - low[0]).max() < 1e-8  # a millionth of the others' motion
        assert made[1].vertices[:, 2].min() == pytest.approx(1.0, abs=1e-8)

    def test_what_is_farther_than_the_tolerance_stays(self):
        low, high = box((0, 0, 0), (1, 1, 1)), box((0, 0, 1.03), (1, 1, 2))
        made, records = mended_solids(drawn([("a", *low), ("b", *high)]), 0.02)
        assert made[1].vertices.tobytes() == high[0].tobytes()
        assert records == []

    def test_faces_that_stand_in_each_other_get_one_plane_where_that_is_asked_for(self):
        low = box((0, 0, 0), (1, 1, 1))
        # Leans into the lower one by a twentieth of its length, and reaches over its edge.
        angle = np.arctan(0.05)
        turn = np.array(
            [[np.cos(angle), 0, -np.sin(angle)], [0, 1, 0], [np.sin(angle), 0, np.cos(angle)]]
        )
        vertices, faces = box((0.2, 0, 0), (1.6, 1, 1))
        high = vertices @ turn.T + [0.0, 0.0, 0.95 - 0.2 * 0.05]
        both = drawn([("low", *low), ("high", high, faces)])
        deep = packed(mended_solids(both, 0.02)[0])[1]
        assert deep.overlap_depths(*deep.near_pairs()).max() > 0.04
        made, records = mended_solids(both, 0.02, overlap=0.06)
        solids = packed(made)[1]
        assert solids.overlap_depths(*solids.near_pairs()).max() < 1e-9
        assert areas(Interfaces.of(solids))[0, 1] == pytest.approx(0.8, rel=0.02)
        assert 0.02 < max(r.how_much for r in records) < 0.12

    def test_overlaps_of_a_hair_are_cut_off(self):
        low = box((0, 0, 0), (1, 1, 1))
        # Stands on a corner that reaches a little into the lower block.
        tip = np.array([[0.5, 0.5, 0.9999], [0.9, 0.5, 1.5], [0.3, 0.8, 1.5], [0.3, 0.2, 1.5]])
        faces = ((0, 2, 1), (0, 3, 2), (0, 1, 3), (1, 2, 3))
        parts = [list(Figure.of(*low).parts), list(Figure.of(tip, faces).parts)]
        kept, cut = trimmed(parts, [0.01, 0.01], [False, False])
        assert cut == {1: pytest.approx(1e-4, rel=1e-9)}
        solids = Polyhedra.pack([[(p.vertices, p.faces) for p in own] for own in kept])
        assert solids.overlap_depths(*solids.near_pairs()).max() <= 0.0
        _, cut = trimmed(parts, [0.01, 5e-5], [False, False])
        assert cut == {}


class TestPieces:
    def test_planes_are_met_with_the_least_motion(self):
        # A square with one corner lifted by h: the least sum of squares lifts each by h / 4.
        vertices = np.array([[0, 0, 0.4], [1, 0, 0], [1, 1, 0], [0, 1, 0]]) * [1, 1, 1e-3]
        incidences = Incidences.of(np.arange(4), np.zeros(4, np.int64))
        moved = onto_planes(vertices, incidences, np.zeros(4, bool))
        assert np.abs(fitted_planes(moved, incidences).off).max() < 1e-12  # `ON_PLANE`
        assert moved[:, 2] - vertices[:, 2] == pytest.approx(
            1e-4 * np.array([-1, 1, -1, 1]),
            rel=1e-5,  # of the slope, squared
        )

    def test_both_sides_of_what_is_thin_are_planes_of_their_own(self):
        # All of its vertices are nearer to the plane of any face than the tolerance.
        vertices = np.array([(0, 0, 0), (1, 1, 0), (1, 0, 0.01), (0, 1, 0.01)], float)
        mesh, _ = oriented(Mesh(vertices, ((0, 1, 2), (0, 3, 1), (0, 2, 3), (1, 3, 2))))
        label = plane_labels(mesh, 0.02)
        up = face_normals(mesh)[:, 2] > 0.0
        assert len(set(label)) == 2
        assert all((label[i] == label[0]) == (up[i] == up[0]) for i in range(4))

    @pytest.mark.parametrize(("wide", "meet"), [(0.005, False), (0.03, True)])
    def test_faces_that_share_less_than_the_tolerance_do_not_meet(self, wide, meet):
        low, high = box((0, 0, 0), (1, 1, 1)), box((1 - wide, 0, 1), (2, 1, 2))
        found = meeting_faces([Mesh(*low), Mesh(*high)], np.array([0.01, 0.01]))
        assert bool(found) == meet

    def test_flat_pieces_are_as_few_as_may_be(self):
        # A strip that is bent twice.
        vertices = np.array(
            [
                [0, 0, 0],
                [1, 0, 0],
                [2, 0, 1],
                [3, 0, 1],
                [3, 1, 1],
                [2, 1, 1],
                [1, 1, 0],
                [0, 1, 0],
            ],
            float,
        )
        pieces = flat_pieces(vertices, tuple(range(8)), 1e-6)
        assert sorted(map(sorted, pieces)) == [[0, 1, 6, 7], [1, 2, 5, 6], [2, 3, 4, 5]]

    def test_triangles_fill_a_concave_face(self):
        outline = np.array([[0, 0], [4, 0], [4, 3], [3, 1], [1, 1], [0, 3]], float)
        vertices = np.column_stack((outline[:, 0], np.zeros(6), outline[:, 1]))
        cut = triangles(vertices, tuple(range(6)))
        total = sum(
            0.5 * np.linalg.norm(np.cross(*(vertices[list(t[1:])] - vertices[t[0]]))) for t in cut
        )
        assert len(cut) == 4
        assert total == pytest.approx(6.0, rel=1e-12)  # 4 x 3, less (4 + 2) / 2 x 2

    def test_meshes(self):
        vertices, faces = box((0, 0, 0), (1, 1, 1))
        mesh = Mesh(np.vstack((vertices, vertices[0] + 1e-9)), (*faces[:-1], (3, 8, 4, 7)))
        joined, removed = welded(mesh, 1e-6)
        assert removed == 1
        assert len(joined.vertices) == 8
        assert once(Mesh(vertices, faces + faces))[1] == 6
        assert stitched(Mesh(vertices, faces), 1e-6)[1] == 0
        assert oriented(Mesh(vertices, faces))[1] == 0
        assert len(shells(Mesh(vertices, faces))) == 1
