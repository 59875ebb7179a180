"""What a run amounts to: means, peaks, power and orders, with the motion between its samples; and
which numbers of a scene no machine has.

Differences from formulas or other runs belong in compare.
"""

from crankmbs.measures.engine_orders import EngineOrder, EngineOrders, engine_orders
from crankmbs.measures.estimate import Estimate
from crankmbs.measures.interpolate import interp
from crankmbs.measures.joints import JointForce
from crankmbs.measures.orders import Orders, orders
from crankmbs.measures.span import Span, last_span
from crankmbs.measures.summary import Measures, efficiency, fluctuation, mean_speed, measure

__all__ = [
    "EngineOrder",
    "EngineOrders",
    "Estimate",
    "JointForce",
    "Measures",
    "Orders",
    "Span",
    "efficiency",
    "engine_orders",
    "fluctuation",
    "interp",
    "last_span",
    "mean_speed",
    "measure",
    "orders",
]
