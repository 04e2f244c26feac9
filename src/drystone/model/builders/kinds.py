"""All builders by the kinds that [[build]] names."""

from __future__ import annotations

from drystone.common.registry import Registry
from drystone.model.builders.base import Builder

#: A file each, which declares its keys as the parameters of a function.
BUILDERS: Registry[Builder] = Registry(
    what="kind",
    group="drystone.builders",
    ours={
        "panel": "drystone.model.builders.panel:PANEL",
        "plan": "drystone.model.builders.plan:PLAN",
        "column": "drystone.model.builders.column:COLUMN",
        "stack": "drystone.model.builders.column:STACK",
        "drum_column": "drystone.model.builders.drum_column:DRUM_COLUMN",
        "tower": "drystone.model.builders.tower:TOWER",
        "pyramid": "drystone.model.builders.pyramid:PYRAMID",
        "buttress": "drystone.model.builders.buttress:BUTTRESS",
        "arch": "drystone.model.builders.arch:ARCH",
        "portal": "drystone.model.builders.portal:PORTAL",
        "bridge": "drystone.model.builders.bridge:BRIDGE",
        "barrel_vault": "drystone.model.builders.barrel_vault:BARREL_VAULT",
        "groin_vault": "drystone.model.builders.groin_vault:GROIN_VAULT",
        "dome": "drystone.model.builders.dome:DOME",
        "spiral": "drystone.model.builders.spiral:SPIRAL",
        "rubble": "drystone.model.builders.rubble:RUBBLE",
    },
)
