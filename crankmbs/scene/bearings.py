"""What carries the crank: shells, places of the main journals, counterweights of the throws.

The load of the journals is the usual statically determinate split, an approximation: each throw,
with its rods, its unbalance and its weight, is held by the two journals beside it as a beam on two
supports. A stiff crank in more than two bearings shares it otherwise, by how it and they bend.
"""

from __future__ import annotations

import cmath
import math
from collections.abc import Sequence
from itertools import pairwise
from typing import TYPE_CHECKING, Annotated, NamedTuple

from annotated_types import Len

from crankmbs.errors import InputError
from crankmbs.scene.parts import Distance, Length
from crankmbs.scene.schema import Float, part, si

if TYPE_CHECKING:
    from crankmbs.scene.scene import Scene

__all__ = ["Bearings", "Shell", "Throws", "throw_numbers", "throws_of"]

_SAME = 1e-9  # rad: throws nearer than this stand at one angle
_CLOSES = 1e-6  # of the largest unbalance: so near is the sum of all to the crank's

_SPLIT = (
    "split pins with no journal between them cannot be described: without throw, main_journal and "
    "journal_positions each is a throw of its own, and the loads of crank pins and of the main "
    "bearing as a whole are right, but not its split among journals"
)


@part
class Shell:
    """A plain bearing: diameter and width [m]."""

    diameter: Length
    width: Length

    @property
    def area(self) -> float:
        """Projected area [m2], over which a specific load is taken.

        >>> Shell(diameter="60 mm", width="30 mm").area
        0.0018
        """
        return self.diameter * self.width


@part
class Bearings:
    """Shells of the crank pins and of the main journals.

    crank_pin : of one rod; main_journal : of each
    journal_positions [m] : along the crank, one more than throws; left out, halfway between throws
        and the outer two as far outside as the next ones are inside; of one throw both carry half
    throw_unbalance [kg m] : mass times radius of each throw along it, negative for a counterweight;
        left out, the crank's mass times center_of_mass is shared equally
    """

    crank_pin: Shell | None = None
    main_journal: Shell | None = None
    journal_positions: Annotated[tuple[Distance, ...], Len(2)] | None = None
    throw_unbalance: Annotated[tuple[Annotated[Float, si("unbalance")], ...], Len(1)] | None = None


class Throws(NamedTuple):
    """The throws of a crank and the main journals that hold them, one more than throws.

    numbers : of each cylinder's throw, from 0
    rods : for each journal the share of every cylinder's load that it carries
    throws : for each journal the share of what belongs to every throw itself
    unbalances : of each throw, complex [kg m], in the engine's frame at crank angle 0
    levers : how far each throw stands beyond the middle of the crank [m]; 0 of one without a place
    journals : their places along the crank [m]; none where one throw is held by halves
    """

    numbers: tuple[int, ...]
    rods: tuple[tuple[float, ...], ...]
    throws: tuple[tuple[float, ...], ...]
    unbalances: tuple[complex, ...]
    levers: tuple[float, ...]
    journals: tuple[float, ...]

    @property
    def shared(self) -> bool:
        """Whether two rods share a pin."""
        return len(self.throws[0]) < len(self.numbers)


def throws_of(scene: Scene) -> Throws | None:
    """The throws of a scene with bearings; None of another, and where the throws have no places.

    Raises
    ------
    InputError : throws, places or unbalances that contradict one another

    >>> scene = load_scene("propeller").with_(bearings=Bearings())
    >>> throws_of(scene).rods
    ((0.5,), (0.5,))
    """
    bearings, numbers = scene.bearings, throw_numbers(scene)
    if bearings is None:
        return None
    count = max(numbers) + 1
    places = [cylinder.position for cylinder in scene.cylinders]
    if count > 1 and None in places:
        if (bearings.main_journal, bearings.journal_positions, bearings.throw_unbalance) == (
            (None,) * 3
        ):
            return None
        raise InputError(
            f"bearings: what each journal carries depends on where the {count} throws stand; give "
            "layout.spacing or each cylinder's position along the crank"
        )
    along = [place or 0.0 for place in places]
    middles = [
        math.fsum(z for z, k in zip(along, numbers, strict=True) if k == throw)
        / numbers.count(throw)
        for throw in range(count)
    ]
    journals = _journals(bearings, middles)
    return Throws(
        numbers,
        _shares(journals, numbers, along),
        _shares(journals, range(count), middles),
        _unbalances(scene, bearings, numbers, count),
        tuple(place - 0.5 * (min(along) + max(along)) for place in middles),
        tuple(journals),
    )


