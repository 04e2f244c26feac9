"""A model: everything that one analysis needs, read from a file or put together in Python."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Any

import numpy as np

from drystone.common.arrays import Array
from drystone.common.errors import ModelError
from drystone.common.names import quoted
from drystone.common.ranges import RANGES, found
from drystone.common.vectors import direction_of
from drystone.geometry.mended import Mended
from drystone.model.assembly import Assembly, Corner
from drystone.model.history import History, history_of
from drystone.model.loading import DeadLoad, LoadPattern
from drystone.model.loading.acting import Acting
from drystone.model.monitor import ControlPoint
from drystone.model.settlement import Settlement
from drystone.model.site import AssessmentInput, Site
from drystone.model.ties import Tie

#: What becomes of an analysis where a part of the structure collapses.
REMOVE, STOP = "remove", "stop"

#: What settings may be that are words, as in files; engines may come from packages.
CHOICES = {"strategy": ("displacement", "published"), "falling": (REMOVE, STOP)}


@dataclass(frozen=True, kw_only=True)
class Analysis:
    """Settings of the analysis, as in the file.

    ``options`` are the numerical settings of strategy and engine, by name.
    """

    engine: str = "equilibrium"
    strategy: str = "displacement"  # or "published"
    stop_multiplier: float = 0.01  # load multiplier under which the curve ends, after the peak
    ground: float | None = None  # m; None: the supports' lowest point, see `Problem.level`
    falling: str | None = None  # `REMOVE` blocks that leave and go on, or `STOP` where a part
    # collapses; None leaves it to the command: an assessment stops, all else removes
    event_share: float = 0.5  # of its smallest extent, by which a block that moves by itself has
    # collapsed; see `event_log`
    max_penetration: float = 0.05  # of two blocks, over the smallest block: the published walls'
    # joints close by up to 0.01, and with 0.05 the block has another shape than the drawn one
    options: Mapping[str, float] = field(default_factory=dict)
    #: Files asked for beside the usual ones: name and keys of each.
    outputs: tuple[tuple[str, Mapping[str, Any]], ...] = ()


@dataclass(frozen=True, kw_only=True)
class Origin:
    """The file that a model was read from, and what it held."""

    path: str
    sha256: str  # of the file's bytes; with imports or a history's file, of its digest and theirs
    contents: tuple[Any, ...]  # `Model.contents` as read


@dataclass(frozen=True, kw_only=True, eq=False, repr=False)
class Model:
    """Assembly, load, control point and analysis, with where they came from.

    A model never changes. The methods ``with_...`` return a new model, which is checked like the
    first, and in which all derived data are updated. `dataclasses.replace` does the same without
    the checks.
    """

    title: str
    assembly: Assembly
    load: LoadPattern
    control_point: ControlPoint
    dead_loads: tuple[DeadLoad, ...] = ()  # beside the blocks' weight
    ties: tuple[Tie, ...] = ()
    settlement: Settlement | None = None  # of supports that move, in place of a load that grows
    history: History | None = None  # of the control displacement, where it goes to and fro
    analysis: Analysis = field(default_factory=Analysis)
    origin: Origin | None = None
    notes: tuple[str, ...] = ()
    """Sentences on what was amended or looks amiss in the file or the outlines."""
    mended: tuple[Mended, ...] = ()
    """What was done to which block of files that were imported."""
    site: Site | None = None
    """What the ground does, for an assessment; the curve does not depend on it."""
    assessment: AssessmentInput | None = None
    """How the curve is assessed; likewise."""

    @property
    def contents(self) -> tuple[Any, ...]:
        """What makes one model differ from another."""
        return (
            self.assembly,
            self.load,
            self.control_point,
            self.dead_loads,
            self.ties,
            self.settlement,
            self.history,
            self.title,
            self.analysis,
            self.site,
            self.assessment,
        )

    @cached_property
    def load_along(self) -> Array:
        """(dim,) unit vector that the load pattern as a whole leads along."""
        return self.load.along(self.assembly)

    @cached_property
    def acting(self) -> Acting:
        """All that acts on the structure as designed."""
        return Acting.of(self.assembly, self.load, self.dead_loads, self.ties)

    @property
    def load_force(self) -> float:
        """Sum [N] of the load pattern's forces along `load_along`, at multiplier one."""
        return self.acting.total

    @property
    def load_shown(self) -> Array | None:
        """Direction of the load for pictures; None if supports move instead."""
        return None if self.settlement is not None else self.load_along

    @property
    def parts_that_may_fall(self) -> frozenset[str]:
        """Ids of the blocks whose fall does not limit the structure, by [assessment]."""
        values = {} if self.assessment is None else self.assessment.values
        names = values.get("parts_that_may_fall", ())
        ids, groups = self.assembly.ids, self.assembly.groups
        return frozenset(
            member
            for name in names
            for member in ([ids[i] for i in groups[name]] if name in groups else [name])
        )

    @property
    def source(self) -> str | None:
        """Path of the model file; None where the model was varied since, or made in Python."""
        return self.origin.path if self.origin and self._as_read(self.origin) else None

    @cached_property
    def sha256(self) -> str:
        """Digest of the file's bytes, of those of its imports and of the file of its history;
        without `source`, of the model's own description."""
        if self.origin and self._as_read(self.origin):
            return self.origin.sha256
        from drystone.model.construction.describe import digest

        return digest(self)

    def _as_read(self, origin: Origin) -> bool:
        now, read = self.contents, origin.contents
        same = all(a is b for a, b in zip(now[:7], read[:7], strict=True))
        return same and now[7:] == read[7:]

    def with_joint(
        self, *, between: tuple[str, str] | None = None, **values: float | None
    ) -> Model:
        """The model with other values of the joint law.

        A law of a pair keeps those values in which it differs from the law of all other joints. Its
        other values change.

        Parameters
        ----------
        between
            Two block ids or two materials: only the law between them is changed, or created.
        values
            Values of `JointLaw` by name, for instance ``friction_coefficient=0.5``.

        Raises
        ------
        ModelError
            A joint cannot have such a value, or a name is not known.
        """
        from drystone.model.construction.vary import joints_with, remade

        return remade(self, **joints_with(self.assembly, between, values))

    def with_corner(self, *, radius: float | None = None, chamfer: float | None = None) -> Model:
        """The model with other corners [m]: rounded, chamfered, or by default sharp."""
        from drystone.model.construction.vary import remade

        return remade(self, corner=Corner(radius=radius, chamfer=chamfer))

    def with_load(
        self,
        pattern: LoadPattern | Sequence[float] | None = None,
        *,
        direction: Sequence[float] | None = None,
        dead_loads: Sequence[DeadLoad] | None = None,
    ) -> Model:
        """The model under another load: a pattern, its direction, or other dead loads.

        Instead of a pattern you may give a direction: ``model.with_load((-1, 0))``.

        Control block, point and direction follow the load where they are those that it has by
        default, named or not. Others stay. Supports that move do so under other dead loads, too;
        a pattern or a direction takes their place.
        """
        from drystone.model.construction.vary import control_beside_default, remade

        if isinstance(pattern, list | tuple | np.ndarray):
            if direction is not None:
                raise ModelError(["load: there are two directions: give one of them"])
            direction = direction_of(pattern, "load.direction").tolist()
            pattern = None
        kept = None if self.settlement is not None else self.load
        load: dict[str, Any] = {
            "load": kept if pattern is None else pattern,
            "load_direction": direction,
        }
        if self.settlement is None or pattern is not None or direction is not None:
            load["settlement"] = None
        if dead_loads is not None:
            load["dead_loads"] = tuple(dead_loads)
        return remade(self, **load, **control_beside_default(self))

    def with_ties(self, ties: Sequence[Tie]) -> Model:
        """The model with these ties and springs instead of its own."""
        from drystone.model.construction.vary import remade

        return remade(self, ties=tuple(ties))

    def with_settlement(self, settlement: Settlement) -> Model:
        """The model with supports that move, instead of the load pattern."""
        from drystone.model.construction.vary import remade

        return remade(self, settlement=settlement, load=None, history=None)

    def with_control(
        self,
        *,
        block: str | None = None,
        point: str | Sequence[float] | None = None,
        direction: Sequence[float] | None = None,
    ) -> Model:
        """The model with another control point. Arguments that are left out have the defaults of
        model files."""
        from drystone.model.construction.vary import remade

        return remade(self, control_block=block, control_point=point, control_direction=direction)

    def with_history(
        self,
        targets: Sequence[float] | None = None,
        *,
        amplitudes: Sequence[float] | None = None,
        cycles: int = 1,
    ) -> Model:
        """The model with control displacements that are reached one after another; monotonic if
        none is given.

        Parameters
        ----------
        targets
            Control displacements [m].
        amplitudes, cycles
            Instead of ``targets``: each amplitude [m] is reached in both senses, in this number of
            cycles. The last target is zero.

        Raises
        ------
        ModelError
            The displacements cannot be reached by a control point.
        """
        from drystone.model.construction.vary import remade

        return remade(self, history=history_of(targets, amplitudes, cycles))

    def with_analysis(
        self,
        *,
        engine: str | None = None,
        strategy: str | None = None,
        stop_multiplier: float | None = None,
        ground: float | None = None,
        falling: str | None = None,
        event_share: float | None = None,
        max_penetration: float | None = None,
        **options: float | None,
    ) -> Model:
        """The model with other settings of the analysis.

        Parameters
        ----------
        engine, strategy, stop_multiplier, ground, falling, event_share, max_penetration
            As in `Analysis`. Those that are left out do not change.
        options
            Settings by name, in addition to the present ones; None removes a setting.

        Raises
        ------
        ModelError
            A setting is no number, or what none can be.
        """
        wrong = [
            f"[analysis] {name}: must be a number, it is {found(value)}"
            for name, value in options.items()
            if value is not None and not isinstance(value, int | float | np.number)
        ]
        now = self.analysis
        given = {
            "engine": engine,
            "strategy": strategy,
            "stop_multiplier": stop_multiplier,
            "ground": ground,
            "falling": falling,
            "event_share": event_share,
            "max_penetration": max_penetration,
        }
        changes: dict[str, Any] = {name: x for name, x in given.items() if x is not None}
        for name, value in changes.items():
            problem = RANGES[name].problem(value) if name in RANGES else None
            if name in CHOICES and value not in CHOICES[name]:
                problem = f"must be {' or '.join(map(quoted, CHOICES[name]))}, it is {found(value)}"
            if problem:
                wrong.append(f"[analysis] {name}: {problem}")
        if wrong:
            raise ModelError(wrong)
        merged = {**now.options, **options}
        kept = {name: value for name, value in merged.items() if value is not None}
        analysis = replace(now, options=kept, **changes)
        return replace(self, analysis=analysis)

    def __repr__(self) -> str:
        along = ", ".join(f"{x:g}" for x in self.load_along)
        return (
            f"<Model {self.title!r}: {self.assembly!r}, pushed along ({along}), "
            f"{self.analysis.engine}>"
        )

    def _repr_html_(self) -> str:
        """The viewer with the model as designed, for notebooks."""
        from drystone.report.notebook import model_viewer

        return model_viewer(self)
