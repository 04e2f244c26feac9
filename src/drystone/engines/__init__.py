"""Engines by name.  Each is imported only when it is asked for.

An entry point of another package names a callable without arguments that makes the engine, usually
its class.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Any

from drystone.common.registry import Registry, RegistryError

if TYPE_CHECKING:
    from drystone.engines.base import Capabilities, Engine

#: Our own engine classes, and the callables that make engines of other packages.
ENGINES: Registry[Callable[[], object]] = Registry(
    what="engine",
    group="drystone.engines",
    ours={
        "equilibrium": "drystone.statics.equilibrium:EquilibriumEngine",
        "nscd": "drystone.dynamics.nscd:NscdEngine",
        "distinct": "drystone.dynamics.distinct.engine:DistinctEngine",
    },
)
#: Our own engines in separate packages, which are found like those of others; and the command that
#: installs each, in the folder of drystone's source.
_APART = {"lmgc90": "pip install ./plugins/drystone-lmgc90"}


#: Names of our own engines.
BUILT_IN = tuple(ENGINES.ours)


def able(can: Callable[[Capabilities], bool]) -> tuple[str, ...]:
    """Names of our own engines whose capabilities fulfil a condition."""
    classes: Any = ENGINES.own()
    return tuple(name for name, own in classes if can(own.capabilities))


def engine_names() -> tuple[str, ...]:
    """Names that `make_engine` knows: our own engines, then those of other packages."""
    return tuple(dict.fromkeys((*BUILT_IN, *_APART, *ENGINES.names())))


def make_engine(name: str) -> Engine[Any]:
    """Make a new engine with its default settings.

    Raises
    ------
    EngineError
        There is no engine of this name, or its package is not installed or cannot be loaded.
    """
    from drystone.engines.base import EngineError
    from drystone.engines.framed import framed

    if name not in ENGINES:
        if name in _APART:
            raise EngineError(
                f'the engine "{name}" is a package of its own and is not installed: '
                f"{_APART[name]}, in the folder of drystone's source"
            )
        known = ", ".join(engine_names())
        raise EngineError(f'there is no engine "{name}": take one of {known}')
    try:
        engine = ENGINES[name]()
    except RegistryError as error:
        raise EngineError(str(error)) from error
    except (ImportError, TypeError) as error:  # a package or an abstract method is missing
        told = f'the engine "{name}" ({ENGINES.place(name)}) cannot be made: {error}'
        raise EngineError(told) from error
    return framed(checked(engine))


def checked(engine: object) -> Engine[Any]:
    """Check an object made by another package; raises `EngineError` if it is no engine."""
    from drystone.engines.base import Engine, EngineError

    kind = type(engine)
    if not isinstance(engine, Engine):
        raise EngineError(
            f"{kind.__module__}.{kind.__qualname__} is no engine: derive the class from "
            "drystone.engines.base.Engine, and say what it can do in its capabilities "
            "(docs/howto/own-engine.md)"
        )
    if not engine.name:
        raise EngineError(f"{kind.__module__}.{kind.__qualname__}: the engine has no name")
    return engine
