"""What is wrong with a model, said all at once."""

from __future__ import annotations

from collections.abc import Iterable

#: How many problems the text of an error lists before it counts the rest.
MAX_LISTED = 10


class ModelError(Exception):
    """A model that cannot be analysed.

    `problems` holds a sentence for each: the place, what is wrong there, and how to correct it.
    ``str(error)`` lists the first ten of them, one a line.
    """

    def __init__(self, problems: Iterable[str]) -> None:
        self.problems: list[str] = list(problems)
        super().__init__(*self.problems)

    def __reduce__(self) -> tuple[type[ModelError], tuple[list[str]]]:
        return type(self), (self.problems,)  # between processes, too

    def __str__(self) -> str:
        lines = self.problems[:MAX_LISTED]
        unlisted = len(self.problems) - len(lines)
        if unlisted:
            lines.append(f"... and {unlisted} more")
        return "\n".join(lines)
