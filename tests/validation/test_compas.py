"""Problems of the real compas_dem: as models, solved, as results, and in JSON."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

import compas_here
import drystone as ds
from drawn import box
from drystone.common.errors import ModelError
from drystone.compas import model_of, solve
from drystone.compas.results import results_of
from drystone.io.drawings import FORMATS, Shape
from drystone.model.loading import AccelerationPattern, ForcesPattern, MassPattern

compas = pytest.importorskip("compas", reason="pip install 'drystone[compas]'")
pytest.importorskip("compas_dem", reason="pip install 'drystone[compas]'")

X = (1.0, 0.0, 0.0)
#: Of two ways to the same model: block by block they differ by roundings alone.
SAME = 1e-9

HEAD = f"""
title = "by file"
dimension = 3
[material.limestone]
density = {compas_here.DENSITY}
[joint]
friction_coefficient = {compas_here.MU}
normal_stiffness = {compas_here.STIFFNESS}
shear_stiffness = {compas_here.STIFFNESS}
[[import]]
file = "model.json"
material = "limestone"
unit = "m"
"""


def by_file(model, folder: Path, load: str) -> ds.Model:
    """The same structure by a model file that imports the JSON of compas_dem."""
    compas.json_dump(model, folder / "model.json")
    (folder / "model.toml").write_text(HEAD + load)
    return ds.read_model(folder / "model.toml")


#: Masses pushed along x, as a model file says it.
MASS = '[load]\npattern = "mass"\ndirection = [1.0, 0.0, 0.0]\n'


def balance(problem, solution) -> float:
    """Largest unbalanced force on a block by the results alone, over the largest load."""
    results, assembly = solution.results, solution.model.assembly
    multiplier = results.metadata["load_multiplier"]
    total = -assembly.weight[:, None] * assembly.up
    total = total + multiplier * solution.model.load.forces(assembly, _masses(solution)).force
    for load in solution.model.dead_loads:
        total = total + load.forces(assembly).force
    largest = np.linalg.norm(total[~assembly.fixed], axis=1).max()
    row = {int(name): i for i, name in enumerate(assembly.ids)}
    for edge in results.edges():
        force = np.array(results.resultant_global(edge))
        total[row[edge[0]]] += force
        total[row[edge[1]]] -= force
    return float(np.linalg.norm(total[~assembly.fixed], axis=1).max() / largest)


def _masses(solution):
    from drystone.model.loading import masses_of

    return masses_of(solution.model.assembly, solution.model.dead_loads)


def check(problem, solution, folder: Path, load: str) -> None:
    """Peak as by file, results in balance, and through JSON and back."""
    peak = solution.curve.peak.load_multiplier
    other = ds.pushover(by_file(problem.model, folder, load)).peak.load_multiplier
    assert peak == pytest.approx(other, rel=SAME)
    # Residuals of static steps are below 1e-8; what is left of the loads is inertia, of which the
    # last points of a jump have some.
    at_peak = solution.curve.peak.inertia_ratio
    assert balance(problem, solution) < 1e-6 + at_peak
    compas.json_dump(solution.results, folder / "results.json")
    again = compas.json_load(folder / "results.json")
    assert again.model_id == str(problem.model.guid)
    assert list(again.edges()) == list(solution.results.edges()) != []
    for edge in again.edges():
        one, two = again.contact_data(edge), solution.results.contact_data(edge)
        assert again.resultant_global(edge) == solution.results.resultant_global(edge)
        assert one.forces == two.forces
        resultant = solution.results.resultant_global(edge)
        n, u, v = one.frame.zaxis, one.frame.xaxis, one.frame.yaxis
        parts = again.resultant_local(edge)
        rebuilt = np.array(u) * parts[0] + np.array(v) * parts[1] + np.array(n) * parts[2]
        assert rebuilt == pytest.approx(resultant, rel=1e-9, abs=1e-6 * np.abs(resultant).max())
    for node in again.nodes():
        assert again.displacement(node) == pytest.approx(solution.results.displacement(node))
    assert again.metadata["peak_multiplier"] == peak


@pytest.mark.slow
def test_an_arch_of_the_template(tmp_path):
    problem = compas_here.problem_of(compas_here.arch())
    solution = solve(problem, direction=X)
    check(problem, solution, tmp_path, MASS)
    # Tangential and normal: what presses is positive along the normal, towards the first node.
    results = solution.results
    for edge in results.edges():
        a, b = (np.array(list(problem.model._block(node).point)) for node in edge)
        assert np.array(results.contact_data(edge).frame.zaxis) @ (a - b) > 0.0
        assert sum(results.force_normal(edge)) > 0.0


@pytest.mark.slow
def test_a_barrel_vault_of_the_template(tmp_path):
    problem = compas_here.problem_of(compas_here.barrel_vault())
    solution = solve(problem, direction=X)
    check(problem, solution, tmp_path, MASS)


@pytest.mark.slow
def test_a_wall_of_boxes_under_a_body_force(tmp_path):
    problem = compas_here.problem_of(compas_here.wall())
    wind = problem.add_boundary_condition("Quake")
    problem.add_global_body_force(9.81, 0.0, 0.0, boundary_condition=wind)
    solution = solve(problem)
    assert isinstance(solution.model.load, AccelerationPattern)
    check(problem, solution, tmp_path, MASS)


@pytest.mark.slow
def test_an_arch_under_a_load_that_grows_beside_a_dead_one(tmp_path):
    problem = compas_here.problem_of(compas_here.arch())
    block = problem.model._block(2)
    top = max(block.modelgeometry.faces(), key=lambda f: block.modelgeometry.face_center(f)[2])
    dead, live = (problem.add_boundary_condition(name) for name in ("Dead", "Live"))
    dead.add_surface_load(2, top, [0.0, 0.0, -2e3])
    problem.add_point_load_at_centroid(2, [0.0, 0.0, -1e5], boundary_condition=live)
    solution = solve(problem, load="Live")
    assert isinstance(solution.model.load, ForcesPattern)
    centre = list(map(float, block.modelgeometry.face_center(top)))
    down = -2e3 * block.modelgeometry.face_area(top)
    load = f"""
