"""The command line: prints and writes what the Python interface returns.

Exit status 0: done; 2: bad input or output, one message; 3: the run ended before its end, results
written; 130: interrupted; 141: nobody reads the output on, files written.
"""

from crankmbs.cli.app import app, main

__all__ = ["app", "main"]
