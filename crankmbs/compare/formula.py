"""A formula that someone wrote in Python: what it stands for, what it asks for, what it answers."""

from __future__ import annotations

import inspect
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from crankmbs.compare.excerpt import Excerpt
from crankmbs.compare.lectured import LECTURES
from crankmbs.compare.numbers import NUMBERS
from crankmbs.compare.quantities import OBSERVABLES, QUANTITIES
from crankmbs.compare.words import WORDS, Words
from crankmbs.errors import InputError, shown
from crankmbs.numerics.arrays import Array
from crankmbs.numerics.function import named
from crankmbs.scene.sentences import did_you_mean

__all__ = ["CLOSED_FORM", "Formula", "formulas_of", "formulated"]


CLOSED_FORM = "closed form"

_SHORT = {name.removeprefix("piston "): name for name in OBSERVABLES if name.startswith("piston ")}
_NAMES = _SHORT | {name: name for name in (*OBSERVABLES, *NUMBERS)}
_ELSEWHERE = {
    "crank_angle": "theta, or for phi, of the cylinder compared",
    "crank_speed": "omega",
    "crank_acceleration": "alpha",
}  # what a result calls otherwise
_LISTED = f"{', '.join((*QUANTITIES, *NUMBERS))}, and the variables of a result"
_TAKEN = ("run", "lecture", CLOSED_FORM, *LECTURES)
_KNOWS = {
    "constant speed": {"omega", "alpha"},
    "two-mass rod": {"rod_inertia", "reduced_inertia", "reduced_slope"},
    "gravity": {"gravity_x", "gravity_y", "generalized_force"},
    "friction": {"friction_force"},
    "forces": {"applied_force"},
}


@dataclass(frozen=True)
class Formula:
    """label : under which it is shown; quantity : that it stands for; words : that it asks for."""

    label: str
    function: Callable[..., Any]
    quantity: str
    words: tuple[str, ...]

    @property
    def is_number(self) -> bool:
        """Whether it stands for one number of the run, not for a curve."""
        return self.quantity in NUMBERS

    @property
    def idealized(self) -> frozenset[str]:
        """The causes of error that it cannot be free of, as it does not ask for what they are
        about."""
        return frozenset(cause for cause, words in _KNOWS.items() if not words & set(self.words))

    def curve(self, excerpt: Excerpt) -> Array:
        """Its answer on a stretch of a run, shape (n,).

        Raises
        ------
        InputError : it raises, or answers no n finite numbers
        """
        answer = self._called(Words(excerpt, one=OBSERVABLES[self.quantity].per_cylinder))
        n = len(excerpt.theta)
        if answer.shape not in ((), (n,)):
            raise InputError(
                f"{self.label}: must give {n} numbers, one for each sample, or a single one; an "
                f"array of shape {answer.shape} came"
                + (
                    "; take every cylinder's values together, such as np.sum(..., axis=1)"
                    if answer.shape[:1] == (n,)
                    else ""
                )
            )
        values = np.array(np.broadcast_to(answer, n))
        wrong = np.flatnonzero(~np.isfinite(values))
        if len(wrong):
            at = excerpt.theta[wrong[0]]
            raise InputError(
                f"{self.label}: must give finite numbers; {values[wrong[0]]} came at {len(wrong)} "
                f"of {n} samples, first at theta = {at:.6g} rad; give there what the formula tends "
                "to"
            )
        return values

    def number(self, excerpt: Excerpt) -> float:
        """Its one number for a run.

        Raises
        ------
        InputError : it raises, or answers no single finite number
        """
        per_cylinder = NUMBERS[self.quantity].per_cylinder
        answer = self._called(Words(excerpt, one=per_cylinder))
        if answer.shape != () or not np.isfinite(answer):
            came = f"an array of shape {answer.shape}" if answer.shape else str(answer)
            raise InputError(f"{self.label}: the {self.quantity} is one finite number; {came} came")
        return float(answer)

    def _called(self, words: Words) -> Array:
        """What the function answers, as numbers; numpy's warnings are ours to put in a sentence."""
        given = {name: words[name] for name in self.words}
        given = {k: v.copy() if isinstance(v, np.ndarray) else v for k, v in given.items()}
        try:
            with np.errstate(all="ignore"):
                answer = self.function(**given)
        except Exception as error:  # whatever the function of a user may raise
            what = f"{type(error).__name__}: {error}".rstrip(": ")
            raise InputError(
                f"{self.label}: {named(self.function)} raises {what}; it is called with "
                f"{', '.join(_described(*pair) for pair in given.items()) or 'nothing'}"
            ) from error
        try:
            return np.asarray(answer).astype(np.float64, casting="same_kind")
        except (TypeError, ValueError):
            raise InputError(
                f"{self.label}: {named(self.function)} must give real numbers; {shown(answer)} came"
            ) from None


