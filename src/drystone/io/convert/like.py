"""What a model file of other blocks takes over from a model file: all that names none of these."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from drystone.io.modelfile.named import files_named
from drystone.io.modelfile.parse import parse
from drystone.io.modelfile.read import pair_named
from drystone.model.assembly import Block
from drystone.model.construction.contents import read_bytes
from drystone.model.construction.errors import ModelError
from drystone.model.construction.words import listed

#: Tables that are taken over from another model file.
TAKEN = (
    "thickness",
    "material",
    "joint",
    "corner",
    "contact",
    "load",
    "control",
    "analysis",
    "output",
    "site",
    "assessment",
)
#: Tables that name blocks of their own file, or places on them.
LEFT = ("dead_load", "tie", "spring", "settlement", "group")
#: Keys of tables that name a block, or a place on it.
NAMING = ("block", "group", "point")
#: Keys of lists of names.
NAMES = ("parts_that_may_fall",)


def tables_of(like: Path) -> tuple[dict[str, Any], list[str]]:
    """The tables that are taken from a model file, and a note on those that are not.

    Raises
    ------
    ModelError
        The file cannot be read.
    """
    try:
        given = parse(read_bytes(like, "the model file"), is_json=like.suffix.lower() == ".json")
    except ModelError as error:
        raise ModelError(f"{like}: {problem}" for problem in error.problems) from None
    known, left = {}, []
    for key, table in given.items():
        if key in LEFT or (key in TAKEN and files_named({key: table})):
            left.append(f"[{key}]")
        elif key in TAKEN or key == "dimension":
            known[key] = table
    note = f"{like}: {', '.join(left)} left out: blocks or files of that model are named there"
    return known, [note] if left else []


def fitting(
    tables: Mapping[str, Any], blocks: Sequence[Block], like: Path
) -> tuple[dict[str, Any], list[str]]:
    """The tables without what names blocks or groups that are not there, and a note on that.

    A load is left out as a whole where nothing is left of its forces.
    """
    ids = {block.id for block in blocks}
    groups = {name for block in blocks for name in block.groups}
    left: list[str] = []
    kept = {key: _fitting(table, ids | groups, left) for key, table in tables.items()}
    load = tables.get("load")
    if isinstance(load, Mapping) and load.keys() - kept["load"].keys():
        del kept["load"]
    joint, materials = kept.get("joint"), kept.get("material")
    if isinstance(joint, Mapping) and isinstance(between := joint.get("between"), Mapping):
        known = set(materials) if isinstance(materials, Mapping) else set()
        pairs = [pair for pair in between if _is_pair(pair, ids, known, frozenset(groups))]
        left += [pair for pair in between if pair not in pairs]
        kept["joint"] = {**joint, "between": {pair: between[pair] for pair in pairs}}
    if not left:
        return kept, []
    return kept, [
        f"{like}: what is said of {listed(list(dict.fromkeys(left)))} was left out: no block or "
        "group of the drawing is called so"
    ]


def _fitting(value: Any, names: set[str], left: list[str]) -> Any:
    """A value of a model file without what names others than ``names``; they go to ``left``.

    A table of a list goes as a whole, and a list with its last entry.  Another table loses the keys
    that name something.
    """
    if not isinstance(value, Mapping):
        return value
    if unknown := _unknown(value, names):
        left += unknown
        value = {key: inner for key, inner in value.items() if key not in NAMING}
    kept = {}
    for key, inner in value.items():
        if not isinstance(inner, list):
            kept[key] = _fitting(inner, names, left)
            continue
        entries = []
        for entry in inner:
            unknown = [entry] if key in NAMES and entry not in names else _unknown(entry, names)
            left += unknown
            entries += [] if unknown else [entry]
        if entries or not inner:
            kept[key] = entries
    return kept


def _unknown(value: Any, names: set[str]) -> list[str]:
    """Blocks and groups that a table names, and that are not among ``names``."""
    if not isinstance(value, Mapping):
        return []
    named = (value.get(key) for key in ("block", "group"))
    return [name for name in named if isinstance(name, str) and name not in names]


def _is_pair(pair: str, ids: set[str], materials: set[str], groups: frozenset[str]) -> bool:
    try:
        pair_named(pair, ids, materials, groups)
    except ModelError:
        return False
    return True
