"""Levels of a cylinder's pressure that no engine has, in a scene or in a measured file.

The limits are wide: what they catch is a unit, not a bold design.
"""

from __future__ import annotations

from collections.abc import Iterator

from crankmbs.scene.units import BAR

__all__ = ["unlikely_compression", "unlikely_peak"]

# Engines fire below 300 bar. A four-stroke engine that is only turned over, throttled, compresses
# to several bar.
_HIGHEST = 350.0 * BAR
_LOWEST_FOUR_STROKE = 2.0 * BAR
# A closed throttle leaves 0.2 bar at the beginning of the compression.
_LOWEST_INTAKE = 0.15 * BAR


def unlikely_peak(peak: float, stroke: int) -> Iterator[str]:
    """What is unlikely about a peak [Pa] above ambient.

    >>> list(unlikely_peak(60.0 * BAR, 4))
    []
    """
    if peak > _HIGHEST:
        yield (
            f"the pressure peaks at {peak / BAR:.4g} bar, and engines fire below 300; check "
            "its unit, such as MPa for bar"
        )
    if stroke == 4 and peak < _LOWEST_FOUR_STROKE:
        yield (
            f"the pressure of a four-stroke cycle peaks at {peak / BAR:.3g} bar above "
            "ambient; even turned over it reaches several bar; check its unit"
        )


def unlikely_compression(begin: float) -> Iterator[str]:
    """What is unlikely about an absolute pressure [Pa] with which a compression begins.

    >>> list(unlikely_compression(0.25 * BAR))
    []
    """
    if 0.0 <= begin < _LOWEST_INTAKE:
        yield (
            f"the compression begins at an absolute {begin / BAR:.2g} bar, and a closed throttle "
            "leaves 0.2; check its unit, such as bar for MPa or psi, and the reference"
        )
