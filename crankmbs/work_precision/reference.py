"""The reference at the limit of double precision."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

from crankmbs.choose import choose
from crankmbs.result import Result
from crankmbs.scene.run import Extent
from crankmbs.scene.scene import Scene
from crankmbs.simulate import simulate
from crankmbs.work_precision.trace import Trace, stated, trace_of

__all__ = ["Reference", "reference_of"]

_RTOL = 1e-13  # the finest that a run can be asked for
_ROUNDING = 1e-13  # what rounding the scene's numbers changes over some ten revolutions
_PER_TURN = 10  # samples that the peers give


@dataclass(frozen=True)
class Reference:
    """A run at the limit of double precision.

    result : on the scene's samples, which `trace` holds
    floors : by name, its error, relative as in `differences`: what it states, or rounding
    """

    result: Result
    trace: Trace
    floors: dict[str, float]

    @property
    def start(self) -> float:
        """Crank angle at time 0 [rad]."""
        return _origin(self.result.scene)

    def sentence(self) -> str:
        """What it is, and how it was checked."""
        result, floor = self.result, max(self.floors.values())
        if result.formulation == "kinetostatic":
            return f"kinetostatic, algebra: nothing is integrated, rounding {floor:.1g}"
        return (
            f"{result.formulation} at rtol {_RTOL:g}, two passes of different order agree within "
            f"{floor:.1g}"
        )

    def at_times(self) -> Trace:
        """The same motion at equal times, ten a revolution, for contenders of fixed step."""
        data = self.result.data
        end = float(data["time"].values[-1])
        turns = abs(float(data["crank_angle"].values[-1]) - self.start) / (2.0 * math.pi)
        every = Extent(value=end / max(math.ceil(_PER_TURN * turns), 1), unit="s")
        run = replace(self.result.scene.run, until=Extent(value=end, unit="s"), every=every)
        return trace_of(_run(replace(self.result.scene, run=run)))


def reference_of(scene: Scene) -> Reference:
    """Solve a scene as exactly as double precision lets it: algebra, or the crank angle."""
    result = _run(scene)
    trace = trace_of(result)
    floors = stated(result, trace, _origin(scene))
    return Reference(result, trace, {name: max(floors[name], _ROUNDING) for name in floors})


def _run(scene: Scene) -> Result:
    return simulate(scene, formulation=choose(scene).formulation, rtol=_RTOL)


def _origin(scene: Scene) -> float:
    origin = scene.motion if scene.start is None else scene.start
    assert origin is not None
    return origin.angle
