"""Barrel vaults in running bond."""

from __future__ import annotations

from typing import Annotated

from drystone.model.assembly import Block
from drystone.model.builders.arch import abutments_of
from drystone.model.builders.base import Builder, Count, Length, Points, YesOrNo
from drystone.model.builders.coursing import Bond, BondName, Line, bond_problems
from drystone.model.builders.profile import CurveName, ring
from drystone.model.builders.stones import Mason, positive
from drystone.model.construction.errors import ModelError


# Many, each a key of model files.
def barrel_vault(
    *,
    length: Annotated[Length, "along y, in m"],
    thickness: Annotated[Length, "of the arch, in m"],
    unit: Annotated[Length, "length of a stone along y, in m"],
    unit_weight: float,
    span: Length | None = None,
    rise: Length | None = None,
    shape: CurveName = "circular",
    intrados: Points | None = None,
    voussoirs: Count | None = None,
    size: Length | None = None,
    bond: BondName = "running",
    abutments: YesOrNo = False,
    material: str = "",
) -> list[Block]:
    """An arch that goes on along y, each course of it cut into stones.

    Along the vault units are cut to fit, none shorter than a quarter of one, where the neighbour is
    longer instead.

    Parameters
    ----------
    length
        Along y, from 0 [m].
    unit
        Length of a stone along y [m].
    bond
        As of a panel; courses are those of voussoirs.
    thickness, span, rise, shape, intrados, voussoirs, size, abutments
        As of an `arch`.

    Returns
    -------
    list of Block
        ``v{voussoir}u{number}``, from left to right and along y.  Groups are "course 1", ... by
        voussoir.

    Raises
    ------
    ModelError
        The measures make no vault.
    """
    problems = [*positive(length=length, unit=unit), *bond_problems(bond, 0, 1)]
    if problems:
        raise ModelError(problems)
    joints = ring(
        thickness=thickness, span=span, rise=rise, shape=shape, intrados=intrados,
        voussoirs=voussoirs, size=size,
    )  # fmt: skip
    mason = Mason(unit_weight=unit_weight, material=material)
    laid = Bond(name=bond, unit=unit)
    made = abutments_of(mason, joints, (0.0, length)) if abutments else []
    for i in range(joints.n_voussoirs):
        pieces = laid.pieces(i, Line(0.0), Line(length), (0.0, 0.0), 0.0)
        for k, piece in enumerate(pieces, start=1):
            depth = piece.begin.at, piece.end.at
            name = f"v{i + 1}u{k}"
            made.append(mason.upright(name, joints.outline(i), depth, f"course {i + 1}"))
    return made


BARREL_VAULT = Builder(make=barrel_vault, dimensions=(3,))
