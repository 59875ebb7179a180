"""The server of the live page: this machine only, nothing from other hosts."""

from __future__ import annotations

import signal
from collections.abc import Callable
from typing import Any

from bokeh.document import Document
from bokeh.server.server import Server

from crankmbs.demo.live import Live
from crankmbs.demo.outcome import prepared, run
from crankmbs.errors import InputError
from crankmbs.scene.scene import Scene

__all__ = ["serve"]

_LAST_PORT = 65535


def serve(scene: Scene, stem: str, port: int, ready: Callable[[str, Server], None]) -> None:
    """Serve the page of a scene until interrupted.

    Parameters
    ----------
    port : 0 takes a free one; ready : called with the address of the page, and the server

    Raises
    ------
    InputError : the scene stops before its end, or the port is none or taken
    """
    if not 0 <= port <= _LAST_PORT:
        raise InputError(f"--port must be from 0, a free one, to {_LAST_PORT}; {port} came")
    start = prepared(scene)
    outcome = run(start)

    def fill(document: Document) -> None:
        Live(start, outcome, stem).add_to(document)

    try:
        server = Server({"/": fill}, port=port, address="127.0.0.1")
    except OSError as error:
        raise InputError(
            f"--port {port}: cannot be used ({error.strerror}); choose another, or 0 for a free one"
        ) from None
    server.start()
    loop: Any = server.io_loop

    def stop(*_: object) -> None:  # KeyboardInterrupt would be lost where Python tidies up
        loop.asyncio_loop.call_soon_threadsafe(loop.stop)

    before = signal.signal(signal.SIGINT, stop)
    try:
        ready(f"http://localhost:{server.port}/", server)
        loop.start()
    finally:
        signal.signal(signal.SIGINT, before)
        server.stop()
