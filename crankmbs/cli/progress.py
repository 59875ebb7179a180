"""A sign of life for work that takes longer than a second."""

from __future__ import annotations

import sys
from collections.abc import Iterator
from contextlib import contextmanager
from threading import Timer

__all__ = ["progress"]

_PATIENCE = 1.0  # s


@contextmanager
def progress(task: str) -> Iterator[None]:
    """Show a bar and the time elapsed on a terminal's stderr, from the second second on.

    How far the work has come is not known, so the bar only moves; it is gone when the work is.
    """
    if not sys.stderr.isatty():
        yield
        return
    from rich.console import Console
    from rich.progress import BarColumn, Progress, TextColumn, TimeElapsedColumn

    bar = Progress(
        TextColumn("{task.description}", markup=False),
        BarColumn(),
        TimeElapsedColumn(),
        console=Console(stderr=True),
        transient=True,
    )
    bar.add_task(task, total=None)
    timer = Timer(_PATIENCE, bar.start)
    timer.daemon = True
    timer.start()
    try:
        yield
    finally:
        timer.cancel()
        timer.join()  # or the bar could start after it was stopped
        bar.stop()
