"""Limit analysis of a run: in a process beside it, where there is a processor for it."""

from __future__ import annotations

from concurrent.futures import Future
from dataclasses import replace
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from drystone.common.aside import Aside
    from drystone.limit.beside import Beside
    from drystone.model.model import Model
    from drystone.model.monitor import ControlPoint

#: Functions that the process is asked for.
LIMITS, PICTURES = "drystone.limit.beside", "drystone.report.folder.aside"

INTERRUPTED = "limit analysis was interrupted"


class Limits:
    """What limit analysis finds of the model that a run traces.

    Parameters
    ----------
    aside
        The process, which has been started; None where everything is done here.
    """

    def __init__(self, aside: Aside | None) -> None:
        self.aside = aside
        self._model: Model | None = None
        self._moved: ControlPoint | None = None
        self._going: Future[Any] | None = None
        self._found: Beside | None = None
        if aside is not None:  # before there is a model: importing takes long
            aside.begin(f"{LIMITS}:made_ready")

    def begin(self, model: Model) -> Model:
        """Begin with a model; the one to trace, whose control point is on a part that moves.

        The process goes on with the multipliers, and then makes ready to draw.
        """
        from drystone.limit import on_what_moves

        self._model = model
        if self.aside is None:
            return on_what_moves(model, self.found())
        moved = None
        if model.control_point.default and model.settlement is None:
            moved = self.aside.begin(f"{LIMITS}:moving_control", model)
        self._going = self.aside.begin(f"{LIMITS}:limits_beside", model)
        self.aside.begin(f"{PICTURES}:made_ready")
        if moved is not None:
            from drystone.common.aside import answer
            from drystone.limit.beside import moving_control

            self._moved = answer(moved, lambda: moving_control(model))
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
