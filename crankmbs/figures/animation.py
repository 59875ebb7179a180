"""The mechanism and the speed over the last cycle as a moving picture, for slides."""

from __future__ import annotations

import math
import subprocess
import textwrap
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib import rc_context
from matplotlib.animation import AbstractMovieWriter, FFMpegWriter, PillowWriter
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.text import Text

from crankmbs.errors import InputError, OutputError, shown
from crankmbs.figures.arrows import BODIES, COLOUR, Force
from crankmbs.figures.frames import Frames, frames_of
from crankmbs.figures.machines import Machine, at_frames, shown_forces
from crankmbs.figures.mechanism import slices
from crankmbs.figures.outline import mechanism
from crankmbs.figures.style import STYLE, caption, crank_axis, line_of, whose
from crankmbs.figures.view import View, last_view
from crankmbs.numerics.arrays import Array
from crankmbs.result import Result
from crankmbs.scene.scene import Scene
from crankmbs.scene.sentences import did_you_mean
from crankmbs.scene.units import RPM
from crankmbs.storage.files import write_in_one_move

__all__ = ["AS_USUAL", "Filming", "check_filming", "check_format", "save_animation"]


_RATES = {".gif": 20, ".mp4": 25}  # frames per second; whole hundredths of a second a frame
_DPI = {".gif": 62.5, ".mp4": 100.0}  # 800 x 450 and 1280 x 720 pixels
_SIZE = (12.8, 7.2)  # inch
_FLAT = 0.002  # of the mean: the least half height of the speed's axis
_HOTTEST = 0.9  # opacity of the gas at the highest pressure
_TITLE = 95  # letters of the title
_LENGTHS = (0.5, 120.0)  # s
_WIDTHS = (320, 3840, 32)  # pixels: from, to, in steps that leave the height even


@dataclass(frozen=True)
class Filming:
    """How a film is made.

    length [s] : of a cycle on the screen, about; None: six
    width [pixels] : its height is 9/16 of it; None: 800 of a .gif, 1280 of an .mp4
    cylinder : number, from 1, of the one that is shown alone; None: all are
    forces : on the "piston", the "rod" or the "crank", as arrows with their scale; None: none.
        The bearings' force on the crank is all cylinders' together, and shown where all are in one
        drawing
    """

    length: float | None = None
    width: int | None = None
    cylinder: int | None = None
    forces: str | None = None


AS_USUAL = Filming()


def check_format(file: Path) -> None:
    """Refuse a file that cannot be written here, before anything runs.

    Raises
    ------
    InputError : neither .gif nor .mp4; or .mp4 where there is no ffmpeg
    """
    suffix = file.suffix.lower()
    if suffix not in _RATES:
        raise InputError(
            f"{file}: the name of an animation must end with .gif or .mp4; "
            f"{suffix or 'no ending'} came"
        )
    if suffix == ".mp4" and not FFMpegWriter.isAvailable():
        raise InputError(
            f"{file}: an mp4 needs the program ffmpeg, which is not on this machine; "
            f"install it, or write {file.with_suffix('.gif').name}"
        )


def check_filming(filming: Filming, scene: Scene) -> None:
    """Refuse a length, a width, a cylinder or a body that cannot be, before anything runs.

    Raises
    ------
    InputError : which, its rule, and what came
    """
    length, width, cylinder = filming.length, filming.width, filming.cylinder
    least, most = _LENGTHS
    if length is not None and not least <= length <= most:
        raise InputError(f"length must be from {least:g} to {most:g} s; {length:g} came")
    low, high, step = _WIDTHS
    if width is not None and not (low <= width <= high and width % step == 0):
        raise InputError(f"width must be a multiple of {step} from {low} to {high}; {width} came")
    count = len(scene.cylinders)
    if cylinder is not None and not 1 <= cylinder <= count:
        ending = "s" if count > 1 else ""
        raise InputError(f"cylinder: the scene has {count} cylinder{ending}; {cylinder} came")
    if filming.forces is not None and filming.forces not in BODIES:
        near = did_you_mean(filming.forces, BODIES)
        raise InputError(
            f"forces: must be those on the piston, rod or crank; {shown(filming.forces)} came{near}"
        )


@rc_context(STYLE)
def save_animation(result: Result, file: Path, filming: Filming = AS_USUAL) -> Path:
    """Film the last cycle into a .gif or .mp4 file, replaced in one move.

    Raises
    ------
    InputError : another ending, no ffmpeg for .mp4, a film that cannot be, or nothing that moves
    OutputError : the file cannot be written
    """
    check_format(file)
    check_filming(filming, result.scene)
    suffix = file.suffix.lower()
    frames = frames_of(result, _RATES[suffix], filming.length)
    dpi = _DPI[suffix] if filming.width is None else filming.width / _SIZE[0]
    cuts = slices(result.scene) if filming.cylinder is None else [[filming.cylinder - 1]]
    film = _Film(result, frames, cuts, filming.forces, dpi)
    writer = (PillowWriter if suffix == ".gif" else FFMpegWriter)(fps=_RATES[suffix])
    write_in_one_move(file, lambda part: film.write(writer, part))
    return file


