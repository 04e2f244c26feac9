"""The error that builders and files raise, by the name that they know it under."""

from __future__ import annotations

from drystone.common.errors import MAX_LISTED, ModelError

__all__ = ["MAX_LISTED", "ModelError"]
