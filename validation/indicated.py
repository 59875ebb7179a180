"""The pressures of `models/pressure/indicated.csv`: cycles as an indicator would have them, drawn
from a seed. `python -m validation.indicated` writes the file.

The compression of `yi_diesel`, its mirror image behind the dead centre without combustion, and what
combustion adds to that, scattered: p = motored + q (fired - motored), q = 1 + 0.08 z.
"""

from __future__ import annotations

import argparse
import sys

import numpy as np

from crankmbs.scene.shipped import models_folder

__all__ = ["CYCLES", "SEED", "text"]

SEED, CYCLES, SCATTER = 1, 6, 0.08
_FIRED = models_folder() / "pressure" / "yi_diesel.csv"
_FILE = models_folder() / "pressure" / "indicated.csv"
_HEAD = f"""\
# {CYCLES} cycles of a four-stroke diesel, absolute, 0 = gas-exchange TDC; computed, not measured,
# from yi_diesel.csv by python -m validation.indicated: what combustion adds to the mirror image
# of the compression is scattered, standard deviation {SCATTER:g}, numpy's default_rng({SEED})
crank_angle_deg,pressure_kgf_cm2
"""


def text() -> str:
    """The file's text."""
    degrees, fired = np.loadtxt(_FIRED, delimiter=",", skiprows=5, unpack=True)
    motored = fired.copy()
    expands = (degrees > 360.0) & (degrees <= 540.0)
    mirrored = np.interp(720.0 - degrees[expands], degrees, fired)
    motored[expands] = np.minimum(mirrored, fired[expands])
    kept = (degrees < 720.0) & ((degrees % 10.0 == 0.0) | (abs(degrees - 370.0) < 22.0))
    kept &= degrees % 2.0 == 0.0
    shares = 1.0 + SCATTER * np.random.default_rng(SEED).standard_normal(CYCLES)
    rows = [
        f"{720 * k + degree:g},{pressure:.4f}\n"
        for k, share in enumerate(shares)
        for degree, pressure in zip(
            degrees[kept], (motored + share * (fired - motored))[kept], strict=True
        )
    ]
    return _HEAD + "".join(rows)


def main(arguments: list[str] | None = None) -> int:
    """Write the file."""
    parser = argparse.ArgumentParser(prog="python -m validation.indicated", description=__doc__)
    parser.parse_args(arguments)
    _FILE.write_text(text(), encoding="utf-8")
    return 0


if __name__ == "__main__":
    sys.exit(main())
