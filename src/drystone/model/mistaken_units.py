"""Values of a model so far from masonry that a unit may have been mistaken."""

from __future__ import annotations

import math
from collections.abc import Iterator

import numpy as np

from drystone.model.assembly import GRAVITY, Assembly
from drystone.model.construction.words import millimetres
from drystone.model.joint_law import JointLaw
from drystone.model.model import Model
from drystone.model.ties import Tie

#: Beyond these a unit has been mistaken: m, N/m3 (lead weighs 111e3).
LONGEST_BLOCK, HEAVIEST = 50.0, 115e3
#: Below the first a weight in kN/m3 or a density in t/m3, below the second, which is the lightest
#: aerated concrete, a density in kg/m3: N/m3.
WEIGHTLESS, LIGHTEST = 1e3, 2.9e3
#: Thickness out of plane over the largest side of the structure.
THICKEST = 20.0
#: Friction of 63 degrees.
ROUGHEST = 2.0
#: Share of the smallest block by which joints under a structure's weight may close, and over which
#: its weight presses more than a bond that is not worth its name bears.
SOFT = 0.05
#: Strains at which a bar reaches its strength; of steel 1e-3 to 1e-2, with its anchorages more.
LEAST_STRAIN, MOST_STRAIN = 1e-5, 0.3
#: Ground acceleration on rock beyond those of NTC 2018 and EN 1998, g.
STRONGEST = 1.0


def unit_doubts(model: Model) -> list[str]:
    """Sentences on values that are hardly meant in the unit of the file."""
    assembly = model.assembly
    return [
        *_size_doubts(assembly),
        *_weight_doubts(assembly),
        *_law_doubts(assembly),
        *(doubt for tie in model.ties for doubt in _tie_doubts(tie)),
        *_site_doubts(model),
    ]


def _size_doubts(assembly: Assembly) -> Iterator[str]:
    """Of blocks, and of the thickness out of plane."""
    movable = [block.vertices for block in assembly.blocks if not block.support]
    largest = max(float(np.ptp(vertices, axis=0).max()) for vertices in movable)
    if largest > LONGEST_BLOCK:
        yield f"block: the largest is {largest:g} m long: are the coordinates in metres?"
    size = float(np.ptp(np.vstack(movable), axis=0).max())
    thickness = assembly.kind.thickness(assembly.thickness)
    if thickness is not None and thickness > THICKEST * size:
        yield (
            f"thickness: {thickness:g} m is much for a structure of {size:.4g} m: are "
            "both in metres?"
        )


def _weight_doubts(assembly: Assembly) -> Iterator[str]:
    weights = [block.unit_weight for block in assembly.blocks if not block.support]
    lightest, heaviest = min(weights), max(weights)
    if lightest < LIGHTEST:
        mend = "is it a density given as a weight? Then write it as density"
        if lightest < WEIGHTLESS:
            mend = "is it in kN/m3, or its density in t/m3? Then take it times 1000"
        yield _unlike_masonry(lightest, "light", mend)
    if heaviest > HEAVIEST:
        mend = "is it a weight given as a density? Then write it as unit_weight"
        yield _unlike_masonry(heaviest, "heavy", mend)


def _unlike_masonry(weight: float, word: str, mend: str) -> str:
    return (
        f"material: {weight:.4g} N/m3, a density of {weight / GRAVITY:.4g} kg/m3, is {word} for "
        f"masonry: {mend}"
    )


def _law_doubts(assembly: Assembly) -> Iterator[str]:
    """Friction that is an angle, joints that close by more than a hair under the weight, strengths
    that weight alone exceeds."""
    highest = max(float((block.vertices @ assembly.up).max()) for block in assembly.blocks)
    lowest = min(
        float((block.vertices @ assembly.up).min())
        for block in assembly.blocks
        if not block.support
    )
    densest = max(block.unit_weight for block in assembly.blocks if not block.support)
    pressure = float(densest * (highest - lowest))  # Pa, above the lowest
    smallest = assembly.smallest_extent
    for law in dict.fromkeys(assembly.laws):
        mu, stiffness = law.friction_coefficient, law.normal_stiffness
        if mu > ROUGHEST:
            tangent = f"{math.tan(math.radians(mu)):.4g}" if mu < 90.0 else "below 1 as a rule"
            yield (
                f"joint: friction_coefficient = {mu:g} is more than any joint has: is it the "
                f"angle in degrees? The coefficient is its tangent, {tangent}"
            )
        if stiffness is not None and pressure / stiffness > SOFT * smallest:
            yield (
                f"joint: normal_stiffness = {stiffness:g} Pa/m lets joints close by "
                f"{millimetres(pressure / stiffness)} under the weight of all that is above the "
                "lowest: is it in kPa/mm, or MPa/mm? Then take it times 1e6, or 1e9"
            )
        yield from _strength_doubts(law, pressure, SOFT * smallest * densest)


def _strength_doubts(law: JointLaw, pressure: float, slight: float) -> Iterator[str]:
    """Of strengths against pressures of the weight [Pa]: that of the whole structure, and that of
    a thin slice of a block."""
    mend = "is it in kPa, or MPa? Then take it times 1e3, or 1e6"
    crushing = law.compressive_strength
    if crushing is not None and crushing < pressure:
        yield (
            f"joint: compressive_strength = {crushing:g} Pa is less than the pressure under the "
            f"weight of all that is above the lowest, {pressure:.3g} Pa: {mend}"
        )
    for key in ("cohesion", "tensile_strength"):
        strength = getattr(law, key)
        if 0.0 < strength < slight:
            yield (
                f"joint: {key} = {strength:g} Pa is less than the pressure under a twentieth of "
                f"the smallest block, {slight:.3g} Pa: {mend}"
            )


def _tie_doubts(tie: Tie) -> Iterator[str]:
    """Of a bar that reaches its strength at a strain of no bar."""
    strain = tie.strength / tie.per_length / tie.length
    if not tie.spring and not LEAST_STRAIN <= strain <= MOST_STRAIN:
        given = "stiffness in N/m"
        if tie.stiffness is None:
            given = "area in m2, and young_modulus in Pa"
        yield (
            f"{tie.place}: reaches its strength of {tie.strength:g} N at a strain of {strain:.2g}, "
            f"as no bar does: are its forces in N, its {given}?"
        )


def _site_doubts(model: Model) -> Iterator[str]:
    if model.site is None:
        return
    tables = {"site": model.site.values}
    tables |= {f"site.{state}": values for state, values in model.site.states.items()}
    for table, values in tables.items():
        given = values.get("ag")
        if given is not None and given > STRONGEST:
            yield (
                f"{table}.ag: {given:g} g is more than NTC 2018 or EN 1998 asks for: is it in "
                f"m/s2? Then divide it by {GRAVITY:g}"
            )
