"""Measured cylinder pressures: what indicating systems write, to the table that a scene uses.

Reading, checking and referencing a signal belong here; what a run makes of it does not.
"""

from crankmbs.indicated.found import CylinderPressure, Indicated
from crankmbs.indicated.read import read_pressure

__all__ = ["CylinderPressure", "Indicated", "read_pressure"]
