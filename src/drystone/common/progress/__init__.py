"""Progress on standard error: on the command line, and where somebody watches in Python."""

from drystone.common.progress.points import Progress, progress_for
from drystone.common.progress.watched import counted, somebody_watches

__all__ = ["Progress", "counted", "progress_for", "somebody_watches"]
