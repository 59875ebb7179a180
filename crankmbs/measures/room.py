"""What stands along the crank and does not fit beside one another: said, not refused."""

from __future__ import annotations

import math
from collections.abc import Iterator
from itertools import pairwise

from crankmbs.scene.scene import Scene

__all__ = ["bores_overlap", "shells_overlap"]


def bores_overlap(scene: Scene) -> Iterator[str]:
    """Of neighbours in one bank the two that overlap most: closer than their mean bore."""
    places = [each.position for each in scene.cylinders]
    banks: dict[float, list[tuple[float, float, int]]] = {}
    for number, (place, gear) in enumerate(zip(places, scene.running_gear, strict=True), start=1):
        area = gear.piston.gas_area
        if place is not None and area is not None:
            bank = round(math.degrees(scene.cylinders[number - 1].bank) % 360.0, 6)
            banks.setdefault(bank, []).append((place, math.sqrt(area / math.pi), number))
    pairs = [
        (second[0] - first[0], first[1] + second[1], sorted((first[2], second[2])))
        for bank in banks.values()
        for first, second in pairwise(sorted(bank))
    ]
    step, least, numbers = min(
        pairs, key=lambda pair: round(pair[0] - pair[1], 9), default=(0.0, 0.0, [])
    )
    if step < least:
        key = "layout.cylinders: position" if scene.layout.spacing is None else "layout.spacing"
        yield (
            f"{key}: cylinders {numbers[0]} and {numbers[1]} of one bank are {step * 1e3:.4g} mm "
            f"apart, less than their mean bore of {least * 1e3:.4g} mm, so that they overlap; "
            "check its unit"
        )


def shells_overlap(scene: Scene) -> Iterator[str]:
    """Of the throws the one with the least room between its journals for the shells on it."""
    bearings, throws = scene.bearings, scene.throws
    if bearings is None or throws is None or not throws.journals:
        return
    shells = bearings.main_journal, bearings.crank_pin
    journal, rod = (0.0 if shell is None else shell.width for shell in shells)
    rooms = [abs(end - begin) for begin, end in pairwise(throws.journals)]
    wide = [journal + throws.numbers.count(throw) * rod for throw in range(len(rooms))]
    tight = min(range(len(rooms)), key=lambda throw: round(rooms[throw] - wide[throw], 9))
    if rooms[tight] < wide[tight]:
        yield (
            f"bearings: main journals {tight + 1} and {tight + 2} are {rooms[tight] * 1e3:.4g} mm "
            f"apart, less than one journal and the big ends between them are wide together, "
            f"{wide[tight] * 1e3:.4g} mm; check the widths of the shells and the places along the "
            "crank"
        )
