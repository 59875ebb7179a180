"""V8, which computes in browsers, without a browser: for modules of the page that draw nothing."""

from concurrent.futures import ThreadPoolExecutor
from contextlib import contextmanager

from py_mini_racer import MiniRacer

_ATOB = """globalThis.atob = (text) =>
  Array.from(Uint8Array.fromBase64(text), (each) => String.fromCharCode(each)).join("");"""
"""All that they take of a browser, for the doubles that Python writes."""


@contextmanager
def running():
    """V8, whose `call` takes arguments and gives answers as JSON, which keeps every double; what is
    no finite number comes as None."""
    # in a thread of its own: beside a browser it would wait for playwright's loop, which waits
    with ThreadPoolExecutor(1) as alone:
        v8 = alone.submit(MiniRacer).result()
    with v8:
        v8.eval(_ATOB)
        yield v8
