"""A formula that a user wrote in Python: its quantity, its parameters and its values."""

from __future__ import annotations

import inspect
from collections.abc import Callable, Mapping, Sequence
from copy import copy
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from crankmbs.compare.excerpt import Excerpt
from crankmbs.compare.lectured import LECTURES, short_name
from crankmbs.compare.numbers import NUMBERS
from crankmbs.compare.quantities import OBSERVABLES, QUANTITIES
from crankmbs.compare.words import WORDS, Words
from crankmbs.errors import InputError, shown
from crankmbs.numerics.arrays import Array
from crankmbs.numerics.function import named
from crankmbs.scene.sentences import did_you_mean

__all__ = ["CLOSED_FORM", "Formula", "formulas_of", "formulated", "variables_of"]


CLOSED_FORM = "closed form"
_SAME = 1e-12  # of the largest value: rounding

_SHORT = {name.removeprefix("piston "): name for name in OBSERVABLES if name.startswith("piston ")}
_QUANTITY_NAMES = _SHORT | {name: name for name in (*OBSERVABLES, *NUMBERS)}
_WORDS_OF_RESULT = {
    "crank_angle": "theta, or for phi, of the cylinder compared",
    "crank_speed": "omega",
    "crank_acceleration": "alpha",
}  # names of a result, and the words for them
_NAMES_LISTED = f"{', '.join((*QUANTITIES, *NUMBERS))}, and the variables of a result"
_RESERVED_LABELS = ("run", CLOSED_FORM, *LECTURES, *map(short_name, LECTURES))
_LIFTED_BY = {
    "constant speed": {"omega", "alpha"},
    "two-mass rod": {"rod_inertia", "reduced_inertia", "reduced_slope"},
    "gravity": {"gravity_x", "gravity_y", "generalized_force"},
    "friction": {"friction_force"},
    "forces": {"applied_force"},
}


@dataclass(frozen=True)
class Formula:
    """label : under which it is shown; quantity : what it gives; words : what it asks for."""

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
        """The causes that its error includes, as it asks for none of the words that lift them."""
        return frozenset(
            cause for cause, words in _LIFTED_BY.items() if not words & set(self.words)
        )

    def curve(self, excerpt: Excerpt) -> Array:
        """Its values at the samples of a run, shape (n,).

        Raises
        ------
        InputError : it raises, or gives other than n finite numbers
        """
        answer = self._evaluate(excerpt)
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
        not_finite = np.flatnonzero(~np.isfinite(values))
        if len(not_finite):
            theta = excerpt.theta[not_finite[0]]
            raise InputError(
                f"{self.label}: must give finite numbers; {values[not_finite[0]]} came at "
                f"{len(not_finite)} of {n} samples, first at theta = {theta:.6g} rad; give there "
                "what the formula tends to"
            )
        return values

    def depends_on_angle_alone(self, excerpt: Excerpt) -> bool:
        """Whether its value at a sample stays what it is without every other sample; that of a
        running sum or of harmonics does not."""
        every, second = self.curve(excerpt), slice(None, None, 2)
        variables = {name: rows[second] for name, rows in excerpt.variables.items()}
        try:
            fewer = self.curve(replace(excerpt, variables=variables))
        except InputError:  # it may count on so many samples
            return False
        return bool(np.all(np.abs(fewer - every[second]) <= _SAME * np.max(np.abs(every))))

    def number(self, excerpt: Excerpt) -> float:
        """Its one number for a run.

        Raises
        ------
        InputError : it raises, or gives other than a single finite number
        """
        answer = self._evaluate(excerpt)
        if answer.shape != () or not np.isfinite(answer):
            text = f"an array of shape {answer.shape}" if answer.shape else str(answer)
            raise InputError(f"{self.label}: the {self.quantity} is one finite number; {text} came")
        return float(answer)

    def _evaluate(self, excerpt: Excerpt) -> Array:
        """What the function returns, as numbers, without numpy's warnings; callers check it."""
        about = NUMBERS[self.quantity] if self.is_number else OBSERVABLES[self.quantity]
        words = Words(excerpt, per_cylinder=about.per_cylinder)
        arguments = {name: copy(words[name]) for name in self.words}  # the function may write
        try:
            with np.errstate(all="ignore"):
                answer = self.function(**arguments)
        except Exception as error:  # whatever the function of a user may raise
            exception = f"{type(error).__name__}: {error}".rstrip(": ")
            raise InputError(
                f"{self.label}: {named(self.function)} raises {exception}; it is called with "
                f"{', '.join(_described(*pair) for pair in arguments.items()) or 'nothing'}"
            ) from error
        try:
            return np.asarray(answer).astype(np.float64, casting="same_kind")
        except (TypeError, ValueError):
            raise InputError(
                f"{self.label}: {named(self.function)} must give real numbers; {shown(answer)} came"
            ) from None


