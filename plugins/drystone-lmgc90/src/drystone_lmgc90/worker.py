"""The other side of the pipes: ``python -m drystone_lmgc90.worker DRIVER IN OUT``."""

from __future__ import annotations

import os
import sys
from importlib import import_module

from drystone_lmgc90.messages import Setup
from drystone_lmgc90.process import RemoteError, receive, send


def main(arguments: list[str]) -> None:
    """Answer messages until the pipe is closed."""
    driver = import_module(f"drystone_lmgc90.{arguments[0]}")
    incoming = os.fdopen(int(arguments[1]), "rb")
    outgoing = os.fdopen(int(arguments[2]), "wb")
    simulation = None
    while True:
        try:
            message = receive(incoming)
        except EOFError:
            break
        try:
            if isinstance(message, Setup):
                simulation = driver.Simulation(message)
                answer = simulation.ready
            else:
                assert simulation is not None
                answer = simulation.step(message)
        except Exception as error:
            answer = RemoteError(f"LMGC90: {type(error).__name__}: {error}")
        try:
            send(outgoing, answer)
        except BrokenPipeError:
            break
    # Fortran's own finalisers have been seen to fail; there is nothing left to save.
    sys.stdout.flush()
    os._exit(0)


if __name__ == "__main__":
    main(sys.argv[1:])
