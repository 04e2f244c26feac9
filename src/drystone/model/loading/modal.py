"""``pattern = "modal"``: forces of the first mode of vibration, of blocks on elastic joints.

Of small motions x about the structure at rest under its weight

    M x'' + K x = 0

with the masses and the stiffness of the joints that are then closed: all that press on each other,
where none pulls; of the springs, and of the ties that are then taut.  What rollers hold does not
move.  Of the lowest modes that one counts which has the largest mass along the direction.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any, ClassVar
from weakref import WeakKeyDictionary

import numpy as np

from drystone.common.arrays import Array, BoolArray, IntArray
from drystone.common.errors import ModelError
from drystone.common.names import listed
from drystone.common.tolerances import BUILT_SHUT
from drystone.geometry.motion import about_the_world, across, rotations, translations
from drystone.model.assembly import GRAVITY, Assembly
from drystone.model.loading.base import NO_MASSES, Directed, Masses
from drystone.model.loading.dead_forces import DeadForces
from drystone.model.tie_kernels import FORCE, add_forces
from drystone.model.ties import Bars

if TYPE_CHECKING:
    from scipy.sparse import csc_array


#: Modes that are looked at, and degrees of freedom up to which all are.
MODES, ALL_UP_TO = 20, 60
#: Looks at which joints are closed, and force over the weight of all that closes one.
LOOKS, CLOSED = 50, 1e-9
#: Shift of the stiffness, over the mean of its diagonal: what keeps loose blocks from making it
#: singular.
SHIFT = 1e-9
#: Share of a mode's mass that moves with blocks on no support, from which on it is their free
#: motion: of modes that vibrate it is zero but for rounding, of free motions one.
FREE = 0.5


@dataclass(frozen=True, kw_only=True, eq=False)
class Mode:
    """A mode of vibration."""

    shape: Array  # (n, n_dof), the largest displacement of a centroid along the direction being 1
    frequency: float  # Hz
    participation: float  # mass along the direction over that of all blocks
    number: int  # counted from 1, in the order of frequencies

    @property
    def period(self) -> float:
        """In s."""
        return 1.0 / self.frequency if self.frequency > 0.0 else np.inf


@dataclass(frozen=True, kw_only=True, eq=False)
class ModalPattern(Directed):
    """Sideways forces in proportion to mass times the mode's displacement along the direction.

    Their sum is the weight of all masses. That of a dead load moves where the load acts.
    """

    name: ClassVar[str] = "modal"
    horizontal: ClassVar[bool] = True
    known: WeakKeyDictionary[Assembly, tuple[Masses, Mode]] = field(
        default_factory=WeakKeyDictionary, repr=False, init=False
    )

    def forces(self, assembly: Assembly, masses: Masses = NO_MASSES) -> DeadForces:
        """See `LoadPattern`."""
        shape = self.mode(assembly, masses).shape
        along = [motion @ self.direction for motion in _motions(assembly, masses, shape)]
        mean = masses.mean(assembly, along)
        return masses.forces_in_place(
            assembly, [(values / mean)[:, None] * self.direction for values in along]
        )

    def __getstate__(self) -> dict[str, Any]:
        """What goes to another process: modes are found again there."""
        return {"direction": self.direction}

    def __setstate__(self, state: dict[str, Any]) -> None:
        """See `__getstate__`."""
        object.__setattr__(self, "direction", state["direction"])
        object.__setattr__(self, "known", WeakKeyDictionary())

    def mode(self, assembly: Assembly, masses: Masses = NO_MASSES) -> Mode:
        """The mode, found once."""
        known = self.known.get(assembly)
        if known is None or not _alike(known[0], masses):
            known = masses, first_mode(assembly, self.direction, masses)
            self.known[assembly] = known
        return known[1]

    def problems(self, assembly: Assembly) -> list[str]:
        """See `LoadPattern`."""
        found = super().problems(assembly)
        if any(
            law.normal_stiffness is None or law.shear_stiffness is None for law in assembly.laws
        ):
            found.append('load.pattern: "modal" needs the stiffnesses of the joints: add them')
        return found


def first_mode(assembly: Assembly, direction: Array, masses: Masses = NO_MASSES) -> Mode:
    """The mode with the largest mass along a direction (dim,), of the lowest `MODES`.

    Raises
    ------
    ModelError
        Nothing vibrates: it is the free motion of blocks that no closed joint ties to a support.
    """
    free = np.flatnonzero(~assembly.fixed)
    mass = mass_matrices(assembly, masses)
    stiffness, loose = _stiffness_at_rest(assembly, masses)
    if not stiffness.count_nonzero():
        raise _free(assembly, loose)
    moving = _moving(assembly)
    kept = np.flatnonzero(moving[free])
    square, shapes = _lowest(stiffness, _side_by_side(mass[free])[kept][:, kept])
    rigid = np.zeros((len(free), assembly.n_dof))
    rigid[:, : assembly.dimension] = direction
    momentum = np.einsum("nij,nj->ni", mass[free], rigid)
    share = (shapes.T @ momentum[moving[free]]) ** 2 / float(rigid.ravel() @ momentum.ravel())
    best = int(np.argmax(share))
    shape = np.zeros((assembly.n_bodies, assembly.n_dof))
    shape[moving] = shapes[:, best]
    if float(np.einsum("ni,nij,nj->n", shape, mass, shape)[loose].sum()) > FREE:
        raise _free(assembly, loose)
    along = shape[:, : assembly.dimension] @ direction
    return Mode(
        shape=shape / along[int(np.argmax(np.abs(along)))],
        frequency=float(np.sqrt(max(square[best], 0.0))) / (2.0 * np.pi),
        participation=float(share[best]),
        number=best + 1,
    )


def _moving(assembly: Assembly) -> BoolArray:
    """What of the blocks' motion nothing holds, (n, n_dof)."""
    return ~assembly.fixed[:, None] & ~assembly.restrained


