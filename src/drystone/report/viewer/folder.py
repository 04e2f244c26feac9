"""A folder of results with what was found about it since: limit states, bodies of the mechanism."""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

from drystone.io.results.folder import OutputError
from drystone.io.results.own_files import ASSESSMENT
from drystone.io.results.senses import FORWARD, OPPOSITE, OPPOSITE_FOLDER
from drystone.report.folder.results import Results, load_results
from drystone.report.viewer.contents import Contents, Mark, contents_of_folder
from drystone.results.curve import FINISHED

#: What marks of limit states are called in the header of a page.
LIMIT = "limit"


@dataclass(frozen=True, kw_only=True)
class Folder:
    """Results and, where there is one, their assessment as ``assessment.json`` holds it."""

    results: Results
    assessment: Mapping[str, Any] = field(default_factory=dict)

    sense: str = FORWARD  # that of the results among those that were assessed

    @property
    def warnings(self) -> list[str]:
        """What to say of a curve that has not come to its end."""
        curve = self.results.curve
        return [f"warning: the curve is not whole: {curve.reason}"] * (curve.status != FINISHED)

    @classmethod
    def read(cls, path: Path | str) -> Folder:
        """Read a folder of results.

        The folder of the opposite sense has its assessment beside it.  One that cannot be read is
        none: it is made again at any time.

        Raises
        ------
        OutputError
            There are no results, or the assessment is that of another model.
        """
        folder = Path(path)
        results = load_results(folder)
        opposite = folder.resolve().name == OPPOSITE_FOLDER
        assessment = _assessment(folder / ASSESSMENT, results.sha256)
        if opposite and not assessment:
            assessment = _assessment(folder.resolve().parent / ASSESSMENT, results.part_of)
        sense = OPPOSITE if opposite else FORWARD
        return cls(results=results, assessment=assessment, sense=sense)

    @property
    def governs(self) -> bool:
        """Whether the assessment's own figures are those of this curve: a cyclic one has both
        senses."""
        sense = self.assessment.get("governing_sense", self.sense)
        return sense == self.sense or self.results.curve.is_cyclic

    @property
    def governing_sign(self) -> float:
        """What the assessment counts along its sense times this is counted along the curve's: -1
        where of a cyclic curve the envelope against the load governs."""
        sense = self.assessment.get("governing_sense", self.sense)
        return 1.0 if sense == self.sense or not self.governs else -1.0

    @property
    def limit_states(self) -> dict[str, dict[str, Any]]:
        """Limit states of this sense by their names."""
        found: Mapping[str, Any] = self.assessment
        if not self.governs:
            found = dict(self.assessment.get("senses") or {}).get(self.sense) or {}
        return {str(name): dict(state) for name, state in (found.get("limit_states") or {}).items()}

    @property
    def limit_marks(self) -> list[Mark]:
        """Places of the limit states on the curve, as far as it reaches them."""
        curve = self.results.curve
        if not curve.points:
            return []
        sign = self.governing_sign
        x, y = curve.control_displacement, curve.load_multiplier
        after = curve.points.index(curve.peak if sign > 0.0 else curve.lowest)
        found = []
        for name, state in self.limit_states.items():
            place = _number(state.get("limit_control_displacement"))
            place = None if place is None else sign * place
            if place is None or not x.min() <= place <= x.max():
                continue
            on = np.arange(len(x)) >= (after if sign * (place - x[after]) >= 0.0 else 0)
            row = int(np.argmin(np.where(on, np.abs(x - place), np.inf)))
            found.append(
                Mark(
                    name=str(name),
                    control_displacement=place,
                    load_multiplier=float(y[row]),
                    kind=LIMIT,
                )
            )
        return found

    def contents(self) -> Contents:
        """What the viewer shows of it."""
        labels = self.labels
        bodies = {} if labels is None else {"the mechanism": labels}
        return contents_of_folder(self.results, marks=self.limit_marks, macro_blocks=bodies)

    @property
    def labels(self) -> list[int] | None:
        """Number of the body of the mechanism that each block belongs to, -1 of those at rest."""
        labels = dict(self.assessment.get("mechanism") or {}).get("body_of_block") or []
        if not self.governs or len(labels) != self.results.poses.shape[1]:
            return None
        return [int(label) for label in labels]


def _assessment(path: Path, digest: str) -> dict[str, Any]:
    """What a file holds; `OutputError` where that is of another model than the one named."""
    try:
        found = json.loads(path.read_text(encoding="utf-8"))
    except (OSError, ValueError):
        return {}
    if not isinstance(found, dict):
        return {}
    if found.get("model_sha256") != digest:
        raise OutputError(
            f"{path} belongs to another model than the results beside it: run `drystone assess "
            f"{path.parent}` again, or remove it"
        )
    return found


def _number(value: Any) -> float | None:
    return float(value) if isinstance(value, int | float) and np.isfinite(value) else None
