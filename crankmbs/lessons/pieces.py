"""What a lesson is made of: sections with a figure that computes, formulas, questions."""

from __future__ import annotations

import inspect
import re
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any

from crankmbs.digits import digits, error_digits
from crankmbs.measures import Estimate
from crankmbs.page.knobs import Choice, Knob
from crankmbs.scene.scene import Scene

__all__ = [
    "TITLES",
    "Figure",
    "Formula",
    "Lesson",
    "Number",
    "Question",
    "Section",
    "exact",
    "simulated",
]

_RAISED = str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹")
_GREEK = {"lambda": "λ", "phi": "φ", "beta": "β", "omega": "ω", "alpha": "α", "pi": "π"}
_LABELS = re.compile(
    r"\n(?=(?:Exact|Approximate|Error|Relative error|Source|Misprint|Arguments|Returns)\b)"
)
_UNITS = {
    "mm": {"mm": 1.0, "cm": 10.0, "m": 1e3, "µm": 1e-3},
    "°": {"°": 1.0, "degrees": 1.0, "°rees": 1.0, "rad": 57.29577951308232},
    "m/s": {"m/s": 1.0, "km/h": 1.0 / 3.6},
    "m/s²": {"m/s2": 1.0, "km/s2": 1e3},
    "N": {"N": 1.0, "kN": 1e3},
    "kN": {"kN": 1.0, "N": 1e-3},
    "N m": {"Nm": 1.0, "kNm": 1e3},
    "J": {"J": 1.0, "Nm": 1.0, "kJ": 1e3},
    "kg": {"kg": 1.0, "g": 1e-3},
    "kg m²": {"kgm2": 1.0},
    "%": {"%": 1.0},
    "rpm": {"rpm": 1.0, "1/min": 1.0, "rad/s": 9.549296585513721},
    "": {"": 1.0},
}
"""What may be typed for a unit, without blanks and with its factor to it."""

TITLES = {
    "S0": (
        "Grega",
        "R. Grega: Automobile Design, part 5L, Kinematics and dynamics of crank mechanism. "
        "Lecture, Technical University of Košice.",
    ),
    "S1": (
        "Yi, Win, Htay",
        "M. M. Yi, S. Y. Win, T. T. Htay: Kinematic Analysis of Crank Shaft for Diesel Engine. "
        "Technological University Thanlyin.",
    ),
    "S2": (
        "Kholbekov, Amonov, Omanov",
        "T. K. Kholbekov, C. E. Amonov, E. N. Omanov: Kinematics of KShM of Internal Combustion "
        "Engines. Termez.",
    ),
}
"""By their key in the validation's bibliography: short, and in full."""

_KEY = re.compile(r"\b(S[012])\b(?: (Eq\. \d+(?:(?:,| to| =) \d+)*))?")


