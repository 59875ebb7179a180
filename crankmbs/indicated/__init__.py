"""Measured cylinder pressures: what indicating systems write, to the table that a scene uses.

Reading, checking and referencing a signal belong here; what a run makes of it does not.
"""

from crankmbs.indicated.findings import CylinderPressure, Indicated
from crankmbs.indicated.read import read_pressure
from crankmbs.indicated.speed import MeasuredSpeed, read_speed

__all__ = ["CylinderPressure", "Indicated", "MeasuredSpeed", "read_pressure", "read_speed"]
