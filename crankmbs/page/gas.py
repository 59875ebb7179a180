"""The gas of a scene for the browser: pressures, and what they were made of."""

from __future__ import annotations

from typing import Any

from crankmbs.mechanics.cycle_rows import rows_of
from crankmbs.mechanics.pressure import PeriodicPressure
from crankmbs.mechanics.train import CrankTrain
from crankmbs.numerics.arrays import Array
from crankmbs.scene.gas import AnyPressure, Gas, Indicator, Polytrope
from crankmbs.scene.scene import Scene

__all__ = ["exported_gas"]

_DIAGRAM = (
    "compression_ratio",
    "n_compression",
    "n_expansion",
    "intake_pressure",
    "exhaust_pressure",
    "peak_pressure",
    "pre_expansion",
)


def exported_gas(scene: Scene, train: CrankTrain) -> dict[str, Any] | None:
    """What pushes every piston over its area, with fuel without combustion and `firing`, and the
    crank ends, as cycles; the sources of the pressures, and by number which is that of which
    cylinder, `below` of the crank ends; the shape that they belong to, None where cylinders are
    unlike. None without gas.

    >>> scene = load_scene("v_twin")
    >>> exported_gas(scene, crank_train(scene))["fired"]
    [0, 0]
    """
    gas = scene.gas
    if gas is None or train.pressure is None:
        return None
    sources = _Sources(scene, gas)
    fired = sources.numbers(gas.pressure if gas.indicator is None else gas.indicator, fires=True)
    motored = None
    if scene.fuel is not None:
        given = gas.motored if gas.indicator is None else gas.indicator
        motored = sources.numbers(given, fires=False)
    return {
        "shape": None if scene.unlike else _shape(scene),
        "pressure": [_cycle(each) for each in train.pressure],
        "firing": list(map(_sum, train.pressure, train.combustion or ())),
        "crank_end": [_cycle(each) for each in train.crank_end or ()],
        "sources": sources.exported,
        "fired": fired,
        "motored": motored,
        "below": [] if gas.crank_end is None else sources.numbers(gas.crank_end, fires=False),
        "period": gas.period,
        "ambient": gas.ambient or 0.0,
    }


def _shape(scene: Scene) -> dict[str, float]:
    return {
        "radius": scene.crank.radius,
        "length": scene.rod.length,
        "offset": scene.piston.offset,
    }


def _sum(one: PeriodicPressure, other: PeriodicPressure) -> dict[str, Array]:
    """The sum of two cycles with the same knots."""
    return {**_cycle(one), "coefficients": (one.coefficients + other.coefficients).ravel()}


def _cycle(pressure: PeriodicPressure) -> dict[str, Array]:
    return {"knots": pressure.knots, "coefficients": pressure.coefficients.ravel()}


class _Sources:
    """The different sources that have come, numbered."""

    def __init__(self, scene: Scene, gas: Gas) -> None:
        self._scene, self._gas = scene, gas
        self.exported: list[dict[str, Any]] = []

    def numbers(
        self, given: AnyPressure | Indicator | Polytrope | None, *, fires: bool
    ) -> list[int]:
        """The numbers of the sources of the cylinders."""
        count, gas = len(self._scene.cylinders), self._gas
        if isinstance(given, float):
            value = given - (gas.ambient or 0.0)
            return [self._number({"kind": "constant", "value": value})] * count
        if isinstance(given, Indicator):
            numbers = {name: getattr(given, name) for name in _DIAGRAM}
            return [self._number({"kind": "indicator", "fires": fires, **numbers})] * count
        if isinstance(given, Polytrope):
            names = ("polytrope", "closes", "compression_ratio")
            numbers = {name: getattr(given, name) for name in names}
            return [self._number({"kind": "polytrope", **numbers})] * count
        assert given is not None
        rows = rows_of(self._scene, gas, given)
        once = {
            id(row): self._number(
                {
                    "kind": "rows",
                    "angle": row.angle,
                    "value": row.value,
                    "jumps": bool(row.jumps),
                    "interpolation": gas.interpolation,
                }
            )
            for row in rows
        }
        return [once[id(row)] for row in rows]

    def _number(self, source: dict[str, Any]) -> int:
        self.exported.append(source)
        return len(self.exported) - 1