def _motions(assembly: Assembly, masses: Masses, shape: Array) -> list[Array]:
    """Displacements (n, dim) by a field (n, n_dof), of the centroids and of each load's masses."""
    spin = about_the_world(rotations(shape), assembly.axes)
    return [translations(shape) + across(spin, arm) for arm in masses.arms(assembly)]


def mass_matrices(assembly: Assembly, masses: Masses) -> Array:
    """Mass matrices of the blocks with what they carry where it lies, (n, n_dof, n_dof).

    A mass m that moves by J x, x being the motion of its block, adds m J^T J.
    """
    n, n_dof = assembly.mass.shape
    mass = np.zeros((n, n_dof, n_dof))
    each = np.arange(n_dof)
    mass[:, each, each] = assembly.mass
    mass[:, each[: assembly.dimension], each[: assembly.dimension]] = (
        assembly.weight[:, None] / GRAVITY
    )
    units = np.broadcast_to(np.eye(n_dof)[:, None, :], (n_dof, n, n_dof))
    # J of the masses of each load: a column by each unit motion.
    _, *jacobians = np.stack([_motions(assembly, masses, unit) for unit in units], axis=-1)
    for carried, moved in zip(masses.carried, jacobians, strict=True):
        mass += np.einsum("n,nki,nkj->nij", carried.weight / GRAVITY, moved, moved)
    return mass


def _side_by_side(blocks: Array) -> csc_array:
    """Matrices (n, k, k) as those on the diagonal of one."""
    from scipy.sparse import bsr_array, csc_array

    n, k, _ = blocks.shape
    size = n * k
    return csc_array(bsr_array((blocks, np.arange(n), np.arange(n + 1)), shape=(size, size)))


def _free(assembly: Assembly, loose: IntArray) -> ModelError:
    """The error on blocks that neither closed joints nor taut ties lead to a support."""
    names = [assembly.ids[i] for i in loose]
    who, have = ("block", "has") if len(names) == 1 else ("blocks", "have")
    return ModelError(
        [
            'load.pattern: "modal" has no mode here: '
            f"under the weight {who} {listed(names)} {have} no closed joint or taut tie that leads "
            "to a support: move them onto one another, or take another pattern"
        ]
    )


def _lowest(stiffness: csc_array, mass: csc_array) -> tuple[Array, Array]:
    """Squares of circular frequencies [1/s2], ascending, and modes in columns, of mass one."""
    from scipy.linalg import eigh  # scipy takes long to import; other patterns do without
    from scipy.sparse.linalg import eigsh

    if mass.shape[0] <= ALL_UP_TO:
        square, shapes = eigh(stiffness.toarray(), mass.toarray())
        return square, shapes
    shift = -SHIFT * float((stiffness.diagonal() / mass.diagonal()).mean())
    start = np.ones(mass.shape[0])  # the same modes in every run
    square, shapes = eigsh(stiffness, MODES, M=mass, sigma=shift, v0=start)
    order = np.argsort(square)
    return square[order], shapes[:, order]


