"""The forces on one body of the mechanism as arrows, with the bar that is their scale."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
from matplotlib.axes import Axes

from crankmbs.figures.frames import round_below
from crankmbs.figures.mechanism import on_paper
from crankmbs.figures.outline import Mechanism, in_engine_frame
from crankmbs.numerics.arrays import Array
from crankmbs.scene.scene import Scene

__all__ = ["BODIES", "COLOUR", "Arrows", "Force", "draw_bar", "forces_on", "largest"]

Read = Callable[[str], Array]

BODIES = ("piston", "rod", "crank")
COLOUR = {"gas": "#b85400", "wall": "#00805c", "pin": "#0068a5", "bearing": "#8b3f86"}
_REACH = 1.2  # of the crank radius: the longest arrow
_BAR = 2.2  # the largest force is about so many times the bar, or up to twice as many
_WIDTH = 0.15  # of the crank radius: an arrow's shaft


@dataclass(frozen=True)
class Force:
    """A force on a body, in the engine's frame.

    kind : of what it comes from, a colour; cylinder : from 0, or None for the whole engine's
    at [m], force [N] : shape (n, 2); pushes : drawn with its tip where it acts, not its tail, while
        it points against this direction, shape (n, 2), or never
    """

    name: str
    kind: str
    cylinder: int | None
    at: Array
    force: Array
    pushes: Array | None = None


def forces_on(body: str, scene: Scene, parts: Mechanism, read: Read) -> list[Force]:
    """The forces on "piston", "rod" or "crank" of every cylinder, weights apart.

    parts : at the samples; read : a variable by its name there, shape (n,) or (n, cylinders)
    """
    draw = {"piston": _on_piston, "rod": _on_rod, "crank": _on_crank}[body]
    count = len(scene.cylinders)
    forces = [force for k in range(count) for force in draw(k, scene, parts, read)]
    if body == "crank":
        force = np.stack([read("main_bearing_force_x"), read("main_bearing_force_y")], axis=-1)
        forces.append(Force("bearings on crank", "bearing", None, np.zeros_like(force), force))
    return forces


def _on_piston(k: int, scene: Scene, parts: Mechanism, read: Read) -> list[Force]:
    pin, corners = parts.piston_pin[:, k], parts.piston[:, k]
    pressed = read("side_force")
    none = np.zeros_like(pressed)

    def downwards(variable: str) -> Array:
        return in_engine_frame(scene, -read(variable), none)[:, k]

    side = in_engine_frame(scene, none, pressed)[:, k]
    forces = [
        Force("wall on piston", "wall", k, pin, side),
        Force("rod on piston", "pin", k, pin, _of_pin(k, scene, read, "piston_pin")),
    ]
    if scene.friction is not None:
        away = np.where(pressed[:, k, None] > 0.0, -0.5, 0.5)
        at = pin + away * (corners[:, 0] - corners[:, 3])  # on the side that the wall presses
        rubs = downwards("friction_force")
        forces.append(Force("friction on piston", "bearing", k, at, rubs))
    if scene.force:
        applied = downwards("applied_force")
        forces.append(Force("applied force on piston", "bearing", k, pin, applied))
    crown = 0.5 * (corners[:, 1] + corners[:, 2])
    gas = downwards("gas_force")
    return [*forces, Force("gas on piston", "gas", k, crown, gas, pushes=crown - pin)]


def _on_rod(k: int, scene: Scene, parts: Mechanism, read: Read) -> list[Force]:
    small, big = (_of_pin(k, scene, read, pin) for pin in ("piston_pin", "crank_pin"))
    return [
        Force("piston on rod", "pin", k, parts.piston_pin[:, k], -small),
        Force("crank on rod", "bearing", k, parts.crank_pin[:, k], big),
    ]


def _on_crank(k: int, scene: Scene, parts: Mechanism, read: Read) -> list[Force]:
    force = -_of_pin(k, scene, read, "crank_pin")
    return [Force("rod on crank", "pin", k, parts.crank_pin[:, k], force)]


def _of_pin(k: int, scene: Scene, read: Read, pin: str) -> Array:
    return in_engine_frame(scene, read(f"{pin}_force_x"), read(f"{pin}_force_y"))[:, k]


def largest(forces: list[Force]) -> float:
    """The largest magnitude [N] of some forces; 0 without any."""
    return max((float(np.max(np.hypot(*each.force.T))) for each in forces), default=0.0)


class Arrows:
    """Arrows of some forces on their axes; newtons : of the longest, one crank radius and a
    fifth; radius : of the crank, in the axes' unit."""

    def __init__(self, ax: Axes, forces: list[Force], radius: float, newtons: float) -> None:
        scale = _REACH * radius / newtons
        self._tails: list[Array] = []
        self._arrows: list[Array] = []
        for each in forces:
            vector = np.stack(on_paper(each.force), axis=-1) / 1e3 * scale  # on_paper gives mm
            tail = np.stack(on_paper(each.at), axis=-1)
            if each.pushes is not None:
                against = np.sum(each.force * each.pushes, axis=-1) < 0.0
                tail = tail - np.where(against[:, None], vector, 0.0)
            self._tails.append(tail)
            self._arrows.append(vector)
        still: Any = {"angles": "xy", "scale_units": "xy", "scale": 1.0, "units": "xy"}
        still |= {"width": _WIDTH * radius, "zorder": 25, "clip_on": False}
        colours = [COLOUR[each.kind] for each in forces]
        none = np.zeros(len(forces))
        self._quiver = ax.quiver(none, none, none, none, color=colours, **still)

    def move(self, sample: int) -> None:
        """Put every arrow where it is at a sample."""
        self._quiver.set_offsets([tail[sample] for tail in self._tails])
        self._quiver.set_UVC(*np.array([arrow[sample] for arrow in self._arrows]).T)


def draw_bar(ax: Axes, radius: float, newtons: float) -> None:
    """A bar as long as a round force, in the lower left corner; arguments as of `Arrows`."""
    force = round_below(newtons / _BAR)
    long = _REACH * radius * force / newtons
    notch = 0.06 * radius
    left, low = ax.get_xlim()[0] + notch, ax.get_ylim()[0] + notch
    x, y = [left, left, left + long, left + long], [low + notch, low, low, low + notch]
    ax.plot(x, y, color="0.1", linewidth=2.0, clip_on=False, zorder=25)
    size = f"{force / 1e3:g} kN" if force >= 1e3 else f"{force:g} N"
    ax.text(left, low + 2.5 * notch, size, fontsize=15, zorder=25)
