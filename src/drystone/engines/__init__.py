"""Engines by name.  Each is imported only when it is asked for.

Names that are not built in are looked for among the entry points of the group `GROUP`, by which
other packages add engines.  An entry point names what makes the engine when called without
arguments: its class, as a rule.
"""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from importlib.metadata import EntryPoint

    from drystone.engines.base import Engine

#: Group of entry points of other packages' engines.
GROUP = "drystone.engines"

_ENGINES = {
    "equilibrium": ("drystone.statics.equilibrium", "EquilibriumEngine"),
    "nscd": ("drystone.dynamics.nscd", "NscdEngine"),
    "distinct": ("drystone.dynamics.distinct", "DistinctEngine"),
    "lmgc90": ("drystone.dynamics.lmgc90", "Lmgc90Engine"),
}


def engine_names() -> tuple[str, ...]:
    """Names that `make_engine` knows: ours, then those of other packages."""
    return (*_ENGINES, *(name for name in _outside() if name not in _ENGINES))


def make_engine(name: str) -> Engine:
    """A new engine with its default settings.

    Raises
    ------
    EngineError
        There is no engine of that name, or another package's cannot be loaded.
    """
    from drystone.engines.base import EngineError
    from drystone.engines.framed import framed

    make: Any
    if name in _ENGINES:
        module, attribute = _ENGINES[name]
        make = getattr(import_module(module), attribute)
    else:
        entry = _outside().get(name)
        if entry is None:
            known = ", ".join(engine_names())
            raise EngineError(f'there is no engine "{name}": take one of {known}')
        try:
            make = entry.load()
        except (ImportError, AttributeError) as error:
            raise EngineError(
                f'the engine "{name}" ({entry.value}) cannot be loaded: {error}'
            ) from error
    engine: Engine = framed(make())
    return engine


def _outside() -> dict[str, EntryPoint]:
    """Engines of other packages by name; of two with one name the first found."""
    from importlib.metadata import entry_points  # takes longer than all the rest here

    found: dict[str, EntryPoint] = {}
    for entry in entry_points(group=GROUP):
        found.setdefault(entry.name, entry)
    return found
