"""The pushover analysis written out by hand, from the same public parts that `ds.pushover` uses.

An engine starts a state from a problem and steps it as demanded; a control reads the report of the
step and says what to demand next.  Nothing else is needed: a test checks that the curve equals
that of `ds.pushover` to the last bit.
"""

from dataclasses import replace
from pathlib import Path

import drystone as ds
from drystone.control import ExcessControl, ExcessSettings
from drystone.engines import make_engine
from drystone.engines.base import Problem
from drystone.engines.frame import Frame

MODEL = Path(__file__).with_name("two_blocks.toml")


def trace(model: ds.Model, displacement_step: float) -> list[tuple[float, float]]:
    """Control displacement [m] and static load multiplier of every point."""
    engine = make_engine("nscd")
    control = ExcessControl(
        ExcessSettings(
            displacement_step=displacement_step,
            stop_multiplier=model.analysis.stop_multiplier,
            time_step=0.1 * Frame.of(model.assembly).time,  # s; larger blocks take longer to move
        )
    )
    problem = Problem(assembly=model.assembly, load=model.load, control_point=model.control_point)

    state, report = engine.start(problem)  # equilibrium under the dead load
    settlement = report.control_displacement  # the curve begins where the load does
    decision = control.first(report)
    points = [(0.0, decision.load_multiplier)]

    while decision.demand is not None:
        trial, report = engine.step(state, decision.demand)
        moved = report.control_displacement - settlement
        report = replace(report, control_displacement=moved)
        decision = control.decide(decision.state, decision.demand, report)
        if decision.accept:  # else the next step starts from the same state again, demanding less
            state = trial
            points.append((moved, decision.load_multiplier))

    engine.close()
    return points


if __name__ == "__main__":
    curve = trace(ds.read_model(MODEL), displacement_step=2e-3)
    peak = max(multiplier for _, multiplier in curve)
    print(f"{len(curve)} points, peak multiplier {peak:.4f}")
