"""[group.NAME]: blocks put into groups by their ids."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace

from drystone.io.drawings.patterns import expression
from drystone.io.modelfile.schema import GroupSection
from drystone.io.modelfile.sentences import place_of
from drystone.model.assembly import Block
from drystone.model.construction.words import quoted, suggestion


def grouped(
    blocks: Sequence[Block], groups: Mapping[str, GroupSection], problems: list[str]
) -> list[Block]:
    """The blocks with the groups that the file puts them into, after those of their own.

    A sentence on every pattern that no block's id has is added to ``problems``.
    """
    blocks = list(blocks)
    ids = [block.id for block in blocks]
    for name, section in groups.items():
        rows: set[int] = set()
        for k, pattern in enumerate(section.blocks):
            fits = expression(pattern).fullmatch
            found = {i for i, own in enumerate(ids) if fits(own)}
            if not found:
                place = place_of(("group", name, "blocks", k), {})
                problems.append(f"{place}: {nothing_fits(pattern, ids)}")
            rows |= found
        for i in sorted(rows):
            block = blocks[i]
            blocks[i] = replace(
                block,
                groups=tuple(dict.fromkeys((*block.groups, name))),
                support=block.support or section.support,
            )
    return blocks


def nothing_fits(pattern: str, ids: Sequence[str]) -> str:
    """Sentence on a pattern that fits no block."""
    if "*" in pattern or "?" in pattern:
        first = f", the first is {quoted(ids[0])}" if ids else ""
        return f"no block has an id like {quoted(pattern)}{first}"
    return f"there is no block {quoted(pattern)}: {suggestion(pattern, list(ids))}"
