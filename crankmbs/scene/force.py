"""What every force from outside on a piston has in common, and how a file names one.

A force says what it is the sum of: functions of the piston's displacement, of its velocity, of its
cycle angle and of time, or one of all of them. Its other end stands on the frame.
"""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Callable
from typing import Annotated, ClassVar, NamedTuple

from annotated_types import Ge
from pydantic import PlainValidator, SerializeAsAny, StrictInt

from crankmbs.numerics.cycle import Cycle
from crankmbs.numerics.piecewise import Piecewise
from crankmbs.scene.schema import part
from crankmbs.scene.windowed import Windowed, one_of_kinds

__all__ = ["AnyForce", "Law", "PistonForce", "PythonLaw"]


class PythonLaw(NamedTuple):
    """A function(t, cycle_angle, displacement, velocity) of Python, the force of four numbers [s,
    rad, m, m/s]; what it declares of where it bends or jumps, [s, rad, m], and its period [rad]."""

    function: Callable[[float, float, float, float], float]
    times: tuple[float, ...] = ()
    angles: tuple[float, ...] = ()
    displacements: tuple[float, ...] = ()
    period: float | None = None


class Law(NamedTuple):
    """What a force [N] on a piston towards the crank is the sum of.

    forward, back : of the displacement [m], while the piston moves towards the crank and away from
        it
    over_angle : of the cycle angle [rad]; over_time : of time [s]
    viscous : per velocity towards the crank, against it [N s/m]
    """

    forward: Piecewise | None = None
    back: Piecewise | None = None
    over_angle: Cycle | None = None
    over_time: Piecewise | None = None
    viscous: float = 0.0
    python: PythonLaw | None = None

    @property
    def switches(self) -> bool:
        """Whether it is another on the way back."""
        return self.back is not self.forward

    @property
    def period(self) -> float | None:
        """Crank angle [rad] after which it comes again, where that is no single revolution."""
        repeating = self.over_angle or self.python
        return None if repeating is None else repeating.period


@part
class PistonForce(Windowed):
    """A force from outside on a piston along its axis, positive towards the crank; its other end
    stands on the frame. It acts in its window (`crankmbs.scene.windowed.Windowed`).

    cylinder : on whose piston, from 1; left out, one on each
    """

    kinds: ClassVar[dict[str, type[PistonForce]]] = {}
    unwritten: ClassVar[dict[str, type[PistonForce]]] = {}
    heading: ClassVar[str] = "force"
    unit: ClassVar[str] = "N"
    cylinder: Annotated[StrictInt, Ge(1)] | None = None

    @property
    @abstractmethod
    def law(self) -> Law:
        """What it is the sum of."""

    @property
    def is_steady(self) -> bool:
        """Whether it is always the same function of angle and speed."""
        law = self.law
        varies = law.over_time is not None
        unknown = law.python is not None and law.python.period is None
        return not (varies or self.has_window or unknown)


AnyForce = Annotated[SerializeAsAny[PistonForce], PlainValidator(one_of_kinds(PistonForce))]
"""A force of whatever class."""
