"""Driving the LMGC90 of the wheel ``compas-lmgc90``: polyhedra, through its Fortran procedures.

The wheel's own interface sets a simulation up.  It offers no step in parts, no reset of velocities,
no forces and no settings of the solver; but its library exports LMGC90's module procedures, which
`ctypes` reaches: arguments by reference, lengths of texts by value at the end, null pointers for
optional arguments that are left out.  The procedures carry no version, so that all of them are
looked up before anything is done.

A step is made in two halves.  The first computes: contacts, reactions, velocities, places.  The
second, `Simulation._accept`, makes its end the start of the next.  A step that is not wanted is
left at its first half, and the next one starts where it started.

LMGC90 counts rotations and moments about the axes of inertia that it finds itself, which turn with
the body: from those of the setup they differ by a rotation that stays as it is.

What is held has driven degrees of freedom, whose velocity is zero.  The contact law is
``ELASTIC_REPELL_CLB_adapt``, which is ``ELASTIC_REPELL_CLB`` with a stiffness of each point's own:
a joint's stiffness is shared over the points that were found of it.
"""

from __future__ import annotations

import ctypes
import importlib.util
from collections import Counter
from importlib.metadata import PackageNotFoundError, version
from typing import Any, ClassVar

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from drystone.common.arrays import Array, BoolArray, IntArray
from drystone.geometry.space import solid
from drystone.geometry.space.solid import Faces
from drystone_lmgc90.messages import Outcome, Ready, Setup, Step
from drystone_lmgc90.process import RemoteError

PACKAGE = "compas-lmgc90"
MODULE = "compas_lmgc90._lmgc90"
LAW_NAME, LAW = "iqsc0", "ELASTIC_REPELL_CLB_adapt"  # the wheel looks for that name
NORM = b"QM/16"
#: LMGC90's number of contacts between polyhedra, ``i_prprx``.
POLYHEDRA = 18
#: Degrees of freedom: three translations, three rotations in the frame of inertia.
N_DOF = 6

RBDY3, PRPRX, NLGS = "__rbdy3_MOD_", "__prprx_MOD_", "__nlgs_3d_MOD_"
OVERALL, HANDLER = "__overall_MOD_", "__inter_meca_handler_3d_MOD_"
PROCEDURES = (
    *(RBDY3 + name for name in (
        "increment_rbdy3", "comp_fext_rbdy3", "comp_fint_rbdy3", "comp_free_vlocy_rbdy3",
        "comp_dof_rbdy3", "update_dof_rbdy3", "put_vector_rbdy3", "get_vector_rbdy3",
    )),
    *(PRPRX + name for name in (
        "check_prprx", "compute_box_prprx", "coor_prediction_prprx", "creation_tab_visu_prprx",
        "sto_compute_contact_prprx", "set_f2f_tol_prprx", "set_f2f_tol_small_surface_prprx",
        "sto_set_explicit_detection_prprx", "sto_set_decompression_prprx",
    )),
    *(NLGS + name for name in (
        "assume_is_initialized", "set_nlgs_parameter", "prep_nlgs", "solve_nlgs",
        "prep_check_nlgs", "comp_check_nlgs", "rnodhrloc_nlgs", "nullify_entitylist_nlgs",
        "update_tact_behav_nlgs", "quick_scramble_nlgs",
    )),
    *(OVERALL + name for name in (
        "time_increment", "init_entitylist", "set_run_contactor", "updt_time_begin",
    )),
    *(HANDLER + name for name in (
        "recup_rloc", "stock_rloc", "get_nb_inters", "get_idata", "get_local_frame", "get_rloc",
        "get_gaps", "set_internal_bv",
    )),
    "lmgc90_get_all_bodies", "_gfortran_random_seed_i4",
)  # fmt: skip
VARIABLES = (OVERALL + "h", *(f"__bulk_behaviour_MOD_grav{axis}" for axis in (1, 2, 3)))


def _integer(value: int) -> Any:
    return ctypes.byref(ctypes.c_int(value))


