"""The contract of a control."""

from __future__ import annotations

from dataclasses import Field, dataclass, fields
from typing import TYPE_CHECKING, Any, ClassVar, Generic, Protocol, TypeVar

from drystone.common.ranges import problem
from drystone.control.progress import End
from drystone.engines.base import Demand, StepReport

if TYPE_CHECKING:
    from drystone.control.stops import Stops

#: What one control remembers.  Only this control reads it.
Memory = TypeVar("Memory")


class ControlError(ValueError):
    """Settings that make no sense together; the message is for the user."""


class Settings(Protocol):
    """A dataclass of the settings of a strategy."""

    __dataclass_fields__: ClassVar[dict[str, Field[Any]]]

    @property
    def stops(self) -> Stops:
        """Conditions that end the curve, beside those of the strategy."""
        ...


def check_settings(settings: Settings) -> None:
    """Raise `ControlError` for the first of a strategy's settings that is out of its range."""
    for field in fields(settings):
        value = getattr(settings, field.name)
        wrong = problem(field.name, value) if value != field.default else None
        if wrong:
            raise ControlError(wrong)
    for stop, value in settings.stops:
        if wrong := stop.problem(value):
            raise ControlError(wrong)


@dataclass(frozen=True, kw_only=True)
class Decision(Generic[Memory]):
    """What a control decides after a step.

    `accept` says whether the step becomes a point of the curve; if not, the next step starts from
    the same state again.  `demand` is the next step; it is None if the analysis is over, for the
    `reason` given.  `load_multiplier` is the multiplier that the curve shows at the point.
    `dynamic` says that the point was passed in motion.
    """

    accept: bool
    demand: Demand | None
    state: Memory  # the control's own state, passed back to it with the next report
    reason: str = ""
    load_multiplier: float = 0.0
    dynamic: bool = False
    jumped: bool = False  # see `CurvePoint`
    finished: bool = False  # over because the curve is complete, not because it cannot go on
    #: Load multipliers that the curve shows at the dynamic points within the step, see
    #: `StepPath.dynamic_states`: of all these points, or of none if the step is tried again.
    dynamic_multipliers: tuple[float, ...] = ()


class Strategy(Generic[Memory]):
    """Base class of the strategies: their settings, and how they make a decision."""

    def __init__(self, settings: Any) -> None:
        self.settings = settings

    def _demand(self, state: Memory) -> Demand:
        raise NotImplementedError

    def _decided(
        self, state: Memory, end: End | None = None, *, accept: bool = True, **shown: Any
    ) -> Decision[Memory]:
        """A decision to go on from a state, to try the step again (without ``accept``), or to end.

        ``shown`` are further fields of the `Decision`.
        """
        return Decision(
            accept=accept,
            demand=None if end else self._demand(state),
            state=state,
            reason=end.reason if end else "",
            finished=end is not None and end.finished,
            **shown,
        )

    def again(self, state: Memory) -> Decision[Memory]:
        """Go on from what was remembered; the settings may have another end than then."""
        return self._decided(state)


class Control(Protocol[Memory]):
    """A strategy that traces the curve."""

    def first(self, report: StepReport) -> Decision[Memory]:
        """The first demand, of the structure at rest under its dead load."""
        ...

    def again(self, state: Memory) -> Decision[Memory]:
        """What to demand of a run that stopped, from what the control remembers."""
        ...

    def decide(self, state: Memory, demand: Demand, report: StepReport) -> Decision[Memory]:
        """Whether to accept a step, and what to demand next."""
        ...
