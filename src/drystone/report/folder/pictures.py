"""Pictures of a folder of results: ``curve.png`` and ``mechanism.png``, in other formats too."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from drystone.io.results.folder import whole_file
from drystone.io.results.names import CURVE_FIGURE, FORMATS, MECHANISM_FIGURE
from drystone.io.results.outputs import Finished, Output
from drystone.results.curve import CapacityCurve, CurvePoint

# What draws takes long to import, and a run may leave it to another process.

#: Control displacement [m] of the mechanism's picture, the published one.
MECHANISM_DISPLACEMENT = 0.2
#: The option of a model's analysis that says otherwise.
MECHANISM_OPTION = "mechanism_displacement"


def _draw_curve(done: Finished, keys: Mapping[str, Any]) -> None:
    from drystone.report.curve_figure import draw_curve

    for format in done.formats:
        with whole_file((done.folder / CURVE_FIGURE).with_suffix(f".{format}")) as draft:
            draw_curve(
                done.curve,
                draft,
                title=done.model.title,
                limits=done.beside.limits,
                format=format,
            )


def _draw_mechanism(done: Finished, keys: Mapping[str, Any]) -> None:
    from drystone.report.mechanism import Mechanism, readable_magnification
    from drystone.report.mechanism_figure import draw_mechanism

    model, curve, results = done.model, done.curve, done.results
    assert results is not None
    wanted = done.mechanism_displacement
    if wanted is None:
        usual = model.settlement.largest if model.settlement else MECHANISM_DISPLACEMENT
        wanted = float(model.analysis.options.get(MECHANISM_OPTION, usual))
    row = mechanism_row(curve, wanted)
    point, pose, initial = curve.points[row], results.pose(row), results.pose(0)
    departed = curve.departed(model.assembly.ids, point.step)
    pose = np.where(departed[:, None], initial, pose)  # they are shown as designed
    mechanism = Mechanism(
        assembly=model.assembly,
        pose=pose,
        initial=initial,
        departed=departed,
        contacts=results.contacts(row),
        load_direction=model.load_shown,
        control_point=model.control_point,
        ties=model.ties,
        dead_loads=model.dead_loads,
        tie_branch=curve.ties.branch[row] if curve.ties else None,
        magnification=readable_magnification(model.assembly, pose, initial),
    )
    title = mechanism_title(model.title, curve, point)
    for format in done.formats:
        with whole_file((done.folder / MECHANISM_FIGURE).with_suffix(f".{format}")) as draft:
            draw_mechanism(mechanism, draft, title=title, format=format)


def mechanism_row(curve: CapacityCurve, control_displacement: float) -> int:
    """Row of the point nearest to a control displacement [m], the last if the curve ends before."""
    if float(curve.control_displacement.max()) < control_displacement:
        return len(curve.points) - 1
    return curve.nearest(control_displacement)


def mechanism_title(title: str, curve: CapacityCurve, point: CurvePoint) -> str:
    """What a picture shows: the point's own displacement, not the one that was asked for."""
    from drystone.report import canvas
    from drystone.report.quantities import state_text

    values = state_text(curve, point)
    return f"{canvas.literal(title)}: {values}" if title else values


def _of(picture: str) -> tuple[str, ...]:
    """Names of a picture in all formats."""
    return tuple(f"{picture.partition('.')[0]}.{format}" for format in FORMATS)


CURVE_OUTPUT = Output(files=_of(CURVE_FIGURE), write=_draw_curve, aside=True)
MECHANISM_OUTPUT = Output(files=_of(MECHANISM_FIGURE), write=_draw_mechanism, aside=True)
