"""Many arrays for a kernel at the price of one argument.

Each array among the arguments of a kernel adds some 0.3 microseconds to every call.  A kernel of a
small structure may take forty arrays, and then the call costs more than the work.  So arrays that
stay the same objects are put into a box once.  A kernel takes the box as one argument, and reads
the arrays from its ``value``.
"""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any, Self

from numba.core import config

from drystone.common.compiled import njit

if config.DISABLE_JIT:

    def boxed(value: Any) -> Any:
        """A box of arrays, numbers, and tuples of them."""
        return SimpleNamespace(value=value)

else:
    from numba import typeof
    from numba.core import types
    from numba.experimental import structref

    @structref.register
    class BoxType(types.StructRef):  # type: ignore[name-defined]
        """The compiler's type of boxes."""

    class Box(structref.StructRefProxy):
        """A box as Python holds it; its ``value`` is for kernels that are interpreted."""

        value: Any

        def __new__(cls, value: Any) -> Self:
            """One that no compiled kernel can take: for `compilation.rehearse`."""
            box = object.__new__(cls)
            box._type, box.value = BoxType([("value", typeof(value))]), value
            return box

    structref.define_constructor(Box, BoxType, ["value"])
    structref.define_boxing(BoxType, Box)

    @njit(cache=True)
    def _boxed(value):  # type: ignore[no-untyped-def]
        return Box(value)

    def boxed(value: Any) -> Any:
        """A box of arrays, numbers, and tuples of them."""
        box = _boxed(value)
        box.value = value
        return box
