"""Arguments and options that several commands share."""

from __future__ import annotations

from enum import StrEnum
from pathlib import Path
from typing import Annotated

import typer


class Strategy(StrEnum):
    """How the load is applied; the names are those of the library."""

    displacement = "displacement"
    published = "published"


class Language(StrEnum):
    """Languages of what is written for people; the names are those of
    `drystone.common.language`."""

    en = "en"
    it = "it"


ModelFile = Annotated[
    Path, typer.Argument(metavar="MODEL", help="Model file, TOML or JSON.", show_default=False)
]
OptionalModelFile = Annotated[
    Path | None,
    typer.Argument(metavar="MODEL", help="Model file, TOML or JSON.", show_default=False),
]
AsJson = Annotated[
    bool, typer.Option("--json", help="Print one JSON object on standard output, nothing else.")
]
Quiet = Annotated[bool, typer.Option("--quiet", "-q", help="Show no progress.")]
StrategyName = Annotated[
    Strategy | None,
    typer.Option(
        help="How the load is applied. [default: what the model says]", show_default=False
    ),
]
