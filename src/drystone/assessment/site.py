"""From [site] to spectra: one for all limit states, or one for each."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass, replace
from typing import Any

from drystone.assessment.errors import AssessmentError
from drystone.assessment.methods.base import Spectra
from drystone.assessment.spectra.base import Spectrum
from drystone.assessment.spectra.ec8 import RETURN_PERIODS, Ec8Spectrum
from drystone.assessment.spectra.floor import FloorSpectrum, first_mode
from drystone.assessment.spectra.ntc2018 import (
    PROBABILITIES,
    NtcSpectrum,
    reference_life,
    return_period,
)
from drystone.assessment.spectra.table import read_spectrum
from drystone.common.language import say
from drystone.model.assembly import GRAVITY
from drystone.model.site import Site

#: States that a motion given without a name is meant for, where others have one of their own: the
#: return period of 475 years of new buildings.
REFERENCE = ("SLV", "SD")

#: What each code needs, and how to give it.
NEEDED = {
    "ntc2018": {
        "ag": "the ground acceleration on rock in g, as in ag = 0.17",
        "F0": "the amplification, as in F0 = 2.45",
        "TC_star": "the corner period in s, as in TC_star = 0.29",
        "soil": '"A" to "E"',
        "topography": '"T1" to "T4"',
    },
    "ec8": {
        "ag": "the reference ground acceleration a_gR in g, as in ag = 0.17",
        "type": "1, or 2 where surface-wave magnitudes do not exceed 5.5",
        "ground": '"A" to "E"',
        "importance": 'a class "I" to "IV", or gamma_I',
    },
    "csv": {
        "file": 'the path of a table with the header T,Se, as in file = "spectrum.csv"',
        "unit": '"g" or "m/s2"',
        "damping": "that of the table in percent, as in damping = 5.0",
    },
}

#: Share by which the return period of a motion may differ from that of the limit state it is for:
#: 475 years stand for 474.6.
SAME_PERIOD = 0.01


@dataclass(frozen=True, kw_only=True)
class MotionAsked:
    """The ground motion that NTC 2018 asks for in a limit state, and whether the site gives it."""

    state: str
    probability: float  # P_VR, Table 3.2.I
    reference_life: float  # years, V_R
    return_period: float  # years, T_R
    ground_acceleration: float | None  # m/s2, a_g of that return period; None: not given

    def as_dict(self) -> dict[str, Any]:
        """For files."""
        return asdict(self)


def motions_asked(site: Site, states: Sequence[str]) -> tuple[MotionAsked, ...]:
    """What NTC 2018 asks of the site for the limit states of a method, by V_N and class of use.

    V_R = V_N C_U and T_R = -V_R/ln(1 - P_VR), [2.4.1] and [3.2.0].  Nothing where [site] does not
    give both.  The hazard grid is not part of the package: a_g is what the site gives.
    """
    if site.code != "ntc2018":
        return ()
    found = []
    for name in states:
        values = _of_state(site, name)
        if name not in PROBABILITIES or "nominal_life" not in values or "use" not in values:
            continue
        life = reference_life(values["nominal_life"], values["use"])
        years = return_period(life, name)
        given = values.get("return_period", years)
        own = "ag" in site.states.get(name, {}) or (name in REFERENCE and "ag" in values)
        same = abs(given - years) <= SAME_PERIOD * years
        found.append(
            MotionAsked(
                state=name,
                probability=PROBABILITIES[name],
                reference_life=life,
                return_period=years,
                ground_acceleration=values["ag"] * GRAVITY if own and same else None,
            )
        )
    return tuple(found)


def missing_motions(asked: Sequence[MotionAsked]) -> tuple[str, ...]:
    """A sentence on limit states whose ground motion the site does not give."""
    missing = [motion for motion in asked if motion.ground_acceleration is None]
    if not missing:
        return ()
    states = [say("verdict.motion", state=m.state, years=m.return_period) for m in missing]
    tables = [f"[site.{m.state}]" for m in missing]
    return (say("verdict.missing_motions", states=states, tables=tables),)


def spectra_of_site(site: Site) -> Spectra:
    """One spectrum that serves for every limit state, or one for each that is given.

    Of EN 1998-1 a_gR is that of 475 years: DL, SD and NC have motions of their own return periods
    unless [site] names one, and the name "" stands for states of other codes.

    Raises
    ------
    AssessmentError
        A key is missing, or a spectrum cannot be used.
    """
    if site.code not in NEEDED:
        raise AssessmentError(
            f'site.code: there is no code "{site.code}": take one of {", ".join(NEEDED)}'
        )
    carried = site.code == "ec8" and "return_period" not in site.values
    if not site.states and not carried:
        return _at_height(site, _spectrum(site, "", site.values))
    spectra: dict[str, Spectrum] = {}
    if _complete(site) or not site.states:
        own = _at_height(site, _spectrum(site, "", site.values))
        spectra = {name: own for name in REFERENCE if name not in site.states}
        if carried:
            for name in RETURN_PERIODS.keys() - spectra.keys() - site.states.keys():
                spectra[name] = _at_height(site, _spectrum(site, name, site.values))
            if site.states.keys() <= RETURN_PERIODS.keys():
                spectra[""] = own
    for name in site.states:
        spectra[name] = _at_height(site, _spectrum(site, name, _of_state(site, name)))
    return spectra


def _of_state(site: Site, name: str) -> dict[str, Any]:
    """The keys of [site] with those of a limit state's own table over them.

    A motion of its own has a return period of its own, or that of the state.
    """
    own = site.states.get(name, {})
    values = {**site.values, **own}
    if ("ag" in own or "file" in own) and "return_period" not in own:
        values.pop("return_period", None)
    return values


def _complete(site: Site) -> bool:
    """Whether [site] itself gives a motion, beside those of limit states."""
    return all(key in site.values for key in NEEDED[site.code])


def _spectrum(site: Site, state: str, values: Mapping[str, Any]) -> Spectrum:
    """A spectrum of the keys of a code; ``state`` names the table that they are from."""
    place = f"site.{state}" if state else "site"
    for key, mend in NEEDED[site.code].items():
        if key not in values:
            raise AssessmentError(f"{place}: {key} is missing: give {mend}")
    make = {"ntc2018": _ntc, "ec8": _ec8, "csv": _table}[site.code]
    try:
        return make(site, state, values)
    except AssessmentError as error:
        raise AssessmentError(f"{place}: {error}") from None


def _ntc(site: Site, state: str, values: Mapping[str, Any]) -> Spectrum:
    years = values.get("return_period")
    if years is None and "nominal_life" in values and "use" in values:
        years = return_period(
            reference_life(values["nominal_life"], values["use"]), state or REFERENCE[0]
        )
    return NtcSpectrum(
        ground_acceleration=values["ag"] * GRAVITY,
        amplification=values["F0"],
        reference_corner=values["TC_star"],
        soil=values["soil"],
        topography=values["topography"],
        return_period=years,
    )


def _ec8(site: Site, state: str, values: Mapping[str, Any]) -> Spectrum:
    own = site.states.get(state, {})
    years = values.get("return_period", RETURN_PERIODS.get(state))
    as_given = "ag" in own  # the motion of that return period itself: nothing is carried over
    spectrum = Ec8Spectrum.of_reference(
        values["ag"] * GRAVITY,
        importance=values["importance"],
        spectrum_type=values["type"],
        ground=values["ground"],
        return_period=None if as_given else years,
    )
    if as_given:
        return replace(spectrum, return_period=own.get("return_period"))
    if "return_period" not in values and spectrum.notes:
        note = say("ec8.state", state=state, years=years)
        spectrum = replace(spectrum, notes=(note, *spectrum.notes))
    return spectrum


def _table(site: Site, state: str, values: Mapping[str, Any]) -> Spectrum:
    return read_spectrum(
        site.file(values["file"]),
        unit=values["unit"],
        damping=values["damping"] / 100.0,
        soil_factor=values.get("soil_factor", 1.0),
        corner_period=values.get("corner_period"),
        site_specific=values.get("site_specific", True),
        return_period=values.get("return_period"),
    )


def _at_height(site: Site, spectrum: Spectrum) -> Spectrum:
    """The spectrum at the height of [site.floor], or on the ground where there is none."""
    floor = dict(site.floor)
    if not floor:
        return spectrum
    for key in ("height", "building_height", "damping"):
        if key not in floor:
            raise AssessmentError(f"site.floor: {key} is missing: add it, or take the table out")
    mode, assumed = first_mode(**{**floor, "damping": floor["damping"] / 100.0})
    return FloorSpectrum(ground=spectrum, modes=(mode,), assumed=assumed)
