"""Files that cannot be read, by what is wrong with them: name, bytes, options."""

import numpy as np
from exports import FIRED, columns_of_cycles, cycles, text

from validation.oracles.measured import pressure_of

FULL = np.arange(-360.0, 360.0, 1.0)
EXACT = pressure_of(FIRED, FULL)
GOOD = text([FULL, EXACT], ["CA", "PCYL1"], ["deg", "bar(a)"])
BINARY = bytes(range(256)) * 8


def of(angle, *columns, names=("CA", "PCYL1"), units=("deg", "bar(a)"), **options):
    return text([angle, *columns], list(names), list(units), **options)


def changed(line, new):
    lines = GOOD.split("\n")
    lines[line - 1] = new
    return "\n".join(lines)


def without(first, last):
    lines = GOOD.split("\n")
    return "\n".join(lines[: first - 1] + lines[last:])


LONG = np.arange(0.0, 720.0 * 3, 1.0)
MANY = pressure_of(FIRED, LONG - 360.0)
SHORT = np.flatnonzero((LONG % 720 < 180) | (LONG % 720 >= 230))
FOUR = pressure_of(FIRED, FULL - 65.0)

WRONG = {
    "MF4": ("a.mf4", b"MDF     4.10    " + BINARY, {}),
    "TDMS": ("a.tdms", b"TDSm\x0e\x00\x00\x00" + BINARY, {}),
    "HDF5": ("a.h5", b"\x89HDF\r\n\x1a\n" + BINARY, {}),
    "iFile": ("a.ifl", BINARY, {}),
    "numbered iFile": ("motor.001", BINARY, {}),
    "xlsx": ("a.xlsx", b"PK\x03\x04" + BINARY, {}),
    "xls": ("a.xls", b"\xd0\xcf\x11\xe0\xa1\xb1\x1a\xe1" + BINARY, {}),
    "MATLAB": ("a.mat", b"MATLAB 5.0 MAT-file" + BINARY, {}),
    "gzip": ("a.csv.gz", b"\x1f\x8b\x08" + BINARY, {}),
    "binary": ("a.csv", BINARY, {}),
    "empty": ("a.csv", b"", {}),
    "no rows": ("a.csv", b"Crank Angle;PCYL1\ndeg;bar\n", {}),
    "prose": ("a.csv", b"The measurement of Tuesday\nwas not saved.\n", {}),
    "over time": (
        "a.csv",
        of(FULL / 100 + 4, EXACT, names=("Time", "PCYL1"), units=("s", "bar")),
        {},
    ),
    "no angle": ("a.csv", of(FULL, EXACT, names=("X", "PCYL1"), units=("", "bar")), {}),
    "no pressure": ("a.csv", of(FULL, EXACT, names=("CA", "TEMP"), units=("deg", "°C")), {}),
    "no unit": ("a.csv", text([FULL, EXACT], ["CA", "PCYL1"]), {}),
    "another unit": ("a.csv", GOOD, {"unit": "kPa"}),
    "no such column": ("a.csv", GOOD, {"columns": "PCYL7"}),
    "no reference": ("a.csv", of(FULL, EXACT - 4.0, units=("deg", "bar")), {}),
    "rows missing at the peak": (
        "a.csv",
        of(np.delete(FULL, np.arange(350, 393)), np.delete(EXACT, np.arange(350, 393))),
        {},
    ),
    "a word in a cell": ("a.csv", changed(50, "-313,0;over"), {}),
    "another row": ("a.csv", changed(50, "-313,0;1,0;2,0"), {}),
    "a footer": ("a.csv", GOOD + "end of file\n", {}),
    "an angle missing": ("a.csv", changed(50, ";1,0"), {}),
    "an angle twice": ("a.csv", changed(50, "-314,0;1,0"), {}),
    "an angle back": ("a.csv", changed(50, "-320,0;1,0"), {}),
    "falling angles": ("a.csv", of(-FULL, EXACT), {}),
    "half a cycle": ("a.csv", of(FULL[180:540], EXACT[180:540]), {}),
    "two thirds": ("a.csv", of(FULL[:480], EXACT[:480]), {}),
    "stroke 4 of half a cycle": ("a.csv", of(FULL[180:540], EXACT[180:540]), {"stroke": 4}),
    "rows missing in every cycle": ("a.csv", of(LONG[SHORT] % 720, MANY[SHORT]), {}),
    "cycles at other angles": ("a.csv", of(LONG + 0.4 * (LONG >= 1440), MANY), {}),
    "missing everywhere": (
        "a.csv",
        "\n".join(
            line.split(";")[0] + ";-9999" if 100 < k < 110 else line
            for k, line in enumerate(GOOD.split("\n"))
        ),
        {},
    ),
    "upside down": ("a.csv", of(FULL, -EXACT), {}),
    "a peak beside the dead centre": ("a.csv", of(FULL, FOUR), {}),
    "two peaks": ("a.csv", of(FULL, EXACT + np.roll(EXACT, 360)), {}),
    "an odd lag": (
        "a.csv",
        of(
            FULL,
            EXACT,
            pressure_of(FIRED, FULL - 51.0),
            names=("CA", "PCYL1", "PCYL2"),
            units=("deg", "bar(a)", "bar(a)"),
        ),
        {},
    ),
    "cycles or cylinders": (
        "a.csv",
        of(FULL, EXACT, EXACT, names=("CA", "1", "2"), units=("deg", "bar(a)", "bar(a)")),
        {},
    ),
    "two of one cylinder": (
        "a.csv",
        of(FULL, EXACT, EXACT, names=("CA", "PCYL1", "PCYL1_HP"), units=("deg", "bar", "bar")),
        {},
    ),
    "intake alone": ("a.csv", of(FULL, EXACT, names=("CA", "PINT")), {}),
    "inlet without its column": ("a.csv", GOOD, {"reference": "inlet"}),
    "polytrope without geometry": ("a.csv", GOOD, {"reference": "polytrope 1.32"}),
    "smooth without rows": ("a.csv", GOOD, {"smooth": "2 deg"}),
    "a cycle that is not there": (
        "a.csv",
        columns_of_cycles(FULL, cycles(FIRED, FULL, 3), reference="(a)"),
        {"cycles": "7"},
    ),
    "the wrong separator": ("a.csv", GOOD, {"separator": "tab"}),
    "the wrong decimal sign": ("a.csv", GOOD, {"decimal": "."}),
}
