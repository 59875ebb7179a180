"""Counterweights for a share of the reciprocating mass, and what the frame still feels."""

from __future__ import annotations

import cmath
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from functools import partial

import numpy as np

from crankmbs.errors import InputError
from crankmbs.lecture import two_mass_rod
from crankmbs.measures import Estimate, Orders
from crankmbs.measures.orders import Harmonics
from crankmbs.numerics.arrays import Array
from crankmbs.result import Result
from crankmbs.scene.bearings import throw_numbers
from crankmbs.scene.parts import RunningGear
from crankmbs.scene.scene import Scene
from crankmbs.simulate import simulate

__all__ = ["Balance", "Remaining", "balance"]

_ALONG = 1e-9  # of a throw's counterweight: what lies across the reference line, or is left
_ORDERS = (1.0, 2.0)
_VECTORS = ("frame force", "rocking moment")


@dataclass(frozen=True)
class Remaining:
    """One order of a vector on the frame [units], before and after.

    direction : "x" or "y", amplitudes along the engine's axes; "largest", the length of the vector
        where it is longest in a turn of its order
    """

    quantity: str
    direction: str
    order: float
    units: str
    before: Estimate
    after: Estimate


@dataclass(frozen=True)
class Balance:
    """Counterweights, mass times radius [kg m], and what remains.

    share : of the reciprocating mass
    per_throw : opposite each throw, in the order of `crankmbs.scene.bearings.throw_numbers`, for
        the masses of its rods at the crank pin and the share of their reciprocating masses; in all,
        also what a throw_unbalance of the scene's bearings has of it
    of_crank : opposite the crank's centre of mass; negative: as much less of what it has
    remaining : orders 1 and 2 of the force and, where cylinders have places, rocking moment
    result : the run they are taken from
    before, after : shape (n, 2) [N], force on the frame along X and Y at the samples of ``result``
    """

    share: float
    per_throw: tuple[float, ...]
    of_crank: float
    remaining: tuple[Remaining, ...]
    result: Result
    before: Array
    after: Array

    @property
    def crank(self) -> dict[str, float]:
        """mass [kg] and center_of_mass [m] of the scene's crank with the counterweights.

        The crank keeps its mass; where it has none, the counterweight stands opposite the throw at
        the crank radius. Of a crank whose throws stand in several directions they are those of all
        counterweights together.

        Raises
        ------
        InputError : the counterweights do not lie along the crank's reference line

        >>> crank = balance(load_scene("propeller"), 0.5).crank
        >>> f"{crank['mass']:.4g} kg at {1e3 * crank['center_of_mass']:.4g} mm"
        '5 kg at -16.54 mm'
        """
        scene = self.result.scene
        throws = np.exp(1j * _places(scene)[0])
        moment = complex(-np.array(self.per_throw) @ throws)
        if abs(moment) <= _ALONG * max(self.per_throw):  # they cancel
            moment = 0j
        if abs(moment.imag) > _ALONG * max(self.per_throw):
            at = float(np.degrees(np.angle(moment)))
            turn = (at + 90.0) % 180.0 - 90.0  # to the nearer end of the reference line
            more, less = ("from", "to") if turn > 0.0 else ("to", "from")
            where = "[start]" if scene.motion is None else "[motion]"
            verb, back = ("take", "add") if turn > 0.0 else ("add", "take")
            raise InputError(
                f"the counterweights together, {abs(moment):.6g} kg m at {at:.6g} degrees, do not "
                "lie along the crank's reference line, where center_of_mass is; to turn that line "
                f"{verb} {abs(turn):.6g} degrees {more} every phase of [layout], and {back} as "
                f"much {less} the angle of {where}; the centre of mass that the crank has turns "
                "with it"
            )
        radius = scene.crank.radius
        mass = scene.crank.mass or abs(float(moment.real)) / radius
        return {"mass": mass, "center_of_mass": float(moment.real) / mass if mass else 0.0}

    @property
    def throw_unbalance(self) -> tuple[float, ...] | None:
        """throw_unbalance [kg m] of the scene's bearings with the counterweights; None where no
        journals hold the throws, so that the crank is one body.

        >>> balance(load_scene("propeller"), 0.5).throw_unbalance is None
        True
        """
        if self.result.scene.throws is None:
            return None
        return tuple(-moment for moment in self.per_throw)


def balance(scene: Scene, share: float = 0.5, *, cost_cap: float = 10.0) -> Balance:
    """Balance a machine's rotating mass and a share of its reciprocating mass.

    per_throw = sum r (m_B + share m_A),  m_A = m_piston + m_rod a / l,  m_B = m_rod (l - a) / l

    summed over the rods of a throw, opposite it, in its plane, and m c opposite the crank's centre
    of mass, or in place of that what takes the unbalance of each throw of [bearings] away. What the
    frame feels before is `frame_force` and `rocking_moment` of a run over its last whole cycle;
    after, with what the counterweights add to it in the same motion, but for their moment of
    inertia, which at a prescribed speed is exact.

    Parameters
    ----------
    share : 0 to 1
    cost_cap : as `simulate` takes it [s]

    Raises
    ------
    InputError : the share; what `crankmbs.orders` refuses of the run

    >>> weights = balance(load_scene("yi_diesel"), 0.5)
    >>> print(weights.remaining[0].after.value < weights.remaining[0].before.value)
    True
    """
    if not 0.0 <= share <= 1.0:
        raise InputError(f"share must be from 0 to 1 of the reciprocating mass; {share!r} came")
    per_throw = [0.0] * (max(throw_numbers(scene)) + 1)
    for throw, gear in zip(throw_numbers(scene), scene.running_gear, strict=True):
        per_throw[throw] += _counterweight(gear, share)
    weights = _Weights(scene, tuple(per_throw), scene.crank.mass * scene.crank.center_of_mass)
    result = simulate(scene, cost_cap=cost_cap)
    data = {name: values for name, (_, values, _) in result.variables.items()}
    before = np.stack([data["frame_force_x"], data["frame_force_y"]], axis=1)
    after = before + weights.on_frame(data)["frame_force"]
    remaining = tuple(_remaining(result, weights))
    return Balance(share, weights.per_throw, weights.of_crank, remaining, result, before, after)


