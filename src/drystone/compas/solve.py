"""A problem of compas_dem, solved: its capacity curve, and one point of it as `Results`."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, NamedTuple

from drystone.analysis.driver import pushover
from drystone.compas.joints import check_stiffness
from drystone.compas.problem import model_of
from drystone.compas.results import PEAK, check_installed, results_of
from drystone.model.joint_law import JointLaw
from drystone.model.model import Model
from drystone.results.curve import CapacityCurve


class Solution(NamedTuple):
    """What `solve` found."""

    results: Any  # `compas_dem.problem.Results` of one point of the curve
    curve: CapacityCurve
    model: Model  # what was traced


# Many: those of `model_of` that are asked for most, and what a run takes.
def solve(
    problem: Any,
    *,
    load: Any = None,
    direction: Sequence[float] | None = None,
    at: str | int = PEAK,
    joint: JointLaw | None = None,
    control_block: int | None = None,
    control_point: str | Sequence[float] | None = None,
    control_direction: Sequence[float] | None = None,
    density: float | None = None,
    points: int | None = None,
    engine: str | None = None,
    progress: Any = None,
    **options: Any,
) -> Solution:
    """Trace the capacity curve of a `Problem`, past its peak.

    Parameters
    ----------
    problem
        Of compas_dem, with its model loaded and supports on it.  Neither is changed.
    load, direction, joint, control_block, control_point, control_direction, density, points
        See `model_of`.
    at
        Of which point of the curve results are given, see `results_of`.
    engine, progress, options
        See `drystone.pushover`.

    Raises
    ------
    ModelError
        The problem holds what drystone cannot do, or lacks what it needs.
    EngineError
        The structure cannot be analysed; `UnstableError` where it does not stand.
    """
    check_installed()
    model = model_of(
        problem,
        load=load,
        direction=direction,
        joint=joint,
        control_block=control_block,
        control_point=control_point,
        control_direction=control_direction,
        density=density,
        points=points,
    )
    check_stiffness(model.assembly.joint)
    curve = pushover(
        model,
        engine=engine,
        progress=progress,
        keep_poses=True,
        keep_contacts=True,
        **options,
    )
    return Solution(results_of(problem, model, curve, at=at), curve, model)
