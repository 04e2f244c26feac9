"""Senses of the load in an assessment: their names in files, and the folder of the second one."""

from __future__ import annotations

FORWARD, OPPOSITE = "along the load", "against the load"

#: In the folder of the first sense.
OPPOSITE_FOLDER = "opposite"

#: Beginning of the names of folders of several directions.
DIRECTION = "direction-"
