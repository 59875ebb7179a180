"""The machine of a scene, to scale, where its run begins."""

from __future__ import annotations

from matplotlib import rc_context
from matplotlib.figure import Figure

from crankmbs.figures.mechanism import Drawing, slices
from crankmbs.figures.outline import mechanism
from crankmbs.figures.style import STYLE, caption, panels
from crankmbs.scene.scene import Scene

__all__ = ["machine_figure"]

_ACROSS = 6  # cuts in one row


@rc_context(STYLE)
def machine_figure(scene: Scene) -> Figure:
    """Crank, rods, pistons and liners at the angle of the start: one drawing for each cylinder, or
    for those of different banks that stand side by side.

    >>> len(machine_figure(load_scene("yi_diesel_free")).axes)
    4
    """
    cuts = slices(scene)
    across = min(len(cuts), _ACROSS)
    down = -(-len(cuts) // across)
    figure, axes = panels(down, across, 2.2 * across + 1.0, 4.0 * down)
    begin = scene.start or scene.motion
    parts = mechanism(scene, [begin.angle if begin is not None else 0.0])
    for ax in axes:
        ax.axis("off")
    for ax, cut in zip(axes, cuts, strict=False):
        Drawing(ax, parts, cut)
        if len(scene.cylinders) > 1:
            ax.set_title(", ".join(str(k + 1) for k in cut))
    caption(figure, ["X upwards, Y to the left, to scale, where the run begins"])
    return figure
