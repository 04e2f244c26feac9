"""Formats of drawings by name: one file each, which declares a `Format`."""

from __future__ import annotations

from typing import TYPE_CHECKING

from drystone.common.registry import Registry

if TYPE_CHECKING:
    from drystone.io.drawings.format import Format

FORMATS: Registry[Format] = Registry(
    what="format",
    group="drystone.drawings",
    ours={
        "obj": "drystone.io.drawings.obj:FORMAT",
        "ply": "drystone.io.drawings.ply:FORMAT",
        "stl": "drystone.io.drawings.stl:FORMAT",
        "compas": "drystone.io.drawings.compas:FORMAT",
        "dxf": "drystone.io.drawings.dxf:FORMAT",
        "bodies": "drystone.io.drawings.bodies:FORMAT",
        "ifc": "drystone.io.drawings.ifc:FORMAT",
    },
)
