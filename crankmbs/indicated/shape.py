"""The cylinder's geometry: from the scene, from the header of a file, and how the two compare."""

from __future__ import annotations

import math
import re
from collections.abc import Iterator, Sequence
from typing import NamedTuple

from crankmbs.errors import InputError
from crankmbs.mechanics.geometry import close_loop, dead_centres, top_position
from crankmbs.numerics.arrays import Array
from crankmbs.scene.gas import Polytrope
from crankmbs.scene.scene import Scene
from crankmbs.scene.units import quantity

__all__ = ["Shape", "differences", "of_header", "of_scene", "shape_of"]

_SAME = 1e-3  # relative: what a header rounds

_LABELS = {
    "bore": r"(?:cylinder )?bore(?: diameter)?|bohrung",
    "stroke": r"(?:piston )?stroke(?: length)?|(?:kolben)?hub",
    "rod length": r"(?:con(?:necting)?[ -_]?)?rod[ -_]?length|pleuell(?:ä|ae)nge",
    "compression ratio": r"compression[ _]?ratio|verdichtungsverh(?:ä|ae)ltnis|verdichtung|epsilon",
    "offset": r"(?:piston[ -_]?|wrist[ -_]?|gudgeon[ -_]?)?pin[ -_]?offset|desachsierung",
}
_LINE = (
    r"(?:^|[^\w])(?:{label})\s*(?:[\[(]([\w/^ -]*)[\])])?\s*[:=]?\s*"
    r"([+-]?[0-9]+(?:\.[0-9]*)?(?:[eE][+-]?[0-9]+)?)\s*(?:[\[(]?(mm|cm|m|in|inch)\b)?"
)


class Shape(NamedTuple):
    """crank radius, rod length and offset [m], compression ratio [1]; its source."""

    radius: float
    rod_length: float
    offset: float
    ratio: float | None
    source: str

    @property
    def top(self) -> float:
        """Cycle angle [rad] of the true top dead centre."""
        return dead_centres(*self[:3])[0]

    def travel(self, angle: Array) -> Array:
        """Piston travel over the stroke, (x_top - x) / (x_top - x_bottom) [1].

        angle : shape (...) [rad] from the true top dead centre
        """
        return (top_position(*self[:3]) - close_loop(angle + self.top, *self[:3]).x) / self.stroke

    def travel_1(self, angle: Array) -> Array:
        """Its derivative in the angle [1/rad]."""
        return -close_loop(angle + self.top, *self[:3]).x_1 / self.stroke

    def volume(self, angle: Array) -> Array:
        """V / V_clearance = 1 + (compression ratio - 1) travel [1]."""
        assert self.ratio is not None
        return 1.0 + (self.ratio - 1.0) * self.travel(angle)

    @property
    def stroke(self) -> float:
        """From dead centre to dead centre [m]."""
        bottom = float(close_loop(dead_centres(*self[:3])[1], *self[:3]).x)
        return top_position(*self[:3]) - bottom


def shape_of(scene: Scene | None, header: dict[str, float], ratio: float | None) -> Shape | None:
    """The geometry that is used: the scene's, else the header's; None where neither has one."""
    if scene is not None:
        shape = of_scene(scene)
        return shape._replace(ratio=ratio or shape.ratio or header.get("compression ratio"))
    if "stroke" not in header or "rod length" not in header:
        return None
    radius, rod, offset = 0.5 * header["stroke"], header["rod length"], header.get("offset", 0.0)
    if not 0.0 < radius <= rod - abs(offset):
        raise InputError(
            f"the file's header gives a stroke of {2e3 * radius:g} mm and a rod of {1e3 * rod:g} "
            "mm, which close no loop; correct the header, or give a scene"
        )
    return Shape(radius, rod, offset, ratio or header.get("compression ratio"), "the file's header")


def of_scene(scene: Scene) -> Shape:
    """A scene's geometry, with the compression ratio where its gas has one.

    Raises
    ------
    InputError : its cylinders are unlike

    >>> of_scene(load_scene("v_twin")).source
    'the scene'
    """
    gas, ratio = scene.gas, None
    if scene.unlike:
        raise InputError(
            "scene: its cylinders are unlike, and a record is read with the geometry of one; give "
            "a scene of the cylinder that was measured"
        )
    if gas is not None and gas.indicator is not None:
        ratio = gas.indicator.compression_ratio
    elif gas is not None and isinstance(gas.motored, Polytrope):
        ratio = gas.motored.compression_ratio
    return Shape(scene.crank.radius, scene.rod.length, scene.piston.offset, ratio, "the scene")


def of_header(above: Sequence[Sequence[str]], decimal: str) -> dict[str, float]:
    """Bore, stroke, rod length, offset [m] and compression ratio that stand above a table.

    A length without a unit is left out.

    >>> of_header([["Bore", "85,25", "mm"], ["Compression ratio", "18"]], ",")
    {'bore': 0.08525, 'compression ratio': 18.0}
    """
    header: dict[str, float] = {}
    for cells in above:
        line = " ".join(cells).replace(",", ".") if decimal == "," else " ".join(cells)
        for name, label in _LABELS.items():
            match = re.search(_LINE.format(label=label), line, re.IGNORECASE)
            if match is None or name in header:
                continue
            unit = (match[3] or match[1] or "").strip().lower()
            if name == "compression ratio":
                header[name] = float(match[2])
            elif unit in ("mm", "cm", "m", "in", "inch"):
                header[name] = quantity(f"{match[2]} {unit}", "length")
    return header


def differences(header: dict[str, float], scene: Scene) -> Iterator[str]:
    """Where the header and the scene do not describe one cylinder, in sentences."""
    shape, area = of_scene(scene), scene.piston.gas_area
    theirs = {
        "bore": None if area is None else math.sqrt(4.0 * area / math.pi),
        "stroke": shape.stroke,
        "rod length": shape.rod_length,
        "offset": shape.offset,
        "compression ratio": shape.ratio,
    }
    for name, value in header.items():
        other = theirs[name]
        if other is None or math.isclose(value, other, rel_tol=_SAME, abs_tol=1e-6):
            continue
        scale, unit = (1.0, "") if name == "compression ratio" else (1e3, " mm")
        yield (
            f"warning: the file's header gives a {name} of {value * scale:.6g}{unit}, the scene "
            f"{other * scale:.6g}{unit}; the scene's is used: is it the same engine?"
        )
