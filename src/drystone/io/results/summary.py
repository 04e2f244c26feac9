"""``summary.json``: the figures of one analysis."""

from __future__ import annotations

import json
import math
from collections.abc import Mapping
from dataclasses import asdict
from pathlib import Path
from typing import TYPE_CHECKING, Any

from drystone.common.version import package_version
from drystone.io.results.names import SUMMARY
from drystone.io.results.outputs import Output

if TYPE_CHECKING:
    from drystone.model.model import Model
    from drystone.results.curve import CapacityCurve


def summarise(curve: CapacityCurve, model: Model) -> dict[str, Any]:
    """Figures of a curve of at least one point, SI units, ready for JSON: None where there is none.

    ``max_...`` are taken over all points of the curve, ``peak`` is the whole point of the peak,
    or the highest so far where ``peak_passed`` is false.
    """
    from drystone.results.curve import COLUMNS, DYNAMIC

    peak = curve.peak
    last = curve.points[-1]
    summary: dict[str, Any] = {
        "title": model.title,
        "engine": curve.engine,
        "strategy": curve.strategy,
        "status": curve.status,
        "reason": curve.reason,
        "dimension": model.assembly.dimension,
        "n_blocks": model.assembly.n_blocks,
        "n_supports": model.assembly.n_supports,
        "load": model.load.words,
        "mode": _mode(model),
        "n_steps": curve.n_steps,
        "n_points": len(curve.points),
        "n_dynamic": sum(point.status == DYNAMIC for point in curve.points),
        "n_iterations": sum(point.n_iterations for point in curve.points),
        "peak_multiplier": peak.load_multiplier,
        "peak_displacement": peak.control_displacement,
        "peak_passed": curve.peak_passed,
        "ultimate_displacement": curve.ultimate_displacement,
        "stop_multiplier": curve.stop_multiplier,
        "settlement": curve.settlement,
        "capacity_multiplier": curve.capacity.load_multiplier,
        "capacity_displacement": curve.capacity.control_displacement,
        "events": [event.as_dict() for event in curve.events],
        "blocks_left": [asdict(block) for block in curve.blocks_left],
        "last_displacement": last.control_displacement,
        "last_multiplier": last.load_multiplier,
        "max_residual": _largest(curve, "residual"),
        "max_penetration": _largest(curve, "penetration"),
        "max_friction_violation": _largest(curve, "friction_violation"),
        "peak": {name: getattr(peak, name) for name in COLUMNS},
        **(support_figures(curve, model) if curve.moves_supports else {}),
        **(_cyclic(curve, model) if curve.is_cyclic else {}),
        "wall_time": curve.wall_time,
        "compile_time": curve.compile_time,
        "version": package_version(),
        "notes": model.notes,
        "model": model.source,
        "model_sha256": model.sha256,
    }
    return {key: plain(value) for key, value in summary.items()}


def rises_after_collapse(figures: Mapping[str, Any]) -> bool:
    """Whether what is left after a part has collapsed bears more than the whole did before, by the
    figures of a summary; see `CapacityCurve.rises_after_collapse`."""
    return bool(figures["peak_multiplier"] > figures["capacity_multiplier"])


def _cyclic(curve: CapacityCurve, model: Model) -> dict[str, Any]:
    """Of a cyclic analysis: cycles in N, m and J, envelopes of multipliers."""
    from drystone.results.cycles import dissipated

    cycles, lowest = curve.cycles, curve.lowest
    return {
        "history": [] if model.history is None else list(model.history.targets),
        "load_force": curve.load_force,
        "lowest_multiplier": lowest.load_multiplier,
        "lowest_displacement": lowest.control_displacement,
        "cycles": [cycle.as_dict() for cycle in cycles],
        "dissipated_energy": dissipated(cycles),
        "envelope": {
            name: {"control_displacement": x, "load_multiplier": y}
            for name, (x, y) in (
                ("positive", curve.envelope(1.0)),
                ("negative", curve.envelope(-1.0)),
            )
        },
    }


def support_figures(curve: CapacityCurve, model: Model) -> dict[str, Any]:
    """Of supports that move: how their reaction goes, in N and m, or in N m and rad."""
    from drystone.results.curve import STATIC

    settlement = model.settlement
    return {
        "support_motion": settlement.words if settlement is not None else "",
        **reaction_figures(curve),
        "stands": settlement is not None
        and curve.points[-1].status == STATIC
        and curve.points[-1].control_displacement >= settlement.largest * (1.0 - 1e-9),
    }


def reaction_figures(curve: CapacityCurve) -> dict[str, float]:
    """What the curve alone knows of them: reactions [N, N m], and at which motion [m, rad]."""
    least, greatest = (curve.marked_reactions[name] for name in ("least", "greatest"))
    return {
        "initial_reaction": curve.points[0].reaction,
        "least_reaction": least.reaction,
        "least_reaction_at": least.control_displacement,
        "greatest_reaction": greatest.reaction,
        "greatest_reaction_at": greatest.control_displacement,
        "largest_motion": curve.points[-1].control_displacement,
    }


def _mode(model: Model) -> dict[str, Any] | None:
    """Of a load in proportion to a mode of vibration."""
    from drystone.model.inspection import VibrationMode

    mode = VibrationMode.of(model)
    return asdict(mode) if mode is not None else None


def write_summary(summary: dict[str, Any], path: Path | str) -> None:
    """Write it whole or not at all: readers never see half a file."""
    from drystone.io.results.folder import whole_file

    with whole_file(Path(path)) as draft:
        draft.write_text(to_json(summary) + "\n", encoding="utf-8")


def to_json(value: Any) -> str:
    """JSON that every reader takes: no NaN, no infinity."""
    return json.dumps(plain(value), indent=2, allow_nan=False, ensure_ascii=False)


def plain(value: Any) -> Any:
    """The same value in Python's own types; NaN and infinities become None."""
    if hasattr(value, "tolist"):  # arrays and scalars of numpy
        value = value.tolist()
    if isinstance(value, dict):
        return {str(key): plain(item) for key, item in value.items()}
    if isinstance(value, list | tuple):
        return [plain(item) for item in value]
    if isinstance(value, float) and not math.isfinite(value):
        return None
    return value


def _largest(curve: CapacityCurve, name: str) -> float:
    """Largest value over all points; NaN where no point knows it."""
    known = [
        v for v in (float(getattr(point, name)) for point in curve.points) if not math.isnan(v)
    ]
    return max(known, default=math.nan)


SUMMARY_OUTPUT = Output(
    files=(SUMMARY,),
    write=lambda done, keys: write_summary(done.summary, done.folder / SUMMARY),
    short=True,
)
