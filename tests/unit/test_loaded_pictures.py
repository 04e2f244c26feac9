"""Pictures of structures with ties and dead loads: nothing is cut off, "at rest" is at rest."""

from __future__ import annotations

import numpy as np
import pytest
from matplotlib.figure import Figure
from matplotlib.quiver import Quiver

import drystone as ds
from drystone.report import Mechanism
from drystone.report.load_arrows import SHORTEST, arrows_of, dead_arrows
from drystone.report.mechanism import Drawn
from drystone.report.mechanism_figure import plot_mechanism
from drystone.results.shapes import MovingShapes, compliance, moving_blocks
from piers import FAR, piers


def shown(model: ds.Model, pose=None, initial=None) -> Mechanism:
    return Mechanism(
        assembly=model.assembly,
        pose=model.assembly.design_pose() if pose is None else pose,
        initial=initial,
        ties=model.ties,
        dead_loads=model.dead_loads,
        load_direction=model.load_shown,
    )


@pytest.mark.parametrize("space", [False, True])
def test_the_picture_holds_base_ties_and_arrows(space):
    model = ds.extruded(piers()) if space else piers()
    mechanism = shown(model)
    drawn = Drawn.of(mechanism)
    axes = Figure().subplots()
    plot_mechanism(axes, mechanism)
    (left, right), (bottom, top) = axes.get_xlim(), axes.get_ylim()
    ends = [line.get_xydata() for line in axes.get_lines() if line.get_label() == "tie"]
    (quiver,) = (artist for artist in axes.get_children() if isinstance(artist, Quiver))
    tips = quiver.XY + np.column_stack((quiver.U, quiver.V))
    places = np.vstack([*ends, quiver.XY, tips])
    if not space:
        assert len(ends) == 1 and np.array_equal(ends[0][1], FAR)
        places = np.vstack((places, drawn.shapes.vertices))
    assert (places > (left, bottom)).all() and (places < (right, top)).all()
    if space:  # what is drawn of the blocks is a picture: no block touches its rim
        (image,) = axes.get_images()
        pixels = np.asarray(image.get_array())
        for rim in (pixels[0], pixels[-1], pixels[:, 0], pixels[:, -1]):
            assert (rim == 1.0).all()


def test_arrows_end_where_their_line_meets_the_block():
    """The roof's at the top of its block, and no force is so small that its arrow is not seen."""
    model = piers()
    rows, arrows = dead_arrows(model.assembly, model.dead_loads)
    roof, push = arrows
    assert rows.tolist() == [2, 1]
    np.testing.assert_allclose(roof[1], [2.25, 2.0], atol=1e-12)
    np.testing.assert_allclose(push[1], [0.5, 1.0], atol=1e-12)  # comes from the right
    way = np.diff(arrows, axis=1)[:, 0]
    np.testing.assert_allclose(way[0] / np.linalg.norm(way[0]), [0.0, -1.0], atol=1e-12)
    # A tenth of the roof's force: the shortest arrow.
    np.testing.assert_allclose(way[1], [-SHORTEST * np.linalg.norm(way[0]), 0.0], atol=1e-12)


def test_arrows_go_with_their_blocks_and_keep_their_direction():
    model = piers()
    pose = model.assembly.design_pose()
    pose[2] = (0.3, 0.1, np.pi / 2.0)
    forces = [load.forces(model.assembly) for load in model.dead_loads]
    _, (roof,) = arrows_of(model.assembly, forces[:1], pose)
    # Its tip was 1 m above the centroid (2.25, 1), and is that far to the left of it now.
    np.testing.assert_allclose(roof[1], [2.55 - 1.0, 1.1], atol=1e-12)
    np.testing.assert_allclose(np.diff(roof, axis=0)[0, 0], 0.0, atol=1e-12)
    departed = np.array([True, True, False])
    assert len(arrows_of(model.assembly, forces, pose, present=departed)[1]) == 1


def test_what_has_moved_is_not_at_rest_however_far_another_part_falls():
    """One block falls by 7 m, the other has moved by 0.2 m: 3 % of that."""
    model = piers()
    initial = model.assembly.design_pose()
    initial[1:, 1] = -1e-4
    pose = initial.copy()
    pose[1, 0], pose[2, 1] = 0.2, -7.0
    drawn = Drawn.of(shown(model, pose, initial))
    assert drawn.moving.tolist() == [False, True, True]
    assert drawn.visible < 0.2  # its joint has slid, and is drawn as slid
    pose[1, 0] = 5e-5  # less than the joints closed by under the dead load: it follows them
    assert Drawn.of(shown(model, pose, initial)).moving.tolist() == [False, False, True]


def test_compliance_is_the_motion_under_the_dead_load():
    model = piers()
    shapes, fixed = MovingShapes.of(model.assembly), model.assembly.fixed
    initial = model.assembly.design_pose()
    initial[1:, 1] = (-1e-3, -2e-3)
    assert compliance(shapes, initial, fixed) == pytest.approx(2e-3, rel=1e-9)
    assert compliance(shapes, None, fixed) == np.inf
    assert 0.0 < compliance(shapes, model.assembly.design_pose(), fixed) < 1e-4
    # Where all that moves is small, a twentieth of the largest motion counts.
    small = np.array([0.0, 1e-4, 1e-6])
    assert moving_blocks(small, fixed, 2e-3).tolist() == [False, True, False]
