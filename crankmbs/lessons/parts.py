"""What a lesson is made of: numbers, formulas, figures, questions."""

from __future__ import annotations

import inspect
import re
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

from matplotlib.figure import Figure

from crankmbs.digits import digits, error_digits
from crankmbs.measures import Estimate, measure
from crankmbs.result import Result
from crankmbs.scene.units import RPM

__all__ = ["Formula", "Lesson", "Number", "Question", "Slider", "Step", "exact", "simulated"]

_RAISED = str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹")
_GREEK = {"lambda": "λ", "phi": "φ", "beta": "β", "omega": "ω", "alpha": "α", "pi": "π"}
_LABELS = re.compile(
    r"\n(?=(?:Exact|Approximate|Error|Relative error|Source|Misprint|Arguments|Returns)\b)"
)


@dataclass(frozen=True)
class Number:
    """A number of a page, as a str its HTML.

    name : its id in the page; value, error : in ``unit``; error None: no simulation in it
    most : digits shown
    """

    name: str
    value: float
    unit: str
    error: float | None = None
    most: int = 4

    def __str__(self) -> str:
        gap = "" if self.unit in ("", "°") else "\u00a0"
        unit = f"{gap}{self.unit}"
        shown = _powers(digits(self.value, self.error or 0.0, self.most))
        text = f'<data id="{self.name}" value="{self.value!r}">{shown}{unit}</data>'
        if self.error is None:
            return text
        return f'{text} <small class="error">± {_powers(error_digits(self.error))}{unit}</small>'


def exact(name: str, value: Any, unit: str = "", scale: float = 1.0, most: int = 4) -> Number:
    """A number of a formula; ``scale`` takes it from SI units to ``unit``."""
    return Number(name, float(value) * scale, unit, None, most)


def simulated(
    name: str, estimate: Estimate, unit: str = "", scale: float = 1.0, most: int = 4
) -> Number:
    """A number of a run with its stated error; ``scale`` takes both from SI units to ``unit``."""
    value, error = (float(part) for part in estimate)
    return Number(name, value * scale, unit, error * abs(scale), most)


@dataclass(frozen=True)
class Formula:
    """A formula in TeX.

    function : of `crankmbs.lecture`, whose docstring says how exact it is and whose
    note : the same for a formula that is none of the lectures'
    """

    tex: str
    function: Callable[..., Any] | None = None
    note: str = ""

    @property
    def about(self) -> str:
        """How exact the formula is and where it is from."""
        if self.function is None:
            return self.note
        said = ("Exact", "Approximate", "Source")
        return _symbols(" ".join(part for part in self._paragraphs if part.startswith(said)))

    @property
    def _paragraphs(self) -> list[str]:
        text = inspect.getdoc(self.function) or ""
        return [" ".join(part.split()) for part in _LABELS.split(text)]


@dataclass(frozen=True)
class Slider:
    """The frames of a figure that is moved by hand.

    name : of what is moved; marks : its value in each frame; first : number of the frame shown
    first
    """

    name: str
    marks: tuple[str, ...]
    first: int


@dataclass(frozen=True)
class Step:
    """One idea and its figure. ``caption`` and ``words`` are HTML in which $...$ is TeX."""

    title: str
    figures: tuple[Figure, ...]
    caption: str
    formulas: tuple[Formula, ...] = ()
    words: str = ""
    slider: Slider | None = None


@dataclass(frozen=True)
class Question:
    """A question and its answer, which opens on a click; HTML in which $...$ is TeX."""

    asked: str
    answer: str


@dataclass(frozen=True)
class Lesson:
    """One page.

    idea : what one should take home, in a sentence or two
    scene : name of the scene and what was changed in it; result : its run
    """

    idea: str
    steps: tuple[Step, ...]
    questions: tuple[Question, ...]
    scene: str
    result: Result

    @property
    def facts(self) -> str:
        """The run behind the page, in a line."""
        scene, result = self.result.scene, self.result
        radius, length, offset = scene.crank.radius, scene.rod.length, scene.piston.offset
        speed = measure(result).mean_speed.value / RPM
        parts = [
            f"r = {digits(radius * 1e3, most=4)} mm",
            f"l = {digits(length * 1e3, most=4)} mm",
            f"λ = {digits(radius / length, most=4)}",
            *([f"offset {digits(offset * 1e3, most=4)} mm"] if offset else []),
            f"{digits(speed, most=5)} rpm",
            f"{result.formulation}, relative error {_powers(f'{result.error.estimated:.0e}')}",
        ]
        return ", ".join(parts)


def _powers(number: str) -> str:
    """A number as it is printed: -1.5e-12 as −1.5·10⁻¹².

    >>> _powers("1.5e-12")
    '1.5·10⁻¹²'
    """
    mantissa, mark, exponent = number.partition("e")
    mantissa = mantissa.replace("-", "\N{MINUS SIGN}")
    return f"{mantissa}·10{str(int(exponent)).translate(_RAISED)}" if mark else mantissa


def _symbols(words: str) -> str:
    """Plain-text formulas of a docstring with Greek letters and raised exponents."""
    for name, letter in _GREEK.items():
        words = re.sub(rf"\b{name}\b", letter, words)
    words = re.sub(r"\^(\d)", lambda match: match[1].translate(_RAISED), words)
    return words.replace("`", "")
