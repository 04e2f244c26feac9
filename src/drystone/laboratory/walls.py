"""What laboratories have measured: walls, loads, strengths, and force against displacement.

The data are from the Stone Masonry Database (EESD laboratory, EPFL; MIT licence in
``data/LICENSE.txt``), to be cited as `CITATION`, with the paper of each series.
"""

from __future__ import annotations

import csv
import math
import tomllib
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cache
from importlib import resources
from typing import Any

import numpy as np

from drystone.common.arrays import Array
from drystone.common.language import say

#: Of the largest displacement measured, up to which a reversal of a cyclic test is none: gauges
#: drift by some tenths of a millimetre while the actuator turns.
REVERSAL_NOISE = 0.02


@dataclass(frozen=True, kw_only=True)
class Wall:
    """A wall that was tested; in SI units."""

    name: str  # of the database
    reference: str
    series: str  # key of ``series.toml``
    cyclic: bool
    height: float  # m
    length: float  # m
    thickness: float  # m
    load_height: float  # m, of the horizontal force above the base
    unit_height: float  # m
    unit_length: float  # m
    vertical_force: float  # N, kept constant beside the weight
    unit_weight: float  # N/m3, from the difference of both vertical stresses
    strength: float  # Pa, of masonry in compression
    unit_modulus: float  # Pa
    wall_modulus: float  # Pa, from compression of the wall before the test
    modulus_source: str
    given: Mapping[str, float | None]  # figures of the database: forces [kN], drifts [%], [kN/mm]
    failure: str  # from the report
    map_pushed_left: bool = True  # how its crack map shows it, where it has one

    @property
    def joint_stiffness(self) -> float:
        """Normal stiffness of a bed joint [Pa/m]: with it a wall of rigid units closes by as much
        as one of the wall's modulus does beyond units of theirs."""
        e, eb = self.wall_modulus, self.unit_modulus
        return e * eb / (self.unit_height * (eb - e))

    def bilinear_given(self, sense: float) -> tuple[float | None, float | None, float | None]:
        """Level [kN], yield and ultimate drift [%] of the database's bilinear, in a sense."""
        mark = "+" if sense > 0.0 else "-"
        level, start, end = (
            self.given[key.format(mark)] for key in ("Vu,{} [kN]", "dy,{} [%]", "du,{} [%]")
        )
        return level, start, end

    def drift(self, displacement: float) -> float:
        """Displacement at the load's height over that [%]."""
        return 100.0 * displacement / self.load_height


@cache
def series() -> Mapping[str, Any]:
    """``series.toml``: what walls of a series have in common, with its sources."""
    return tomllib.loads(_text("series.toml"))


@cache
def walls() -> tuple[Wall, ...]:
    """All walls of the data, those that were pushed one way first."""
    rows = list(csv.DictReader(_text("walls.csv").splitlines()))
    found = [_wall(row, rows) for row in rows]
    return tuple(sorted(found, key=lambda wall: (wall.cyclic, wall.series == "SW")))


def wall_named(name: str) -> Wall:
    """The wall of that name; `KeyError` where there is none."""
    return {wall.name: wall for wall in walls()}[name]


def alike(one: Wall, other: Wall) -> bool:
    """Whether walls were built and loaded alike: their model is one."""
    same = ("series", "cyclic", "vertical_force", "unit_weight", "wall_modulus")
    return all(getattr(one, key) == getattr(other, key) for key in same)


def known_miss(wall: Wall) -> str:
    """Why the computed peak of a wall is far from the measured one; empty where that is not known,
    or not so."""
    known = series()["series"][wall.series].get("known_misses", {})
    return next((text for start, text in known.items() if wall.name.startswith(start)), "")


def measured(wall: Wall) -> tuple[Array, Array]:
    """Displacement [m] at the load's height and horizontal force [N], in the order measured."""
    rows = list(csv.reader(_text(f"{wall.name}.csv").splitlines()))[1:]
    x, y = np.array([[float(v) for v in row] for row in rows]).T
    return 1e-3 * x, 1e3 * y


def crack_map(wall: Wall) -> bytes | None:
    """The drawing of its final state, a picture in PNG, where the database has one."""
    file = resources.files("drystone.laboratory") / "data" / "crackmaps" / f"{wall.name}.png"
    return file.read_bytes() if file.is_file() else None


def _text(name: str) -> str:
    folder = resources.files("drystone.laboratory") / "data"
    return (folder / name).read_text(encoding="utf-8-sig")


STRESS = "\u03c30,pc [MPa]"  # mean vertical stress that is kept constant


def _wall(row: Mapping[str, str], rows: list[dict[str, str]]) -> Wall:
    name = row["Test unit name"]
    height, length, thickness = (1e-3 * float(row[key]) for key in ("H [mm]", "L [mm]", "t [mm]"))
    area = length * thickness
    force = 1e6 * float(row[STRESS]) * area
    modulus, source = _number(row["Epc [MPa]"]), say("laboratory.of_this_wall")
    if modulus is None:  # of walls of the series under the same stress
        same = [
            value
            for other in rows
            if other[STRESS] == row[STRESS]
            and other["Stone"] == row["Stone"]
            and (value := _number(other["Epc [MPa]"])) is not None
        ]
        modulus, source = sum(same) / len(same), say("laboratory.of_same_stress")
    figures = (
        "dmax,+ [%]", "Vmax,+ [kN]", "dmax,- [%]", "Vmax,- [kN]", "dy,+ [%]", "dy,- [%]",
        "du,+ [%]", "Vu,+ [kN]", "du,- [%]", "Vu,- [kN]", "Kel,+ [kN/mm]", "Keff,+ [kN/mm]",
        "Kel,- [kN/mm]", "Keff,- [kN/mm]",
    )  # fmt: skip
    return Wall(
        name=name,
        reference=row["Reference"],
        series=name[:2],
        cyclic=row["Cyclic / Monotonic"] == "Cyclic",
        height=height,
        length=length,
        thickness=thickness,
        load_height=1e-3 * float(row["H0 [mm]"]),
        unit_height=1e-3 * float(row["hb [mm]"]),
        unit_length=1e-3 * float(row["lb [mm]"]),
        vertical_force=force,
        unit_weight=(1e3 * float(row["Ntot [kN]"]) - force) / (area * height),
        strength=1e6 * float(row["fc [MPa]"]),
        unit_modulus=1e6 * float(row["Eb [MPa]"]),
        wall_modulus=1e6 * modulus,
        modulus_source=source,
        given={key: _number(row[key]) for key in figures},
        failure=row["From test report: Failure type"],
        map_pushed_left=name not in series()["maps"]["pushed_right"],
    )


def _number(text: str) -> float | None:
    value = float(text) if text.strip() else math.nan
    return None if math.isnan(value) else value
