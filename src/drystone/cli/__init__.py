"""The command line: ``drystone COMMAND``; one file for each command.

What a command needs of the library is imported when it runs, so that ``--help`` answers at once;
nothing is imported here before signals are seen to.  Before that, Ctrl-C is answered by Python with
a traceback: while it starts by itself, and while the script that an installer has made imports
`re`.
"""

import _signal  # `signal` makes enumerations of it, which takes longer than all else here

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any


def main() -> None:
    """Entry point of the command ``drystone``.

    Ctrl-C ends it at once and silently while it is loaded, until a command takes care of it in
    `drystone.cli.outcome`.
    """
    if _signal.getsignal(_signal.SIGINT) is _signal.default_int_handler:
        _signal.signal(_signal.SIGINT, _signal.SIG_DFL)
    import sys

    from drystone.common.importing import importing

    begun, wanted = None, "".join(sys.argv[1:2])
    with importing():
        if wanted == "run":  # its other process takes as long as this one to be ready
            from drystone.cli.limits import Limits

            begun = Limits.where_it_helps()
        from drystone.cli.program import program

        app = program(wanted)
    app(obj=begun)


def __getattr__(name: str) -> "Any":
    if name != "app":
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    from drystone.cli.program import program

    return program()
