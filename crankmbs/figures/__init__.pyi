"""The figures and where each lives."""

from .bearings import bearings_figure
from .compare import budget_figure, comparison_figure, save_validation
from .cycles import cycles_figure, transient_figure
from .design import (
    balance_figure,
    flywheel_figure,
    orders_figure,
    save_balance_figure,
    save_flywheel_figure,
    save_orders_figure,
)
from .difference import difference_figure, save_differences
from .indicated import pressure_figure, save_indicated_figures, scatter_figure, volume_figure
from .mechanism import machine_figure
from .polar import crank_pin_figure, main_bearing_figure, piston_pin_figure
from .run import plot, save_figures
from .strips import (
    forces_figure,
    indicator_figure,
    piston_motion_figure,
    speed_figure,
    torque_figure,
)
from .style import png
from .sweep import sweep_figure
from .view import last_view

__all__ = [
    "balance_figure",
    "bearings_figure",
    "budget_figure",
    "comparison_figure",
    "crank_pin_figure",
    "cycles_figure",
    "difference_figure",
    "flywheel_figure",
    "forces_figure",
    "indicator_figure",
    "last_view",
    "machine_figure",
    "main_bearing_figure",
    "orders_figure",
    "piston_motion_figure",
    "piston_pin_figure",
    "plot",
    "png",
    "pressure_figure",
    "save_balance_figure",
    "save_differences",
    "save_figures",
    "save_flywheel_figure",
    "save_indicated_figures",
    "save_orders_figure",
    "save_validation",
    "scatter_figure",
    "speed_figure",
    "sweep_figure",
    "torque_figure",
    "transient_figure",
    "volume_figure",
]
