"""``assessment.json`` and ``adrs.png``."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

from drystone.export.folder import in_a_sentence, whole_file
from drystone.export.summary import package_version, write_summary

if TYPE_CHECKING:
    from drystone.assessment.verdict import Verdict


def write_assessment(
    path: Path,
    result: dict[str, Any],
    *,
    figure: Path,
    verdict: Verdict | None,
    title: str = "",
) -> None:
    """Write the result, and the picture of the verdict where there is one.

    Raises
    ------
    OutputError
        The folder cannot be written.
    """

    def write() -> None:
        path.parent.mkdir(parents=True, exist_ok=True)
        write_summary({**result, "version": package_version()}, path)
        if verdict is None:
            return
        from drystone.report.adrs_figure import draw_adrs

        with whole_file(figure) as draft:
            draw_adrs(verdict.assessment, draft, title=title)

    in_a_sentence(write)
