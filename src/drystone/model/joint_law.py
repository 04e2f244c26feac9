"""The law of a joint: every value with its unit, its range and what it means, declared once.

The model file's keys, the check of values and the change of units are made of these declarations.
What joints do with the values is `drystone.law`; `law.table` hands them over.
"""

from __future__ import annotations

import math
import numbers
from collections.abc import Callable
from dataclasses import dataclass, field, fields
from enum import Enum
from typing import Any

from drystone.common.errors import ModelError
from drystone.common.keys import NEEDED, Key, Number
from drystone.common.ranges import Range


def _value(
    least: float,
    most: float,
    unit: str = "",
    *,
    default: Any = NEEDED,
    may_miss: bool = False,
    says: str = "",
) -> Any:
    """A value from ``least`` to ``most``, or None where it ``may_miss``; or infinite as by default.

    ``says`` is added to the message where a file leaves it out.
    """
    range_, missing = Range(least=least, most=most, unit=unit), may_miss or default is None
    metadata = {"range": range_, "may_miss": missing, "says": says}
    return (
        field(metadata=metadata) if default is NEEDED else field(default=default, metadata=metadata)
    )


def _sound(value: Any, positive: bool) -> bool:
    """Whether it is a finite number of the sign that it must have, in whatever units."""
    if isinstance(value, bool) or not isinstance(value, numbers.Real):
        return False
    number = float(value)
    return math.isfinite(number) and (number > 0.0 if positive else number >= 0.0)


@dataclass(frozen=True, kw_only=True)
class JointLaw:
    """No-tension elastic joint with Coulomb friction, stiffnesses per area of joint.

    Raises `ModelError` if a value has an impossible sign or is not a number. Which values may be
    combined is checked when a model is made.
    """

    #: Tangent of the friction angle.
    friction_coefficient: float = _value(
        0.0, 1e6, says="the tangent of the friction angle, as in friction_coefficient = 0.65"
    )
    #: None where only limit analysis is asked for; the shear stiffness likewise.
    normal_stiffness: float | None = _value(1e-3, 1e20, "Pa/m", may_miss=True)
    shear_stiffness: float | None = _value(1e-3, 1e20, "Pa/m", may_miss=True)
    #: 0 is the dry joint of the literature.
    dilatancy_angle: float = _value(0.0, 89.9, "degrees", default=0.0)
    #: Slid distance after which the joint dilates no more.
    dilatancy_end: float = _value(0.0, 1e6, "m", default=math.inf)
    cohesion: float = _value(0.0, 1e15, "Pa", default=0.0)
    tensile_strength: float = _value(0.0, 1e15, "Pa", default=0.0)
    #: None: the bond is lost at once.
    tensile_fracture_energy: float | None = _value(1e-12, 1e12, "N/m", default=None)
    shear_fracture_energy: float | None = _value(1e-12, 1e12, "N/m", default=None)
    #: None: friction stays what it is.
    residual_friction_coefficient: float | None = _value(0.0, 1e6, default=None)
    #: Over which friction falls; None: as the bond softens.
    residual_slip: float | None = _value(1e-12, 1e6, "m", default=None)
    compressive_strength: float = _value(1e-3, 1e15, "Pa", default=math.inf)
    #: None: crushed joints stay as strong.
    compressive_fracture_energy: float | None = _value(1e-12, 1e12, "N/m", default=None)
    #: Of hyperbolic closure; infinite: linear.
    greatest_closure: float = _value(1e-12, 1e6, "m", default=math.inf)
    #: Of closure that goes with the logarithm of the pressure; infinite: linear.
    logarithmic_closure: float = _value(1e-12, 1e6, "m", default=math.inf)

    def __post_init__(self) -> None:
        if wrong := self.problems(in_range=False):
            raise ModelError(f"joint.{sentence}" for sentence in wrong)

    def problems(self, *, in_range: bool = True) -> list[str]:
        """Values that no joint can have, each as "key: sentence".

        Without ``in_range`` only those of a sign that none can have, or that are no numbers: in
        other units than those of files the ranges are others.
        """
        wrong = []
        for declared in fields(self):
            value, range_ = getattr(self, declared.name), declared.metadata["range"]
            missing = value is None and declared.metadata["may_miss"]
            infinite = value == math.inf and declared.default == math.inf
            sound = not in_range and _sound(value, range_.least > 0.0)
            if not (missing or infinite or sound) and (sentence := range_.problem(value)):
                wrong.append(f"{declared.name}: {sentence}")
        return wrong

    def in_units(self, own: Callable[[float, str], float]) -> JointLaw:
        """The law with every value in other units: ``own`` gives a value of a unit in them."""
        values = {}
        for declared in fields(self):
            value, unit = getattr(self, declared.name), declared.metadata["range"].unit
            changes = value is not None and unit not in ("", "degrees")
            values[declared.name] = own(value, unit) if changes else value
        return JointLaw(**values)

    @property
    def softens(self) -> bool:
        """Whether cohesion and tensile strength are lost over fracture energies."""
        return self.shear_fracture_energy is not None

    @property
    def yields(self) -> bool:
        """Whether more than friction and brittle bonds limits what the joint carries."""
        return any(part.of(self) for part in Yielding)


class Yielding(Enum):
    """What joints may do beside sliding, opening and breaking: they ..."""

    SOFTEN = "lose their bond over fracture energies"
    LOSE_FRICTION = "lose friction"
    CRUSH = "are crushed"
    CLOSE = "close hyperbolically"
    CLOSE_BY_LOGARITHM = "close with the logarithm of the pressure"

    def of(self, law: JointLaw) -> bool:
        """Whether the joints of a law do so."""
        if self is Yielding.SOFTEN:
            return law.softens
        if self is Yielding.LOSE_FRICTION:
            return law.residual_friction_coefficient is not None
        if self is Yielding.CRUSH:
            return law.compressive_strength < math.inf
        if self is Yielding.CLOSE_BY_LOGARITHM:
            return law.logarithmic_closure < math.inf
        return law.greatest_closure < math.inf


#: Keys of files, all of which may be left out: [joint.between] takes from [joint] what it has not.
LAW_KEYS = tuple(
    Key(
        name=declared.name,
        type=Number(declared.metadata["range"]),
        default=None,
        says=declared.metadata["says"],
    )
    for declared in fields(JointLaw)
)
