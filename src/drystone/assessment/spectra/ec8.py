"""Elastic spectra of EN 1998-1:2004, recommended values of the tables."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

from drystone.assessment.errors import AssessmentError, positive
from drystone.assessment.spectra.shape import (
    Shape,
    ShapedSpectrum,
    checked_acceleration,
    checked_ground,
)
from drystone.common.language import say
from drystone.model.assembly import GRAVITY

GROUNDS = ("A", "B", "C", "D", "E")

#: S, T_B, T_C, T_D [s] by type and ground: Table 3.2 (type 1), Table 3.3 (type 2).
TABLES: dict[int, dict[str, tuple[float, float, float, float]]] = {
    1: {
        "A": (1.0, 0.15, 0.4, 2.0),
        "B": (1.2, 0.15, 0.5, 2.0),
        "C": (1.15, 0.20, 0.6, 2.0),
        "D": (1.35, 0.20, 0.8, 2.0),
        "E": (1.4, 0.15, 0.5, 2.0),
    },
    2: {
        "A": (1.0, 0.05, 0.25, 1.2),
        "B": (1.35, 0.05, 0.25, 1.2),
        "C": (1.5, 0.10, 0.25, 1.2),
        "D": (1.8, 0.10, 0.30, 1.2),
        "E": (1.6, 0.05, 0.25, 1.2),
    },
}

#: T_E, T_F [s]: Table A.1.
LONG_PERIODS = {"A": (4.5, 10.0), "B": (5.0, 10.0), **dict.fromkeys("CDE", (6.0, 10.0))}

#: gamma_I by class: 4.2.5(5)P, recommended.
IMPORTANCE = {"I": 0.8, "II": 1.0, "III": 1.2, "IV": 1.4}

AMPLIFICATION = 2.5

#: Return period [years] of the reference ground motion a_gR, 3.2.1(3).
REFERENCE_RETURN_PERIOD = 475.0

#: Return periods [years] of the limit states of EN 1998-3:2004, 2.1(3)P.
RETURN_PERIODS = {"DL": 225.0, "SD": 475.0, "NC": 2475.0}

#: k of H(a_g) ~ a_g^-k, 2.1(4): a_g goes with the return period to the power 1/k.
HAZARD_EXPONENT = 3.0


def acceleration_of_return_period(reference_acceleration: float, return_period: float) -> float:
    """a_g(T_R) = a_gR (T_R/475)^(1/3), EN 1998-1:2004 2.1(4) with k = 3; in the unit of a_gR."""
    years = positive(return_period, "the return period", "give it in years")
    share = (years / REFERENCE_RETURN_PERIOD) ** (1.0 / HAZARD_EXPONENT)
    return checked_acceleration(reference_acceleration) * float(share)


@dataclass(frozen=True, kw_only=True)
class Ec8Spectrum(ShapedSpectrum):
    """Elastic spectrum of EN 1998-1:2004 3.2.2.2, above T_E of Annex A, of a_g = gamma_I a_gR.

    Nothing else moves with a_g.
    """

    spectrum_type: int  # 1, or 2 where surface-wave magnitudes do not exceed 5.5
    ground: str  # "A" to "E"
    return_period: float | None = None  # years
    notes: tuple[str, ...] = ()

    def __post_init__(self) -> None:
        checked_acceleration(self.ground_acceleration)
        if self.spectrum_type not in TABLES:
            raise AssessmentError(
                f"there is no spectrum of type {self.spectrum_type!r} in EN 1998-1: 1, or 2 where "
                "surface-wave magnitudes do not exceed 5.5"
            )
        object.__setattr__(self, "ground", checked_ground(self.ground, GROUNDS))

    @classmethod
    def of_reference(
        cls,
        reference_acceleration: float,
        *,
        importance: float | str,
        spectrum_type: int,
        ground: str,
        return_period: float | None = None,
    ) -> Ec8Spectrum:
        """The spectrum of a_g = gamma_I a_gR (T_R/475)^(1/3).

        Parameters
        ----------
        reference_acceleration
            a_gR [m/s2], of 475 years.
        importance
            gamma_I, or the importance class "I" to "IV" with its recommended factor.
        return_period
            T_R [years] of another limit state; a_gR is not changed where it is left out.
        """
        notes: tuple[str, ...] = ()
        if isinstance(importance, str):
            if importance not in IMPORTANCE:
                raise AssessmentError(
                    f'there is no importance class "{importance}": {", ".join(IMPORTANCE)}, or a '
                    "factor gamma_I"
                )
            factor = IMPORTANCE[importance]
        else:
            factor = positive(importance, "the importance factor gamma_I")
        acceleration = factor * checked_acceleration(reference_acceleration)
        if return_period is not None:
            acceleration = acceleration_of_return_period(acceleration, return_period)
        if return_period not in (None, REFERENCE_RETURN_PERIOD):
            notes = (say("ec8.carried", years=return_period),)
        return cls(
            ground_acceleration=acceleration,
            spectrum_type=spectrum_type,
            ground=ground,
            return_period=REFERENCE_RETURN_PERIOD if return_period is None else return_period,
            notes=notes,
        )

    @property
    def soil_factor(self) -> float:
        """S of Table 3.2 or 3.3."""
        return TABLES[self.spectrum_type][self.ground][0]

    @property
    def corner_period(self) -> float:
        """T_C [s]."""
        return self.shape.corner

    @property
    def return_period_exponent(self) -> float:
        """T_R goes with a_g to this power."""
        return HAZARD_EXPONENT

    @property
    def label(self) -> str:
        """For people."""
        return say(
            "ec8.label",
            type=self.spectrum_type,
            ground=self.ground,
            ag=self.ground_acceleration / GRAVITY,
        )

    @property
    def uncertain(self) -> tuple[str, ...]:
        """What was not checked against the standard."""
        said: tuple[str, ...] = (say("ec8.tables"),)
        if self.spectrum_type == 2:
            said += (say("ec8.type_2"),)
        return said

    @cached_property
    def shape(self) -> Shape:
        """The corners."""
        factor, rise, corner, displacement_corner = TABLES[self.spectrum_type][self.ground]
        long_period, ground_period = LONG_PERIODS[self.ground]
        return Shape(
            ground_acceleration=self.ground_acceleration,
            soil_factor=factor,
            amplification=AMPLIFICATION,
            rise=rise,
            corner=corner,
            displacement_corner=displacement_corner,
            long_period=long_period,
            ground_period=ground_period,
        )