@dataclass(frozen=True)
class Number:
    """A number of a lesson, as a str its HTML; what a run errs by stands in the footer.

    name : its id in the page; value, error : in ``unit``; error None: no run is in it
    most : digits shown
    """

    name: str
    value: float
    unit: str
    error: float | None = None
    most: int = 4

    def __str__(self) -> str:
        unit = self.unit if self.unit in ("", "°") else f"\u00a0{self.unit}"
        shown = _powers(digits(self.value, self.error or 0.0, self.most))
        error = ""
        if self.error is not None and self.error > 1e-8 * abs(self.value):  # not only rounding
            error = f' data-error="{_powers(error_digits(self.error))}{unit}"'
        return f'<data id="{self.name}" value="{self.value!r}"{error}>{shown}{unit}</data>'


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
    note, source : the same for one that is none of the lectures', or in better words
    """

    tex: str
    function: Callable[..., Any] | None = None
    note: str = ""
    source: str = ""

    @property
    def about(self) -> str:
        """How exact the formula is."""
        exactness = [part for part in self._paragraphs if part.startswith(("Exact", "Approximate"))]
        return self.note or _symbols(" ".join(exactness))

    @property
    def sources(self) -> str:
        """Where it is from, by title."""
        paragraphs = [part for part in self._paragraphs if part.startswith("Source")]
        return self.source or _sources_in(" ".join(paragraphs))

    @property
    def _paragraphs(self) -> list[str]:
        text = inspect.getdoc(self.function) or "" if self.function else ""
        return [" ".join(part.split()) for part in _LABELS.split(text)]


@dataclass(frozen=True)
class Figure:
    """A figure that computes in the browser; its lesson's module in JavaScript says what.

    name : its id; plots : what each shows; knobs, choices : what moves it
    forces : the body whose forces are shown, or "none"; cylinder : number of that shown, from 1
    angle : at which it stands first [deg], None for a telling one; ring : at the mean speed
    machine : whether the mechanism is shown; plays : whether it has a crank angle
    drawing : what a drawing shows in place of the mechanism; beside : whether its plots
    stand side by side
    """

    name: str
    caption: str
    plots: tuple[str, ...] = ()
    knobs: tuple[Knob, ...] = ()
    choices: tuple[Choice, ...] = ()
    forces: str = "none"
    cylinder: int = 1
    angle: float | None = None
    ring: bool = False
    machine: bool = True
    plays: bool = True
    drawing: str = ""
    beside: bool = False

    @property
    def data(self) -> dict[str, Any]:
        """What the scripts take of it."""
        values = {knob.name: knob.value for knob in self.knobs}
        return {
            "name": self.name,
            "knobs": [vars(knob) for knob in self.knobs],
            "values": {**values, **{choice.name: choice.value for choice in self.choices}},
            "forces": self.forces,
            "cylinder": self.cylinder,
            "angle": self.angle,
            "ring": self.ring,
        }


@dataclass(frozen=True)
class Section:
    """One idea: words, its figure, words, formulas. Words are HTML in which $...$ is TeX."""

    title: str
    before: str
    figure: Figure
    after: str = ""
    formulas: tuple[Formula, ...] = ()


@dataclass(frozen=True)
class Question:
    """A question whose answer is typed, in the unit shown or another; words as in a section.

    name : its id; solution : the right number; tolerance : relative; hint : where it is missed
    also : other right numbers, in the same unit
    answer : in full, which opens when it is right or on a click
    """

    name: str
    text: str
    solution: Number
    hint: str
    answer: str
    tolerance: float = 0.01
    also: tuple[float, ...] = ()

    @property
    def data(self) -> dict[str, Any]:
        """What the scripts take of it."""
        return {
            "name": self.name,
            "values": [self.solution.value, *self.also],
            "unit": self.solution.unit,
            "tolerance": self.tolerance,
            "units": _UNITS[self.solution.unit],
            "hint": self.hint,
        }


@dataclass(frozen=True)
class Lesson:
    """One lesson.

    idea : what one should take home, in a sentence or two; scene : which its figures begin with
    about : what was changed in the scene that was asked for, plain text
    error : relative, stated by the runs behind its numbers; more : what its scripts take besides
    """

    idea: str
    sections: tuple[Section, ...]
    questions: tuple[Question, ...]
    scene: Scene
    about: str
    error: float
    more: dict[str, Any] = field(default_factory=dict)

    @property
    def texts(self) -> list[str]:
        """All words in which numbers may stand."""
        sections = [t for s in self.sections for t in (s.before, s.figure.caption, s.after)]
        return [*sections, *(text for q in self.questions for text in (q.text, q.answer))]


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


def _sources_in(text: str) -> str:
    """The sources that a docstring names by their keys, in words; equations that have numbers.

    >>> _sources_in("Source: S0-F28, S1 Eq. 25 before its truncation.")
    'Grega; Yi, Win, Htay, Eq. 25'
    """
    equations_of: dict[str, list[str]] = {}
    for key, equations in _KEY.findall(text):
        equations_of.setdefault(key, [])
        if equations:
            equations_of[key].append(equations)
    return "; ".join(", ".join([TITLES[key][0], *where]) for key, where in equations_of.items())
