"""Cases that show what the program is worth: closed forms, published walls, laboratory tests.

Each case computes one number and knows what is expected of it, and from where.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import cache, partial

from drystone.analysis.driver import pushover
from drystone.laboratory.comparison import computed
from drystone.laboratory.figures import figures_of
from drystone.laboratory.walls import measured, walls
from drystone.limit import collapse_load
from drystone.model.assembly import Block, Corner
from drystone.model.builders.published import PUBLISHED_WALLS, published_wall
from drystone.model.builders.stones import rectangle
from drystone.model.construction.model import make_model
from drystone.model.joint_law import JointLaw
from drystone.model.model import Model

ENGINES = ("equilibrium", "nscd", "distinct")
CLOSED_FORM, PROGRAM, LABORATORY = "closed form", "program", "laboratory"


@dataclass(frozen=True, kw_only=True)
class Case:
    """One number to be computed."""

    name: str
    kind: str  # `CLOSED_FORM`, `PROGRAM` or `LABORATORY`
    source: str  # of what is expected
    expected: float
    compute: Callable[[], float]
    quick: bool = True  # part of the quick set


@dataclass(frozen=True, kw_only=True)
class Checked:
    """What came of a case."""

    case: Case
    got: float
    seconds: float

    @property
    def error(self) -> float:
        """Relative difference from what is expected."""
        return self.got / self.case.expected - 1.0

    def as_dict(self) -> dict[str, str | float]:
        """For JSON."""
        case = self.case
        return {
            "case": case.name,
            "kind": case.kind,
            "source": case.source,
            "expected": case.expected,
            "got": self.got,
            "error": self.error,
            "seconds": self.seconds,
        }


def checked(cases: list[Case]) -> Iterator[Checked]:
    """Compute cases one after another."""
    for case in cases:
        begun = time.perf_counter()
        got = float(case.compute())
        yield Checked(case=case, got=got, seconds=time.perf_counter() - begun)


def cases(*, everything: bool = False) -> list[Case]:
    """The quick set, or all cases."""
    found = [*_closed_forms(), *_published(), *_tests()]
    return [case for case in found if everything or case.quick]


def _block(width: float, height: float, friction: float, stiffness: float) -> Model:
    """A block on a fixed base; the control point is its centroid."""

    base, own = rectangle(-2.0, -0.2, 2.0, 0.0), rectangle(-0.5 * width, 0.0, 0.5 * width, height)
    return make_model(
        [
            Block(id="base", vertices=base, unit_weight=10e3, support=True),
            Block(id="block", vertices=own, unit_weight=10e3),
        ],
        joint=JointLaw(
            friction_coefficient=friction,
            normal_stiffness=stiffness,
            shear_stiffness=stiffness,
        ),
        thickness=1.0,
        corner=Corner(),
        load_direction=(1.0, 0.0),
        control_point="centre",
    )


def _closed_forms() -> list[Case]:
    found = []
    for engine in ENGINES:
        found += [
            Case(
                name=f"sliding block, friction 0.3: multiplier, {engine}",
                kind=CLOSED_FORM,
                source="lambda = mu",
                expected=0.3,
                compute=lambda e=engine: (
                    pushover(  # type: ignore[misc]
                        _block(0.6, 0.4, 0.3, 1e9).with_analysis(max_displacement=0.01), engine=e
                    ).peak.load_multiplier
                ),
            ),
            Case(
                name=f"sliding block to and fro by 10 mm: energy of a cycle [J], {engine}",
                kind=CLOSED_FORM,
                source="4 mu W (a - u), u by which the joint gives way",
                expected=4.0 * 0.3 * 2400.0 * (0.01 - _gives_way(engine)),
                compute=lambda e=engine: (
                    pushover(  # type: ignore[misc]
                        _block(0.6, 0.4, 0.3, 1e9).with_history(amplitudes=[0.01], cycles=2),
                        engine=e,
                    )
                    .cycles[1]
                    .energy
                ),
            ),
        ]
    return [
        *found,
        Case(
            name="rocking block 0.4 m x 0.9 m: peak multiplier, equilibrium",
            kind=CLOSED_FORM,
            source="lambda = width / height",
            expected=0.4 / 0.9,
            compute=lambda: pushover(_block(0.4, 0.9, 0.7, 1e11)).peak.load_multiplier,
        ),
    ]


def _gives_way(engine: str) -> float:
    """Slip and tilt of the joint under the centroid at the friction limit [m]; `nscd` has no
    stiffness along joints."""
    push = 0.3 * 2400.0
    tilt = push * 0.2**2 / (1e9 * 0.6 * 0.3**2)
    return tilt if engine == "nscd" else tilt + push / (1e9 * 0.6)


def _published() -> list[Case]:
    found = []
    for number, wall in PUBLISHED_WALLS.items():
        found.append(
            Case(
                name=f"published wall {number}: collapse multiplier, associative",
                kind=PROGRAM,
                source="Ferris and Tin-Loi (2001)",
                expected=wall.associative_multiplier,
                compute=lambda n=number: (
                    collapse_load(  # type: ignore[misc]
                        _sharp(n), flow="associative"
                    ).load_multiplier
                ),
            )
        )
        for program, peak in (("LMGC90", wall.peak_lmgc90), ("UDEC", wall.peak_udec)):
            found.append(
                Case(
                    name=f"published wall {number}: peak multiplier, equilibrium",
                    kind=PROGRAM,
                    source=f"{program}, Bouckaert et al. (2022), Table 1",
                    expected=peak,
                    compute=partial(_published_peak, number),
                    quick=number == 1,
                )
            )
    return found


@cache
def _published_peak(number: int) -> float:
    """Of a published wall, which two programs are set beside; computed once."""
    return float(pushover(published_wall(number)).peak.load_multiplier)


def _sharp(number: int) -> Model:
    return published_wall(number).with_corner()


def _tests() -> list[Case]:
    found = []
    for wall in walls():
        found.append(
            Case(
                name=f"{wall.name}: peak force [kN], equilibrium",
                kind=LABORATORY,
                source=wall.reference,
                expected=1e-3 * figures_of(wall, *measured(wall)).peak,
                compute=lambda w=wall: _peak(w.name),  # type: ignore[misc]
                quick=not wall.cyclic and wall.name.endswith(("100", "250", "1")),
            )
        )
    return found


def _peak(name: str) -> float:
    """Of a wall, computed by what the reports say [kN]."""
    curve = computed(name, "reported")
    return 1e-3 * float(curve.force.max())
