"""Measured cylinder pressures: what indicating systems write, to the table that a scene uses.

Reading, checking and referencing a signal belong here; what a run makes of it does not.
"""
