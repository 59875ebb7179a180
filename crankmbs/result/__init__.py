"""What a run gives: its labelled data, with an error for every variable, kept in files and tables.

What floors above make of it, measures and figures, are methods here all the same: each imports
what it calls when it is called.
"""

from crankmbs.result.record import Cost, Error, Result

__all__ = ["Cost", "Error", "Result"]
