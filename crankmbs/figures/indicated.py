"""Measured pressures over the crank angle, over the volume, and their scatter over the cycles."""

from __future__ import annotations

from pathlib import Path, PurePath

import numpy as np
from matplotlib import rc_context
from matplotlib.figure import Figure

from crankmbs.figures.style import (
    STYLE,
    caption,
    legend,
    line_of,
    logarithmic,
    panels,
    save,
)
from crankmbs.indicated import CylinderPressure, Indicated
from crankmbs.scene.units import BAR
from crankmbs.storage.files import together

__all__ = ["pressure_figure", "save_indicated_figures", "scatter_figure", "volume_figure"]


@rc_context(STYLE)
def pressure_figure(indicated: Indicated) -> Figure:
    """The mean cycle of each cylinder from its firing dead centre, and the band of its cycles."""
    figure, (ax,) = panels(1, 1, 10.0, 5.5)
    for k, each in enumerate(indicated.cylinders):
        line = line_of(k)
        if len(each.pressure) > 1:
            low, high = np.min(each.pressure, axis=0), np.max(each.pressure, axis=0)
            ax.fill_between(each.angle, low / BAR, high / BAR, color=line["color"], alpha=0.25)
        ax.plot(each.angle, each.mean / BAR, **line, label=_name(each))
    ax.axvline(0.0, color="0.55", linewidth=1.0, linestyle=(0, (6, 4)), zorder=1)
    half = 90 * indicated.stroke
    ax.set_xticks(np.arange(-half, half + 1, 90))
    ax.set_xlim(-half, half)
    ax.set_xlabel("crank angle from the firing dead centre [deg]")
    ax.set_ylabel(_pressure(indicated))
    legend(figure, ax)
    about = f"{_which(indicated)} of each cylinder"
    band = "; band: least to largest of its cycles" if _several(indicated) else ""
    _footer(figure, indicated, about + band)
    return figure


@rc_context(STYLE)
def volume_figure(indicated: Indicated) -> Figure:
    """The mean cycle over the volume, with its imep: over V / V_clearance, both logarithmic, where
    the compression ratio is known and the pressure absolute, and over the travel."""
    shape = indicated.shape
    assert shape is not None
    with_log = shape.ratio is not None and indicated.absolute
    figure, axes = panels(1, 1 + with_log, 10.0 if with_log else 7.0, 5.5)
    for k, each in enumerate(indicated.cylinders):
        assert each.imep is not None
        angle = np.radians(np.append(each.angle, each.angle[0]))
        mean = np.append(each.mean, each.mean[0]) / BAR
        label = f"{_name(each)}, imep {np.mean(each.imep) / BAR:.4g} bar"
        axes[0].plot(shape.travel(angle), mean, **line_of(k), label=label)
        if with_log:
            axes[1].plot(shape.volume(angle), np.maximum(mean, 1e-3), **line_of(k))
    axes[0].set_xlabel("piston displacement from TDC over the stroke [1]")
    for ax in axes:
        ax.set_ylabel(_pressure(indicated))
    if with_log:
        axes[1].set_xlabel("volume over the clearance volume [1]")
        logarithmic(axes[1].xaxis)
        logarithmic(axes[1].yaxis)
    legend(figure, axes[0])
    about = f"{_which(indicated)} of each cylinder; imep: indicated mean effective pressure"
    _footer(figure, indicated, about)
    return figure


@rc_context(STYLE)
def scatter_figure(indicated: Indicated) -> Figure:
    """Peak and, with a geometry, imep of each cycle."""
    with_imep = indicated.shape is not None
    figure, axes = panels(1 + with_imep, 1, 10.0, 3.2 * (1 + with_imep))
    for k, each in enumerate(indicated.cylinders):
        number = np.arange(1, len(each.pressure) + 1)
        line = line_of(k) | {"marker": ".", "linewidth": 0.8}
        axes[0].plot(number, each.peaks / BAR, **line, label=_name(each))
        if with_imep:
            assert each.imep is not None
            axes[1].plot(number, each.imep / BAR, **line)
    axes[0].set_ylabel("peak pressure [bar]")
    if with_imep:
        axes[1].set_ylabel("indicated mean\neffective pressure [bar]")
    for ax in axes:
        ax.locator_params("x", integer=True)
    axes[-1].set_xlabel("cycle")
    legend(figure, axes[0])
    about = "peak and mean effective pressure" if with_imep else "peak pressure"
    _footer(figure, indicated, f"{about} of each measured cycle")
    return figure


def save_indicated_figures(indicated: Indicated, folder: Path, stem: str) -> list[Path]:
    """Draw measured pressures into STEM_angle.png, with a geometry STEM_pv.png, and of several
    cycles STEM_cycles.png, which appear together.

    Raises
    ------
    OutputError : the folder cannot be made or written
    """
    draw = {"angle": pressure_figure}
    if indicated.shape is not None:
        draw["pv"] = volume_figure
    if _several(indicated):
        draw["cycles"] = scatter_figure
    with together(folder) as part:
        for name, figure in draw.items():
            save(figure(indicated), part / f"{stem}_{name}.png")
    return [folder / f"{stem}_{name}.png" for name in draw]


def _several(indicated: Indicated) -> bool:
    return any(len(each.pressure) > 1 for each in indicated.cylinders)


def _which(indicated: Indicated) -> str:
    return "mean cycle" if _several(indicated) else "measured cycle"


def _name(cylinder: CylinderPressure) -> str:
    return f"cylinder {cylinder.number}"


def _pressure(indicated: Indicated) -> str:
    return f"cylinder pressure, {'absolute' if indicated.absolute else 'gauge'} [bar]"


def _footer(figure: Figure, indicated: Indicated, about: str) -> None:
    caption(figure, [PurePath(indicated.source).name, about])
