"""LMGC90 itself as an engine: the same models, controls and results over the real program.

LMGC90 keeps one simulation per process, prints what it likes and ends in a Fortran stop where it
cannot go on.  So it runs in a process of its own (`worker`), spoken to over two pipes (`process`);
`wheel` and `chipy` are the two ways of driving it there, `messages` is what goes over the pipes
and `engine` is what the pushover sees.
"""

from drystone_lmgc90.engine import Lmgc90Engine, Lmgc90Settings

__all__ = ["Lmgc90Engine", "Lmgc90Settings"]
