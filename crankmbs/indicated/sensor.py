"""From a sensor's volts to pressures: a formula, or two points."""

from __future__ import annotations

import ast
import operator
import re
from collections.abc import Callable
from typing import Any

import numpy as np

from crankmbs.errors import InputError, shown
from crankmbs.numerics.arrays import Array
from crankmbs.scene.units import quantity

__all__ = ["Sensor", "sensor_of"]

Sensor = Callable[[Array], Array]

_POINT = r"\s*([+-]?[\d.]+(?:[eE][+-]?\d+)?)\s*(m?)V\s*=\s*([^,=]+?)\s*"
_POINTS = re.compile(f"{_POINT},{_POINT}")
_FORMULA = re.compile(r"(.*[\dV.)])\s+([^\s\d()]\S*)\s*")
_OPERATIONS: dict[type[ast.AST], Callable[[Any, Any], Any]] = {
    ast.Add: operator.add,
    ast.Sub: operator.sub,
    ast.Mult: operator.mul,
    ast.Div: operator.truediv,
    ast.Pow: operator.pow,
}


def sensor_of(value: Any) -> Sensor:
    """The function from volts to Pa, shape (...) each, that a text says.

    Parameters
    ----------
    value : a formula in V and the unit of its pressure, "(V/5 - 0.115)/0.00385 bar", or two points,
        "0.5 V = 0 bar, 4.5 V = 100 bar"

    Raises
    ------
    InputError : neither of them

    >>> sensor_of("0.5 V = 0 bar, 4.5 V = 100 bar")(np.array([2.5])).tolist()
    [5000000.0]
    >>> sensor_of("V**2 / 2 bar")(np.array([4.0])).tolist()
    [800000.0]
    """
    if callable(value):
        return value  # type: ignore[no-any-return]
    points = _POINTS.fullmatch(value) if isinstance(value, str) else None
    if points is not None:
        return _line(points, value)
    formula = _FORMULA.fullmatch(value.strip()) if isinstance(value, str) else None
    if formula is None:
        raise InputError(_rule(value))
    try:
        tree = ast.parse(formula[1].strip(), mode="eval").body
        float(np.max(_evaluated(tree, 1.0)))
    except (SyntaxError, ZeroDivisionError, OverflowError, TypeError, ValueError):
        raise InputError(_rule(value)) from None
    unit = quantity(f"1 {formula[2]}", "pressure")
    return lambda volts: _evaluated(tree, volts) * unit + 0.0 * volts


def _line(points: re.Match[str], value: str) -> Sensor:
    volts = [float(points[k]) * (1e-3 if points[k + 1] else 1.0) for k in (1, 4)]
    pressures = [quantity(points[k], "pressure") for k in (3, 6)]
    if volts[0] == volts[1]:
        raise InputError(f"two points have two voltages; {shown(value)} came")
    slope = (pressures[1] - pressures[0]) / (volts[1] - volts[0])
    return lambda signal: pressures[0] + slope * (signal - volts[0])


def _evaluated(node: ast.expr, volts: Any) -> Any:
    """The value of a formula of numbers, V, + - * / ** and brackets."""
    match node:
        case ast.Constant(value=int() | float() as number):
            return float(number)
        case ast.Name(id="V"):
            return volts
        case ast.BinOp(left=left, op=op, right=right) if type(op) in _OPERATIONS:
            return _OPERATIONS[type(op)](_evaluated(left, volts), _evaluated(right, volts))
        case ast.UnaryOp(op=ast.USub(), operand=operand):
            return -_evaluated(operand, volts)
    raise ValueError


def _rule(value: Any) -> str:
    return (
        'must be a formula in V with the unit of its pressure, "(V/5 - 0.115)/0.00385 bar", or two '
        f'points, "0.5 V = 0 bar, 4.5 V = 100 bar"; {shown(value)} came'
    )
