"""`python -m validation.lecture_map`: how far the lecture is off over rod ratio and fluctuation.

The settled motion of `propeller`, its flywheel from heavy to light and its rod from long to short,
at the same stroke and with the gas carried over the volume.
"""

import argparse
import sys
from pathlib import Path

import matplotlib as mpl
import numpy as np
import xarray as xr
from matplotlib.axes import Axes

from crankmbs import load_scene, sweep
from crankmbs.compare import short_name
from crankmbs.digits import error_digits
from crankmbs.figures.style import STYLE, caption, label_contours, logarithmic, panels
from crankmbs.storage.files import write_in_one_move

__all__ = ["main"]

_FILE = Path(__file__).parent / "figures" / "lecture_map.png"
_LECTURE = "S1 (motion and forces truncated)"
_QUANTITIES = (
    "piston velocity",
    "piston acceleration",
    "side thrust",
    "rod force",
    "torque",
    "crank pin force x",
    "crank pin force y",
    "main bearing force x",
)


def main(arguments: list[str] | None = None) -> int:
    """Compute and draw the map."""
    parser = argparse.ArgumentParser(prog="python -m validation.lecture_map", description=__doc__)
    parser.parse_args(arguments)
    scene = load_scene("propeller").with_(run__until="settled")
    vary = {"rod_ratio": "0.15..0.45:25", "crank.inertia": "0.02..2 kg m^2:49:log"}
    found = sweep(scene, vary).sel(lecture=_LECTURE)
    with mpl.rc_context(STYLE):
        figure, axes = panels(2, len(_QUANTITIES) // 2, 18.0, 10.0)
        for ax, quantity in zip(axes, _QUANTITIES, strict=True):
            _draw(ax, found.sel(quantity=quantity))
        for ax in axes[:: len(_QUANTITIES) // 2]:
            ax.set_ylabel("rod ratio r / l")
        error = 100.0 * float(found["lecture_deviation_error"].sel(quantity=[*_QUANTITIES]).max())
        caption(
            figure,
            [
                f"largest error of the truncated formulas of {short_name(_LECTURE)} at constant "
                "speed, in % of the peak of each quantity",
                f"settled cycles of propeller, one cylinder; numerical error at most "
                f"{error_digits(error)} %",
            ],
        )
    write_in_one_move(_FILE, lambda part: figure.savefig(part, format="png", dpi=100))
    print(_said(found), f"\nwritten: {_FILE}")
    return 0


def _draw(ax: Axes, data: xr.Dataset) -> None:
    fluctuation = 100.0 * data["fluctuation"].values
    ratio = np.broadcast_to(data["rod_ratio"].values[:, None], fluctuation.shape)
    off = 100.0 * data["lecture_deviation"].values
    ax.grid(visible=False)
    levels = [0.0, 1.0, 2.0, 3.0, 5.0, 7.0, 10.0, 15.0, 20.0, 30.0, 45.0]
    norm = mpl.colors.BoundaryNorm(levels, 256)
    ax.contourf(fluctuation, ratio, off, levels, cmap="YlOrBr", norm=norm, extend="max")
    lines = ax.contour(fluctuation, ratio, off, levels[1:], colors="black", linewidths=1.0)
    ax.set_xscale("log")
    logarithmic(ax.xaxis)
    label_contours(ax, lines, lambda value: f"{value:g} %", fontsize=12)
    ax.set_xlabel("coefficient of fluctuation [%]")
    ax.set_title(str(data["quantity"].values))


def _said(found: xr.Dataset) -> str:
    """The bounds of each quantity at the least and at the largest fluctuation."""
    lines = []
    for quantity in _QUANTITIES:
        off = 100.0 * found["lecture_deviation"].sel(quantity=quantity).values
        ends = ", ".join(f"{off[i, k]:.3g} %" for i in (0, -1) for k in (-1, 0))
        lines.append(f"{quantity}: {ends} (long rod heavy, light; short rod heavy, light)")
    return "\n".join(lines)


if __name__ == "__main__":
    sys.exit(main())
