"""What a run amounts to: means, peaks, power and orders, with the motion between its samples; and
which numbers of a scene no machine has.

Differences from formulas or other runs belong in compare.
"""

from crankmbs.measures.joints import Estimate, JointForce
from crankmbs.measures.orders import Orders, orders
from crankmbs.measures.summary import Measures, fluctuation, mean_speed, measure
from crankmbs.measures.window import Window, last_window

__all__ = [
    "Estimate",
    "JointForce",
    "Measures",
    "Orders",
    "Window",
    "fluctuation",
    "last_window",
    "mean_speed",
    "measure",
    "orders",
]
