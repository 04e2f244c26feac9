"""The curve of smoothed problems: what it ends at, and what is said where it ends nowhere."""

import json
from dataclasses import replace

import numpy as np
import pytest
from typer.testing import CliRunner

import solids
from drystone.cli import app
from drystone.io.modelfile import write_model
from drystone.limit import coulomb_path, limits_beside, non_associative
from drystone.limit.collapse import collapse_load, collapse_loads
from drystone.limit.cones import shear_strength
from drystone.limit.coulomb_path import Ending, follow
from drystone.limit.equilibrium import Equilibrium
from drystone.model.joint_law import JointLaw

MOST = 300


def block(friction=0.2, angle=25.0, **more):
    law = JointLaw(friction_coefficient=friction, normal_stiffness=1e9, shear_stiffness=1e9, **more)
    model = solids.one_block(0.4, 0.6, 1.5, angle=angle)
    return replace(model, assembly=replace(model.assembly, joint=law))


def balance(model):
    return Equilibrium.of(model.assembly, model.load)


def tangent(degrees):
    return float(np.tan(np.radians(degrees)))


@pytest.mark.parametrize("seed", range(3))
@pytest.mark.parametrize("friction", [0.0, 0.1, 0.9])
def test_a_block_slides_or_rocks_whatever_the_weights(seed, friction):
    expected = min(friction, 0.4 / (1.5 * np.cos(np.radians(25.0))))
    end = follow(balance(block(friction)), seed=seed, most=MOST)
    assert end.finished and not end.locked
    assert end.smoothing <= coulomb_path.ENOUGH
    assert end.factor == pytest.approx(expected, abs=1e-7)


@pytest.mark.parametrize("law", [{}, {"dilatancy_angle": 5.0}, {"cohesion": 900.0}])
def test_the_end_satisfies_coulomb(law):
    """To the smoothing at the end, 1e-8 at worst; velocities are of order one."""
    equilibrium = balance(block(**law))
    end = follow(equilibrium, seed=1, most=MOST)
    relative = equilibrium.relative(end.velocity)
    slip = equilibrium.slip(relative)
    opening = relative[:, 0] - equilibrium.points.dilatancy * slip
    spare = shear_strength(equilibrium, end.forces[:, 0]) - equilibrium.slip(end.forces)
    assert equilibrium.live @ end.velocity == pytest.approx(1.0, abs=1e-9)
    assert equilibrium.residual(end.forces, end.factor) < 1e-9
    assert spare.min() > -1e-9 and opening.min() > -1e-7
    assert np.abs(end.forces[:, 0] * opening).max() < 1e-7
    assert np.abs(spare * slip).max() < 1e-7
    # Friction is against the slip.
    assert np.sum(end.forces[:, 1:] * relative[:, 1:], axis=1).max() < 0.0


def test_with_few_factorisations_it_says_that_it_is_not_at_the_end():
    end = follow(balance(block()), seed=0, most=12)
    assert not end.finished and end.n_factorisations == 12


def test_the_lower_bound_is_that_of_joints_with_as_much_friction_as_dilatancy():
    """A block that slides at 0.4 with 5 degrees of dilatancy: no state lies below tan 5."""
    equilibrium = balance(block(0.2, dilatancy_angle=5.0))
    slope = non_associative.flow_tangent(equilibrium, 0.0)
    assert non_associative.lower_bound(equilibrium, slope) == pytest.approx(tangent(5), abs=1e-7)
    assert non_associative.lower_bound(equilibrium, 0.0 * slope) == pytest.approx(0.0, abs=1e-7)


def test_cohesion_is_in_the_lower_bound():
    """Without friction a block of 0.4 m x 0.6 m x 1.5 m slides at c A / W."""
    equilibrium = balance(block(0.2, cohesion=600.0))
    expected = 600.0 / (solids.UNIT_WEIGHT * 1.5)
    slope = np.zeros(equilibrium.n_contacts)
    assert non_associative.lower_bound(equilibrium, slope) == pytest.approx(expected, abs=1e-7)


@pytest.fixture
def lost(monkeypatch):
    """No curve comes to its end, no sequence of programs to rest."""

    def nowhere(equilibrium, *, seed, most):
        return Ending(
            finished=False,
            locked=False,
            factor=0.3,
            forces=np.zeros((equilibrium.n_contacts, 3)),
            velocity=np.zeros_like(equilibrium.dead),
            smoothing=1e-3,
            n_factorisations=most,
        )

    monkeypatch.setattr(coulomb_path, "follow", nowhere)
    monkeypatch.setattr(non_associative, "_certify", lambda *_: None)


def test_without_a_state_there_is_a_bracket(lost):
    associative, found = collapse_loads(block(dilatancy_angle=5.0))
    assert found.status == "bracketed" and np.isnan(found.load_multiplier)
    assert found.collapse_range == pytest.approx((tangent(5), 0.2), abs=1e-7)
    assert found.upper_bound == associative.load_multiplier
    assert "none below 0.087489" in found.reason and "none above 0.2" in found.reason


def test_the_bracket_is_printed(lost, tmp_path):
    path = tmp_path / "block.toml"
    write_model(block(dilatancy_angle=5.0), path)
    run = CliRunner().invoke(app, ["limit", str(path), "--json"])
    found = json.loads(run.stdout)
    assert run.exit_code == 0
    assert found["status"] == "bracketed" and found["collapse_multiplier"] is None
    assert found["collapse_range"] == pytest.approx([tangent(5), 0.2], abs=1e-7)
    assert "no collapse state was found" in CliRunner().invoke(app, ["limit", str(path)]).stdout
    beside = limits_beside(block(dilatancy_angle=5.0))
    assert beside.non_associative is None
    assert beside.collapse_range == pytest.approx((tangent(5), 0.2), abs=1e-7)


def test_alpha_tilts_the_flow_in_space():
    settings = non_associative.NonAssociativeSettings(alpha=0.5, n_paths=1)
    found = collapse_load(block(0.2), settings=settings)
    assert found.velocities[1, 2] == pytest.approx(
        0.1 * np.hypot(*found.velocities[1, :2]), abs=1e-4
    )
