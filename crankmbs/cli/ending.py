"""How a command ends that does not reach its end: a message and an exit status, no traceback."""

from __future__ import annotations

import os
import signal
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any, TextIO

from typer import Exit, echo

from crankmbs.errors import CrankmbsError

__all__ = ["ending", "listen"]

_MEMORY = (
    "this machine has not enough memory for it; give a wider run.every, or "
    'every = "none" to keep the last cycle alone'
)

_interrupts: list[int] = []


def listen() -> None:
    """Keep in mind that there was an interrupt: a library that is being imported may make another
    error of it."""

    def interrupt(number: int, _: Any) -> None:
        _interrupts.append(number)
        raise KeyboardInterrupt

    if signal.getsignal(signal.SIGINT) is signal.default_int_handler:  # not of one in background
        signal.signal(signal.SIGINT, interrupt)


@contextmanager
def ending() -> Iterator[None]:
    """Exit 2 for what cannot be, 130 for an interrupt, 141 where nobody reads the output on."""
    try:
        yield
    except CrankmbsError as error:
        raise _exit(2, f"error: {error}") from None
    except MemoryError:
        raise _exit(2, f"error: {_MEMORY}") from None
    except KeyboardInterrupt:
        raise _exit(130, "interrupted") from None
    except BrokenPipeError:  # head, or a pager that was left
        _close(sys.stdout)
        raise Exit(141) from None
    except OSError as error:
        if error.filename is not None:  # no error of the output
            raise
        _close(sys.stdout)
        why = f"standard output cannot be written ({error.strerror})"
        raise _exit(2, f"error: {why}; send it elsewhere") from None
    except Exception:
        if _interrupts:
            raise _exit(130, "interrupted") from None
        raise


def _exit(status: int, message: str) -> Exit:
    try:
        echo(message, err=True)
    except OSError:  # stderr is as full
        _close(sys.stderr)
    return Exit(status)


def _close(stream: TextIO) -> None:
    """Send what is still to be written nowhere, or Python would fail once more when it ends."""
    nowhere = os.open(os.devnull, os.O_WRONLY)
    os.dup2(nowhere, stream.fileno())
    os.close(nowhere)
