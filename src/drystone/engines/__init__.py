"""Engines by name.  Each is imported only when it is asked for."""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from drystone.engines.base import Engine

_ENGINES = {
    "equilibrium": ("drystone.engines.equilibrium", "EquilibriumEngine"),
    "nscd": ("drystone.engines.nscd", "NscdEngine"),
}


def engine_names() -> tuple[str, ...]:
    """Names that `make_engine` knows."""
    return tuple(_ENGINES)


def make_engine(name: str) -> Engine:
    """A new engine with its default settings; raises `EngineError` for an unknown name."""
    from drystone.engines.base import EngineError

    if name not in _ENGINES:
        known = ", ".join(_ENGINES)
        raise EngineError(f'there is no engine "{name}": take one of {known}')
    module, attribute = _ENGINES[name]
    engine: Engine = getattr(import_module(module), attribute)()
    return engine
