"""Conditions under which a curve stops, each given by a number in [analysis] and defined in a file
of its own."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass

from drystone.common.keys import NEEDED, Key, Number
from drystone.common.registry import Registry
from drystone.control.progress import End, Progress


@dataclass(frozen=True, kw_only=True)
class Stop:
    """A condition: its key in [analysis], and a function of the number and the progress that gives
    the end of the curve, or None if the curve goes on."""

    key: Key  # a number; with a default the condition always applies
    end: Callable[[float, Progress], End | None]
    first: bool = False  # whether it is checked before the strategy's own ends
    #: Whether the number is a control displacement [m] that the last step should not pass.
    is_displacement: bool = False

    def problem(self, value: float) -> str | None:
        """What is wrong with a value, as a sentence that begins with its key."""
        assert isinstance(self.key.type, Number)
        found = self.key.type.range.problem(value)
        return None if found is None else f"{self.key.name}: {found}"


#: By the names of their keys.
STOPS: Registry[Stop] = Registry(
    what="stop condition",
    group="drystone.stops",
    ours={
        "max_displacement": "drystone.control.stops.displacement:STOP",
        "max_steps": "drystone.control.stops.steps:STOP",
    },
)

#: Conditions with their numbers.
Stops = tuple[tuple[Stop, float], ...]


def stops_of(options: Mapping[str, float]) -> Stops:
    """The conditions that options name, and those that always apply."""
    found: list[tuple[Stop, float]] = []
    for name, stop in STOPS.own():
        default = None if stop.key.default is NEEDED else stop.key.default
        value = options.get(name, default)
        if value is not None:
            found.append((stop, value))
    others = [name for name in options if name not in STOPS.ours and name in STOPS]
    return (*found, *((STOPS[name], options[name]) for name in others))
