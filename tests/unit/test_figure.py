"""Blocks of any shape in an assembly: mass, parts and contact shapes, in both dimensions."""

import numpy as np
import pytest

from drystone.geometry import GeometryError
from drystone.geometry.figure import Figure
from drystone.geometry.space import solid
from drystone.geometry.space.solid import Part
from drystone.model.assembly import GRAVITY, Assembly, Block, Corner
from drystone.model.joint_law import JointLaw

LAW = JointLaw(friction_coefficient=0.6, normal_stiffness=1e9, shear_stiffness=1e9)
L_SHAPE = np.array([[0.0, 0.0], [0.6, 0.0], [0.6, 0.2], [0.2, 0.2], [0.2, 0.5], [0.0, 0.5]])


def assembly(*blocks: Block, **more) -> Assembly:
    return Assembly.build(blocks, joint=LAW, **more)


def block(vertices, **more) -> Block:
    return Block(id="b", vertices=np.asarray(vertices, float), unit_weight=10e3, **more)


def test_an_l_in_the_plane_is_two_parts_with_the_mass_of_one_piece():
    """0.6 x 0.2 below 0.2 x 0.3: area 0.18 m2, centroid by hand."""
    made = assembly(block(L_SHAPE), thickness=2.0)
    assert len(made.shapes.radius) == 2 and set(made.shapes.body) == {0}
    assert made.volume[0] == pytest.approx(0.36, rel=1e-12)
    x = (0.12 * 0.3 + 0.06 * 0.1) / 0.18
    y = (0.12 * 0.1 + 0.06 * 0.35) / 0.18
    assert made.centroid[0] == pytest.approx([x, y], rel=1e-12)


def test_the_same_l_as_a_prism_has_that_mass_and_the_plane_moment():
    vertices, faces = solid.extruded(L_SHAPE, (0.0, 2.0))
    flat, made = assembly(block(L_SHAPE), thickness=2.0), assembly(block(vertices, faces=faces))
    assert made.dimension == 3 and made.n_dof == 6
    assert made.weight[0] == pytest.approx(flat.weight[0], rel=1e-12)
    assert made.centroid[0] == pytest.approx([flat.centroid[0, 0], 1.0, flat.centroid[0, 1]])
    # About y, which is a principal axis, the inertia is that of the plane.
    k = int(np.argmax(np.abs(made.axes[0][1])))
    assert abs(made.axes[0][1, k]) == pytest.approx(1.0, abs=1e-12)
    assert made.mass[0, 3 + k] == pytest.approx(flat.mass[0, 2], rel=1e-10)


def test_a_box_has_the_moments_of_a_box():
    vertices, faces = solid.box([[0.0, 0.0, 0.0], [0.4, 0.6, 1.5]])
    made = assembly(block(vertices, faces=faces))
    m = 10e3 * 0.36 / GRAVITY
    moments = [m / 12.0 * (p**2 + q**2) for p, q in ((0.6, 1.5), (0.4, 1.5), (0.4, 0.6))]
    assert made.mass[0] == pytest.approx([m, m, m, *moments], rel=1e-12)
    assert np.array_equal(made.axes[0], np.eye(3))


@pytest.mark.parametrize("corner", [Corner(), Corner(radius=0.02), Corner(chamfer=0.02)])
def test_parts_that_are_given_move_as_one_and_keep_their_seam(corner):
    """A box cut in two: its contact shapes reach to the seam, treated corners or not."""
    halves = [
        Part(*solid.box([[0.0, 0.0, 0.0], [0.2, 0.3, 0.4]])),
        Part(*solid.box([[0.2, 0.0, 0.0], [0.4, 0.3, 0.4]])),
    ]
    cut = Block.of_parts(halves, id="b", unit_weight=10e3)
    vertices, faces = solid.box([[0.0, 0.0, 0.0], [0.4, 0.3, 0.4]])
    whole = assembly(block(vertices, faces=faces), corner=corner)
    made = assembly(cut, corner=corner)
    assert made.mass[0] == pytest.approx(whole.mass[0], rel=1e-12)
    assert made.centroid[0] == pytest.approx(whole.centroid[0], rel=1e-12)
    assert list(made.shapes.body) == [0, 0]
    first, second = np.split(made.shapes.vertices + made.centroid[0], made.shapes.offset[1:-1])
    assert first[:, 0].max() == pytest.approx(0.2, abs=1e-12)
    assert second[:, 0].min() == pytest.approx(0.2, abs=1e-12)
    assert made.shapes.vertices.min() == pytest.approx(whole.shapes.vertices.min(), abs=1e-12)