[[dead_load]]
kind = "force"
mass = false
block = "{block.guid}"
point = {centre}
force = [0.0, 0.0, {down}]
[load]
pattern = "forces"
[[load.force]]
block = "{block.guid}"
force = [0.0, 0.0, -1e5]
"""
    check(problem, solution, tmp_path, load)


@pytest.mark.slow
def test_the_dual_of_a_triangulation(tmp_path):
    problem = compas_here.problem_of(compas_here.triangulation_dual())
    solution = solve(problem, direction=X)
    check(problem, solution, tmp_path, MASS)


@pytest.mark.slow
def test_a_problem_comes_back_from_json_and_gives_the_same(tmp_path):
    from compas_dem.models import Analysis

    problem = compas_here.problem_of(compas_here.wall())
    quake = problem.add_boundary_condition("Quake")
    quake.add_global_body_force(0.0, 3.0, 0.0)
    analysis = Analysis(problem.model)
    analysis.add_problem(problem)
    compas.json_dump(analysis, tmp_path / "analysis.json")
    again = compas.json_load(tmp_path / "analysis.json").problems[0]
    first, second = solve(problem), solve(again)
    peaks = [one.curve.peak.load_multiplier for one in (first, second)]
    assert peaks[1] == pytest.approx(peaks[0], rel=SAME)
    at_rest = results_of(problem, first.model, first.curve, at="rest")
    assert at_rest.metadata["load_multiplier"] == first.curve.points[0].load_multiplier


def test_a_model_has_what_the_problem_has():
    problem = compas_here.problem_of(compas_here.arch())
    problem.set_contact_model("MohrCoulomb", phi=30.0, c=2e5, t_c=1e5)
    model = model_of(problem, direction=X, control_block=3)
    assembly, law = model.assembly, model.assembly.joint
    assert assembly.ids == tuple(str(node) for node in range(8))
    assert [assembly.ids[i] for i in np.flatnonzero(assembly.fixed)] == ["0", "7"]
    assert law.friction_coefficient == pytest.approx(np.tan(np.radians(30.0)))
    assert (law.cohesion, law.tensile_strength) == (2e5, 1e5)
    assert (law.normal_stiffness, law.shear_stiffness) == (1e10, 1e10)
    volumes = [block.modelgeometry.volume() for block in problem.model.elements()]
    assert assembly.weight == pytest.approx(2200.0 * 9.81 * np.array(volumes))
    assert assembly.ids[model.control_point.block] == "3"
    assert isinstance(model.load, MassPattern)


def test_supports_that_move_are_a_settlement():
    problem = compas_here.problem_of(compas_here.arch())
    spread = problem.add_boundary_condition("Spread")
    spread.add_displacement(7, dx=-0.03, dy=0.0, dz=-0.04)
    settlement = model_of(problem).settlement
    assert settlement.blocks == ("7",)
    assert settlement.direction == pytest.approx([-0.6, 0.0, -0.8])
    assert settlement.max == pytest.approx(0.05)


def test_a_support_that_turns_is_a_settlement_about_its_middle():
    problem = compas_here.problem_of(compas_here.arch())
    problem.add_boundary_condition("Tilt").add_rotation(0, [0.0, 0.02, 0.0])
    settlement = model_of(problem).settlement
    assert settlement.axis == pytest.approx([0.0, 1.0, 0.0])
    assert settlement.max == pytest.approx(np.degrees(0.02))
    assert settlement.centre == pytest.approx(list(problem.model._block(0).point))


def test_displacements_of_zero_on_blocks_that_move_are_rollers():
    problem = compas_here.problem_of(compas_here.arch())
    problem.add_boundary_condition("Sides").add_displacement(4, dy=0.0)
    model = model_of(problem, direction=X)
    assert model.assembly.blocks[4].held == ("y",)


def _instantaneous(problem):
    problem.add_boundary_condition("Bang").add_point_load(
        3, [1e3, 0.0, 0.0], loading_type="instantaneous"
    )


def _instantaneous_everywhere(problem):
    problem.add_boundary_condition("Quake").add_global_body_force(
        3.0, 0.0, 0.0, loading_type="instantaneous"
    )


def _moment(problem):
    problem.add_boundary_condition("Twist").add_moment(3, [0.0, 1e3, 0.0])


def _moved_block(problem):
    problem.add_boundary_condition("Pull").add_displacement(3, dx=0.1)


def _supports_apart(problem):
    apart = problem.add_boundary_condition("Apart")
    apart.add_displacement(0, dx=0.1)
    apart.add_displacement(7, dx=-0.1)


def _two_groups(problem):
    for name in ("One", "Two"):
        problem.add_boundary_condition(name).add_point_load(3, [1e3, 0.0, 0.0])


def _load_and_displacement(problem):
    both = problem.add_boundary_condition("Both")
    both.add_point_load(3, [1e3, 0.0, 0.0])
    both.add_displacement(0, dx=0.1)


def _off_the_block(problem):
    problem.add_boundary_condition("Off").add_point_load(3, [1e3, 0.0, 0.0], point=[0.0, 9.0, 9.0])


def _unknown_block(problem):
    problem.add_boundary_condition("Nobody").add_point_load(99, [1e3, 0.0, 0.0])


def _no_contact_model(problem):
    problem.add_boundary_condition("Push").add_point_load(3, [1e3, 0.0, 0.0])
    problem.contact_properties.contact_model = None


def _two_gravities(problem):
    problem.add_boundary_condition("One").add_point_load(3, [1e3, 0.0, 0.0])
    problem.add_boundary_condition("Moon").add_gravity(1.62)


@pytest.mark.parametrize(
    ("given", "said"),
    [
        (_instantaneous, 'boundary condition "Bang", point load 1: loading_type="instantaneous"'),
        (_instantaneous_everywhere, 'boundary condition "Quake", body force 1: loading_type='),
        (_moment, 'boundary condition "Twist", point load 1: has a moment'),
        (_moved_block, 'boundary condition "Pull", displacement 1: moves block 3'),
        (_supports_apart, 'boundary condition "Apart": its supports move in different ways'),
        (_two_groups, 'say which of "One", "Two" grows'),
        (_load_and_displacement, 'boundary condition "Both": has loads and a prescribed'),
        (_off_the_block, 'boundary condition "Off", point load 1: its point is not on block 3'),
        (_unknown_block, 'boundary condition "Nobody", point load 1: there is no block at node 99'),
        (_no_contact_model, "contact model: is missing"),
        (_two_gravities, "gravity: the boundary conditions have different ones"),
        (lambda problem: None, "boundary conditions: none holds a load"),
    ],
)  # fmt: skip
def test_what_drystone_cannot_do_is_refused_by_name(given, said):
    problem = compas_here.problem_of(compas_here.arch())
    given(problem)
    with pytest.raises(ModelError) as raised:
        model_of(problem)
    assert said in str(raised.value)


def test_loads_of_all_boundary_conditions_are_refused_at_once():
    problem = compas_here.problem_of(compas_here.arch())
    _instantaneous_everywhere(problem)
    _moment(problem)
    with pytest.raises(ModelError) as raised:
        model_of(problem, load="Quake")
    assert [line.split(":")[0] for line in raised.value.problems] == [
        'boundary condition "Quake", body force 1',
        'boundary condition "Twist", point load 1',
    ]


def test_blocks_of_a_group_stand_where_it_moves_them():
    from compas.geometry import Translation
    from compas_model.elements import Group

    model = compas_here.wall()
    plain = model_of(compas_here.problem_of(model), direction=X).assembly
    grouped = type(model)()
    group = grouped.add_element(Group(transformation=Translation.from_vector([0.0, 0.0, 2.0])))
    for block in model.elements():
        grouped.add_element(block.copy(), parent=group)
    assembly = model_of(compas_here.problem_of(grouped), direction=X).assembly
    # The group is the node 0 of the graph.
    assert assembly.ids == tuple(str(int(name) + 1) for name in plain.ids)
    assert assembly.centroid == pytest.approx(plain.centroid + [0.0, 0.0, 2.0])


def read_back(model, folder: Path) -> list[tuple[str, bool, np.ndarray]]:
    """Names, supports and vertices (n, 3) [m] of the blocks of a file that COMPAS wrote."""
    compas.json_dump(model, folder / "model.json")
    settings = ds.ImportSettings(file=folder / "model.json", unit="m")
    made = ds.imported(settings, lambda layer: ("stone", 2e4))
    return [(block.id, block.support, block.vertices) for block in made.blocks]


def test_blocks_of_a_file_stand_where_groups_move_them(tmp_path):
    from compas.geometry import Rotation, Translation
    from compas_model.elements import Group

    plain = compas_here.wall()
    model = type(plain)()
    model.transformation = Translation.from_vector([0.0, 3.0, 0.0])
    turned = Rotation.from_axis_and_angle([0.0, 0.0, 1.0], 0.3)
    outer = model.add_element(Group(transformation=Translation.from_vector([5.0, 0.0, 0.0])))
    inner = model.add_element(Group(transformation=turned), parent=outer)
    blocks = [block.copy() for block in plain.elements()]
    for k, block in enumerate(blocks):
        block.name = f"stone {k}"
        model.add_element(block, parent=inner)
    found = read_back(model, tmp_path)
    for block, (name, support, vertices) in zip(blocks, found, strict=True):
        assert (name, support) == (block.name, block.is_support)
        points = np.array(block.modelgeometry.vertices_attributes("xyz"))
        away = np.linalg.norm(points[:, None] - vertices, axis=2).min(axis=1)
        assert away.max() < 1e-9  # of roundings at ten metres


def test_contacts_that_were_computed_are_no_blocks(tmp_path):
    model = compas_here.wall()
    model.compute_contacts()
    contacts = list(model.contacts())
    assert contacts
    assert all(contact.mesh for contact in contacts)  # which are written from then on
    assert len(read_back(model, tmp_path)) == len(list(model.elements()))


def written(names: list[str]) -> str:
    """An assembly of cubes as drystone writes it."""
    shapes = []
    for k, name in enumerate(names):
        vertices, faces = box((0, 0, k), (1, 1, k + 1))
        shapes.append(Shape(name=name, vertices=vertices, faces=tuple(faces), support=k == 0))
    return FORMATS["compas"].write(shapes, "cubes", (0.0, 0.0, 0.0))


NAMES = ["semicircle/left", "it's", 'a "b"', "7"]


def test_compas_loads_the_graph_of_an_assembly(tmp_path):
    data = json.loads(written(NAMES))["data"]["graph"]
    (tmp_path / "graph.json").write_text(json.dumps(data))
    graph = compas.json_load(tmp_path / "graph.json")
    assert list(graph.nodes()) == ["semicircle/left", "it's", 'a "b"', 7]
    assert [graph.node_attribute(node, "is_support") for node in graph.nodes()][:2] == [True, False]
    volumes = [graph.node_attribute(node, "block").volume() for node in graph.nodes()]
    assert volumes == pytest.approx([1.0] * 4)


def test_compas_assembly_loads_an_assembly(tmp_path):
    pytest.importorskip("compas_assembly")
    (tmp_path / "a.json").write_text(written(NAMES))
    assembly = compas.json_load(tmp_path / "a.json")
    assert [block.volume() for block in assembly.blocks()] == pytest.approx([1.0] * 4)
    assert [name for name, _, _ in read_back(assembly, tmp_path)] == NAMES


def test_elements_that_are_no_blocks_are_named():
    from compas_model.elements import ColumnElement

    model = compas_here.wall()
    model.add_element(ColumnElement(width=0.3, depth=0.3, height=2.0, name="pier"))
    with pytest.raises(ModelError, match=r'element 8, "pier": is a ColumnElement'):
        model_of(compas_here.problem_of(model), direction=X)


def test_a_curve_needs_a_joint_stiffness():
    problem = compas_here.problem_of(compas_here.arch())
    problem.contact_properties.joint_model = None
    assert model_of(problem, direction=X).assembly.joint.normal_stiffness is None
    with pytest.raises(ModelError, match=r"set_joint_model\(kn=..., kt=...\)"):
        solve(problem, direction=X)


def test_a_block_without_density_is_named():
    model = compas_here.arch()
    from compas_dem.problem import Problem

    problem = Problem(model)
    problem.set_contact_model("MohrCoulomb", mu=0.7)
    with pytest.raises(ModelError, match='block "0": has no density'):
        model_of(problem, direction=X)
    assert model_of(problem, direction=X, density=2000.0).assembly.weight[0] > 0.0
