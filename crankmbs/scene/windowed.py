"""What torques and forces from outside have in common: when they act, and how a file names one."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable
from typing import Any, ClassVar, Self, TypeVar

from pydantic import StrictStr, TypeAdapter, ValidationError, ValidationInfo

from crankmbs.errors import InputError, shown
from crankmbs.scene.schema import SAVED, AngularSpeed, Time, of_file, part
from crankmbs.scene.sentences import PartError, did_you_mean
from crankmbs.scene.tables import Table
from crankmbs.scene.units import RPM

__all__ = ["Windowed", "one_of_kinds", "registered"]

T = TypeVar("T", bound="type[Windowed]")


@part
class Windowed(ABC):
    """What acts from outside, in a window.

    It acts from when the time ``after`` [s] and the speed ``from_speed`` [rad/s] have both been met
    to the time ``until`` or, after that, the speed ``until_speed``, and then never again; what is
    not given bounds nothing. ``name`` is what it is called in tables and figures.
    """

    kinds: ClassVar[dict[str, type[Any]]] = {}
    unwritten: ClassVar[dict[str, type[Any]]] = {}  # no file names them, but a saved result
    heading: ClassVar[str]  # of its table in a file
    kind: str
    name: StrictStr = ""
    after: Time | None = None
    until: Time | None = None
    from_speed: AngularSpeed | None = None
    until_speed: AngularSpeed | None = None

    def __post_init__(self) -> None:
        begin = self.after or 0.0
        if self.until is not None and self.until <= begin:
            raise InputError(
                f"until must be later than {'after' if begin else 'the start'}, {begin:g} s, or it "
                f"never acts; {self.until:g} s came"
            )

    @property
    @abstractmethod
    def words(self) -> str:
        """What a reader is told of it, after its kind."""

    @property
    def window_words(self) -> str:
        """What a reader is told of when it acts; nothing where it does throughout."""
        speeds = [("from", self.from_speed), ("until", self.until_speed)]
        times = [("after", self.after), ("until", self.until)]
        bounds = [f"{word} {t:.6g} s" for word, t in times if t is not None]
        bounds += [f"{word} {v / RPM:.6g} rpm" for word, v in speeds if v is not None]
        return "".join(f", {bound}" for bound in bounds)

    @property
    def given(self) -> Self:
        """Itself, as a scene gives it."""
        return self

    @property
    def has_window(self) -> bool:
        """Whether it does not act throughout."""
        ends = self.after, self.until, self.from_speed, self.until_speed
        return any(end is not None for end in ends)

    @property
    def called(self) -> str:
        """Its name on one line; without one its kind in words."""
        return " ".join(self.name.split()) or self.kind.replace("_", " ")

    @property
    def introduced(self) -> str:
        """Its name, where it has one, and its kind."""
        return ", ".join(dict.fromkeys([self.called, self.kind.replace("_", " ")]))

    @property
    def table_over_time(self) -> Table | None:
        """Its table, if that must cover the time in which it acts."""
        return None

    @property
    def lacks(self) -> str | None:
        """Why it cannot be run again, and the way out; None where it can."""
        return None

    def check_time(self, t: float) -> None:
        """Refuse a time [s] at which it is not known.

        Raises
        ------
        InputError : key, what came, and the way out
        """
        table = self.table_over_time
        if table is not None and t >= table.x[-1]:
            raise InputError(
                f"file: {table.source}: the time table ends at {table.x[-1]:g} s, before the run "
                "does; lengthen the table or shorten the run"
            )


def registered(cls: T) -> T:
    """Make a part a torque or a force that a file names by its kind.

    >>> from crankmbs.scene.torque import Torque
    >>> Torque.kinds["viscous"].__name__
    'Viscous'
    """
    cls.kinds[cls.kind] = cls
    return cls


def one_of_kinds(base: type[Windowed]) -> Callable[[Any, ValidationInfo], Any]:
    """What reads one as it is, or by its kind from a table of a file."""

    def read(value: Any, info: ValidationInfo) -> Any:
        if isinstance(value, base):
            return value
        if not isinstance(value, dict) and info.context is None:
            names = ", ".join(cls.__name__ for cls in base.kinds.values())
            raise InputError(f"must be one of {names}; {shown(value)} came")
        if not isinstance(value, dict):
            raise InputError(
                f"must be a table with its kind, [[{base.heading}]]; {shown(value)} came"
            )
        kind = value.get("kind")
        known = base.kinds | (base.unwritten if info.context is SAVED else {})
        if not isinstance(kind, str) or kind not in known:
            came = f"{shown(kind)} came" if "kind" in value else "none came"
            near = did_you_mean(kind, list(base.kinds)) if isinstance(kind, str) else ""
            raise InputError(f"kind must be one of {', '.join(base.kinds)}; {came}{near}")
        cls: Any = known[kind]
        by_name = False if of_file(info) else None
        try:
            return TypeAdapter(cls).validate_python(value, context=info.context, by_name=by_name)
        except ValidationError as error:
            raise PartError(error, cls, value) from None

    return read
