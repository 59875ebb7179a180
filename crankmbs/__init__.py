"""Time-domain dynamics of the slider-crank and the engine crank train.

>>> import crankmbs
>>> result = crankmbs.simulate(crankmbs.load_scene("yi_diesel"))
"""

from crankmbs.choose import Choice, choose
from crankmbs.compare import Budget, Comparison, budget, compare
from crankmbs.errors import (
    CrankmbsError,
    FormulationError,
    InputError,
    OutputError,
    SceneError,
)
from crankmbs.lecture.accumulated_torque import accumulated_torque
from crankmbs.result import Cost, Error, Result
from crankmbs.scene.drives import Motion, Oscillation, Ramp, SpeedFile, Start
from crankmbs.scene.gas import Gas, Indicator
from crankmbs.scene.loads import AngleTable, Constant, Quadratic, SpeedTable, TimeTable, Viscous
from crankmbs.scene.parts import Crank, Cylinder, Gravity, Layout, Piston, Rod
from crankmbs.scene.read import load_scene, shipped_scenes
from crankmbs.scene.scene import Extent, Run, Scene
from crankmbs.scene.tables import Columns, Table
from crankmbs.simulate import simulate

__all__ = [
    "AngleTable",
    "Budget",
    "Choice",
    "Columns",
    "Comparison",
    "Constant",
    "Cost",
    "Crank",
    "CrankmbsError",
    "Cylinder",
    "Error",
    "Extent",
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
    "load_scene",
    "shipped_scenes",
    "simulate",
]
