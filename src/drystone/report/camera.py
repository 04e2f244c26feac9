"""From where a structure in space is seen: a parallel projection, obliquely from above.

Lines that are parallel stay so, and one scale holds in the whole picture.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from drystone.common.arrays import Array

#: Height of the camera over the horizon [degrees].
ELEVATION = 24.0
#: Turned away from the load direction by this much at least, and by this much more at most, where
#: the structure is long along the load: that side is then the one to see [degrees].
TURNED, FURTHER = 34.0, 34.0
#: A load steeper than this has no side that it comes from: horizontal part of its direction.
STEEP = 0.2


@dataclass(frozen=True, kw_only=True, eq=False)
class Camera:
    """Axes of the picture, unit vectors in the world's; ``towards`` leads to the viewer."""

    right: Array  # (3,)
    up: Array  # (3,)
    towards: Array  # (3,)

    @classmethod
    def before(cls, sides: Array, direction: Array | None = None) -> Camera:
        """A camera before a structure, so that what the load pushes comes nearer, and goes right.

        Parameters
        ----------
        sides
            Of the box around the structure, (3,) [m].
        direction
            Of the load, (3,); without one, or a vertical one, it is the shorter horizontal side.
        """
        along = np.zeros(3) if direction is None else np.array([*direction[:2], 0.0])
        if np.linalg.norm(along) < STEEP:
            along = np.array([0.0, -1.0, 0.0] if sides[0] >= sides[1] else [1.0, 0.0, 0.0])
        along /= np.linalg.norm(along)
        across = np.array([-along[1], along[0], 0.0])
        length, width = np.abs(along) @ sides, np.abs(across) @ sides
        away = np.radians(TURNED + FURTHER * length / max(length + width, 1e-300))
        level = np.cos(away) * along - np.sin(away) * across
        height = np.radians(ELEVATION)
        towards = np.cos(height) * level + np.sin(height) * np.array([0.0, 0.0, 1.0])
        right = np.cross([0.0, 0.0, 1.0], level)
        return cls(right=right, up=np.cross(towards, right), towards=towards)

    def seen(self, points: Array) -> Array:
        """Points (..., 3) [m] as places in the picture and nearness, (..., 3) [m]: to the right,
        up, and towards the viewer."""
        return np.asarray(points @ np.column_stack((self.right, self.up, self.towards)))
