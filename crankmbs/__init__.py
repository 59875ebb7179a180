"""Time-domain dynamics of the slider-crank and the engine crank train.

>>> import crankmbs
>>> result = crankmbs.simulate(crankmbs.load_scene("yi_diesel"))

A name is imported when it is first used, and subpackages such as ``crankmbs.figures`` with it.
"""

import sys as _sys
from importlib import import_module as _import_module
from importlib.util import find_spec as _find_spec
from types import ModuleType as _ModuleType
from typing import TYPE_CHECKING as _TYPE_CHECKING

if _TYPE_CHECKING:  # what type checkers see; `_NAMES` is what runs
    from crankmbs.choose import Choice, choose
    from crankmbs.compare import AtAngle, Budget, Comparison, Reading, at_angle, budget, compare
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
    from crankmbs.scene.read import load_scene
    from crankmbs.scene.run import Extent, Run
    from crankmbs.scene.scene import Scene
    from crankmbs.scene.shipped import shipped_scenes
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

_NAMES = {
    "choose": "Choice choose",
    "compare": "AtAngle Budget Comparison Reading at_angle budget compare",
    "design": "Balance Flywheel balance flywheel freed",
    "errors": "CrankmbsError FormulationError InputError OutputError SceneError UndecidedError",
    "export": "export",
    "indicated": "CylinderPressure Indicated read_pressure",
    "lecture.accumulated_torque": "accumulated_torque",
    "measures": "EngineOrders Estimate JointForce Measures Orders engine_orders orders",
    "motion.base": "Decay",
    "result": "Cost Error Result",
    "scene.drives": "Motion Oscillation Ramp SpeedFile Start",
    "scene.fuel": "Fuel Governor Misfire",
    "scene.gas": "Gas Indicator Polytrope",
    "scene.loads": "AngleTable Constant Quadratic SpeedTable TimeTable Viscous",
    "scene.parts": "Crank Cylinder Gravity Layout Piston Rod",
    "scene.python_load": "Load",
    "scene.read": "load_scene",
    "scene.run": "Extent Run",
    "scene.scene": "Scene",
    "scene.shipped": "shipped_scenes",
    "scene.tables": "CylinderTable Table",
    "simulate": "simulate",
    "stepper": "Snapshot Stepper StepperState",
    "sweep": "Minimum Sample Sensitivity SobolIndices Solved load_sweep minimize sensitivity "
    "sobol_indices solve sweep",
}
_MODULE_OF = {name: module for module, names in _NAMES.items() for name in names.split()}


class _Package(_ModuleType):
    """Imports what it is asked for; where a function and its module share a name, such as
    ``simulate``, it is the function."""

    def __getattr__(self, name: str) -> object:
        if name in _MODULE_OF:
            value = getattr(_import_module(f"crankmbs.{_MODULE_OF[name]}"), name)
        elif name.isidentifier() and name[0] != "_" and _find_spec(f"crankmbs.{name}"):
            value = _import_module(f"crankmbs.{name}")
        else:
            raise AttributeError(f"module 'crankmbs' has no attribute {name!r}")
        setattr(self, name, value)
        return value

    def __setattr__(self, name: str, value: object) -> None:
        if not (name in _MODULE_OF and isinstance(value, _ModuleType)):  # an import sets its module
            super().__setattr__(name, value)

    def __dir__(self) -> list[str]:
        from pkgutil import iter_modules

        return sorted({*__all__, *(found.name for found in iter_modules(__path__))})


_sys.modules[__name__].__class__ = _Package
