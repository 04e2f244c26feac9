"""Engines by name.  Each is imported only when it is asked for.

Names that are not built in are looked for among the entry points of the group `GROUP`, by which
other packages add engines.  An entry point names what makes the engine when called without
arguments: its class, as a rule.
"""

from __future__ import annotations

from collections.abc import Callable
from importlib import import_module
from typing import TYPE_CHECKING, Any

from drystone.common.registry import outside

if TYPE_CHECKING:
    from importlib.metadata import EntryPoint

    from drystone.engines.base import Capabilities, Engine

#: Group of entry points of other packages' engines.
GROUP = "drystone.engines"

_ENGINES = {
    "equilibrium": ("drystone.statics.equilibrium", "EquilibriumEngine"),
    "nscd": ("drystone.dynamics.nscd", "NscdEngine"),
    "distinct": ("drystone.dynamics.distinct", "DistinctEngine"),
}
#: Engines of ours in packages of their own, found like those of others: what installs each, in the
#: folder of this source.
_APART = {"lmgc90": "pip install ./plugins/drystone-lmgc90"}


#: Names of our own engines.
BUILT_IN = tuple(_ENGINES)


def able(can: Callable[[Capabilities], bool]) -> tuple[str, ...]:
    """Names of our own engines with capabilities of some kind."""
    return tuple(name for name in BUILT_IN if can(_class(name).capabilities))


def _class(name: str) -> type[Engine[Any]]:
    """The class of one of our own engines."""
    module, attribute = _ENGINES[name]
    made: type[Engine[Any]] = getattr(import_module(module), attribute)
    return made


def engine_names() -> tuple[str, ...]:
    """Names that `make_engine` knows: ours, then those of other packages."""
    ours = (*_ENGINES, *_APART)
    return (*ours, *(name for name in _outside() if name not in ours))


def make_engine(name: str) -> Engine[Any]:
    """A new engine with its default settings.

    Raises
    ------
    EngineError
        There is no engine of that name, its package is not installed or cannot be loaded.
    """
    from drystone.engines.base import EngineError
    from drystone.engines.framed import framed

    if name in _ENGINES:
        return framed(_class(name)())
    entry = _outside().get(name)
    if entry is None and name in _APART:
        raise EngineError(
            f'the engine "{name}" is a package of its own and is not installed: '
            f"{_APART[name]}, in the folder of drystone's source"
        )
    if entry is None:
        known = ", ".join(engine_names())
        raise EngineError(f'there is no engine "{name}": take one of {known}')
    try:
        engine = entry.load()()
    except (ImportError, AttributeError, TypeError) as error:  # also of methods that are missing
        told = f'the engine "{name}" ({entry.value}) cannot be made: {error}'
        raise EngineError(told) from error
    return framed(checked(engine))


def checked(engine: object) -> Engine[Any]:
    """An engine of somebody else's; raises `EngineError` for what is none."""
    from drystone.engines.base import Engine, EngineError

    kind = type(engine)
    if not isinstance(engine, Engine):
        raise EngineError(
            f"{kind.__module__}.{kind.__qualname__} is no engine: derive the class from "
            "drystone.engines.base.Engine, and say what it can do in its capabilities "
            "(docs/own-engine.md)"
        )
    if not engine.name:
        raise EngineError(f"{kind.__module__}.{kind.__qualname__}: the engine has no name")
    return engine


def _outside() -> dict[str, EntryPoint]:
    return outside(GROUP)
