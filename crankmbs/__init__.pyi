"""The public names and where each lives: what type checkers read, and `crankmbs` itself when a name
is first used."""

from . import figures, lecture
from .choose import Choice, choose
from .compare import AtAngle, Budget, Comparison, Reading, at_angle, budget, compare
from .compare.confirm import Confirmation, confirm
from .design import Balance, Flywheel, balance, flywheel, freed
from .errors import (
    CrankmbsError,
    FormulationError,
    InputError,
    OutputError,
    SceneError,
    UndecidedError,
)
from .export import export
from .indicated import CylinderPressure, Indicated, MeasuredSpeed, read_pressure, read_speed
from .lecture.accumulated_torque import accumulated_torque
from .measures import (
    EngineOrders,
    Estimate,
    JointForce,
    Measures,
    Orders,
    engine_orders,
    orders,
)
from .motion.base import Decay
from .result import Cost, Error, Result
from .scene.bearings import Bearings, Shell
from .scene.drives import Motion, Oscillation, Ramp, SpeedFile, Start
from .scene.forces import (
    ConstantForce,
    Damper,
    ForceAngleTable,
    ForceTimeTable,
    Spring,
    TravelTable,
)
from .scene.fuel import Fuel, Governor, Misfire
from .scene.gas import Gas, Indicator, Polytrope
from .scene.loads import AngleTable, Constant, Quadratic, SpeedTable, TimeTable, Viscous
from .scene.parts import (
    Crank,
    Cylinder,
    Friction,
    Gravity,
    Layout,
    OwnPiston,
    OwnRod,
    Piston,
    Rod,
)
from .scene.python_force import Force
from .scene.python_load import Load
from .scene.read import load_scene
from .scene.run import Extent, Run
from .scene.scene import Scene
from .scene.shipped import shipped_scenes
from .scene.tables import CylinderTable, Table
from .simulate import simulate
from .stepper import Snapshot, Stepper, StepperState
from .sweep import (
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

__version__: str

__all__ = [
    "AngleTable",
    "AtAngle",
    "Balance",
    "Bearings",
    "Budget",
    "Choice",
    "Comparison",
    "Confirmation",
    "Constant",
    "ConstantForce",
    "Cost",
    "Crank",
    "CrankmbsError",
    "Cylinder",
    "CylinderPressure",
    "CylinderTable",
    "Damper",
    "Decay",
    "EngineOrders",
    "Error",
    "Estimate",
    "Extent",
    "Flywheel",
    "Force",
    "ForceAngleTable",
    "ForceTimeTable",
    "FormulationError",
    "Friction",
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
    "MeasuredSpeed",
    "Measures",
    "Minimum",
    "Misfire",
    "Motion",
    "Orders",
    "Oscillation",
    "OutputError",
    "OwnPiston",
    "OwnRod",
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
    "Shell",
    "Snapshot",
    "SobolIndices",
    "Solved",
    "SpeedFile",
    "SpeedTable",
    "Spring",
    "Start",
    "Stepper",
    "StepperState",
    "Table",
    "TimeTable",
    "TravelTable",
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
    "figures",
    "flywheel",
    "freed",
    "lecture",
    "load_scene",
    "load_sweep",
    "minimize",
    "orders",
    "read_pressure",
    "read_speed",
    "sensitivity",
    "shipped_scenes",
    "simulate",
    "sobol_indices",
    "solve",
    "sweep",
]
