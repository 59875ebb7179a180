"""Exports of indicating systems: what stands in them, and what is to be read."""

import numpy as np
from exports import FIRED, HEADER, columns_of_cycles, cycles, text

from validation.oracles.measured import pressure_of

FULL = np.arange(-360.0, 360.0, 1.0)
EXACT = pressure_of(FIRED, FULL)


def rows(values, names, units, **options):
    return text([FULL, *values], ["CA", *names], ["deg", *units], **options)


def simple(unit, factor, **options):
    return text([FULL, EXACT * factor], ["CA", "PCYL1"], ["deg", unit], digits=7, **options)


CHANGING = np.concatenate(
    [np.arange(-360.0, -30.0, 1.0), np.arange(-30.0, 90.0, 0.1), np.arange(90.0, 360.0, 1.0)]
)
LONG = np.arange(0.0, 720.0 * 4, 1.0)


def across(angle, values):
    lines = [";".join(["Cycle", *(f"{each:g}" for each in angle)])]
    lines += [
        ";".join([str(k + 1), *(f"{v:.4f}" for v in row)]).replace(".", ",")
        for k, row in enumerate(values)
    ]
    return "PCYL1;[bar]\n" + "\n".join(lines) + "\n"


EXPORTS = {
    "semicolon and decimal comma": (simple("bar", 1.0), "utf-8"),
    "tab and decimal point": (simple("bar", 1.0, separator="\t", comma=False), "utf-8"),
    "comma and decimal point": (simple("bar", 1.0, separator=",", comma=False), "utf-8"),
    "blanks": (simple("bar", 1.0, separator="   ", comma=False), "utf-8"),
    "quoted commas": (
        '"CA [deg]","PCYL1 [bar]"\n'
        + "".join(f'"{a:.1f}","{p:.5f}"\n' for a, p in zip(FULL, EXACT, strict=True)).replace(
            ".", ","
        ),
        "utf-8",
    ),
    "UTF-16 with a mark": (simple("bar", 1.0), "utf-16"),
    "UTF-16 without a mark": (simple("bar", 1.0), "utf-16-le"),
    "UTF-8 with a mark": (simple("bar", 1.0), "utf-8-sig"),
    "umlauts of Windows": ("Prüfstand;Öl 90 °C\n" + simple("bar", 1.0), "cp1252"),
    "lines of Windows": (simple("bar", 1.0).replace("\n", "\r\n"), "utf-8"),
    "kPa": (simple("kPa", 100.0), "utf-8"),
    "Pa": (simple("Pa", 1e5), "utf-8"),
    "MPa": (simple("MPa", 0.1), "utf-8"),
    "psi": (simple("psi", 1e5 / 6894.757293168361), "utf-8"),
    "kgf/cm2": (simple("kgf/cm2", 1e5 / 98066.5), "utf-8"),
    "units in the names": (
        text([FULL, EXACT], ["Crank Angle [deg]", "Cyl Press 1 (bar)"], comma=False),
        "utf-8",
    ),
    "no row of units, a name of ours": (
        text([FULL, EXACT], ["crank_angle_deg", "pressure_bar"], separator=",", comma=False),
        "utf-8",
    ),
    "a long header": (
        "Measurement;2024-05-17\nOperator;N. N.\n\n"
        + HEADER
        + "Speed;2000;rpm\n\n"
        + simple("bar", 1.0),
        "utf-8",
    ),
    "a closing row": (
        text([np.append(FULL, 360.0), np.append(EXACT, EXACT[0])], ["CA", "PCYL1"], ["deg", "bar"]),
        "utf-8",
    ),
    "0 to 720, firing at 360": (
        text([FULL + 360.0, EXACT], ["CA", "PCYL1"], ["deg", "bar"]),
        "utf-8",
    ),
    "0 to 720, firing at 0": (
        text([FULL + 360.0, pressure_of(FIRED, FULL + 360.0)], ["CA", "PCYL1"], ["deg", "bar"]),
        "utf-8",
    ),
    "radians": (
        text([np.radians(FULL), EXACT], ["Angle", "PCYL1"], ["rad", "bar"], digits=9),
        "utf-8",
    ),
    "a resolution that changes": (
        text([CHANGING, pressure_of(FIRED, CHANGING)], ["CA", "PCYL1"], ["deg", "bar"]),
        "utf-8",
    ),
    "cycles as columns": (columns_of_cycles(FULL, cycles(FIRED, FULL, 30)), "utf-8"),
    "cycles as columns of one name": (
        rows(cycles(FIRED, FULL, 30), ["PCYL1"] * 30, ["bar"] * 30),
        "utf-8",
    ),
    "cycles as columns under their numbers": (
        rows(cycles(FIRED, FULL, 30), [str(k + 1) for k in range(30)], ["bar"] * 30),
        "utf-8",
    ),
    "cycles as rows": (across(FULL, cycles(FIRED, FULL, 30)), "utf-8"),
    "consecutive cycles in one piece": (
        text([LONG, pressure_of(FIRED, LONG - 360.0)], ["CA", "PCYL1"], ["deg", "bar"]),
        "utf-8",
    ),
    "consecutive cycles, the angle again from 0": (
        text([LONG % 720, pressure_of(FIRED, LONG - 360.0)], ["CA", "PCYL1"], ["deg", "bar"]),
        "utf-8",
    ),
    "a file that begins and ends within a cycle": (
        text(
            [LONG[100:2600] % 720, pressure_of(FIRED, LONG[100:2600] - 360.0)],
            ["CA", "PCYL1"],
            ["deg", "bar"],
        ),
        "utf-8",
    ),
    "a column that counts the cycles": (
        text(
            [LONG // 720 + 1, LONG % 720, pressure_of(FIRED, LONG - 360.0)],
            ["Cycle", "CA", "PCYL1"],
            ["-", "deg", "bar"],
        ),
        "utf-8",
    ),
    "mean, least and largest beside the cycles": (
        rows(
            [*cycles(FIRED, FULL, 3), EXACT, 0.5 * EXACT, 2.0 * EXACT, 0.01 * EXACT],
            ["PCYL1_1", "PCYL1_2", "PCYL1_3", "PCYL1 mean", "PCYL1_MIN", "PCYL1_MAX", "PCYL1 std"],
            ["bar"] * 7,
        ),
        "utf-8",
    ),
    "a mean cycle alone": (
        rows([EXACT, 2.0 * EXACT], ["PCYL1 avg", "PCYL1 max"], ["bar"] * 2),
        "utf-8",
    ),
    "intake, exhaust, rail and other columns": (
        rows(
            [EXACT, 0.0 * EXACT + 1.0, 0.0 * EXACT + 1.2, 1000.0 + EXACT, EXACT],
            ["PCYL1", "PINT1", "PEXH1", "PRAIL", "TEMP"],
            ["bar", "bar", "bar", "bar", "°C"],
        ),
        "utf-8",
    ),
    "a separator behind every line": (
        simple("bar", 1.0).replace("\n", ";\n"),
        "utf-8",
    ),
    "comments": ("# exported by hand\n# 2000 rpm\n" + simple("bar", 1.0), "utf-8"),
    "no names": (text([FULL, EXACT], ["deg", "bar"]), "utf-8"),
}


EXPORTS |= {
    "names with blanks over columns of blanks": (
        "  Crank Angle     Cylinder 1 Pressure\n  [deg]           [bar]\n"
        + "\n".join(f"  {a:10.2f}  {p:12.5f}" for a, p in zip(FULL, EXACT, strict=True)),
        "utf-8",
    ),
    "rows of descriptions between units and numbers": (
        simple("bar", 1.0).replace("bar\n", "bar\nencoder;6052C\n1st;channel\n", 1),
        "utf-8",
    ),
    "units above the names": (
        simple("bar", 1.0).replace("CA;PCYL1\ndeg;bar\n", "deg;bar\nCA;PCYL1\n", 1),
        "utf-8",
    ),
    "names behind a sign of comment": (
        simple("bar", 1.0).replace("CA;PCYL1\ndeg;bar\n", "% CA [deg];PCYL1 [bar]\n", 1),
        "utf-8",
    ),
    "a line for spreadsheets, units behind a stroke": (
        "sep=;\n" + text([FULL, EXACT], ['"Kurbelwinkel / °KW"', '"p_Zyl1 / bar"']),
        "utf-16",
    ),
    "a unit within the name": (
        text([FULL, EXACT], ["Angle[deg]_Crank", "Pressure[bar]_Cyl01"], comma=False),
        "utf-8",
    ),
    "a stray line below the names": (
        text([FULL, EXACT], ["CrankPos [deg]", "Pcyl [bar]"], comma=False).replace(
            "\n", "\nArrays\n", 1
        ),
        "utf-8",
    ),
    "sections, and cycles under an index": (
        "[Measurement]\nTitle\tÖl 17\nBore [mm]\t85.25\n\n[Data]\n"
        + text(
            [FULL, *cycles(FIRED, FULL, 20)],
            ["CRANKANGLE", *(f"PCYL1[{k + 1}]" for k in range(20))],
            ["°CA aTDC", *["bar"] * 20],
            separator="\t",
            comma=False,
        ),
        "cp1252",
    ),
    "numbers in powers of ten": (
        "Crank Angle [deg] Pcyl [bar]\n".replace(" P", "\tP")
        + "\n".join(f"{a:.7e}\t{p:.7e}" for a, p in zip(FULL, EXACT, strict=True)),
        "utf-8",
    ),
    "units that are of nothing here": (
        rows(
            [EXACT, *(0.0 * EXACT + k for k in (3000.0, 40.0, 12.0, 88.0))],
            ["PCYL1", "Speed", "Torque", "Fuel", "TOIL"],
            ["bar", "rpm", "Nm", "mg", "degC"],
        ),
        "utf-8",
    ),
    "units that are of nothing here, above the names": (
        rows([EXACT, 0.0 * EXACT], ["PCYL1", "Speed"], ["bar", "1/min"]).replace(
            "CA;PCYL1;Speed\ndeg;bar;1/min\n", "deg;bar;1/min\nCA;PCYL1;Speed\n", 1
        ),
        "utf-8",
    ),
    "an angle named by its unit, beside one of nothing here": (
        text(
            [LONG // 720 + 1, LONG % 720, pressure_of(FIRED, LONG - 360.0), 0.0 * LONG],
            ["cycle", "crank_deg", "P_cyl_1", "T_oil"],
            ["", "deg", "bar", "degC"],
            separator=",",
            comma=False,
        ),
        "utf-8",
    ),
}