def throw_numbers(scene: Scene) -> tuple[int, ...]:
    """The throw of each cylinder, from 0; where none is given, one for each along the crank.

    Raises
    ------
    InputError : throws that contradict one another

    >>> throw_numbers(load_scene("v_twin"))
    (0, 1)
    """
    cylinders = scene.cylinders
    throws = [cylinder.throw for cylinder in cylinders]
    if None in throws:
        if any(number is not None for number in throws):
            raise InputError("layout.cylinders: give the throw of every cylinder or of none")
        places = [
            c.position if c.position is not None else float(k) for k, c in enumerate(cylinders)
        ]
        order = sorted(range(len(places)), key=places.__getitem__)
        return tuple(order.index(k) for k in range(len(places)))
    numbers = [number - 1 for number in throws if number is not None]
    if sorted(set(numbers)) != list(range(max(numbers) + 1)):
        raise InputError(
            f"layout.cylinders: throws are numbered from 1 without a gap; "
            f"{sorted({number + 1 for number in numbers})} came"
        )
    turns = [cmath.exp(1j * (c.phase + c.bank)) for c in cylinders]
    for k, number in enumerate(numbers):
        first = numbers.index(number)
        if abs(turns[k] - turns[first]) > _SAME:
            at = [math.degrees(cylinders[i].phase + cylinders[i].bank) % 360.0 for i in (first, k)]
            raise InputError(
                f"layout.cylinders[{k + 1}].throw: cylinders of one throw share a pin, so phase + "
                f"bank is the same; cylinders {first + 1} and {k + 1} of throw {number + 1} have "
                f"{at[0]:.6g} and {at[1]:.6g} degrees; {_SPLIT}"
            )
        radii = [scene.running_gear[i].radius for i in (first, k)]
        if radii[0] != radii[1]:
            raise InputError(
                f"layout.cylinders[{k + 1}].throw: cylinders of one throw share a pin, so its "
                f"radius is the same; cylinders {first + 1} and {k + 1} of throw {number + 1} have "
                f"{radii[0]:.6g} and {radii[1]:.6g} m"
            )
    return tuple(numbers)


def _journals(bearings: Bearings, throws: list[float]) -> list[float]:
    """Places of the journals along the crank [m]; none where one throw is held by halves."""
    positions = bearings.journal_positions
    steps = [b - a for a, b in pairwise(throws)]
    if any(step * steps[0] <= 0.0 for step in steps):
        raise InputError(
            "layout.cylinders: throws follow one another along the crank by their numbers; those "
            f"at {', '.join(f'{place:.6g}' for place in throws)} m do not; cylinders on one pin "
            "have the same throw"
        )
    if positions is None:
        if len(throws) == 1:
            return []
        inner = [0.5 * (a + b) for a, b in pairwise(throws)]
        return [2.0 * throws[0] - inner[0], *inner, 2.0 * throws[-1] - inner[-1]]
    if len(positions) != len(throws) + 1:
        raise InputError(
            f"bearings.journal_positions: one more than throws is needed, {len(throws) + 1}; "
            f"{len(positions)} came; rods that share a pin have the same throw; {_SPLIT}"
        )
    sign = 1.0 if positions[-1] > positions[0] else -1.0
    for k, place in enumerate(throws):
        if not sign * positions[k] < sign * place < sign * positions[k + 1]:
            raise InputError(
                f"bearings.journal_positions: throw {k + 1} at {place:.6g} m must lie between "
                f"journals {k + 1} and {k + 2}; they are at {positions[k]:.6g} and "
                f"{positions[k + 1]:.6g} m"
            )
    return list(positions)


def _shares(
    journals: list[float], numbers: Sequence[int], places: list[float]
) -> tuple[tuple[float, ...], ...]:
    """For each journal what it carries of loads at places on throws: the beam's two supports."""
    count = max(numbers) + 2
    rows = [[0.0] * len(places) for _ in range(count)]
    for k, (number, place) in enumerate(zip(numbers, places, strict=True)):
        share = 0.5
        if journals:
            before, after = journals[number : number + 2]
            share = (place - before) / (after - before)
            if not 0.0 <= share <= 1.0:
                raise InputError(
                    f"layout.cylinders[{k + 1}].position: the rod must lie between the journals "
                    f"beside its throw, {before:.6g} and {after:.6g} m; {place:.6g} m came"
                )
        rows[number][k], rows[number + 1][k] = 1.0 - share, share
    return tuple(map(tuple, rows))


def _unbalances(
    scene: Scene, bearings: Bearings, numbers: tuple[int, ...], count: int
) -> tuple[complex, ...]:
    """Of each throw; those given add up to the crank's."""
    whole = scene.crank.mass * scene.crank.center_of_mass
    unbalances = bearings.throw_unbalance
    if unbalances is None:
        return (complex(whole / count),) * count
    if len(unbalances) != count:
        raise InputError(
            f"bearings.throw_unbalance: one for each throw is needed, {count}; "
            f"{len(unbalances)} came"
        )
    firsts = [scene.cylinders[numbers.index(throw)] for throw in range(count)]
    each = tuple(
        size * cmath.exp(1j * (c.phase + c.bank))
        for size, c in zip(unbalances, firsts, strict=True)
    )
    apart = sum(each) - whole
    if abs(apart) > _CLOSES * max(abs(whole), *map(abs, unbalances)):
        total = sum(each)
        raise InputError(
            "bearings.throw_unbalance: together, each along its throw, they are the crank's mass * "
            f"center_of_mass, {whole:.6g} kg m along its reference line; "
            f"{total.real:.6g} along it and {total.imag:.6g} kg m across came"
        )
    return each