def _double(value: float) -> Any:
    return ctypes.byref(ctypes.c_double(value))


def _array(values: NDArray[Any]) -> Any:
    return values.ctypes.data_as(ctypes.c_void_p)


def _row(values: NDArray[Any], k: int) -> ctypes.c_void_p:
    """Address of row ``k``, sooner than by way of a view of it."""
    return ctypes.c_void_p(values.ctypes.data + k * values.strides[0])


class _Descriptor(ctypes.Structure):
    """How gfortran, from version 8 on, describes an array of one dimension."""

    _fields_ = (
        ("base", ctypes.c_void_p),
        ("offset", ctypes.c_size_t),
        ("element", ctypes.c_size_t),
        ("version", ctypes.c_int),
        ("rank", ctypes.c_int8),
        ("type", ctypes.c_int8),
        ("attribute", ctypes.c_int16),
        ("span", ctypes.c_ssize_t),
        ("stride", ctypes.c_ssize_t),
        ("first", ctypes.c_ssize_t),
        ("last", ctypes.c_ssize_t),
    )


class FortranArray:
    """An array that a procedure takes by its descriptor."""

    #: gfortran's number of a type, by numpy's kind.
    TYPES: ClassVar = {"i": 1, "f": 3}

    def __init__(self, values: NDArray[Any]) -> None:
        self.values, size = values, values.itemsize
        self.descriptor = _Descriptor(
            values.ctypes.data, ctypes.c_size_t(-1).value, size, 0, 1,
            self.TYPES[values.dtype.kind], 0, size, 1, 1, len(values),
        )  # fmt: skip


class Library:
    """The procedures and variables of LMGC90 in the wheel's library."""

    def __init__(self) -> None:
        found = importlib.util.find_spec(MODULE)
        if found is None or found.origin is None:
            raise RemoteError(f"{PACKAGE} is not installed")
        self._library = ctypes.CDLL(found.origin)
        missing = [name for name in (*PROCEDURES, *VARIABLES) if not self._has(name)]
        if missing:
            raise RemoteError(
                f"{program()} lacks {missing[0]}"
                + (f" and {len(missing) - 1} more" if len(missing) > 1 else "")
                + ", which this engine needs: install version 0.1.11"
            )

        self._seed = FortranArray(np.arange(1, 65, dtype=np.int32))

    def _has(self, name: str) -> bool:
        return hasattr(self._library, name)

    def call(self, name: str, *arguments: Any) -> int:
        """Call a procedure; arguments that it has beyond those given are left out."""
        result: int = getattr(self._library, name)(*arguments, None, None, None)
        return result

    def vector(self, verb: str, name: str, body: int, values: Array) -> None:
        """Get or put a vector of a body, counted from 0; its length (6,) [SI]."""
        getattr(self._library, f"{RBDY3}{verb}_vector_rbdy3")(
            name.encode(), _integer(body + 1), _array(values), _integer(N_DOF), ctypes.c_size_t(5)
        )

    def set(self, name: str, value: float) -> None:
        """Set a variable."""
        ctypes.c_double.in_dll(self._library, name).value = value

    def seed(self) -> None:
        """Begin the random numbers anew, so that a step can be taken again to the bit."""
        self._library._gfortran_random_seed_i4(None, ctypes.byref(self._seed.descriptor), None)

    def bodies(self, n: int) -> tuple[Array, Array]:
        """Centres (n, 3) [m] and frames of inertia (n, 3, 3), axes in columns."""
        values = np.zeros((n, 12))
        self._library.lmgc90_get_all_bodies(_array(values), ctypes.c_int(n))
        return values[:, :3], values[:, 3:].reshape(n, 3, 3).transpose(0, 2, 1)


def program() -> str:
    """Name and version of the wheel."""
    try:
        return f"{PACKAGE} {version(PACKAGE)}"
    except PackageNotFoundError:
        return PACKAGE


class NoUprightAxisError(RemoteError):
    """Bodies that are to stay upright have no axis of inertia that is."""

    def __init__(self) -> None:
        super().__init__("LMGC90 finds no axis of inertia across the plane of some block")


