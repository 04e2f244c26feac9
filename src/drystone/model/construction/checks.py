"""What keeps a set of blocks from being an assembly that can be analysed, as sentences."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Mapping, Sequence
from itertools import combinations

import numpy as np

from drystone.common.ranges import problem
from drystone.common.tolerances import TOUCHING
from drystone.geometry import GeometryError
from drystone.geometry.dimension import dimension_of
from drystone.geometry.plane.outlines import Outlines
from drystone.geometry.space.polyhedra import Polyhedra
from drystone.model.assembly import (
    Assembly,
    Block,
    Corner,
    JointLaw,
)
from drystone.model.construction.joint_checks import yielding_problems
from drystone.model.construction.words import millimetres, quoted

#: Overlap, relative to the smaller block, that is taken for rounding of the coordinates.
OVERLAPPING = 1e-6

#: Overlaps that are told, each in a sentence.
MOST_TOLD = 1000

#: Names a block by its row, as its author would look for it.
Place = Callable[[int], str]


def law_problems(law: JointLaw) -> list[str]:
    """Values that no joint can have, each as "key: sentence"."""
    problems = law.problems()
    if problems:
        return problems
    friction_angle = float(np.degrees(np.arctan(law.friction_coefficient)))
    if law.dilatancy_angle > friction_angle * (1.0 + 1e-9):
        problems.append(
            f"dilatancy_angle: {law.dilatancy_angle:g} degrees is more than the friction angle of "
            f"{friction_angle:.4g} degrees, and such a joint would make energy: make it smaller"
        )
    return problems + yielding_problems(law)


def roller_problems(blocks: Sequence[Block], place: Place) -> list[str]:
    """Of motions that rollers cannot hold."""
    problems = []
    for i, block in enumerate(blocks):
        known = dimension_of(block.dimension).motions
        if unknown := [name for name in block.held if name not in known]:
            listed = ", ".join(known)
            problems.append(f'{place(i)} held: there is no motion "{unknown[0]}": take of {listed}')
        elif block.held and (block.support or len(set(block.held)) == len(known)):
            problems.append(f"{place(i)} held: nothing moves it: set support alone")
    return problems


def block_problems(blocks: Sequence[Block], corner: Corner, place: Place) -> list[str]:
    """Ids given twice, outlines and corners that are impossible, blocks without weight."""
    problems = []
    too_round = []
    first: dict[str, int] = {}
    for i, block in enumerate(blocks):
        if first.setdefault(block.id, i) != i:
            problems.append(
                f"{place(i)}: the id is taken by {place(first[block.id])}: give it another"
            )
        wrong = problem("unit_weight", block.unit_weight)
        if wrong:
            problems.append(f"{place(i)} {wrong}")
        try:
            figure = block.figure()
        except GeometryError as error:
            problems.append(f"{place(i)} {block.shape_key}: {error}")
            continue
        try:
            corner.cores(figure)
        except GeometryError as error:
            too_round.append(f"corner, at {place(i)}: {error}")
    if too_round:  # one value is to blame for all of them
        others = f" (and so at {len(too_round) - 1} more)" if len(too_round) > 1 else ""
        problems.append(too_round[0] + others)
    return problems


def pair_problems(
    blocks: Sequence[Block], joint_between: Mapping[frozenset[str], JointLaw]
) -> list[str]:
    """Laws between blocks, groups or materials that do not exist, or cannot be told apart."""
    if not joint_between:
        return []
    ids = {block.id for block in blocks}
    materials = {block.material for block in blocks}
    groups = {name for block in blocks for name in block.groups}
    problems, of_groups = [], []
    for names in joint_between:
        place = f'joint.between."{" ".join(sorted(names))}"'
        if names <= ids and len(names) == 2:
            continue
        if names & groups and names <= ids | groups:
            of_groups.append(names)
            if names <= materials and _is_within_material(names, blocks):
                continue
            problems += [
                f"{place}: {quoted(name)} is a group and a {what}: give the group another name"
                for name in sorted(names & groups)
                for what, others in (("block", ids), ("material", materials))
                if name in others
            ]
        elif not names <= materials:
            problems.append(f"{place}: names neither two blocks or groups nor two materials")
    return problems or _ambiguous(blocks, {names: joint_between[names] for names in of_groups})


def _is_within_material(names: frozenset[str], blocks: Sequence[Block]) -> bool:
    """Whether the groups of these names hold only blocks of the materials of these names, as layers
    of a drawing do: read as materials, the pair then means what it means as groups."""
    return all(
        block.material == name for block in blocks for name in names.intersection(block.groups)
    ) and names.isdisjoint(block.id for block in blocks)


def _ambiguous(blocks: Sequence[Block], of_groups: Mapping[frozenset[str], JointLaw]) -> list[str]:
    """Two blocks between which the pairs of groups give two laws."""
    members: dict[str, set[str]] = {}
    for block in blocks:
        for name in (block.id, *block.groups):
            members.setdefault(name, set()).add(block.id)
    found = []
    for (names, law), (others, other_law) in combinations(of_groups.items(), 2):
        if law == other_law:
            continue
        a, b = members[min(names)], members[max(names)]
        for c, d in ((min(others), max(others)), (max(others), min(others))):
            first, last = a & members[c], b & members[d]
            both = ((i, j) for i in sorted(first) for j in sorted(last) if i != j)
            if pair := next(both, None):
                i, j = pair
                found.append(
                    f'joint.between."{" ".join(sorted(names))}": between blocks {quoted(i)} and '
                    f'{quoted(j)} "{" ".join(sorted(others))}" gives another law: take smaller '
                    "groups, or name the two blocks"
                )
                break
    return found


#: What closes overlaps of blocks that one file holds, as messages name it.
CLOSING = "overlap = {:g} in [[import]]"


def layout_problems(assembly: Assembly, place: Place, closing: str = CLOSING) -> list[str]:
    """No support, nothing that moves, blocks that overlap or touch nothing."""
    problems = []
    if assembly.n_supports == 0:
        problems.append(
            "block: no block is a support: set support = true in one, base = true in [wall] "
            "or [[build]], or support or support_below in [[import]]"
        )
    if assembly.n_blocks == 0:
        problems.append("block: every block is a support, nothing can move: add a block")
    packed = assembly.packed
    p, q = packed.near_pairs()
    depth = packed.overlap_depths(p, q)
    size = packed.pair_size(p, q)
    a, b = packed.body[p], packed.body[q]
    deepest: dict[tuple[int, int], float] = {}  # of the parts of two blocks
    for k in np.flatnonzero(depth > OVERLAPPING * size).tolist():
        pair = int(a[k]), int(b[k])
        deepest[pair] = max(float(depth[k]), deepest.get(pair, 0.0))
    twice = {pair for pair in deepest if _is_within(assembly, *pair)}
    most: dict[str, float] = {}  # of the blocks that one table [[import]] reads
    for (i, j), by in deepest.items():
        if (i, j) not in twice and (table := _table_of(place(i), place(j))):
            most[table] = max(by, most.get(table, 0.0))
    for told, ((i, j), by) in enumerate(deepest.items()):
        if told == MOST_TOLD:
            problems.append(f"block: {len(deepest) - told:,} more pairs of blocks overlap")
            break
        first, second = place(i), place(j)
        mend = "move them apart, or make one smaller"
        if (i, j) in twice:
            mend = "one lies within the other: take it out, or cut it out of the other"
        elif table := _table_of(first, second):
            mend += f", or let {closing.format(_upwards(most[table]))} close the joint"
        problems.append(f"{first} and {second} overlap by {millimetres(by)}: {mend}")
    problems += part_problems(assembly, place)
    touches = np.zeros(assembly.n_bodies, dtype=bool)
    near = depth >= -TOUCHING * size
    touches[a[near]] = touches[b[near]] = True
    if assembly.n_bodies > 1:
        problems.extend(_lonely(packed, np.flatnonzero(~touches & ~assembly.fixed), place))
    return problems


def part_problems(assembly: Assembly, place: Place) -> list[str]:
    """Of given parts of one block that overlap: what they share would weigh twice."""
    from drystone.geometry.broad import candidate_pairs  # brings compiled code along

    packed = assembly.packed
    body = packed.body
    given = np.array([bool(block.parts) for block in assembly.blocks])
    rows = np.flatnonzero(given[body])
    if not len(rows):
        return []
    p, q = (rows[k] for k in candidate_pairs(packed.lower[rows], packed.upper[rows]))
    p, q = p[body[p] == body[q]], q[body[p] == body[q]]
    depth = packed.overlap_depths(p, q)
    too_deep = depth > OVERLAPPING * packed.pair_size(p, q)
    problems = []
    for block in np.unique(body[p[too_deep]]).tolist():
        pairs = np.flatnonzero(too_deep & (body[p] == block))
        k, first = pairs[np.argmax(depth[pairs])], int(np.searchsorted(body, block))
        more = f" (and {len(pairs) - 1} more)" if len(pairs) > 1 else ""
        problems.append(
            f"{place(block)} parts: parts {p[k] - first + 1} and {q[k] - first + 1} overlap by "
            f"{millimetres(float(depth[k]))}{more}, and what they share would weigh twice: cut "
            "one of them so that they only touch, or take it out"
        )
    return problems


def _is_within(assembly: Assembly, i: int, j: int) -> bool:
    """Whether the middle of one of two blocks lies in the other."""
    a, b = assembly.figures[i], assembly.figures[j]
    return bool(a.distance(assembly.centroid[j]) <= 0.0 or b.distance(assembly.centroid[i]) <= 0.0)


def _table_of(first: str, second: str) -> str:
    """The table [[import]] that both places are of; "" where there is none."""
    table = first.split(" ")[0]
    return table if table.startswith("import[") and table == second.split(" ")[0] else ""


def _upwards(value: float) -> float:
    """A value with two digits that is somewhat larger."""
    unit = 10.0 ** (math.floor(math.log10(value)) - 1)
    return round(unit * math.ceil(1.05 * value / unit), 12)


def _lonely(packed: Outlines | Polyhedra, lonely: Iterable[int], place: Place) -> list[str]:
    """Sentences on movable blocks that touch nothing, the first few with their nearest block."""
    problems = []
    for told, i in enumerate(lonely):
        nearest = ""
        if told < 10:  # each one looks at all blocks, so that only those that get listed may
            own, others = np.flatnonzero(packed.body == i), np.flatnonzero(packed.body != i)
            between = np.maximum(packed.lower[others] - packed.upper[own, None], 0.0)
            between += np.maximum(packed.lower[own, None] - packed.upper[others], 0.0)
            distance = np.linalg.norm(between, axis=2)
            k, j = np.unravel_index(int(np.argmin(distance)), distance.shape)
            gap = -packed.overlap_depths(own[[k]], others[[j]])[0]
            nearest = f" ({place(packed.body[others[j]])} is nearest, {millimetres(gap)} away)"
        problems.append(f"{place(i)} touches no other block{nearest}: move it, or take it out")
    return problems
