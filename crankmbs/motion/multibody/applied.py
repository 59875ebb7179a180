"""Forces from outside on the pistons: on whole arrays, and by number as exudyn calls them."""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np

from crankmbs.mechanics.geometry import bottom_position, throw_angles, top_position
from crankmbs.mechanics.knots import KNOT, apart
from crankmbs.mechanics.train import CrankTrain
from crankmbs.mechanics.windows import Phase
from crankmbs.motion.mode import Mode
from crankmbs.numerics.arrays import Array
from crankmbs.numerics.cycle import Cycle
from crankmbs.scene.force import Law, PistonForce
from crankmbs.scene.parts import RunningGear

__all__ = ["Applied", "Push"]

Push = Callable[[float, float, float, float], float]
"""A force [N] on a piston towards the crank: of time [s], crank angle [rad], displacement [m] and
velocity towards the crank [m/s]."""

_TURN = 2.0 * math.pi
_MOST_BENDS = 12  # over the travel: more are run over
_SIDE = 3.0 * KNOT  # rad: so near beside an angle at which a force may jump


class Applied:
    """The forces of a scene.

    angles : crank angles [rad] in a period of the train at which one jumps
    times : [s], at which one jumps or bends
    switches : whether one changes with the sense of sliding
    """

    def __init__(self, train: CrankTrain) -> None:
        scene, self._train = train.scene, train
        self._forces, self._first = scene.force, len(scene.torque)
        self._phases = np.array([cylinder.phase for cylinder in scene.cylinders])
        self._gears = scene.running_gear
        laws = [force.law for force in self._forces]
        self.switches = any(law.switches or law.given for law in laws)
        jumps = [
            self._jumps(law, gear) - phase
            for law in laws
            for gear, phase in zip(self._gears, self._phases, strict=True)
        ]
        own = np.mod(np.concatenate([np.empty(0), *jumps]), _TURN)
        turns = _TURN * np.arange(round(train.period / _TURN))
        self.angles = apart(np.add.outer(turns, own).ravel())
        given = [law.given.times for law in laws if law.given is not None]
        rows = [law.over_time.bends for law in laws if law.over_time is not None]
        self.times = tuple({time for times in (*given, *rows) for time in times})

    def _jumps(self, law: Law, gear: RunningGear) -> Array:
        """Cycle angles [rad] of a cylinder in a revolution at which a force jumps; or, where such
        places are few, bends over the travel."""
        stroke = top_position(*gear.shape) - bottom_position(*gear.shape)
        ways = [way for way in (law.forward, law.back) if way is not None]
        bends = {row for way in ways for row in way.bends}
        jumps = {row for way in ways for row in way.jumps}
        chosen = bends if len(bends) <= _MOST_BENDS else jumps
        rows = np.array(sorted(row for row in chosen if 0.0 < row < stroke))
        found = [*throw_angles(rows, stroke - rows, *gear.shape)]
        if law.over_angle is not None:
            knots = law.over_angle.knots[:-1]
            rises = np.abs(law.over_angle(knots) - law.over_angle(knots - _SIDE))
            found.append(knots[rises > 1e-6 * law.over_angle.largest])
        if law.given is not None:
            found.append(np.array(law.given.angles))
        return np.mod(np.concatenate(found), _TURN)

    def _on(self, force: PistonForce, k: int) -> bool:
        return force.cylinder in (None, k + 1)

    def forces(
        self, motion: tuple[Array, Array, Array], acts: Array, slides: Array, x: Array, v: Array
    ) -> Array:
        """Forces [N] towards the crank, shape (m, n), at times [s], crank angles [rad], speeds.

        acts : shape (m, loads), which loads do, torques first
        slides : shape (m, n), signs of the pistons' velocities; x, v : their positions from the
            crank axis [m], and velocities towards the crank [m/s]
        """
        time, theta, _ = motion
        tops = np.array([top_position(*gear.shape) for gear in self._gears])
        total, down = np.zeros_like(x), tops - x
        for number, force in enumerate(self._forces, start=self._first):
            for k in range(x.shape[1]):
                if not self._on(force, k):
                    continue
                law, phi = force.law, theta + self._phases[k]
                found = -law.viscous * v[:, k]
                if law.forward is not None and law.back is not None:
                    ways = law.forward(down[:, k]), law.back(down[:, k])
                    found += np.where(slides[:, k] > 0.0, *ways)
                found += 0.0 if law.over_angle is None else law.over_angle(phi)
                found += 0.0 if law.over_time is None else law.over_time(time)
                if law.given is not None:
                    at = zip(time, phi, down[:, k], v[:, k], strict=True)
                    found += np.array([law.given.function(*map(float, one)) for one in at])
                total[:, k] += np.where(acts[:, number], found, 0.0)
        return total

    def by_number(self, k: int, mode: Mode, slides: float) -> list[Push]:
        """Those that act on the piston of the cylinder k, which slides with this sign."""
        found = []
        for number, force in enumerate(self._forces, start=self._first):
            acts = not mode.loads or mode.loads[number] is Phase.ACTING
            if acts and self._on(force, k):
                found.append(_push(force.law, float(self._phases[k]), slides))
        return found


def _push(law: Law, phase: float, slides: float) -> Push:
    """A force number by number; over the travel by its way, on straight beyond."""
    way = law.forward if slides > 0.0 else law.back
    over_angle = Cycle.by_number(law.over_angle) if law.over_angle is not None else None
    over_time, viscous, given = law.over_time, law.viscous, law.given

    def force(time: float, theta: float, displacement: float, velocity: float) -> float:
        value = -viscous * velocity
        if way is not None:
            a, b, c = way.piece(displacement, after=slides > 0.0)[0]
            value += a + (b + c * displacement) * displacement
        if over_angle is not None:
            value += over_angle(theta + phase)
        if over_time is not None:
            a, b, c = over_time.piece(time, after=True)[0]
            value += a + (b + c * time) * time
        if given is not None:
            value += given.function(time, theta + phase, displacement, velocity)
        return value

    return force
