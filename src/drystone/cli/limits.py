"""Limit analysis of a run: in a process beside it, where there is a processor for it."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, Any, Self

if TYPE_CHECKING:
    from concurrent.futures import Future

    from drystone.common.aside import Aside
    from drystone.limit.beside import Beside
    from drystone.model.model import Model
    from drystone.model.monitor import ControlPoint

#: Functions that the process is asked for.
LIMITS, PICTURES = "drystone.limit.beside", "drystone.report.folder.aside"

INTERRUPTED = "limit analysis was interrupted"


class Limits:
    """What limit analysis finds of the model that a run traces.

    A process that it has ends with the ``with`` statement.

    Parameters
    ----------
    aside
        The process, which has been started; None where everything is done here.
    """

    def __init__(self, aside: Aside | None) -> None:
        self.aside = aside
        self._model: Model | None = None
        self._moving: Future[ControlPoint | None] | None = None
        self._moved: ControlPoint | None = None
        self._going: Future[Any] | None = None
        self._found: Beside | None = None
        if aside is not None:  # before there is a model: importing takes long
            aside.begin(f"{LIMITS}:made_ready")

    @classmethod
    def where_it_helps(cls) -> Self:
        """In a process of its own, where another processor has nothing to do."""
        from drystone.common.aside import Aside

        return cls(Aside.where_it_helps())

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *error: object) -> None:
        self.end()

    def end(self) -> None:
        """End the process, if there is one, with what it does."""
        if self.aside is not None:
            self.aside.end()

    def begin(self, model: Model) -> None:
        """Let the process, if there is one, begin with a model, and then make ready to draw."""
        self._model = model
        if self.aside is None:
            return
        if model.control_point.default and model.settlement is None:
            self._moving = self.aside.begin(f"{LIMITS}:moving_control", model)
        self._going = self.aside.begin(f"{LIMITS}:limits_beside", model)
        self.aside.begin(f"{PICTURES}:made_ready")

    def to_trace(self) -> Model:
        """The model with its control point on a part that moves; waits for where that is."""
        from drystone.common.aside import answer
        from drystone.limit.beside import moving_control, on_what_moves

        model = self._model
        assert model is not None
        if self.aside is None:
            return on_what_moves(model, self.found())
        if self._moving is None:
            return model
        self._moved = answer(self._moving, lambda: moving_control(model))
        return model if self._moved is None else replace(model, control_point=self._moved)

    def found(self) -> Beside:
        """What was found; waits for it.  A user who interrupts the waiting does without."""
        from drystone.limit.beside import Beside

        if self._found is None:
            try:
                self._found = self._wait()
            except KeyboardInterrupt:
                if self._going is None:
                    raise
                self._found = Beside(note=INTERRUPTED)
        return self._found

    def _wait(self) -> Beside:
        from threadpoolctl import threadpool_limits

        from drystone.common.aside import answer
        from drystone.limit import limits_beside

        model = self._model
        assert model is not None

        def here() -> Beside:
            # As in the process, so that numbers are the same to the last bit.
            with threadpool_limits(limits=1, user_api="blas"):
                return limits_beside(model)

        found = answer(self._going, here)
        return found if self._moved is None else replace(found, fastest=self._moved)
