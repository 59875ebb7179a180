"""Time-domain dynamics of the slider-crank and the engine crank train.

>>> import crankmbs
>>> result = crankmbs.simulate(crankmbs.load_scene("yi_diesel"))
"""

from crankmbs.choose import Choice, choose
from crankmbs.compare import Budget, Comparison, budget, compare
from crankmbs.design.flywheel import Flywheel, flywheel
from crankmbs.errors import (
    CrankmbsError,
    FormulationError,
    InputError,
    OutputError,
    SceneError,
)
from crankmbs.lecture.accumulated_torque import accumulated_torque
from crankmbs.motion.base import Decay
from crankmbs.result import Cost, Error, Result
from crankmbs.scene.drives import (
    Constant,
    Motion,
    Oscillation,
    Quadratic,
    Ramp,
    SpeedFile,
    SpeedTable,
    Start,
    TimeTable,
    Viscous,
)
from crankmbs.scene.parts import Crank, Cylinder, Gas, Gravity, Indicator, Layout, Piston, Rod
from crankmbs.scene.read import load_scene, shipped_scenes
from crankmbs.scene.scene import Extent, Run, Scene
from crankmbs.scene.tables import Table
from crankmbs.simulate import simulate

__all__ = [
    "Budget",
    "Choice",
    "Comparison",
    "Constant",
    "Cost",
    "Crank",
    "CrankmbsError",
    "Cylinder",
    "Decay",
    "Error",
    "Extent",
    "Flywheel",
    "FormulationError",
    "Gas",
    "Gravity",
    "Indicator",
    "InputError",
    "Layout",
    "Motion",
    "Oscillation",
    "OutputError",
    "Piston",
    "Quadratic",
    "Ramp",
    "Result",
    "Rod",
    "Run",
    "Scene",
    "SceneError",
    "SpeedFile",
    "SpeedTable",
    "Start",
    "Table",
    "TimeTable",
    "Viscous",
    "accumulated_torque",
    "budget",
    "choose",
    "compare",
    "flywheel",
    "load_scene",
    "shipped_scenes",
    "simulate",
]
