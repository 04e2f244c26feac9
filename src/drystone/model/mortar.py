"""Mortar joints as stiffness: a bed of given thickness and moduli between blocks."""

from __future__ import annotations

from dataclasses import dataclass

from drystone.common.ranges import problem


@dataclass(frozen=True, kw_only=True)
class Mortar:
    """A bed of mortar; its stiffnesses per area are k_n = E / t and k_s = G / t.

    Raises `ValueError` for an impossible number, and if not exactly one of shear modulus and
    Poisson's ratio is given.
    """

    thickness: float  # m
    young_modulus: float  # Pa
    shear_modulus: float | None = None  # Pa
    poisson_ratio: float | None = None  # -, instead of the shear modulus: G = E / 2 (1 + nu)

    def __post_init__(self) -> None:
        names = {"thickness": "mortar_thickness"}
        for key, value in vars(self).items():
            wrong = None if value is None else problem(names.get(key, key), value)
            if wrong:
                raise ValueError(wrong.replace("mortar_thickness", "thickness"))
        if (self.shear_modulus is None) == (self.poisson_ratio is None):
            has = "neither {} nor {}" if self.shear_modulus is None else "both {} and {}"
            keys = has.format("shear_modulus [Pa]", "poisson_ratio")
            raise ValueError(f"has {keys}: give one of them")

    @property
    def stiffnesses(self) -> dict[str, float]:
        """``normal_stiffness`` and ``shear_stiffness`` [Pa/m] of `JointLaw`, by name."""
        shear = self.shear_modulus
        if shear is None:
            assert self.poisson_ratio is not None
            shear = self.young_modulus / (2.0 * (1.0 + self.poisson_ratio))
        return {
            "normal_stiffness": self.young_modulus / self.thickness,
            "shear_stiffness": shear / self.thickness,
        }
