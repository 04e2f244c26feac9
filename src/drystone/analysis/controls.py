"""The control of an analysis: which strategy, with which settings, for an engine and a model."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import asdict, fields
from typing import Any, TypeVar

import numpy as np

from drystone.analysis.sitting import SITTING
from drystone.common import tolerances
from drystone.common.ranges import RANGES, problem
from drystone.control import (
    Control,
    ControlError,
    DisplacementControl,
    DisplacementSettings,
    ExcessControl,
    ExcessHistoryControl,
    ExcessHistorySettings,
    ExcessSettings,
    HistoryControl,
    HistorySettings,
    PublishedControl,
    PublishedSettings,
    SupportControl,
    SupportSettings,
)
from drystone.control.stops import STOPS, stops_of
from drystone.engines.base import Engine, EngineError
from drystone.engines.frame import Frame
from drystone.engines.refusal import others
from drystone.model.model import Analysis, Model
from drystone.results.curve import CYCLIC, SETTLEMENT

#: Settings of some strategy.
Settings = TypeVar(
    "Settings",
    PublishedSettings,
    DisplacementSettings,
    ExcessSettings,
    HistorySettings,
    ExcessHistorySettings,
)

#: Default displacement per step over the smallest extent of a block.
STEP_SHARE = 0.005

#: Largest one: with longer steps engines fail, and a peak may be missed.
COARSEST_SHARE = 0.2

#: Steps in the longest leg of a history, at least: a loop has an area and a shape.
STEPS_IN_LEG = 20

#: Time step of supports that move in dynamic formulations, in own units [s]: inertia of a step of
#: a hundredth of a block is then 1e-4 of its weight.
STILL = 1.0

STRATEGIES = ("displacement", "published")

#: Names of the settings of an analysis that are no conditions under which it stops: those of the
#: strategies that have a range.  The others follow from the model and the engine.
SETTINGS = {
    "mechanism_displacement",
    *SITTING,
    *(
        key.name
        for cls in (PublishedSettings, ExcessSettings, DisplacementSettings)
        for key in fields(cls)
        if key.name in RANGES
    ),
}


def _options_of(strategy: str, analysis: Analysis) -> dict[str, float]:
    """The numerical settings of an analysis; raises `EngineError`."""
    options = {"stop_multiplier": analysis.stop_multiplier, **analysis.options}
    if strategy not in (*STRATEGIES, SETTLEMENT, CYCLIC):
        raise EngineError(f'there is no strategy "{strategy}": take {" or ".join(STRATEGIES)}')
    unknown = [key for key in options if key not in SETTINGS and key not in STOPS]
    if unknown:
        raise EngineError(f'there is no setting "{unknown[0]}" of the analysis')
    wrong = [sentence for key, value in options.items() if (sentence := problem(key, value))]
    stops = stops_of({key: x for key, x in options.items() if key not in SETTINGS})
    wrong += [sentence for stop, x in stops if (sentence := stop.problem(x))]
    if wrong:  # also of settings that this strategy does not use, as in a model file
        raise EngineError(f"[analysis] {wrong[0]}")
    return options


def make_control(strategy: str, engine: Engine[Any], model: Model) -> Control[Any]:
    """The control of a strategy for an engine; raises `EngineError` for settings that fail."""
    options = _options_of(strategy, model.analysis)
    frame = Frame.of(model.assembly)
    coarsest = COARSEST_SHARE * frame.size
    asked = options.get("displacement_step", 0.0)
    if asked > coarsest:
        raise EngineError(
            f"[analysis] displacement_step of {asked:g} m is too coarse to see the peak: take at "
            f"most {coarsest:.3g} m, a fifth of the smallest block"
        )
    farthest = max(model.assembly.largest_extent, options.get("max_displacement", 0.0))
    step = {"displacement_step": STEP_SHARE * frame.size, "farthest": farthest}
    if model.load.turns_gravity:
        step["upright"] = tolerances.UPRIGHT
    said = asdict(engine.preferred_steps(model.assembly))
    preferred = {key: value for key, value in said.items() if value is not None}
    published = strategy == "published"  # whose steps do not depend on the engine
    suited = {**preferred, **step} if published else {**step, **preferred}
    if model.settlement is not None:
        return _support_control({**suited, **options}, engine, model, frame)
    chosen = {**suited, "suited_step": suited["displacement_step"], **options}
    try:
        if published:
            return PublishedControl(_settings(PublishedSettings, frame.time, chosen))
        if model.history is not None:
            return _cyclic({**chosen, "targets": model.history.targets}, engine, frame)
        if engine.capabilities.prescribes_displacement:
            return DisplacementControl(_settings(DisplacementSettings, frame.time, chosen))
        return ExcessControl(_settings(ExcessSettings, frame.time, chosen))
    except ControlError as error:
        raise EngineError(f"[analysis] {error}") from None


def _cyclic(
    options: Mapping[str, Any], engine: Engine[Any], frame: Frame
) -> HistoryControl | ExcessHistoryControl:
    """The control of a history; its steps are short beside its legs."""
    legs = np.abs(np.diff((0.0, *options["targets"])))
    step = min(options["displacement_step"], float(legs.max()) / STEPS_IN_LEG)
    options = {**options, "displacement_step": step}
    if engine.capabilities.prescribes_displacement:
        return HistoryControl(_settings(HistorySettings, frame.time, options))
    return ExcessHistoryControl(_settings(ExcessHistorySettings, frame.time, options))


def _support_control(
    options: Mapping[str, float], engine: Engine[Any], model: Model, frame: Frame
) -> SupportControl:
    """The control of supports that move; raises `EngineError` for engines that cannot move them."""
    if not engine.capabilities.moves_supports:
        raise EngineError(
            f"the {engine.name} engine cannot move supports: {others(lambda c: c.moves_supports)}"
        )
    settlement, assembly = model.settlement, model.assembly
    assert settlement is not None
    weight = float(assembly.weight[~assembly.fixed].sum())
    lever = 1.0
    if settlement.rotates:
        lever = settlement.lever(assembly)
    step = options["displacement_step"]
    return SupportControl(
        SupportSettings(
            largest=settlement.largest,
            step=min(step, settlement.largest * lever) / lever,
            unit=weight * (lever if settlement.rotates else 1.0),
            scale=lever,
            time_step=0.0 if engine.capabilities.prescribes_displacement else STILL * frame.time,
            jump_time_step=tolerances.JUMP_TIME_STEP * frame.time
            if engine.capabilities.moves_supports_in_time
            else 0.0,
            fall=tolerances.SUPPORT_FALL * assembly.smallest_extent,
            grow_iterations=int(options.get("grow_iterations", SupportSettings.grow_iterations)),
            # How far supports go, [settlement] says.
            stops=stops_of({key: x for key, x in options.items() if key != "max_displacement"}),
        )
    )


def _settings(cls: type[Settings], second: float, options: Mapping[str, Any]) -> Settings:
    """A settings object from those options that it has; whole numbers where it wants them.

    Its default times are in the structure's own ``second`` [s]: what falls its own size in one,
    falls it in another, whatever the size.
    """
    chosen: dict[str, Any] = {}  # of whole numbers, others and switches
    own = {key.name for key in fields(cls)}
    for key in fields(cls):
        if key.name in options:
            value = options[key.name]
            chosen[key.name] = int(value) if key.type == "int" else value
        elif key.name == "stops":
            chosen[key.name] = stops_of({k: x for k, x in options.items() if k not in own})
        elif key.name == "time_step":
            default: Any = key.default
            chosen[key.name] = second * default
    return cls(**chosen)
