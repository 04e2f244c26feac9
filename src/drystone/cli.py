"""The command line: ``drystone COMMAND``.

Nothing is imported here before signals are seen to.
"""

from __future__ import annotations

import signal

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any


def main() -> None:
    """Entry point of the command ``drystone``.

    Ctrl-C ends it at once and silently while it is loaded, until a command takes care of it in
    `drystone.commands.outcome`.
    """
    if signal.getsignal(signal.SIGINT) is signal.default_int_handler:
        signal.signal(signal.SIGINT, signal.SIG_DFL)
    from drystone.commands.app import app

    app()


def __getattr__(name: str) -> Any:
    if name != "app":
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    from drystone.commands.app import app

    return app


if __name__ == "__main__":
    main()