def _stiffness_at_rest(assembly: Assembly, masses: Masses) -> tuple[csc_array, IntArray]:
    """Stiffness of what moves of the blocks, on springs, ties that the weight keeps taut and joints
    that it closes, linear; and rows of the blocks that these do not tie to a support."""
    # Imported here because it brings compiled code along, which a schema check does not need.
    from scipy.sparse import csc_array

    from drystone.contact.contacts import BODY_A, BODY_B, SLOT, STIFF_N, STIFF_T
    from drystone.contact.detection import Detector
    from drystone.law.columns import COHESION, TENSION
    from drystone.law.table import law_table

    detector, laws, pose = Detector(assembly), law_table(assembly), assembly.design_pose()
    pairs = detector.pairs(pose)
    slots = detector.find(pairs, pose)
    contacts = detector.pack(pairs, pose, slots, laws)
    touching = slots.gap[contacts.slot] <= BUILT_SHUT * assembly.smallest_extent
    n_dof, dim = assembly.n_dof, assembly.dimension
    a, b = contacts.which[touching, BODY_A], contacts.which[touching, BODY_B]
    rows = contacts.rows[touching, :dim].reshape(len(a), dim, 2 * n_dof)
    table = contacts.table[touching]
    law = laws[pairs.law_of_slot[contacts.which[touching, SLOT]]]
    bonded = (law[:, COHESION] > 0.0) | (law[:, TENSION] > 0.0)
    ties, bars = masses.ties, Bars.of(assembly, masses.ties)
    stiff = np.column_stack((table[:, STIFF_N], *[table[:, STIFF_T]] * (dim - 1)))
    bar_rows, bar_stiff = _bar_rows(assembly, bars), np.zeros((bars.n_ties, dim))
    bar_stiff[:, 0] = [tie.per_length for tie in ties]
    a, b = np.append(a, bars.body[:, 0]), np.append(b, bars.body[:, 1])
    columns = n_dof * np.column_stack((a, b))[:, :, None] + np.arange(n_dof)
    matrix = _matrix(
        np.concatenate((rows, bar_rows)),
        columns.reshape(len(a), 1, -1),
        n_dof * assembly.n_bodies,
    )
    keep = np.flatnonzero(_moving(assembly))
    matrix = csc_array(matrix[:, keep])
    falling = np.broadcast_to(-assembly.up, assembly.centroid.shape)
    dead = masses.forces(assembly, falling).wrenches(assembly).ravel()[keep]
    stiffness, closed = _closed(
        matrix,
        np.concatenate((stiff, bar_stiff)),
        dead,
        first=np.append(np.zeros(len(rows)), [tie.pretension for tie in ties]),
        bonded=np.append(bonded, [tie.compression for tie in ties]).astype(np.bool_),
        least=CLOSED * float(masses.weights(assembly).sum()),
    )
    return stiffness, _loose(assembly, a[closed], b[closed])


def _bar_rows(assembly: Assembly, bars: Bars) -> Array:
    """How much shorter ties become as their two blocks move, as the normal rows of contacts with
    none along them, (n_ties, dim, 2 n_dof): a tie that pulls by one does such forces."""
    n_dof = assembly.n_dof
    rows = np.zeros((bars.n_ties, assembly.dimension, 2 * n_dof))
    now = bars.at_rest(assembly).now
    now[:, FORCE] = 1.0
    for k, ends in enumerate(bars.body):
        force = np.zeros((assembly.n_bodies, n_dof))
        add_forces(bars.body[k : k + 1], now[k : k + 1], assembly.axes, force)
        rows[k, 0] = force[ends].ravel()
    return rows


def _loose(assembly: Assembly, a: IntArray, b: IntArray) -> IntArray:
    """Rows of blocks that pairs ``a``, ``b`` do not lead to a support."""
    from scipy.sparse import coo_array
    from scipy.sparse.csgraph import connected_components

    n = assembly.n_bodies
    _, label = connected_components(coo_array((np.ones(len(a)), (a, b)), shape=(n, n)), False)
    return np.flatnonzero(~np.isin(label, label[assembly.fixed]))


def _matrix(rows: Array, columns: IntArray, width: int) -> csc_array:
    """Gradients (n, dim, 2 n_dof) as a matrix of n dim rows."""
    from scipy.sparse import coo_array, csc_array

    n, dim, wide = rows.shape
    at = np.repeat(np.arange(n * dim), wide)
    across = np.broadcast_to(columns, rows.shape).ravel()
    return csc_array(coo_array((rows.ravel(), (at, across)), shape=(n * dim, width)))


def _closed(
    matrix: csc_array,
    stiff: Array,
    dead: Array,
    *,
    first: Array,
    bonded: BoolArray,
    least: float,
) -> tuple[csc_array, BoolArray]:
    """The stiffness with those contacts that press under the dead load, ties that pull, and what
    is bonded; and these, (n,).  ``first`` (n,) [N] are forces before anything moves."""
    from scipy.sparse import csc_array, diags_array
    from scipy.sparse.linalg import splu

    closed = np.ones(len(stiff), np.bool_)
    for _ in range(LOOKS if len(stiff) else 0):
        stiffness = _of(matrix, stiff, closed)
        shift = SHIFT * float(stiffness.diagonal().mean())
        pulls = np.zeros(stiff.shape)
        pulls[:, 0] = np.where(closed, first, 0.0)
        shifted = csc_array(stiffness + shift * diags_array(np.ones(len(dead))))
        x = splu(shifted).solve(dead + matrix.T @ pulls.ravel())
        pressed = first - stiff[:, 0] * (matrix @ x).reshape(stiff.shape)[:, 0]
        now = bonded | (pressed > least)
        if np.array_equal(now, closed):
            break
        closed = now
        if not closed.any():
            break
    return _of(matrix, stiff, closed), closed


def _of(matrix: csc_array, stiff: Array, closed: BoolArray) -> csc_array:
    from scipy.sparse import csc_array, diags_array

    values = np.where(closed[:, None], stiff, 0.0).ravel()
    return csc_array(matrix.T @ diags_array(values) @ matrix)


def _alike(first: Masses, second: Masses) -> bool:
    """Whether the same masses lie at the same places, on the same ties."""
    alike = first.ties == second.ties and len(first.carried) == len(second.carried)
    return alike and all(
        np.array_equal(a.weight, b.weight) and np.array_equal(a.moment, b.moment)
        for a, b in zip(first.carried, second.carried, strict=True)
    )
