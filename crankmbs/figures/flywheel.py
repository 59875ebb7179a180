"""The fluctuation of the speed over the inertia of the crank."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from matplotlib import rc_context
from matplotlib.figure import Figure

from crankmbs.design import Flywheel
from crankmbs.figures.style import COLOURS, STYLE, footer, legend, logarithmic, panels, save

__all__ = ["flywheel_figure", "save_flywheel_figure"]

_NOTHING = 1e-9  # of the crank's inertia


@rc_context(STYLE)
def flywheel_figure(wheel: Flywheel, curve: Sequence[tuple[float, float]]) -> Figure:
    """Settled cycles and the textbook's formula over the inertia, and the answer.

    curve : inertia [kg m2] and fluctuation [1] of settled cycles
    """
    figure, (ax,) = panels(1, 1, 9.0, 6.0)
    inertia, fluctuation = zip(*curve, strict=True)
    ax.plot(inertia, [100.0 * each for each in fluctuation], color=COLOURS[0], label="settled")
    work, speed = wheel.work.value, wheel.mean_speed.value
    at, percent = wheel.inertia.value, 100.0 * wheel.fluctuation.value
    formula = [100.0 * work / ((each + wheel.moving) * speed**2) for each in inertia]
    dashes = (0, (5, 3))
    ax.plot(inertia, formula, color=COLOURS[1], linestyle=dashes, label=r"W / (J $\omega^2$)")
    ax.plot([at], [percent], "o", color="black", label=f"{percent:.4g} % with {at:.4g} kg m$^2$")
    present = at - wheel.added
    if min(inertia) <= present <= max(inertia):
        ax.axvline(
            present, color="0.55", linewidth=1.0, label=f"the scene's {present:.4g} kg m$^2$"
        )
    ax.set_xscale("log")
    ax.set_yscale("log")
    for axis in (ax.xaxis, ax.yaxis):
        logarithmic(axis)
    ax.set_xlabel("inertia of crank and flywheel [kg m$^2$]")
    ax.set_ylabel("fluctuation of the speed [%]")
    legend(figure, ax)
    about = "settled cycles"
    if wheel.moving > _NOTHING * at:
        about += f"; J has {wheel.moving:.3g} kg m\u00b2 of rods and pistons in it"
    footer(figure, wheel.result, about)
    return figure


def save_flywheel_figure(
    wheel: Flywheel, curve: Sequence[tuple[float, float]], folder: Path
) -> Path:
    """Draw the fluctuation over the inertia into flywheel.png.

    Raises
    ------
    OutputError : the folder cannot be made or written
    """
    return save(flywheel_figure(wheel, curve), folder / "flywheel.png")
