"""An arch of compas_dem pushed sideways: its capacity curve, and results for the viewer of COMPAS.

Needs ``pip install 'drystone[compas]'``.  Run it with ``python examples/compas_arch.py``; it writes
``out/compas_arch.json``, which `compas.json_load` reads.
"""

from pathlib import Path
from typing import Any

from drystone.compas import Solution, solve


def arch() -> Any:
    """A problem of compas_dem: eight voussoirs of limestone, the lowest two on the ground."""
    from compas_dem.material import Stone
    from compas_dem.models import BlockModel
    from compas_dem.problem import Problem
    from compas_dem.templates import ArchTemplate

    model = BlockModel()
    for mesh in ArchTemplate(rise=3, span=10, thickness=0.9, depth=1.0, n=8).blocks():
        model.add_block_from_mesh(mesh)
    model.add_supports([0, 7])
    limestone = Stone.from_predefined_material("LIMESTONE")
    model.add_material(limestone)
    model.assign_material(limestone, elements=list(model.elements()))

    problem = Problem(model, name="arch")
    problem.set_contact_model("MohrCoulomb", mu=0.7)
    problem.set_joint_model(kn=1e10, kt=1e10)  # Pa/m
    return problem


def pushed() -> Solution:
    """The arch under horizontal forces in proportion to mass."""
    return solve(arch(), direction=(1.0, 0.0, 0.0))


def main() -> None:
    import compas

    results, curve, _ = pushed()
    print(f"peak multiplier {curve.peak.load_multiplier:.4f}")
    for edge in results.edges():
        print(edge, f"{results.force_magnitude(edge) / 1e3:.1f} kN")
    path = Path("out/compas_arch.json")
    path.parent.mkdir(exist_ok=True)
    compas.json_dump(results, path)


if __name__ == "__main__":
    main()