def _counterweight(gear: RunningGear, share: float) -> float:
    """For the rotating mass of one rod and a share of its reciprocating mass [kg m]."""
    rod = gear.rod
    masses = two_mass_rod(
        rod_mass=rod.mass, rod_length=rod.length, center_of_mass=rod.center_of_mass
    )
    reciprocating = gear.piston.mass + float(masses.piston_pin)
    return gear.radius * (float(masses.crank_pin) + share * reciprocating)


def _places(scene: Scene) -> tuple[Array, Array]:
    """Of each throw its angle [rad] from the crank's reference line and its place along the crank
    [m] from the middle, 0 where none is given: amid its rods, as bearings take it."""
    numbers = np.array(throw_numbers(scene))
    levers = np.array(scene.levers or (0.0,) * len(numbers))
    turns = np.array([c.phase + c.bank for c in scene.cylinders])
    count = range(int(numbers.max()) + 1)
    angles = np.array([turns[numbers == throw][0] for throw in count])
    return angles, np.array([levers[numbers == throw].mean() for throw in count])


@dataclass(frozen=True)
class _Weights:
    """Counterweights opposite each throw and opposite the crank's centre of mass [kg m]."""

    scene: Scene
    per_throw: tuple[float, ...]
    of_crank: float

    def on_frame(self, variables: Mapping[str, Array]) -> dict[str, Array]:
        """Their -m a and, where cylinders have places, its moment, shape (n, 2)."""
        names = ("crank_angle", "crank_speed", "crank_acceleration")
        theta, omega, alpha = (variables[name] for name in names)
        force, rocking = np.zeros((len(theta), 2)), np.zeros((len(theta), 2))
        throws = zip(self.per_throw, *_places(self.scene), strict=True)
        for moment, angle, lever in [*throws, *self._of_crank()]:
            cosine, sine = np.cos(theta + angle), np.sin(theta + angle)
            x = -moment * (cosine * omega**2 + sine * alpha)
            y = -moment * (sine * omega**2 - cosine * alpha)
            force += np.stack([x, y], axis=1)
            rocking += lever * np.stack([-y, x], axis=1)
        return {"frame_force": force, "rocking_moment": rocking}

    def _of_crank(self) -> Iterator[tuple[float, float, float]]:
        """What takes away the unbalances that the crank has, at its throws or in its middle: size
        [kg m], angle [rad] and place along the crank [m]."""
        throws = self.scene.throws
        if throws is None:
            yield self.of_crank, 0.0, 0.0
            return
        for unbalance, lever in zip(throws.unbalances, throws.levers, strict=True):
            yield abs(unbalance), cmath.phase(unbalance), lever


def _remaining(result: Result, weights: _Weights) -> Iterator[Remaining]:
    harmonics = Harmonics(result, max(_ORDERS))
    for quantity in _VECTORS:
        vector = quantity.replace(" ", "_")
        names = [f"{vector}_{axis}" for axis in "xy"]
        if names[0] not in result.data:
            continue
        units = str(result.data[names[0]].attrs["units"])
        before = [harmonics.of(name) for name in names]
        after = [harmonics.split(partial(_balanced, weights, vector, k)) for k in range(2)]
        for order in _ORDERS:
            k = int(np.flatnonzero(harmonics.order == order)[0])
            for axis, old, new in zip("xy", before, after, strict=True):
                yield Remaining(quantity, axis, order, units, _one(old, k), _one(new, k))
            longest = _largest(before, k), _largest(after, k)
            yield Remaining(quantity, "largest", order, units, *longest)


def _balanced(weights: _Weights, vector: str, axis: int, variables: Mapping[str, Array]) -> Array:
    """One component of a vector on the frame, with what the counterweights add."""
    added = weights.on_frame(variables)[vector][:, axis]
    return np.asarray(variables[f"{vector}_{'xy'[axis]}"] + added)


def _one(split: Orders, k: int) -> Estimate:
    return Estimate(float(split.amplitude[k]), split.error)


def _largest(parts: list[Orders], k: int) -> Estimate:
    """The longer half axis of the ellipse that one order's vector runs along."""
    along, across = (o.amplitude[k] * np.exp(1j * o.phase[k]) for o in parts)
    length = 0.5 * (abs(along + 1j * across) + abs(along - 1j * across))
    return Estimate(float(length), sum(o.error for o in parts))