class _Film:
    """The figure whose frames are filmed."""

    def __init__(
        self, result: Result, frames: Frames, cuts: list[list[int]], body: str | None, dpi: float
    ) -> None:
        self._frames, self._dpi = frames, dpi
        self._figure = Figure(figsize=_SIZE, dpi=dpi, layout="constrained")
        canvas: Any = FigureCanvasAgg(self._figure)
        machines, trace = _places(self._figure, len(cuts))
        view = last_view(result)
        shift = float(view.degrees[0]) - math.degrees(float(view.values("crank_angle")[0]))
        self._degrees = view.on_axis(np.degrees(frames.angle) + shift)
        parts = mechanism(result.scene, frames.angle)
        forces = [] if body is None else shown_forces(body, view, frames, parts, cuts)
        _speed_axis(trace, view, frames.mean, forces)
        if len(result.scene.cylinders) > 1:
            for ax, cut in zip(machines, cuts, strict=True):
                ax.set_title(whose(cut))
        title = textwrap.shorten(result.scene.title, _TITLE, placeholder=" ...")
        self._figure.suptitle(title, fontsize=16, fontweight="bold", parse_math=False)
        exact = f"speed: {view.exactness('crank_speed')}"
        caption(self._figure, [f"{view.window.kind}, {frames.pace}; {exact}", frames.ring])
        canvas.draw()
        still = np.array(canvas.buffer_rgba())  # text takes most of a frame's time
        self._figure.set_layout_engine(None)  # it stays as it is now
        for artist in (*trace.get_children(), *self._figure.findobj(Text)):
            artist.set_visible(False)
        self._figure.figimage(still, zorder=-1)
        (self._cursor,) = trace.plot([], [], "o", color="black", markersize=11)
        self._now = trace.text(
            0.99, 0.03, "", transform=trace.transAxes, ha="right", family="monospace"
        )
        heat = _heat(view, frames)
        self._machines = [
            Machine(ax, parts, cut, heat, frames, forces)
            for ax, cut in zip(machines, cuts, strict=True)
        ]

    def write(self, writer: AbstractMovieWriter, file: Path) -> None:
        """Film every frame."""
        try:
            with writer.saving(self._figure, str(file), self._dpi):
                for k in range(len(self._frames.time)):
                    self._show(k)
                    writer.grab_frame()
        except subprocess.CalledProcessError as error:
            raise OutputError(
                f"ffmpeg failed with exit status {error.returncode}; write a .gif instead"
            ) from None

    def _show(self, k: int) -> None:
        frames = self._frames
        rpm = frames.speed[k] / RPM
        self._cursor.set_data([self._degrees[k]], [rpm])
        now = f"{frames.time[k] * 1e3:7.2f} ms  {rpm:7.1f} rpm"
        self._now.set_text(f"{frames.lead_in_words(k)}\n{now}" if frames.magnified else now)
        for machine in self._machines:
            machine.move(k)


def _places(figure: Figure, cuts: int) -> tuple[list[Axes], Axes]:
    """Axes of the mechanisms and of the speed: beside them, or below where they are many."""
    if cuts <= 2:
        grid = figure.add_gridspec(1, cuts + 1, width_ratios=[*[1.0] * cuts, 1.8])
        trace = figure.add_subplot(grid[0, cuts])
    else:
        grid = figure.add_gridspec(2, cuts, height_ratios=[1.9, 1.0])
        trace = figure.add_subplot(grid[1, :])
    machines = [figure.add_subplot(grid[0, k]) for k in range(cuts)]
    for ax in machines:
        ax.axis("off")
    return machines, trace


def _speed_axis(ax: Axes, view: View, mean: float, forces: list[Force]) -> None:
    """The speed beside its mean, and a legend that names the arrows of forces too."""
    speed = view.values("crank_speed") / RPM
    ax.plot(*view.drawn(view.degrees, speed), **line_of(0), label="crank speed")
    ax.axhline(mean / RPM, color="0.5", linestyle=(0, (4, 2)), label="mean over time")
    half = max(0.6 * float(np.ptp(speed)), _FLAT * abs(mean) / RPM) or 1.0  # rpm, at rest
    middle = 0.5 * float(speed.min() + speed.max())
    ax.set_ylim(middle - 2.1 * half, middle + 1.1 * half)  # room for legend and numbers below
    ax.set_ylabel("crank speed [rpm]")
    crank_axis([ax], view)
    for name, kind in dict.fromkeys((force.name, force.kind) for force in forces):
        ax.plot([], [], color=COLOUR[kind], linewidth=5.0, label=name)
    ax.legend(loc="lower left", ncols=2, frameon=False)


def _heat(view: View, frames: Frames) -> Array | None:
    """How strongly the gas is coloured, by its pressure over the highest; None without gas."""
    if view.scene.gas is None:
        return None
    pressure = np.maximum(at_frames(view, frames, "gas_pressure"), 0.0)
    return _HOTTEST * np.sqrt(pressure / (float(pressure.max()) or 1.0))
