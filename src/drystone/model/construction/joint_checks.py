"""Values of joint laws that do not go together, of joints that soften, are crushed or close."""

from __future__ import annotations

import math

from drystone.model.joint_law import JointLaw

#: Elastic energy at the strength, twice it over the fracture energy, from which on a joint cannot
#: be softened by what moves its two faces apart: it would snap by itself.
SNAPS = 1.0


def yielding_problems(law: JointLaw) -> list[str]:
    """Of a law whose single values are in their ranges, each as "key: sentence"."""
    return [*_of_bonds(law), *_of_friction(law), *_of_compression(law)]


def _of_bonds(law: JointLaw) -> list[str]:
    tensile, shear = law.tensile_fracture_energy, law.shear_fracture_energy
    if tensile is None and shear is None:
        return []
    found = []
    if shear is None:
        found.append("shear_fracture_energy: is missing beside tensile_fracture_energy: add it")
    elif law.cohesion == 0.0:
        found.append("shear_fracture_energy: there is no cohesion to be lost: take it out")
    if law.tensile_strength > 0.0 and tensile is None:
        found.append("tensile_fracture_energy: is missing beside shear_fracture_energy: add it")
    if law.tensile_strength == 0.0 and tensile is not None:
        found.append("tensile_fracture_energy: there is no tensile_strength: take it out")
    if law.dilatancy_angle > 0.0:
        found.append("dilatancy_angle: joints that soften do not dilate: set it to zero")
    found += _snaps("tensile_fracture_energy", tensile, law.tensile_strength, law.normal_stiffness)
    return found + _snaps("shear_fracture_energy", shear, law.cohesion, law.shear_stiffness)


def _snaps(key: str, energy: float | None, strength: float, stiffness: float | None) -> list[str]:
    if energy is None or stiffness is None or strength**2 / stiffness < SNAPS * energy:
        return []
    return [
        f"{key}: {energy:g} N/m is less than strength squared over stiffness, "
        f"{strength**2 / stiffness:.3g} N/m, and the joint would snap by itself: make it larger, "
        "or leave both fracture energies out for a brittle joint"
    ]


def _of_friction(law: JointLaw) -> list[str]:
    residual = law.residual_friction_coefficient
    if residual is None:
        if law.residual_slip is not None:
            return ["residual_slip: there is no residual_friction_coefficient: take it out"]
        return []
    found = []
    if residual > law.friction_coefficient:
        found.append(
            f"residual_friction_coefficient: {residual:g} is more than friction_coefficient = "
            f"{law.friction_coefficient:g}: make it smaller"
        )
    if law.residual_slip is None and not law.softens:
        found.append(
            "residual_slip: is missing: add the slip in m over which friction falls, or cohesion "
            "with shear_fracture_energy, with which it falls"
        )
    if law.residual_slip is not None and law.softens:
        found.append("residual_slip: friction falls as the bond softens: take it out")
    if law.dilatancy_angle > 0.0:
        found.append("dilatancy_angle: joints whose friction falls do not dilate: set it to zero")
    if (law.cohesion > 0.0 or law.tensile_strength > 0.0) and not law.softens:
        found.append(
            "residual_friction_coefficient: brittle bonds have no residual friction: add "
            "shear_fracture_energy"
        )
    return found


def _of_compression(law: JointLaw) -> list[str]:
    crushed, hyperbolic = law.compressive_strength < math.inf, law.greatest_closure < math.inf
    logarithmic = law.logarithmic_closure < math.inf
    energy = law.compressive_fracture_energy
    found = []
    if energy is not None and not crushed:
        found.append("compressive_fracture_energy: there is no compressive_strength: add it")
    if crushed:
        found += _snaps(
            "compressive_fracture_energy", energy, law.compressive_strength, law.normal_stiffness
        )
    for there, what in (
        (crushed, "are crushed"),
        (hyperbolic, "close hyperbolically"),
        (logarithmic, "close with the logarithm of the pressure"),
    ):
        if there and law.dilatancy_angle > 0.0:
            found.append(f"dilatancy_angle: joints that {what} do not dilate: set it to zero")
        brittle = (law.cohesion > 0.0 or law.tensile_strength > 0.0) and not law.softens
        if there and brittle:
            found.append(
                f"cohesion: joints that {what} have no brittle bonds: add fracture energies"
            )
    closes = (("greatest_closure", hyperbolic), ("logarithmic_closure", logarithmic))
    if crushed:
        found += [
            f"{key}: joints that are crushed close linearly: take one of the two out"
            for key, there in closes
            if there
        ]
    if hyperbolic and logarithmic:
        found.append("logarithmic_closure: there is a greatest_closure: take one of the two out")
    return found
