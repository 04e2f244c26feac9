"""Seconds of what solids take: detection and limit analysis of a house of coursed walls.

python benchmarks/space.py [--blocks N ...] [--limit N]
"""

from __future__ import annotations

import argparse
from functools import partial

import harness  # first: it holds the libraries' threads to one
import numpy as np

from drystone.contact.detection import Detector
from drystone.geometry.space import solid
from drystone.limit.associative import collapse
from drystone.limit.equilibrium import Equilibrium
from drystone.model.assembly import Assembly, Block
from drystone.model.joint_law import JointLaw
from drystone.model.loading import MassPattern

UNIT = np.array([0.4, 0.2, 0.175])  # m
LAW = JointLaw(friction_coefficient=0.65, normal_stiffness=1e9, shear_stiffness=1e9)


def house(n_blocks: int) -> Assembly:
    """Four walls in running bond around a square, of about so many blocks, on one base."""
    length, depth, height = UNIT
    n = max(round((n_blocks / 4.0) ** 0.5), 2)  # units along a wall, about as many courses
    side = n * length + depth
    boxes = [("base", np.array([[-1.0, -1.0, -0.3], [side + 1.0, side + 1.0, 0.0]]))]
    for course in range(max(round(n_blocks / (4 * n)), 1)):
        z = course * height
        for wall in range(4):
            # Like a pinwheel, the other way round in every second course: corners interlock.
            late = (wall >= 2) != (course % 2 == 1)
            cuts = np.linspace(0.0, n * length, n + 1) + (depth if late else 0.0)
            across = (side - depth, side) if wall in (1, 2) else (0.0, depth)
            for i in range(n):
                u, v = (cuts[i], cuts[i + 1]), across
                if wall % 2:
                    u, v = v, u
                low, high = (u[0], v[0], z), (u[1], v[1], z + height)
                boxes.append((f"c{course}w{wall}u{i}", np.array([low, high])))
    blocks = []
    for name, corners in boxes:
        vertices, faces = solid.box(corners)
        support = name == "base"
        blocks.append(
            Block(id=name, vertices=vertices, faces=faces, unit_weight=10e3, support=support)
        )
    return Assembly.build(blocks, joint=LAW)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--blocks", type=int, action="append")
    parser.add_argument("--limit", type=int, default=1000, help="blocks of limit analysis; 0: none")
    chosen = parser.parse_args()
    print(harness.machine())
    for n in chosen.blocks or [1000, 10_000]:
        assembly = house(n)
        detector, pose = Detector(assembly), assembly.design_pose()
        pairs = detector.pairs(pose)
        slots = detector.find(pairs, pose)
        used = int(np.count_nonzero(slots.kind))
        found = harness.median_seconds(partial(detector.fill, pairs, pose, slots), 15)
        listed = harness.median_seconds(partial(detector.pairs, pose), 5)
        print(
            f"{assembly.n_blocks} blocks, {pairs.n_pairs} pairs, {used} points: contacts "
            f"{1e3 * found:.2f} ms, list of pairs {1e3 * listed:.1f} ms"
        )
    if chosen.limit:
        assembly = house(chosen.limit)
        load = MassPattern(direction=np.array([1.0, 0.0, 0.0]))
        equilibrium = Equilibrium.of(assembly, load)
        answer = collapse(equilibrium)
        seconds = harness.median_seconds(partial(collapse, equilibrium), 1)
        print(
            f"{assembly.n_blocks} blocks: associative multiplier {answer.factor:.6f} "
            f"({answer.status}) in {seconds:.1f} s"
        )


if __name__ == "__main__":
    main()
