"""Checks before an engine starts: which parts of a problem it cannot treat, and which engines
can."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from typing import Any

from drystone.engines import able
from drystone.engines.base import Capabilities, Engine, EngineError, Problem
from drystone.model.assembly import Assembly
from drystone.model.joint_law import Yielding


def refuse(problem: Problem, engine: Engine[Any]) -> None:
    """Raise `EngineError` for rollers, ties or joints that an engine cannot treat."""
    assembly, can = problem.assembly, engine.capabilities
    if assembly.on_rollers and not can.rollers:
        raise EngineError(f"the {engine.name} engine has no rollers: {others(_has_rollers)}")
    if problem.ties and not can.ties:
        raise EngineError(f"the {engine.name} engine has no ties and springs: {others(_has_ties)}")
    refuse_joints(assembly, engine)


def refuse_joints(assembly: Assembly, engine: Engine[Any]) -> None:
    """Raise `EngineError` for joints that an engine cannot treat; the message names engines that
    can."""
    can = engine.capabilities
    for part in Yielding:
        if part not in can.yielding and any(map(part.of, assembly.laws)):
            raise EngineError(
                f"the {engine.name} engine has no joints that {part.value}{assembly.kind.where}: "
                f"{others(partial(_yields, part))}"
            )
    if not can.bonds and any(
        law.dilatancy_angle or law.cohesion or law.tensile_strength for law in assembly.laws
    ):
        raise EngineError(
            f"the {engine.name} engine has no dilatancy, cohesion or tensile strength: set them "
            f"to zero, or {others(_has_bonds)}"
        )


def others(can: Callable[[Capabilities], bool]) -> str:
    """The advice "take the ... engine", with those of our own engines that can."""
    names = [f"the {name}" for name in able(can)]
    if not names:
        return "no engine has them"
    listed = " or ".join(filter(None, (", ".join(names[:-1]), names[-1])))
    return f"take {listed} engine"


def _yields(part: Yielding, can: Capabilities) -> bool:
    return part in can.yielding


def _has_rollers(can: Capabilities) -> bool:
    return can.rollers


def _has_ties(can: Capabilities) -> bool:
    return can.ties


def _has_bonds(can: Capabilities) -> bool:
    return can.bonds
