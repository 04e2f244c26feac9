"""Progress on standard error: on the command line, and where somebody watches in Python."""

from drystone.progress.points import Progress, progress_for
from drystone.progress.watched import counted, somebody_watches

__all__ = ["Progress", "counted", "progress_for", "somebody_watches"]