def formulas_of(given: Mapping[str, Callable[..., Any]] | None) -> tuple[Formula, ...]:
    """The formulas behind functions, by their labels.

    Raises
    ------
    InputError : no such mapping; a label that is taken, no function, one that names no quantity, a
        parameter that is no word
    """
    if given is None:
        return ()
    if not isinstance(given, Mapping):
        raise InputError(
            'formulas must be functions by their labels, such as {"my series": function}; '
            f"{shown(given)} came"
        )
    return tuple(formulated(label, function) for label, function in given.items())


def formulated(label: str, function: Callable[..., Any]) -> Formula:
    """The formula behind one function.

    It stands for the quantity that its name begins with, or else its label; a piston's also without
    "piston". Its parameters name what it asks for; one that is no word must have a default.

    Raises
    ------
    InputError : as `formulas_of`

    >>> formula = formulated("series", lambda phi, omega: omega) # doctest: +ELLIPSIS
    Traceback (most recent call last):
    crankmbs.errors.InputError: series: a formula stands for the quantity that ...
    >>> formulated("piston velocity, first order", lambda phi, omega: omega).words
    ('phi', 'omega')
    """
    if not isinstance(label, str) or not label.strip():
        raise InputError(f"a formula's label must be a text; {shown(label)} came")
    if label in _TAKEN:
        raise InputError(f"{label}: this is what another curve is called; choose another label")
    if not callable(function):
        raise InputError(f"{label}: must be a function; {shown(function)} came")
    quantity = _quantity(named(function)) or _quantity(label)
    if quantity is None:
        first = _spaced(named(function)) if named(function) != "<lambda>" else _spaced(label)
        raise InputError(
            f"{label}: a formula stands for the quantity that its function's name begins with, or "
            f"its label; {shown(named(function))} names none"
            + (did_you_mean(first, list(_NAMES)) or f"; there are {_LISTED}")
        )
    return Formula(label, function, quantity, _words(label, function))


def _words(label: str, function: Callable[..., Any]) -> tuple[str, ...]:
    try:
        parameters = inspect.signature(function).parameters.values()
    except (TypeError, ValueError):
        raise InputError(
            f"{label}: the parameters of {named(function)} cannot be read; put it into a function "
            "of your own, whose parameters say what it asks for"
        ) from None
    words = []
    for each in parameters:
        if each.kind in (each.VAR_POSITIONAL, each.VAR_KEYWORD):
            continue
        if each.name in WORDS and each.kind != each.POSITIONAL_ONLY:
            words.append(each.name)
        elif each.default is each.empty:
            raise InputError(
                f"{label}: the parameter {each.name} of {named(function)} {_no_word(each.name)}"
            )
    return tuple(words)


def _no_word(name: str) -> str:
    """Why a parameter can be given nothing, and the way out."""
    if name in WORDS:
        return "must be given by name; leave out the / behind it"
    if name in _ELSEWHERE:
        return f"is nothing it can be given; ask for {_ELSEWHERE[name]}"
    near = did_you_mean(name, list(WORDS)) or f"; there are {', '.join(WORDS)}"
    return f"is nothing it can be given{near}"


def _quantity(text: str) -> str | None:
    """The quantity that a name begins with, the longest of several."""
    spaced = _spaced(text)
    fitting = [name for name in _NAMES if f"{spaced} ".startswith(f"{name} ")]
    return _NAMES[max(fitting, key=len)] if fitting else None


def _spaced(text: str) -> str:
    """A name or label in plain words: blanks for whatever else stands between them."""
    return " ".join("".join(c if c.isalnum() or c == "-" else " " for c in text).split()).lower()


def _described(name: str, value: Array | float) -> str:
    return f"{name} of shape {value.shape}" if isinstance(value, np.ndarray) else name