def formulas_of(functions: Mapping[str, Callable[..., Any]] | None) -> tuple[Formula, ...]:
    """Formulas from functions by their labels.

    Raises
    ------
    InputError : no such mapping; a label that is taken, no function, one that names no quantity, a
        parameter that is no word
    """
    if functions is None:
        return ()
    if not isinstance(functions, Mapping):
        raise InputError(
            'formulas must be functions by their labels, such as {"my series": function}; '
            f"{shown(functions)} came"
        )
    return tuple(formulated(label, function) for label, function in functions.items())


def variables_of(formulas: Sequence[Formula]) -> tuple[str, ...]:
    """The variables of a result that formulas stand for, beside the lectures' quantities."""
    quantities = dict.fromkeys(formula.quantity for formula in formulas)
    return tuple(quantity for quantity in quantities if quantity not in QUANTITIES)


def formulated(label: str, function: Callable[..., Any]) -> Formula:
    """The formula from one function.

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
    if label in _RESERVED_LABELS:
        raise InputError(f"{label}: this is what another curve is called; choose another label")
    if not callable(function):
        raise InputError(f"{label}: must be a function; {shown(function)} came")
    quantity = _quantity(named(function)) or _quantity(label)
    if quantity is None:
        name = _spaced(named(function)) if named(function) != "<lambda>" else _spaced(label)
        raise InputError(
            f"{label}: a formula stands for the quantity that its function's name begins with, or "
            f"its label; {shown(named(function))} names none"
            + (did_you_mean(name, list(_QUANTITY_NAMES)) or f"; there are {_NAMES_LISTED}")
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
    for parameter in parameters:
        if parameter.kind in (parameter.VAR_POSITIONAL, parameter.VAR_KEYWORD):
            continue
        if parameter.name in WORDS and parameter.kind != parameter.POSITIONAL_ONLY:
            words.append(parameter.name)
        elif parameter.default is parameter.empty:
            raise InputError(
                f"{label}: the parameter {parameter.name} of {named(function)} "
                f"{_no_word(parameter.name)}"
            )
    return tuple(words)


def _no_word(name: str) -> str:
    """Why a parameter has no value, and the way out."""
    if name in WORDS:
        return "must be given by name; leave out the / after it"
    if name in _WORDS_OF_RESULT:
        return f"is nothing it can be given; ask for {_WORDS_OF_RESULT[name]}"
    hint = did_you_mean(name, list(WORDS)) or f"; there are {', '.join(WORDS)}"
    return f"is nothing it can be given{hint}"


def _quantity(text: str) -> str | None:
    """The quantity that a name begins with, the longest of several."""
    spaced = _spaced(text)
    matches = [name for name in _QUANTITY_NAMES if f"{spaced} ".startswith(f"{name} ")]
    return _QUANTITY_NAMES[max(matches, key=len)] if matches else None


def _spaced(text: str) -> str:
    """A name or label in plain words: blanks for whatever else stands between them."""
    return " ".join("".join(c if c.isalnum() or c == "-" else " " for c in text).split()).lower()


def _described(name: str, value: Array | float) -> str:
    return f"{name} of shape {value.shape}" if isinstance(value, np.ndarray) else name
