"""How several directions take over a folder from the results before them."""

from __future__ import annotations

import time
import uuid
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Self

from drystone.io.results.checkpoint import CheckpointError, read_plan, write_plan
from drystone.io.results.folder import FolderLock, OutputError
from drystone.io.results.own_files import check_free, clear
from drystone.model.model import Model

#: A folder that is locked while a process takes over.  It stays until all directions have ended.
CLAIM = ".takes-over"
#: Seconds until a process that waits for another looks again.
WAIT = 0.01


def clear_claim(folder: Path) -> None:
    """Remove the claim from a folder that this process holds, once no direction needs it."""
    with suppress(OSError):
        (folder / CLAIM).rmdir()


@dataclass(frozen=True, kw_only=True, eq=False)
class TakingOver:
    """Removes earlier results and writes the plan, once, whichever direction comes first.

    Each direction calls it with its first point on the disk, so that earlier results stay where no
    direction gets that far.  Directions are traced by processes of their own.
    """

    folder: Path  # of all directions, which the process that started them holds
    model: Model
    plan: Mapping[str, Any]
    names: Sequence[str]  # of the folders of the directions

    @classmethod
    def of(cls, folder: Path, model: Model, plan: Mapping[str, Any], names: Sequence[str]) -> Self:
        """For a folder that this process holds; the plan is told from those of other runs.

        Raises
        ------
        OutputError
            A run of its own writes in the folder of a direction.
        """
        check_free(folder)
        clear_claim(folder)
        return cls(folder=folder, model=model, plan={**plan, "run": uuid.uuid4().hex}, names=names)

    def __call__(self) -> None:
        """Take over, unless a direction has; raises `OSError`, and earlier results stay."""
        with self._alone():
            if not self._is_done():
                write_plan(
                    self.folder, self.model, self.plan, lambda: clear(self.folder, keep=self.names)
                )

    def _is_done(self) -> bool:
        try:
            found = read_plan(self.folder)
        except CheckpointError:  # of another version
            return False
        return found is not None and found[1].get("run") == self.plan["run"]

    @contextmanager
    def _alone(self) -> Iterator[None]:
        """Hold the claim; a process that is killed meanwhile lets it go."""
        claim = self.folder / CLAIM
        claim.mkdir(exist_ok=True)
        while True:
            try:
                lock = FolderLock(claim)
                break
            except OutputError:
                time.sleep(WAIT)
        try:
            yield
        finally:
            lock.release()
