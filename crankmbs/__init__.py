"""Time-domain dynamics of the slider-crank and the engine crank train.

>>> import crankmbs
>>> result = crankmbs.simulate(crankmbs.load_scene("yi_diesel"))
"""

import importlib
import types

from crankmbs.choose import Choice, choose
from crankmbs.compare import AtAngle, Budget, Comparison, Reading, at_angle, budget, compare
from crankmbs.compare.confirm import Confirmation, confirm
from crankmbs.design import Balance, Flywheel, balance, flywheel, freed
from crankmbs.errors import (
    CrankmbsError,
    FormulationError,
    InputError,
    OutputError,
    SceneError,
    UndecidedError,
)
from crankmbs.export import export
from crankmbs.indicated import CylinderPressure, Indicated, read_pressure
from crankmbs.lecture.accumulated_torque import accumulated_torque
from crankmbs.measures import (
    EngineOrders,
    Estimate,
    JointForce,
    Measures,
    Orders,
    engine_orders,
    orders,
)
from crankmbs.motion.base import Decay
from crankmbs.result import Cost, Error, Result
from crankmbs.scene.drives import Motion, Oscillation, Ramp, SpeedFile, Start
from crankmbs.scene.fuel import Fuel, Governor, Misfire
from crankmbs.scene.gas import Gas, Indicator, Polytrope
from crankmbs.scene.loads import AngleTable, Constant, Quadratic, SpeedTable, TimeTable, Viscous
from crankmbs.scene.parts import Crank, Cylinder, Gravity, Layout, Piston, Rod
from crankmbs.scene.python_load import Load
from crankmbs.scene.read import load_scene, shipped_scenes
from crankmbs.scene.run import Extent, Run
from crankmbs.scene.scene import Scene
from crankmbs.scene.tables import CylinderTable, Table
from crankmbs.simulate import simulate
from crankmbs.stepper import Snapshot, Stepper, StepperState
from crankmbs.sweep import (
    Minimum,
    Sample,
    Sensitivity,
    SobolIndices,
    Solved,
    load_sweep,
    minimize,
    sensitivity,
    sobol_indices,
    solve,
    sweep,
)

__all__ = [
    "AngleTable",
    "AtAngle",
    "Balance",
    "Budget",
    "Choice",
    "Comparison",
    "Confirmation",
    "Constant",
    "Cost",
    "Crank",
    "CrankmbsError",
    "Cylinder",
    "CylinderPressure",
    "CylinderTable",
    "Decay",
    "EngineOrders",
    "Error",
    "Estimate",
    "Extent",
    "Flywheel",
    "FormulationError",
    "Fuel",
    "Gas",
    "Governor",
    "Gravity",
    "Indicated",
    "Indicator",
    "InputError",
    "JointForce",
    "Layout",
    "Load",
    "Measures",
    "Minimum",
    "Misfire",
    "Motion",
    "Orders",
    "Oscillation",
    "OutputError",
    "Piston",
    "Polytrope",
    "Quadratic",
    "Ramp",
    "Reading",
    "Result",
    "Rod",
    "Run",
    "Sample",
    "Scene",
    "SceneError",
    "Sensitivity",
    "Snapshot",
    "SobolIndices",
    "Solved",
    "SpeedFile",
    "SpeedTable",
    "Start",
    "Stepper",
    "StepperState",
    "Table",
    "TimeTable",
    "UndecidedError",
    "Viscous",
    "accumulated_torque",
    "at_angle",
    "balance",
    "budget",
    "choose",
    "compare",
    "confirm",
    "engine_orders",
    "export",
    "flywheel",
    "freed",
    "load_scene",
    "load_sweep",
    "minimize",
    "orders",
    "read_pressure",
    "sensitivity",
    "shipped_scenes",
    "simulate",
    "sobol_indices",
    "solve",
    "sweep",
]


def __getattr__(name: str) -> types.ModuleType:
    """``crankmbs.figures`` without an import of its own; matplotlib is loaded with it alone."""
    if name == "figures":
        return importlib.import_module("crankmbs.figures")
    raise AttributeError(f"module 'crankmbs' has no attribute {name!r}")
