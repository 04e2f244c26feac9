"""A study as it was read: a model, what varies in it, and what is asked of each sample."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property
from pathlib import Path
from typing import Any

from drystone.common.arrays import Array
from drystone.studies import designs
from drystone.studies.distributions import Law
from drystone.studies.paths import Keys

#: Columns of a sample that are neither parameters nor results.
ABOUT = ("sample", "seed", "status", "reason", "seconds", "version", "digest")

#: Columns of what each output tells, in their order; of "assess" more come with the method.
COLUMNS: dict[str, tuple[str, ...]] = {
    "curve": (
        "peak_multiplier", "peak_displacement", "peak_passed", "ultimate_displacement",
        "capacity_multiplier", "capacity_displacement", "max_residual", "max_penetration",
        "n_points", "certified",
    ),
    "limit": ("limit_associative", "limit_non_associative"),
    "assess": ("safety_index", "satisfied", "activation_multiplier"),
    "senses": (
        "safety_index", "satisfied", "activation_multiplier", "governing_sense",
        "governing_safety_index", "peak_multiplier_against", "capacity_multiplier_against",
        "safety_index_against", "satisfied_against", "activation_multiplier_against",
    ),
}  # fmt: skip

#: Columns of a curve of supports that move, N and m, or N m and rad; it has none of peaks.
REACTIONS = (
    "initial_reaction", "least_reaction", "least_reaction_at", "greatest_reaction",
    "greatest_reaction_at", "largest_motion", "stands",
)  # fmt: skip


@dataclass(frozen=True, kw_only=True)
class Parameter:
    """What varies: its name, where it stands in the model file, and how it gets there."""

    name: str
    paths: tuple[Keys, ...]
    apply: str = "set"  # "multiply" and "add" change what the file says


@dataclass(frozen=True, kw_only=True)
class Imperfection:
    """What differs from the design in each sample."""

    vertices: float | None = None  # m, standard deviation of how far corners are worn off
    unit_sizes: float | None = None  # ratio, by which lengths of units and heights of courses vary
    missing: float | None = None  # probability of a block
    loose: float | None = None  # probability of a block
    loose_gap: float | None = None  # m, by which a loose block is smaller
    blocks: tuple[str, ...] = ()  # ids or groups, with * and ?; all that are no supports by default


@dataclass(frozen=True, kw_only=True)
class Task:
    """What a sample is computed from, beside its values: all that workers are told."""

    model: Mapping[str, Any] | None  # the model file as nested dicts
    function: str | None  # "module:name" in place of a model
    folder: str  # of the study, from where modules are looked for
    source: str | None  # path of the model file
    module: str | None = None  # path of the function's file; None: Python looks for it
    files: Mapping[str, str] | None = None  # texts that the model names; None: it reads them
    parameters: tuple[Parameter, ...] = ()
    outputs: tuple[str, ...] = ()
    seed: int = 1
    shared: tuple[int, ...] = (0,)  # which samples have the same seed, see `designs.sharing`
    engine: str | None = None
    strategy: str | None = None
    points: int = 64  # of each curve in curves.parquet
    timeout: float | None = None  # s
    imperfection: Imperfection | None = None

    @property
    def names(self) -> tuple[str, ...]:
        """Of the parameters."""
        return tuple(parameter.name for parameter in self.parameters)

    def varying(self, parameter: Parameter) -> Task:
        """The task with one of its parameters alone."""
        return replace(self, parameters=(parameter,))

    def seed_at(self, sample: int) -> int:
        """Of what is drawn for a sample."""
        return designs.seed_of(self.seed, sample, self.shared)


@dataclass(frozen=True, kw_only=True)
class Study:
    """A study file, read and checked."""

    title: str
    design: str
    n: int  # samples, or base samples of "saltelli" and "morris"
    task: Task
    laws: tuple[Law, ...]
    steps: tuple[int | None, ...]
    levels: int = 4
    second_order: bool = False
    correlation: Array | None = None
    fragility: tuple[Mapping[str, Any], ...] = ()
    target: Mapping[str, Any] | None = None
    given: Mapping[str, Any] = field(default_factory=dict)  # the file as it was
    source: Path | None = None

    @property
    def seed(self) -> int:
        """Of all that is drawn."""
        return self.task.seed

    @property
    def count(self) -> int:
        """How many samples there are."""
        return designs.count(self.design, self.n, self.laws, self.steps, self.second_order)

    @cached_property
    def values(self) -> list[list[Any]]:
        """Values of all samples, a list for each parameter."""
        return designs.values_of(
            self.design,
            self.n,
            self.laws,
            seed=self.seed,
            steps=self.steps,
            levels=self.levels,
            second_order=self.second_order,
            correlation=self.correlation,
        )

    def values_at(self, sample: int) -> list[Any]:
        """Values of the parameters of a sample."""
        return [column[sample] for column in self.values]

    @cached_property
    def digests(self) -> dict[str, str]:
        """SHA-256 of all that the samples' numbers follow from, beside the version; by what it is.

        It is found once, before samples are computed.  Of designs that grow, how many samples are
        asked for is no part of it.
        """
        from drystone.studies.digests import digests_of

        return digests_of(self)

    @property
    def fingerprint(self) -> str:
        """One digest of all of them."""
        return hashlib.sha256(json.dumps(self.digests, sort_keys=True).encode()).hexdigest()
