"""A force on a piston that is any function, given from Python."""

from __future__ import annotations

from functools import cached_property
from typing import Annotated, Any, ClassVar, Literal

from pydantic import PlainSerializer, PlainValidator

from crankmbs.numerics.function import named
from crankmbs.scene.force import Law, PistonForce, PythonLaw
from crankmbs.scene.python_load import KeptName, Numbers, OfFunction, function_of, within_period
from crankmbs.scene.schema import AnglePeriod, part

__all__ = ["Force"]


@part
class Force(OfFunction, PistonForce):
    """The force [N] on a piston, positive towards the crank, that a function(t, cycle_angle,
    displacement, velocity) gives, of time [s], cycle angle [rad], and the piston's displacement
    from its top dead centre [m] and its velocity towards the crank [m/s], four floats in, one out;
    it must be pure.

    kink_times [s], kink_angles [rad], kink_displacements [m] : where it bends or jumps, the angles
        every ``period``, without one every revolution; that it jumps with the sense of the
        velocity is always allowed for. What is not declared costs accuracy, which the
        stated errors know of unless it is a pulse that lies between the solver's nodes
    period [rad] : declares that it does not depend on t and repeats over the cycle angle; any
        multiple of half a revolution, or a whole part of two revolutions

    >>> Force(lambda t, cycle_angle, displacement, velocity: -2.0 * velocity).called
    'function'
    """

    positional: ClassVar[tuple[str, ...]] = ("function",)
    kind: Literal["function"] = "function"
    function: Annotated[
        Any,
        PlainValidator(function_of("t, cycle_angle, displacement and velocity", "a force")),
        PlainSerializer(named),
    ]
    kink_times: Numbers = ()
    kink_angles: Numbers = ()
    kink_displacements: Numbers = ()
    period: AnglePeriod | None = None

    @cached_property
    def law(self) -> Law:
        if isinstance(self.function, KeptName):
            return Law()
        angles, period = within_period(self.kink_angles, self.period)
        declared = self.kink_times, angles, self.kink_displacements
        return Law(python=PythonLaw(self.function, *declared, period))


PistonForce.unwritten["function"] = Force