def cut_up(how):
    """A box with faces cut into triangles, or with a vertex more: amid an edge, amid a face."""
    vertices, faces = solid.box([[0.0, 0.0, 0.0], [0.6, 0.4, 0.3]])
    if how == "triangles":
        faces = tuple((f[0], f[k], f[k + 1]) for f in faces for k in (1, 2))
    elif how == "amid a face":
        vertices = np.vstack((vertices, vertices[4:].mean(axis=0)))
        top = tuple((4 + k, 4 + (k + 1) % 4, 8) for k in range(4))
        faces = (*(face for face in faces if set(face) != {4, 5, 6, 7}), *top)
    elif how == "amid an edge":
        vertices = np.vstack((vertices, vertices[4:6].mean(axis=0)))
        following = {frozenset((4, 5)): (8,)}
        faces = tuple(
            tuple(
                k
                for i, j in zip(face, (*face[1:], face[0]), strict=True)
                for k in (i, *following.get(frozenset((i, j)), ()))
            )
            for face in faces
        )
    return vertices, faces


@pytest.mark.parametrize("how", ["triangles", "amid a face", "amid an edge"])
@pytest.mark.parametrize("given", ["faces", "parts"])
def test_faces_in_one_plane_are_one_and_vertices_amid_edges_are_left_out(how, given):
    """Contact is on one face of each part: a block of such parts did not stand."""
    part = Part(*cut_up(how))
    figure = Figure.of(*((part.vertices, part.faces) if given == "faces" else ((), (), (part,))))
    (plain,) = figure.parts
    assert len(plain.vertices) == 8 and [len(face) for face in plain.faces] == [4] * 6
    assert figure.volume == pytest.approx(0.072, rel=1e-12)


def test_blocks_are_all_of_one_dimension():
    vertices, faces = solid.box([[0.0, 0.0, 0.0], [0.4, 0.6, 1.5]])
    with pytest.raises(GeometryError, match='block "b": has 2 coordinates'):
        assembly(block(vertices, faces=faces), block(L_SHAPE))


def test_a_solid_that_is_none_is_named():
    flat = [[0, 0, 0], [1, 0, 0], [0, 1, 0], [1, 1, 0]]
    with pytest.raises(GeometryError, match='block "b": the vertices lie in one plane'):
        assembly(block(flat))


def test_where_a_line_enters_a_block():
    """A box of two convex parts side by side, in the plane and in space."""
    l_shape = np.array([[0.0, 0.0], [2.0, 0.0], [2.0, 1.0], [1.0, 1.0], [1.0, 3.0], [0.0, 3.0]])
    figure = Figure.of(l_shape)
    down = np.array([0.0, -1.0])
    # From the middle of the foot up to its top, 0.5 m; above the heel 2.5 m.
    assert figure.entry(np.array([1.5, 0.5]), down) == pytest.approx(-0.5)
    assert figure.entry(np.array([0.5, 0.5]), down) == pytest.approx(-2.5)
    # From beside the leg 0.5 m on to it, across the foot from below.
    assert figure.entry(np.array([1.5, 2.0]), np.array([-1.0, 0.0])) == pytest.approx(0.5)
    assert figure.entry(np.array([5.0, 0.5]), down) == 0.0  # it misses it
    cube = Figure.of(np.array([[x, y, z] for x in (0, 1) for y in (0, 1) for z in (0, 1)], float))
    slanted = np.array([0.6, 0.0, -0.8])
    # Back from the centre: 0.5 m of height before 0.5 m of width, over 0.8.
    assert cube.entry(np.full(3, 0.5), slanted) == pytest.approx(-0.5 / 0.8)
