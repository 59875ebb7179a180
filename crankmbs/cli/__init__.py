"""The command line: prints and writes what the Python interface returns.

Exit status 0: done; 2: bad input, one message; 3: the run ended before its end, results written;
130: interrupted.
"""

from crankmbs.cli.app import app, main

__all__ = ["app", "main"]
