"""Controls: what to apply next, and when to stop, from what was applied and carried so far.

They know nothing of blocks or contacts and hold no state of their own.
"""

from drystone.control.base import Control, ControlError, Decision
from drystone.control.displacement import DisplacementControl, DisplacementSettings
from drystone.control.excess import ExcessControl, ExcessSettings
from drystone.control.excess_history import ExcessHistoryControl, ExcessHistorySettings
from drystone.control.history import HistoryControl, HistorySettings
from drystone.control.published import PublishedControl, PublishedSettings
from drystone.control.support_displacement import SupportControl, SupportSettings

__all__ = [
    "Control",
    "ControlError",
    "Decision",
    "DisplacementControl",
    "DisplacementSettings",
    "ExcessControl",
    "ExcessHistoryControl",
    "ExcessHistorySettings",
    "ExcessSettings",
    "HistoryControl",
    "HistorySettings",
    "PublishedControl",
    "PublishedSettings",
    "SupportControl",
    "SupportSettings",
]
