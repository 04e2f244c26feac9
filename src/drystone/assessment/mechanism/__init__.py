"""From a traced curve to one degree of freedom: which blocks move as one, how, and how much."""

from drystone.assessment.mechanism.bodies import AT_REST, find_macro_blocks
from drystone.assessment.mechanism.envelope import Envelope, static_envelope
from drystone.assessment.mechanism.shapes import (
    Course,
    MechanismShape,
    course_of,
    initial_shape,
    secant_participation,
    tangent_shape,
)
from drystone.assessment.mechanism.transform import GROUPINGS, Reduction, capacity_of, reduced

__all__ = [
    "AT_REST",
    "GROUPINGS",
    "Course",
    "Envelope",
    "MechanismShape",
    "Reduction",
    "capacity_of",
    "course_of",
    "find_macro_blocks",
    "initial_shape",
    "reduced",
    "secant_participation",
    "static_envelope",
    "tangent_shape",
]
