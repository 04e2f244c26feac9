"""The assessment that a report tells: of the folder's own file, or made of what the model asks."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

from drystone.assessment.spectra.base import Spectrum
from drystone.assessment.verdict import sense_words
from drystone.common.language import spoken
from drystone.io.results.names import RESULTS
from drystone.io.results.senses import FORWARD, OPPOSITE, OPPOSITE_FOLDER
from drystone.report.document.facts import NOTHING
from drystone.report.folder.results import check_opposite
from drystone.report.viewer.folder import Folder
from drystone.results.curve import CapacityCurve

#: Damping [ratio] of a spectrum that no limit state says otherwise of.
DAMPING = 0.05


@dataclass(frozen=True, kw_only=True)
class Judged:
    """A folder, its opposite sense where there is one, and what was found of both."""

    folder: Folder
    opposite: Folder | None = None
    reason: str = ""  # why there is no verdict, where one was asked for
    spectra: Mapping[str, Spectrum] = field(default_factory=dict)  # by limit state, "" for all

    @classmethod
    def of(cls, folder: Folder) -> Judged:
        """Take the assessment of the folder; without one, make it where the model asks for one."""
        model, reason = folder.results.model, ""
        if not folder.assessment and model is not None and model.assessment is not None:
            folder, reason = _made(folder)
        elif folder.assessment.get("status") == "no verdict":
            reason = folder.assessment.get("reason") or ""
        opposite = None
        path = folder.results.path / OPPOSITE_FOLDER
        if folder.sense == FORWARD and (path / RESULTS).is_file():
            opposite = Folder.read(path)
            check_opposite(opposite.results, folder.results)
        return cls(folder=folder, opposite=opposite, reason=reason, spectra=_spectra(folder))

    @property
    def data(self) -> Mapping[str, Any]:
        """The assessment, as its file holds it."""
        return self.folder.assessment

    def tell(self, text: str) -> str:
        """A sentence of the assessment in the language that is spoken."""
        return spoken(text, self.data.get("said"))

    @property
    def verdict(self) -> str:
        """The verdict in a sentence; empty without one."""
        return self.data.get("sentence") or ""

    @property
    def governing(self) -> Folder:
        """The folder of the sense that governs."""
        if self.opposite is not None and not self.folder.governs and self.opposite.governs:
            return self.opposite
        return self.folder

    @property
    def curves(self) -> list[tuple[str, CapacityCurve]]:
        """Curves of both senses."""
        found = [(spoken(sense_words(self.folder.sense)), self.folder.results.curve)]
        if self.opposite is not None:
            found.append((spoken(sense_words(OPPOSITE)), self.opposite.results.curve))
        return found

    def sense_sentence(self, text: Mapping[str, str]) -> str:
        """Which senses were traced."""
        cyclic = self.folder.results.curve.is_cyclic
        sense = str(self.data.get("governing_sense") or NOTHING)
        which = {"sense": spoken(sense_words(sense))}
        if self.opposite is not None:
            return text["senses"].format(**which)
        if cyclic and len(self.data.get("senses") or ()) > 1:
            return text["senses_cyclic"].format(**which)
        return text["sense_cyclic" if cyclic else "sense_without"]

    @property
    def demand_spectra(self) -> dict[str, tuple[Spectrum, float]]:
        """Spectrum and damping of each limit state that compares displacements."""
        found: dict[str, tuple[Spectrum, float]] = {}
        for name, state in (self.data.get("limit_states") or {}).items():
            spectrum = self.spectra.get(name, self.spectra.get(""))
            if spectrum is not None and state.get("limit_displacement") is not None:
                found[name] = (spectrum, float(state.get("equivalent_damping") or DAMPING))
        return found

    def drawn_spectra(self, all_states: str) -> dict[str, tuple[Spectrum, float]]:
        """Spectra of the ground at five per cent, each once, by the states that they are for."""
        found: dict[int, tuple[str, Spectrum]] = {}
        for name, spectrum in self.spectra.items():
            names, _ = found.get(id(spectrum), ("", spectrum))
            found[id(spectrum)] = (", ".join(filter(None, (names, name))), spectrum)
        return {name or all_states: (spectrum, DAMPING) for name, spectrum in found.values()}


def _made(folder: Folder) -> tuple[Folder, str]:
    """The folder with an assessment by what its model asks for, or why there is none."""
    from dataclasses import replace

    from drystone.assessment.errors import AssessmentError
    from drystone.assessment.verdict import of_one_sense, verdict_on

    results = folder.results
    assert results.model is not None
    site, asked = results.model.site, results.model.assessment
    try:
        verdict = of_one_sense(verdict_on(results.curve, results.model), folder.sense)
    except AssessmentError as error:
        return folder, error.said
    data = {
        **verdict.as_dict(),
        "governing_sense": folder.sense,
        "site": None if site is None else site.as_dict(),
        "assessment": None if asked is None else asked.as_dict(),
    }
    return replace(folder, assessment=data), ""


def _spectra(folder: Folder) -> dict[str, Spectrum]:
    """Spectra of the site that was assessed, or that the model has."""
    from drystone.assessment.errors import AssessmentError
    from drystone.assessment.site import spectra_of_site
    from drystone.io.modelfile.assessing import tables_of
    from drystone.model.construction.errors import ModelError

    model = folder.results.model
    site = None if model is None else model.site
    stored = folder.assessment.get("site")
    try:
        if isinstance(stored, Mapping):
            site, _ = tables_of({"site": dict(stored)})
        found = None if site is None else spectra_of_site(site)
    except (AssessmentError, ModelError, OSError):
        return {}
    if found is None:
        return {}
    return dict(found) if isinstance(found, Mapping) else {"": found}
