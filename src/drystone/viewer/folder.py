"""A folder of results with what was found about it since: limit states, bodies of the mechanism."""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

from drystone.export.results import Results, load_results
from drystone.viewer.contents import Contents, Mark, contents_of_folder

ASSESSMENT = "assessment.json"
#: What marks of limit states are called in the header of a page.
LIMIT = "limit"


@dataclass(frozen=True, kw_only=True)
class Folder:
    """Results and, where there is one, their assessment as ``assessment.json`` holds it."""

    results: Results
    assessment: Mapping[str, Any] = field(default_factory=dict)

    @classmethod
    def read(cls, path: Path | str) -> Folder:
        """Read a folder of results; raises `OutputError` where there are none.

        An assessment that cannot be read is none: it is made again at any time.
        """
        results = load_results(path)
        return cls(results=results, assessment=_assessment(Path(path) / ASSESSMENT))

    @property
    def limit_marks(self) -> list[Mark]:
        """Places of the limit states on the curve, as far as it reaches them."""
        curve = self.results.curve
        if not curve.points:
            return []
        x, y = curve.control_displacement, curve.load_multiplier
        after = curve.points.index(curve.peak)
        found = []
        for name, state in dict(self.assessment.get("limit_states") or {}).items():
            place = _number(dict(state).get("limit_control_displacement"))
            if place is None or not x.min() <= place <= x.max():
                continue
            on = np.arange(len(x)) >= (after if place >= x[after] else 0)
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
        return contents_of_folder(
            self.results, marks=self.limit_marks, macro_blocks=self._macro_blocks()
        )

    def _macro_blocks(self) -> dict[str, list[int]]:
        """Numbers of the bodies that blocks belong to, by the state in which they were found."""
        found = self.assessment.get("macro_blocks") or {}
        n = self.results.poses.shape[1]
        if not isinstance(found, Mapping):
            found = {"the mechanism": found}
        return {
            str(name): [int(label) for label in labels]
            for name, labels in found.items()
            if len(labels) == n
        }


def _assessment(path: Path) -> dict[str, Any]:
    try:
        found = json.loads(path.read_text(encoding="utf-8"))
    except (OSError, ValueError):
        return {}
    return found if isinstance(found, dict) else {}


def _number(value: Any) -> float | None:
    return float(value) if isinstance(value, int | float) and np.isfinite(value) else None
