"""Controls, which users know as strategies: they choose the next step, and end the curve.

They decide from the reports of the steps so far.  They know nothing of blocks or contacts.  A
control holds no state of its own: its state is passed to it with each report.
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
