"""A cut of the machine that moves: the mechanism, its ring at mean speed, the forces on a body."""

from __future__ import annotations

import numpy as np
from matplotlib.axes import Axes

from crankmbs.figures.arrows import Arrows, Force, draw_bar, forces_on, largest
from crankmbs.figures.frames import Frames
from crankmbs.figures.mechanism import Drawing, Look
from crankmbs.figures.outline import Mechanism
from crankmbs.figures.ring import RADIUS, Ring
from crankmbs.figures.view import View
from crankmbs.numerics.arrays import Array

__all__ = ["Machine", "shown_forces"]

_RIM = 0.1  # of the crank radius: room around the ring
_ABOVE = 0.7  # of the crank radius: room above the heads for the gas's arrow
_SEEN = (
    "side_force",
    "gas_force",
    "friction_force",
    "applied_force",
    "main_bearing_force_x",
    "main_bearing_force_y",
)
_PINS = tuple(f"{pin}_pin_force_{axis}" for pin in ("piston", "crank") for axis in "xy")


class Machine:
    """Some cylinders, movable from frame to frame.

    Parameters
    ----------
    parts : of the whole machine at every frame; cylinders : those drawn, counted from 0
    heat : as of `Drawing`; forces : on the bodies of all drawings, that share one scale
    """

    def __init__(
        self,
        ax: Axes,
        parts: Mechanism,
        cylinders: list[int],
        heat: Array | None,
        frames: Frames,
        forces: list[Force],
    ) -> None:
        pin = parts.crank_pin[:, cylinders[0]]
        radius = float(np.hypot(*pin[0])) * 1e3  # mm, as it is drawn
        newtons = largest(forces)
        look = Look(RADIUS + _RIM, _ABOVE, grey=True) if newtons > 0.0 else Look(RADIUS + _RIM)
        throw = np.arctan2(pin[:, 1], pin[:, 0])
        self._moving: list[Drawing | Ring | Arrows] = [
            Drawing(ax, parts, cylinders, heat, look),
            Ring(ax, RADIUS * radius, throw, frames.magnified * frames.leads),
        ]
        if newtons > 0.0:
            acting = [force for force in forces if force.cylinder in (None, *cylinders)]
            self._moving.append(Arrows(ax, acting, radius, newtons))
            if forces[0].cylinder in cylinders:  # once for all drawings
                draw_bar(ax, radius, newtons)

    def move(self, frame: int) -> None:
        """Put everything where it is at a frame."""
        for part in self._moving:
            part.move(frame)


def shown_forces(
    body: str, view: View, frames: Frames, parts: Mechanism, cuts: list[list[int]]
) -> list[Force]:
    """The forces on a body at the frames, linear between samples, of the cylinders that are drawn;
    the bearings' on the crank, all cylinders' together, where all are in one drawing."""
    time = view.values("time") - view.window.begin
    data = {
        name: np.stack([np.interp(frames.time, time, row) for row in np.atleast_2d(values.T)])
        for name in (*_SEEN, *_PINS)
        if name in view.result.variables
        for values in (view.values(name),)
    }
    data = {name: rows.T if view.values(name).ndim > 1 else rows[0] for name, rows in data.items()}
    drawn = [k for cut in cuts for k in cut]
    if len(cuts) == 1 and len(drawn) == len(view.scene.cylinders):
        return forces_on(body, view.scene, parts, data)
    return [each for each in forces_on(body, view.scene, parts, data) if each.cylinder in drawn]
