"""Makes the font of the lessons' formulas again: python tests/make_math_font.py

A subset of STIX Two Math as the package ziamath ships it, with all its names and its table MATH.
"""

import importlib.util
import io
from pathlib import Path

from fontTools.subset import Options, Subsetter
from fontTools.ttLib import TTFont

TARGET = Path(__file__).parent.parent / "crankmbs" / "lessons" / "font" / "stix_two_math.woff"
RANGES = (
    (0x20, 0x7E),  # letters and digits
    (0x391, 0x3D6),  # Greek
    (0x1D434, 0x1D467),  # mathematical italics, without h
    (0x1D6FC, 0x1D71B),  # small Greek mathematical italics
)
SIGNS = "ℎ−√∑∫∂≈≤≥≠±°·×′″⇒→∞…⋅‾¯\u0302\u0307\u0308\u0305\u2061\u2062"


def source():
    """The file of the whole font, or None without ziamath."""
    found = importlib.util.find_spec("ziamath")
    if found is None or found.origin is None:
        return None
    return Path(found.origin).parent / "fonts" / "STIXTwoMath-Regular.ttf"


def made(path):
    """The subset as the bytes of a WOFF file."""
    font = TTFont(path)
    options = Options()
    options.layout_features = ["ccmp", "mark", "mkmk", "ssty"]
    options.name_IDs = options.name_languages = ["*"]
    options.notdef_outline = True
    options.hinting = options.recalc_timestamp = False
    subsetter = Subsetter(options)
    letters = {code for first, last in RANGES for code in range(first, last + 1)}
    subsetter.populate(unicodes=letters | set(map(ord, SIGNS)))
    subsetter.subset(font)
    font.flavor, font.recalcTimestamp = "woff", False
    file = io.BytesIO()
    font.save(file)
    return file.getvalue()


if __name__ == "__main__":
    TARGET.write_bytes(made(source()))
