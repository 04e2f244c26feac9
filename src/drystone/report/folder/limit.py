"""Results of limit analysis: as data, and a folder with pictures of the mechanisms."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

from drystone.common.arrays import Array
from drystone.common.version import package_version
from drystone.geometry.motion import rotations
from drystone.io.results.folder import check_apart, locked
from drystone.io.results.summary import plain, write_summary
from drystone.limit import FLOWS, Collapse
from drystone.model.model import Model
from drystone.report import Mechanism, canvas, draw_mechanism
from drystone.results.shapes import MovingShapes

LIMIT, MECHANISM = "limit.json", "mechanism"
#: The fastest vertex is drawn this share of the structure's size away from where it was.
DRAWN = 0.08
#: No block is turned by more than this: it would be drawn 2 % too large.
TURNED = 0.2


def collapse_to_dict(result: Collapse) -> dict[str, Any]:
    """Everything but the arrays, ready for JSON: None for what is not finite."""
    values: dict[str, Any] = {
        "flow": result.flow,
        "collapse_multiplier": result.load_multiplier,
        "collapse_range": result.collapse_range,
        "upper_bound": result.upper_bound,
        "status": result.status,
        "reason": result.reason,
        "moving": result.moving,
        "duality_gap": result.duality_gap,
        "residual": result.residual,
        "friction_violation": result.friction_violation,
        "dilatancy_violation": result.dilatancy_violation,
        "n_iterations": result.n_iterations,
        "n_paths": result.n_paths,
        **({} if result.tie_forces is None else {"tie_forces": result.tie_forces}),
    }
    return {key: plain(value) for key, value in values.items()}


def write_collapse(results: Sequence[Collapse], model: Model, folder: Path) -> None:
    """Write ``limit.json`` and ``mechanism-FLOW.png`` for every flow that has a mechanism.

    ``mechanism.png`` is that of the last one.

    Raises
    ------
    OutputError
        The folder cannot be written, another run is writing there, or the model file would go.
    """
    check_apart(model.source, limit_files(folder))
    with locked(folder):
        _write(results, model, folder)


def limit_files(folder: Path) -> list[Path]:
    """Files that `write_collapse` may write."""
    pictures = [MECHANISM, *(f"{MECHANISM}-{flow}" for flow in FLOWS)]
    return [folder / LIMIT, *(folder / f"{name}.png" for name in pictures)]


def _write(results: Sequence[Collapse], model: Model, folder: Path) -> None:
    summary = {
        "title": model.title,
        "n_blocks": model.assembly.n_blocks,
        "flows": [collapse_to_dict(result) for result in results],
        "version": package_version(),
        "model": model.source,
        "model_sha256": model.sha256,
    }
    write_summary(summary, folder / LIMIT)
    size = MovingShapes.of(model.assembly).size()
    last = None
    for result in results:
        if not np.any(result.velocities):
            continue
        last = folder / f"{MECHANISM}-{result.flow}.png"
        mechanism = Mechanism(  # without forces: they belong to the designed shape
            assembly=model.assembly,
            pose=_drawn(result.velocities, size),
            load_direction=model.load_along,
            control_point=model.control_point,
            ties=model.ties,
            dead_loads=model.dead_loads,
            linear=True,
        )
        title = _title(model.title, result)
        draw_mechanism(mechanism, last, title=title, scale="rates of motion, drawn large")
    if last is not None:
        (folder / f"{MECHANISM}.png").write_bytes(last.read_bytes())


def _drawn(velocities: Array, size: float) -> Array:
    """Velocities, the fastest of which is one, as far as they are drawn, (n, n_dof) [m, rad]."""
    fastest_rotation = float(np.linalg.norm(rotations(velocities), axis=1).max())
    return min(DRAWN * size, TURNED / max(fastest_rotation, TURNED / size)) * velocities


def _title(title: str, result: Collapse) -> str:
    what = (
        f"{result.flow}, $λ$ = {result.load_multiplier:.4f}"
        if result.status == "finished"
        else "falls under its own weight"
    )
    return f"{canvas.literal(title)}: {what}" if title else what