class Simulation:
    """The one simulation of this process: polyhedra."""

    def __init__(self, setup: Setup) -> None:
        from compas_lmgc90 import _lmgc90

        self.setup = setup
        self.library = Library()
        self.n = len(setup.shapes)
        self.solver: Any = None
        self._new_solver = _lmgc90.LMGC90Solver
        self.velocity = np.zeros((self.n, N_DOF))
        self.pending: Array | None = None
        self.first = True
        free = np.zeros((self.n, N_DOF), np.bool_)
        held = free | setup.fixed[:, None]
        self.centre, self.frame = self._build(held)
        if setup.upright:  # now it is known which axis of each body is the upright one
            upright = self._upright_axes()
            held = held | [False, False, True, True, True, True]
            held[~setup.fixed, 3 + upright[~setup.fixed]] = False
            self.centre, self.frame = self._build(held)
        #: From LMGC90's axes to those of the setup.
        self.change = np.einsum("nki,nkj->nij", setup.axes, self.frame)
        self._configure()
        self.ready = Ready(program=program())

    def _upright_axes(self) -> IntArray:
        """Which axis of inertia of each body is along z; raises `NoUprightAxisError`."""
        along = np.abs(self.frame[:, 2, :])
        if np.any(along.max(axis=1) <= 1.0 - 1e-9):
            raise NoUprightAxisError
        upright: IntArray = np.argmax(along, axis=1)
        return upright

    def _build(self, held: BoolArray) -> tuple[Array, Array]:
        """Put the bodies together, some degrees of freedom (n, 6) held; centres and frames."""
        setup = self.setup
        if self.solver is not None:
            self.solver.finalize()
        self.solver = solver = self._new_solver()
        solver.initialize(setup.time_step, setup.theta, False)
        solver.add_one_tact_behav(LAW_NAME, LAW, [setup.spare_stiffness, setup.friction])
        distinct, kind = np.unique(setup.density, return_inverse=True)
        solver.set_materials(distinct)
        solver.set_see_tables(setup.reach)
        solver.set_nb_bodies(self.n)
        wanted = np.zeros((self.n, 3))
        for i, shape in enumerate(setup.shapes):
            wanted[i] = solid.mass_properties(shape.vertices, shape.faces).centroid
            driven = np.flatnonzero(held[i]).tolist()
            solver.set_one_polyr(
                f"s{kind.ravel()[i] + 1:04d}",
                wanted[i].tolist(),
                (triangles(shape.faces) + 1).ravel().tolist(),
                (shape.vertices - wanted[i]).ravel().tolist(),
                len(driven),
                0,
            )
            for dof in driven:
                solver.set_drvdof(i + 1, dof + 1, [0.0] * N_DOF, True, False)
        solver.close_before_computing()
        solver.get_initial_state()
        centre, frame = self.library.bodies(self.n)
        if np.abs(centre - wanted).max() > 1e-6:
            raise RemoteError("LMGC90 does not have its bodies where they were put")
        return centre, frame

    def _configure(self) -> None:
        """Face to face detection with pairs kept from the first step, and no gravity of its own."""
        library = self.library
        for axis in (1, 2, 3):
            library.set(f"__bulk_behaviour_MOD_grav{axis}", 0.0)
        library.call(PRPRX + "set_f2f_tol_prprx", _double(1e-3))
        library.call(PRPRX + "set_f2f_tol_small_surface_prprx", _double(0.0))
        library.call(PRPRX + "sto_set_explicit_detection_prprx", _integer(1))
        library.call(PRPRX + "sto_set_decompression_prprx", _double(-1.0))  # points at the edges
        # Else the stiffness of each point is overwritten by the law's at the first step.
        library.call(NLGS + "assume_is_initialized", _integer(1))

    def step(self, request: Step) -> Outcome:
        """The first half of a step, after the second half of the last one if that is accepted."""
        if request.accept:
            self._accept()
        library, h = self.library, request.time_step
        library.set(OVERALL + "h", h)
        self._start(request)
        stiffness, bodies = self._detect()
        n_sweeps, converged = self._solve()
        library.call(RBDY3 + "comp_dof_rbdy3")
        return self._outcome(h, stiffness, bodies, n_sweeps, converged)

    def _start(self, request: Step) -> None:
        """Everything up to the free velocities."""
        library = self.library
        start = np.zeros_like(self.velocity) if request.stop_blocks else self.velocity
        for i in range(self.n):
            library.vector("put", "Vbeg_", i, start[i])
        library.call(OVERALL + "time_increment")
        library.call(RBDY3 + "increment_rbdy3")
        library.call(RBDY3 + "comp_fext_rbdy3")
        force = about_axes(request.force, self.change.transpose(0, 2, 1))
        for i in np.flatnonzero(~self.setup.fixed).tolist():
            library.vector("put", "Fext_", i, force[i])  # is added to what is there
        library.call(RBDY3 + "comp_fint_rbdy3")
        library.call(RBDY3 + "comp_free_vlocy_rbdy3")

    def _detect(self) -> tuple[Array, IntArray]:
        """Find contacts; gives the stiffness [N/m] and the bodies (b, a) of each."""
        library, setup = self.library, self.setup
        library.call(OVERALL + "init_entitylist")
        library.call(OVERALL + "set_run_contactor", _integer(1))
        library.call(PRPRX + "check_prprx")
        if self.first:
            library.call(PRPRX + "compute_box_prprx")
        library.call(PRPRX + "coor_prediction_prprx")
        if self.first:
            library.call(PRPRX + "creation_tab_visu_prprx")
            self.first = False
        library.call(PRPRX + "sto_compute_contact_prprx")
        library.call(HANDLER + "recup_rloc", _integer(POLYHEDRA))
        n = library.call(HANDLER + "get_nb_inters", _integer(POLYHEDRA))
        data = np.zeros((n, 13), dtype=np.int32)
        kind = _integer(POLYHEDRA)
        for k in range(n):
            library.call(HANDLER + "get_idata", kind, _integer(k + 1), _row(data, k))
        bodies = data[:, 2:4].astype(np.int64) - 1
        pairs = [tuple(pair) for pair in np.sort(bodies, axis=1).tolist()]
        found = Counter(pairs)
        first = _integer(1)
        stiffness = np.array(
            [setup.joints.get(pair, setup.spare_stiffness) / found[pair] for pair in pairs]
        )
        for k in range(n):
            library.call(
                HANDLER + "set_internal_bv", kind, _integer(k + 1), first, _double(stiffness[k])
            )
        return stiffness, bodies

    def _solve(self) -> tuple[int, bool]:
        """Gauss-Seidel; gives its sweeps and whether it converged."""
        library, setup = self.library, self.setup
        library.call(
            NLGS + "set_nlgs_parameter",
            NORM, _double(setup.tolerance), _double(1.0), ctypes.c_size_t(len(NORM)),
        )  # fmt: skip
        library.call(NLGS + "prep_nlgs", _integer(1))  # the whole Delassus operator is kept
        sweep, check = _integer(1), _integer(2)
        n_sweeps, state = 0, ctypes.c_int(1)
        library.seed()
        while n_sweeps < setup.max_sweeps:
            for k in range(setup.sweeps_per_check):
                if setup.scramble and k % setup.scramble == 0:
                    library.call(NLGS + "quick_scramble_nlgs")
                library.call(NLGS + "solve_nlgs", sweep)
            n_sweeps += setup.sweeps_per_check
            library.call(NLGS + "prep_check_nlgs", ctypes.byref(state))
            if state.value == 0:  # nothing is in contact
                break
            library.call(NLGS + "solve_nlgs", check)
            library.call(NLGS + "comp_check_nlgs", ctypes.byref(state))
            if state.value <= 0:
                break
        # The last pass is one more sweep.  In LMGC90's own order the bodies get what the contacts
        # had before it, other by what the tolerance leaves; here they get what is reported.
        library.call(NLGS + "solve_nlgs", _integer(3))
        library.call(NLGS + "rnodhrloc_nlgs")
        library.call(NLGS + "nullify_entitylist_nlgs")
        library.call(NLGS + "update_tact_behav_nlgs")
        return n_sweeps, state.value == 0

    def _outcome(
        self,
        h: float,
        stiffness: Array,
        bodies: IntArray,
        n_sweeps: int,
        converged: bool,
    ) -> Outcome:
        n = self.n
        velocity, reaction = np.zeros((n, N_DOF)), np.zeros((n, N_DOF))
        for i in range(n):
            self.library.vector("get", "V____", i, velocity[i])
            self.library.vector("get", "Reac_", i, reaction[i])
        self.pending = velocity
        centre, frame = self.library.bodies(n)
        turn = np.einsum("nik,njk->nij", frame, self.frame)
        return Outcome(
            converged=converged and bool(np.all(np.isfinite(velocity))),
            n_sweeps=n_sweeps,
            pose=np.hstack((centre - self.centre, quaternions(turn))),
            velocity=about_axes(velocity, self.change),
            contact_force=about_axes(reaction, self.change),
            **self._contacts(h, stiffness, bodies),
        )

    def _contacts(self, h: float, stiffness: Array, bodies: IntArray) -> dict[str, NDArray[Any]]:
        """Points, reactions and gaps of the contacts."""
        n = len(stiffness)
        frame, local, gap = np.zeros((n, 12)), np.zeros((n, 3)), np.zeros(n)
        parts = [ctypes.c_double() for _ in range(3)]
        before, status = ctypes.c_double(), ctypes.c_int()
        kind = _integer(POLYHEDRA)
        for k in range(n):
            number = _integer(k + 1)
            self.library.call(HANDLER + "get_local_frame", kind, number, _row(frame, k))
            self.library.call(
                HANDLER + "get_rloc", kind, number, *map(ctypes.byref, parts), ctypes.byref(status)
            )
            local[k] = [part.value for part in parts]
            self.library.call(
                HANDLER + "get_gaps",
                kind, number, ctypes.byref(parts[0]), ctypes.byref(before),
            )  # fmt: skip
            gap[k] = before.value
        # Impulses along tangent, normal (from a to b) and second tangent, which is its own sign.
        tangent, normal, second = frame[:, 3:].reshape(n, 3, 3).transpose(1, 0, 2)
        sign = np.sign(np.sum(np.cross(normal, tangent) * second, axis=1))
        body_b, body_a = bodies.T
        return {
            "body_a": body_a,
            "body_b": body_b,
            "position": frame[:, :3],
            "normal": normal,
            "tangent": tangent,
            "gap": gap,
            "reaction": np.column_stack((local[:, 1], local[:, 0], sign * local[:, 2])) / h,
            "stiffness": stiffness,
        }

    def _accept(self) -> None:
        """Make the end of the last step the start of the next."""
        assert self.pending is not None
        library = self.library
        library.call(HANDLER + "stock_rloc", _integer(POLYHEDRA))
        library.call(OVERALL + "updt_time_begin")
        library.call(RBDY3 + "update_dof_rbdy3")
        self.velocity, self.pending = self.pending, None


def triangles(faces: Faces) -> IntArray:
    """Convex faces as triangles, (k, 3)."""
    return np.array([(f[0], *f[i : i + 2]) for f in faces for i in range(1, len(f) - 1)], np.int64)


def quaternions(matrices: Array) -> Array:
    """Unit quaternions (w, x, y, z) of rotations (n, 3, 3)."""
    return np.asarray(Rotation.from_matrix(matrices).as_quat()[:, [3, 0, 1, 2]])


def about_axes(values: Array, change: Array) -> Array:
    """Motions or forces (n, 6) with their rotations or moments about other axes."""
    turned = values.copy()
    turned[:, 3:] = np.einsum("nij,nj->ni", change, values[:, 3:])
    return turned
