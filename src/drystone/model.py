"""A model: everything that one analysis needs, read from a file or put together in Python."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

from drystone.assembly import Assembly
from drystone.loading import LoadPattern
from drystone.monitor import ControlPoint


@dataclass(frozen=True, kw_only=True)
class Analysis:
    """What the file asks for.

    ``options`` are the numerical settings of strategy and engine, by name.
    """

    engine: str = "equilibrium"
    strategy: str = "displacement"  # or "published"
    stop_multiplier: float = 0.01  # load multiplier under which the curve ends, after the peak
    options: Mapping[str, float] = field(default_factory=dict)


@dataclass(frozen=True, kw_only=True)
class Model:
    """Assembly, load, control point and analysis, with where they came from."""

    title: str
    assembly: Assembly
    load: LoadPattern
    control_point: ControlPoint
    analysis: Analysis = field(default_factory=Analysis)
    source: str | None = None  # path of the model file
    sha256: str = ""  # of the file's bytes, or of the model's own description
