"""From a curve and its model to the oscillator that methods of assessment take."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from drystone.assessment.capacity import READINGS, Capacity, Change, slides
from drystone.assessment.errors import AssessmentError
from drystone.assessment.mechanism.envelope import Envelope, static_envelope
from drystone.assessment.mechanism.orientation import share_out_of_plane
from drystone.assessment.mechanism.overturning import stands_on_its_axis
from drystone.assessment.mechanism.shapes import (
    Course,
    MechanismShape,
    activation_row,
    course_of,
    initial_shape,
)
from drystone.assessment.mechanism.sliding import share_of_friction
from drystone.common.arrays import BoolArray
from drystone.common.language import Saying, said_end, said_status, say
from drystone.common.tolerances import ROUNDING
from drystone.model.assembly import crushes
from drystone.model.loading.base import masses_of
from drystone.model.loading.dead_forces import DeadForces
from drystone.model.loading.mass import MassPattern
from drystone.model.model import Model
from drystone.results.curve import FINISHED, CapacityCurve, CurvePoint
from drystone.results.events import EventKind

#: What counts as a rigid body: macro-blocks, as codes mean it, or every block for itself.
GROUPINGS = ("macro_blocks", "blocks")

#: Share of the collapse displacement by which the line of a curve and the geometry of its one body
#: may differ.  A wall of 4.0 x 0.5 m: 1.7e-3 with joints of 3e7 Pa/m, 5e-5 with 1e11 Pa/m.
AGREEMENT = 0.01


@dataclass(frozen=True, kw_only=True, eq=False)
class Reduction:
    """A curve as one degree of freedom, in every reading."""

    shape: MechanismShape
    envelope: Envelope
    grouping: str
    capacities: Mapping[str, Capacity]  # by reading
    course: Course | None

    def as_dict(self) -> dict[str, Any]:
        """For a file: the mechanism, and what the readings and groupings differ in."""
        shape = self.shape
        return {
            "grouping": self.grouping,
            "n_bodies": shape.n_bodies,
            "n_moving_blocks": shape.n_moving,
            "kinetic_ratio": shape.kinetic_ratio,
            "torsion": shape.torsion,
            "out_of_plane": self.capacities["base_shear"].out_of_plane,
            "friction": self.capacities["base_shear"].friction,
            "macro_blocks": _of(shape, "macro_blocks"),
            "blocks": _of(shape, "blocks"),
            "readings": {name: _reading(c) for name, c in self.capacities.items()},
            "body_of_block": shape.labels.tolist(),
            "course": {} if self.course is None else _columns(self.course),
        }


def capacity_of(
    curve: CapacityCurve,
    model: Model,
    *,
    reading: str = "base_shear",
    grouping: str = "macro_blocks",
) -> Capacity:
    """The capacity of a traced curve, see `reduced`."""
    return reduced(curve, model, grouping=grouping, course=False).capacities[_known(reading)]


def reduced(
    curve: CapacityCurve,
    model: Model,
    *,
    grouping: str = "macro_blocks",
    course: bool = True,
) -> Reduction:
    """A traced curve as one degree of freedom, by its initial mechanism.

    Parameters
    ----------
    curve
        With poses.
    model
        What was traced.
    grouping
        One of `GROUPINGS`.
    course
        Whether to follow the participation along the curve.

    Raises
    ------
    AssessmentError
        The curve is too short to show a mechanism, or has no poses.
    """
    if grouping not in GROUPINGS:
        raise AssessmentError(f'there is no grouping "{grouping}": take {" or ".join(GROUPINGS)}')
    shape, envelope = initial_shape(curve, model), static_envelope(curve)
    part = shape.bodies if grouping == "macro_blocks" else shape.blocks
    share, by_mass, said = pattern_share(model, shape)
    friction = share_of_friction(curve, model)
    if not slides(friction):  # else it falls off what bears it
        envelope = _known_collapse(envelope, curve, model)
    first = curve.points[activation_row(curve)]
    said = (*said, *_first_of_peaks(curve, first))
    collapse = filter(None, [envelope.collapse_note])
    notes = (*_notes(curve, model, shape, grouping), *said, *envelope.notes, *collapse)
    capacity = Capacity.of(
        envelope.control_displacement,
        share * envelope.load_multiplier,
        part,
        reading="base_shear",
        activation_multiplier=share * first.load_multiplier,
        collapse_displacement=envelope.collapse_displacement,
        collapse_extrapolated=envelope.collapse_extrapolated,
        notes=notes,
        losses=[(e.control_displacement, e.said) for e in curve.events],
        changes=_changes(curve),
        out_of_plane=share_out_of_plane(model.assembly, shape, model.load_along),
        friction=friction,
        by_mass=by_mass,
    )
    return Reduction(
        shape=shape,
        envelope=envelope,
        grouping=grouping,
        capacities={name: capacity.read_as(name) for name in READINGS},
        course=course_of(curve, model) if course else None,
    )


def _first_of_peaks(curve: CapacityCurve, first: CurvePoint) -> tuple[Saying, ...]:
    """A sentence where the mechanism forms at a peak before the highest."""
    if first is curve.peak:
        return ()
    known = {"first": first.load_multiplier, "place": first.control_displacement}
    return (say("mechanism.first_peak", peak=curve.peak.load_multiplier, **known),)


def _changes(curve: CapacityCurve) -> list[Change]:
    """The events after which other forces act or other blocks bear."""
    return [
        Change(e.control_displacement, e.said, e.kind is not EventKind.TIE_YIELDED)
        for e in curve.events
        if e.changes
    ]


def _known_collapse(envelope: Envelope, curve: CapacityCurve, model: Model) -> Envelope:
    """The envelope; one rigid body's collapse is known by geometry, and no extrapolation.

    Where both differ by more than `AGREEMENT` something else bears or gives way.
    """
    end = envelope.collapse_displacement
    if end is None or not envelope.collapse_extrapolated:
        return envelope
    place = stands_on_its_axis(curve, model)
    if place is None or abs(place - end) > AGREEMENT * end:
        return envelope
    note = say("mechanism.straight", end=end, place=place)
    return replace(envelope, collapse_extrapolated=False, collapse_note=note)


def pattern_share(model: Model, shape: MechanismShape) -> tuple[float, bool, tuple[str, ...]]:
    """What makes forces in proportion to mass of the load pattern.

    Methods know ground accelerations, and so forces in proportion to mass: 1 of that pattern.  Of
    another, its work in the initial mechanism counts; a sentence says so.

    Returns
    -------
    The multiplier of forces in proportion to mass that do the work of the pattern at one, whether
    the pattern is in proportion to mass itself, and sentences.
    """
    pattern, assembly = model.load, model.assembly
    if pattern.turns_gravity and _bears_without_weight(model):
        raise AssessmentError(say("refused.tilt"))
    if pattern.name == "mass":
        return 1.0, True, ()
    masses = masses_of(assembly, model.dead_loads, model.ties)
    forces, field = pattern.forces(assembly, masses), shape.field
    present = shape.mass > 0.0
    work = float((forces.force * field.velocity)[present].sum())
    work += float((forces.moments() * field.spin)[present].sum())
    own = float(masses.weights(assembly)[present] @ shape.delta[present])
    if not work > 0.0:
        raise AssessmentError(say("refused.no_work", name=pattern.name))
    share = work / own
    by_mass = MassPattern(direction=pattern.along(assembly)).forces(assembly, masses)
    said = say("mechanism.pattern", name=pattern.name, share=share)
    return share, _in_proportion(forces, by_mass, present), (said,)


def _bears_without_weight(model: Model) -> bool:
    """Whether anything acts that does not shrink as gravity turns."""
    laws = model.assembly.laws
    return (
        bool(model.ties)
        or any(not load.mass for load in model.dead_loads)
        or any(law.cohesion > 0.0 or law.tensile_strength > 0.0 for law in laws)
        or crushes(laws)
    )


def _in_proportion(forces: DeadForces, others: DeadForces, rows: BoolArray) -> bool:
    """Whether forces on some blocks (n,), and their moments, are a multiple of others."""
    own, other = (
        np.concatenate((each.force[rows].ravel(), each.moments()[rows].ravel()))
        for each in (forces, others)
    )
    factor = float(own @ other) / float(other @ other)
    return bool(np.abs(own - factor * other).max() <= ROUNDING * np.abs(own).max())


def _notes(
    curve: CapacityCurve, model: Model, shape: MechanismShape, grouping: str
) -> tuple[Saying, ...]:
    """What was assumed, and what to mind."""
    if grouping == "macro_blocks":
        key = "mechanism.one_body" if shape.n_bodies == 1 else "mechanism.bodies"
        notes = [say(key, how=shape.clause, n=shape.n_bodies, blocks=shape.n_moving)]
    else:
        notes = [say("mechanism.of_blocks", how=shape.clause, blocks=shape.n_moving)]
    if shape.twists:
        notes.append(say("mechanism.twists", torsion=shape.torsion))
    if (branch := curve.unstable_branch) is not None:
        notes.append(say("mechanism.unstable", first=branch[0], last=branch[1]))
    if curve.blocks_left:
        names = [f'"{b.block}"' for b in curve.blocks_left[:5]]
        notes.append(say("mechanism.blocks_left", names=names))
    if curve.status != FINISHED:
        end = said_end(curve.reason)
        notes.append(say("mechanism.unfinished", status=said_status(curve.status), reason=end))
    if (assembly := model.assembly).bonds_at_corners:
        known = {"points": assembly.points, "many": assembly.kind.points_if_crushed}
        notes.append(say("mechanism.bonds", **known))
    return tuple(notes)


def _known(reading: str) -> str:
    if reading not in READINGS:
        raise AssessmentError(f'there is no reading "{reading}": take one of {", ".join(READINGS)}')
    return reading


def _of(shape: MechanismShape, grouping: str) -> dict[str, float]:
    part = shape.bodies if grouping == "macro_blocks" else shape.blocks
    return {
        "participation_factor": part.factor,
        "participating_mass_ratio": part.mass_ratio,
        "participating_mass": part.mass,
        "mechanism_mass": part.mechanism_mass,
        "equivalent_mass": part.equivalent_mass,
    }


def _reading(capacity: Capacity) -> dict[str, float | None]:
    return {
        "activation_acceleration": capacity.activation_acceleration,
        "collapse_displacement": capacity.spectral_collapse_displacement,
        "oscillator_mass": capacity.oscillator_mass,
    }


def _columns(course: Course) -> dict[str, list[float]]:
    return {name: getattr(course, name).tolist() for name in course.__dataclass_fields__}
