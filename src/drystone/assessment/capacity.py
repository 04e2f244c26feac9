"""A capacity curve as one degree of freedom: what every method of assessment takes.

Three readings of the same curve are in use.  They share the displacement (but for the literal one)
and differ in the acceleration: see `READINGS`.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from drystone.assessment.errors import AssessmentError, positive
from drystone.common.arrays import Array
from drystone.common.language import Saying, say
from drystone.common.tolerances import ROUNDING
from drystone.model.assembly import GRAVITY

#: How multiplier and control displacement become acceleration and displacement of the oscillator.
READINGS: dict[str, Saying] = {
    name: say(f"reading.{name}") for name in ("base_shear", "energy", "literal_ec8")
}

#: Share of the work of the load, taken by friction, above which a mechanism slides sooner than it
#: rocks.
SLIDES = 0.5


def slides(friction: float | None) -> bool:
    """Whether friction takes so large a share of the work that the mechanism slides."""
    return friction is not None and friction > SLIDES


class Change(NamedTuple):
    """An event after which other forces act or other blocks bear: a tie yields or breaks, a part
    falls."""

    place: float  # m, control displacement
    what: str  # where it happened, and what
    lost: bool  # whether something is lost; a tie that yields still pulls


class Participation(NamedTuple):
    """What the masses of a mechanism and its shape amount to, see `participation`."""

    factor: float  # Gamma, for a shape that is 1 at the control point
    mass_ratio: float  # e*
    mass: float  # kg, M* = e* M
    mechanism_mass: float  # kg, M
    equivalent_mass: float  # kg, sum of m phi, the m* of EN 1998-1
    kinetic_factor: float | None = None  # Gamma_k


def participation(
    mass: ArrayLike, shape: ArrayLike, kinetic_mass: float | None = None
) -> Participation:
    """Participation of masses (n,) [kg] that move by a shape (n,), 1 at the control point.

    Gamma = sum m phi/sum m phi^2 and e* = (sum m phi)^2/(sum m sum m phi^2): EN 1998-1:2004 (B.2)
    and (B.3), NTC 2018 Circ. 7/2019 (C7.3.5), (C8.7.1.4) and (C8.7.1.5).  The masses are those of
    rigid bodies of the mechanism: what is at rest, or one body cut in pieces, changes e*.

    Parameters
    ----------
    kinetic_mass
        M_k = sum (m |v|^2 + w J w) [kg] of all motion of the bodies, along the load, across it and
        turning, at a unit velocity of the control point; Gamma_k = sum m phi/M_k is left out
        without it.
    """
    m, phi = np.asarray(mass, dtype=np.float64), np.asarray(shape, dtype=np.float64)
    if m.shape != phi.shape or m.ndim != 1 or not len(m):
        raise AssessmentError(f"masses {m.shape} and shape {phi.shape} are not two equal lists")
    if not (np.isfinite(m).all() and np.isfinite(phi).all() and (m > 0.0).all()):
        raise AssessmentError("masses are above zero, and a shape is of finite numbers")
    first, second, total = float(m @ phi), float(m @ phi**2), float(m.sum())
    if first <= 0.0:
        raise AssessmentError(say("refused.not_along", momentum=first))
    ratio = first**2 / (total * second)
    kinetic = None if kinetic_mass is None else first / positive(kinetic_mass, "kinetic_mass")
    return Participation(first / second, ratio, ratio * total, total, first, kinetic)


@dataclass(frozen=True, kw_only=True, eq=False)
class Capacity:
    """A capacity curve with what makes an oscillator of it.

    `control_displacement` grows from point to point: of a curve that turns back it is the lower
    envelope of the static points.  Confidence factors are not part of it.
    """

    control_displacement: Array  # (n,) m
    load_multiplier: Array  # (n,)
    participation_factor: float  # Gamma
    participating_mass_ratio: float  # e*
    participating_mass: float  # kg, M* = e* M
    mechanism_mass: float  # kg, M
    equivalent_mass: float  # kg, sum of m phi
    reading: str  # one of `READINGS`
    activation_multiplier: float  # lambda_0
    collapse_displacement: float | None  # m, d_C0 of the control point where lambda is zero
    collapse_extrapolated: bool = False  # whether that lies beyond the last point
    notes: tuple[str, ...] = ()  # assumptions and warnings, a sentence each
    kinetic_factor: float | None = None  # Gamma_k, of the reading "energy"; Gamma where None
    losses: tuple[tuple[float, str], ...] | None = None
    """Control displacement [m] and what happens there, of every event of the curve: a tie yields or
    breaks, a support bears nothing any more, the structure moves by itself, a part falls.  None: of
    a curve without events, as one from elsewhere."""
    changes: tuple[Change, ...] = ()
    """Of these events, those after which other forces act or other blocks bear."""
    out_of_plane: float | None = None
    """Share of the mechanism's momentum that is of walls out of their plane, see
    `drystone.assessment.mechanism.orientation`.  None: not known."""
    friction: float | None = None
    """Share of the work of the load that friction takes, see
    `drystone.assessment.mechanism.sliding`.  None: not known."""
    by_mass: bool = True
    """Whether the load is in proportion to mass.  Of another one the multipliers are those of
    forces in proportion to mass that do its work; the codes' F_b/Gamma, of forces in proportion to
    m phi, is that work."""

    def __post_init__(self) -> None:
        if self.reading not in READINGS:
            raise AssessmentError(
                f'the reading "{self.reading}" is not known: choose one of {", ".join(READINGS)}'
            )
        d = np.ascontiguousarray(self.control_displacement, dtype=np.float64)
        x = np.ascontiguousarray(self.load_multiplier, dtype=np.float64)
        if d.ndim != 1 or d.shape != x.shape or len(d) < 2:
            raise AssessmentError(
                "a capacity curve has two points or more, a displacement and a multiplier each"
            )
        if not (np.isfinite(d).all() and np.isfinite(x).all()):
            raise AssessmentError("the capacity curve holds values that are not finite")
        if d[0] < 0.0 or (np.diff(d) <= 0.0).any():
            raise AssessmentError(
                "control displacements do not grow from zero: keep the static points that go "
                "forward, the lower envelope where the curve turns back"
            )
        for name in (
            "participation_factor",
            "participating_mass_ratio",
            "participating_mass",
            "mechanism_mass",
            "equivalent_mass",
            "activation_multiplier",
        ):
            positive(getattr(self, name), name)
        for name in ("collapse_displacement", "kinetic_factor"):
            if getattr(self, name) is not None:
                positive(getattr(self, name), name)
        object.__setattr__(self, "control_displacement", d)
        object.__setattr__(self, "load_multiplier", x)

    # Many: what a curve does not tell of itself has a name each.
    @classmethod
    def of(
        cls,
        control_displacement: ArrayLike,
        load_multiplier: ArrayLike,
        part: Participation,
        *,
        reading: str,
        activation_multiplier: float | None = None,
        collapse_displacement: float | None = None,
        collapse_extrapolated: bool = False,
        notes: Sequence[str] = (),
        losses: Sequence[tuple[float, str]] | None = None,
        changes: Sequence[Change] = (),
        out_of_plane: float | None = None,
        friction: float | None = None,
        by_mass: bool = True,
    ) -> Capacity:
        """A capacity of a curve (n,) [m], (n,) and of what takes part in it.

        The activation multiplier is the highest one unless given.  Where a curve falls to zero its
        collapse displacement is read from it unless given.
        """
        d = np.asarray(control_displacement, dtype=np.float64)
        x = np.asarray(load_multiplier, dtype=np.float64)
        if collapse_displacement is None:
            collapse_displacement = _zero_after_peak(d, x)
        return cls(
            control_displacement=d,
            load_multiplier=x,
            participation_factor=part.factor,
            participating_mass_ratio=part.mass_ratio,
            participating_mass=part.mass,
            mechanism_mass=part.mechanism_mass,
            equivalent_mass=part.equivalent_mass,
            reading=reading,
            activation_multiplier=float(x.max())
            if activation_multiplier is None
            else activation_multiplier,
            collapse_displacement=collapse_displacement,
            collapse_extrapolated=collapse_extrapolated,
            notes=tuple(notes),
            kinetic_factor=part.kinetic_factor,
            losses=None if losses is None else tuple(losses),
            changes=tuple(changes),
            out_of_plane=out_of_plane,
            friction=friction,
            by_mass=by_mass,
        )

    @classmethod
    def straight(
        cls,
        activation_multiplier: float,
        collapse_displacement: float,
        part: Participation,
        *,
        reading: str,
        notes: Sequence[str] = (),
    ) -> Capacity:
        """Rigid bodies under constant forces: lambda_0 (1 - d_C/d_C0), EN 1998-3:2025 (11.4)."""
        end = positive(collapse_displacement, "collapse_displacement")
        top = positive(activation_multiplier, "activation_multiplier")
        return cls.of([0.0, end], [top, 0.0], part, reading=reading, notes=notes)

    def read_as(self, reading: str) -> Capacity:
        """The same curve in another reading."""
        return replace(self, reading=reading)

    @property
    def transformation_factor(self) -> float:
        """What control displacements are divided by: Gamma, Gamma_k or 1, see `READINGS`."""
        if self.reading == "literal_ec8":
            return 1.0
        if self.reading == "energy" and self.kinetic_factor is not None:
            return self.kinetic_factor
        return self.participation_factor

    @property
    def acceleration_factor(self) -> float:
        """What multipliers are multiplied by [m/s2]: g/e* in the reading of the base shear, of
        loads in proportion to mass."""
        if self.reading == "base_shear" and self.by_mass:
            return GRAVITY / self.participating_mass_ratio
        return GRAVITY

    @property
    def oscillator_mass(self) -> float:
        """Mass of the oscillator [kg]: M* = e* M, Gamma_k sum m phi, or M, see `READINGS`."""
        if self.reading == "literal_ec8":
            return self.mechanism_mass
        if self.reading == "energy" and self.kinetic_factor is not None:
            return self.kinetic_factor * self.equivalent_mass
        return self.participating_mass

    @property
    def kinetic_mass_ratio(self) -> float | None:
        """c = Gamma_k sum m phi/M: the whole kinetic energy's counterpart of e*."""
        if self.kinetic_factor is None:
            return None
        return self.kinetic_factor * self.equivalent_mass / self.mechanism_mass

    @property
    def spectral_displacement(self) -> Array:
        """(n,) d* [m]."""
        return self.control_displacement / self.transformation_factor

    @property
    def spectral_acceleration(self) -> Array:
        """(n,) a* [m/s2], before any confidence factor."""
        return self.load_multiplier * self.acceleration_factor

    @property
    def activation_acceleration(self) -> float:
        """a0* [m/s2], of the activation multiplier, before any confidence factor."""
        return self.activation_multiplier * self.acceleration_factor

    @property
    def spectral_collapse_displacement(self) -> float | None:
        """d0* [m], where the acceleration is zero."""
        if self.collapse_displacement is None:
            return None
        return self.collapse_displacement / self.transformation_factor

    @property
    def peak_index(self) -> int:
        """The first point of highest multiplier."""
        return int(np.argmax(self.load_multiplier))

    @property
    def activation_index(self) -> int:
        """The first point that bears the activation multiplier."""
        least = (1.0 - ROUNDING) * self.activation_multiplier
        reached = np.flatnonzero(self.load_multiplier >= least)
        return int(reached[0]) if len(reached) else self.peak_index

    @property
    def reach(self) -> float:
        """d* [m] up to which the curve is known: its last point, or the collapse beyond it."""
        last = float(self.spectral_displacement[-1])
        return max(last, self.spectral_collapse_displacement or 0.0)

    def acceleration_at(self, spectral_displacement: float) -> float:
        """a* [m/s2] at d* [m], before any confidence factor.

        Straight between points, from the last of them to the collapse, and zero after it.
        """
        d, a = self._branch()
        if not 0.0 <= spectral_displacement <= d[-1]:
            if self.collapse_displacement is not None and spectral_displacement > 0.0:
                return 0.0
            raise AssessmentError(
                say("refused.not_known", place=float(spectral_displacement), end=float(d[-1]))
            )
        return float(np.interp(spectral_displacement, d, a))

    def losses_before(self, control_displacement: float) -> tuple[str, ...]:
        """What happens on the way to a control displacement [m], a clause each."""
        return tuple(what for place, what in self.losses or () if place < control_displacement)

    @property
    def first_change(self) -> Change | None:
        """The first event before the collapse after which other forces act or other blocks bear."""
        return min(self._changes, key=lambda change: change.place, default=None)

    @property
    def first_loss(self) -> Change | None:
        """The first event before the collapse in which a tie breaks or a part falls."""
        lost = (change for change in self._changes if change.lost)
        return min(lost, key=lambda change: change.place, default=None)

    @property
    def _changes(self) -> tuple[Change, ...]:
        end = np.inf if self.collapse_displacement is None else self.collapse_displacement
        return tuple(change for change in self.changes if change.place < end)

    def control_at(self, spectral_displacement: float) -> float:
        """The control displacement [m] of d* [m]."""
        return spectral_displacement * self.transformation_factor

    def spectral_at(self, control_displacement: float) -> float:
        """d* [m] of a control displacement [m]."""
        return control_displacement / self.transformation_factor

    def secant_stiffness(self, spectral_displacement: float) -> float:
        """k_s = M* a*/d* [N/m] at d* [m]."""
        d = positive(spectral_displacement, "spectral_displacement")
        return self.oscillator_mass * self.acceleration_at(d) / d

    def secant_period(self, spectral_displacement: float) -> float:
        """2 pi sqrt(d*/a*) [s] at d* [m], without a confidence factor."""
        d = positive(spectral_displacement, "spectral_displacement")
        a = self.acceleration_at(d)
        if a <= 0.0:
            raise AssessmentError(f"nothing is carried at d* = {d:.4g} m: no secant period there")
        return float(2.0 * np.pi * np.sqrt(d / a))

    def _branch(self) -> tuple[Array, Array]:
        """d* and a* with the collapse as last point where it lies beyond the last one."""
        d, a = self.spectral_displacement, self.spectral_acceleration
        end = self.spectral_collapse_displacement
        if end is None:
            return d, a
        if end > d[-1]:
            return np.append(d, end), np.append(a, 0.0)
        before = d < end
        return np.append(d[before], end), np.append(a[before], 0.0)


def _zero_after_peak(displacement: Array, multiplier: Array) -> float | None:
    """Where the curve first falls to zero after its highest point [m], or None."""
    top = int(np.argmax(multiplier))
    down = np.flatnonzero(multiplier[top:] <= 0.0)
    if not len(down):
        return None
    i = top + int(down[0])
    if i == 0:
        return None
    share = multiplier[i - 1] / (multiplier[i - 1] - multiplier[i])
    return float(displacement[i - 1] + share * (displacement[i] - displacement[i - 1]))
