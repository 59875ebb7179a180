"""ERRATA.md is what its code writes, and every correction that can be computed is, anew."""

from math import asin, cos, degrees, pi, radians, sin, sqrt, tan

import pytest

from crankmbs import lecture
from validation import errata, reference
from validation.checks.s1_tables import printed_cells, table_of

EQUATIONS = {row["id"]: row for row in reference.rows("errata")}
CELLS = {(cell.name, cell.degrees): cell for cell in errata.misprints()}
BY_HAND = [
    row
    for row in reference.rows("s1_verdicts")
    if row["class"] in ("MISPRINT", "slip") and row["quantity"] != "PG"
]
R, L, RATIO, OFFSET, OMEGA = 0.046, 0.046 / 0.3, 0.3, 0.0282, 3200.0 * pi / 30.0


def law(power: int) -> float:
    """The bracket of S1's Eq. 5 at 30 degrees, times R omega^power."""
    phi = radians(30.0)
    bracket = cos(phi) + RATIO * cos(2.0 * phi) + OFFSET * RATIO * sin(phi)
    return R * OMEGA**power * bracket


def brauer(exponent: float) -> float:
    """p V^1.18 behind a step of the construction over that before it, tan beta of an exponent."""
    volume = 1.0 + tan(radians(15.0))
    return volume**1.18 / volume**exponent


def minimum(ratio: float) -> float:
    return degrees(float(lecture.acceleration_minimum_angle(rod_ratio=ratio)))


def quarters() -> tuple[float, float]:
    first, whole = lecture.quarter_displacements_series(crank_radius=R, rod_length=L)[[1, 2]]
    return float(first), float(whole - first)


def square() -> float:
    """S0's greatest speed, that where the rod is square to the crank."""
    return R * OMEGA * sqrt(1.0 + RATIO**2)


def largest_speed() -> float:
    return float(lecture.maximum_piston_speed(crank_radius=R, rod_length=L, omega=OMEGA))


NET = {name: float(printed_cells()[90][name]) for name in ("PG", "Fi", "F")}
TOP = {name: float(printed_cells()[0][name]) for name in ("acceleration", "Fi")}
ROD = lecture.two_mass_rod(rod_mass=1.0, rod_length=L, center_of_mass=0.25 * L)
WEB = {"web_mass": 3.0, "center_of_mass": 0.02, "crank_radius": R}
REDUCED = lecture.reduced_web_mass(**WEB)
# id: what the printed form gives, what the corrected one gives, what must come out, how near
ANEW = {
    "s0-cmax": (square(), square() * 1.000289, largest_speed(), 1e-4),
    "s0-sign": (0.15727 * TOP["acceleration"], -0.15727 * TOP["acceleration"], TOP["Fi"], 5e-3),
    "s1-eq5": (law(0), law(2), 5270.161, 1e-3),
    "s1-eq6": (1.0 + 20.0**19, 1.0 + 19.0, 20.0, 1e-12),
    "s1-eq8": (brauer(1.32), brauer(1.18), 1.0, 1e-12),
    "s1-eq12": (2.0 * REDUCED * R, 2.0 * REDUCED, 2.0 * 3.0 * 0.02 / R, 1e-12),
    "s1-eq13": (0.25 + 0.25, ROD.piston_pin + ROD.crank_pin, 1.0, 1e-12),
    "s1-eq24": (NET["PG"] - NET["Fi"], NET["PG"] + NET["Fi"], NET["F"], 1.5e-3),
    "s2-angle": (6.0 * pi * 3200.0 * 0.01, 6.0 * 3200.0 * 0.01, degrees(OMEGA * 0.01), 1e-9),
    "s2-brix": (R * 1.15, R * 0.3, quarters()[0] - quarters()[1], 1e-12),
    "s2-minimum": (180.0, 148.23, minimum(0.3), 5e-3),
    "s2-beta": (17.0, 17.97, degrees(asin(RATIO * (1.0 + OFFSET))), 5e-3),
}


def test_the_page_is_what_the_code_writes():
    assert errata.ERRATA.read_text(encoding="utf-8") == errata.text()


def test_every_correction_that_says_so_is_computed_anew():
    assert {key for key, row in EQUATIONS.items() if row["anew"] == "yes"} == ANEW.keys()


@pytest.mark.parametrize("key", ANEW)
def test_the_correction_comes_out_and_the_print_does_not(key):
    printed, corrected, true, near = ANEW[key]
    assert abs(corrected - true) <= near
    assert abs(printed - true) > near


@pytest.mark.parametrize("row", BY_HAND, ids=lambda row: f"{row['quantity']}-{row['as_printed']}")
def test_every_misprint_found_by_hand_is_on_the_page(row):
    cell = CELLS[row["quantity"], int(row["crank_angle_deg"])]
    assert cell.printed == row["as_printed"]
    assert cell.corrected != cell.printed
    line = f"| {table_of(cell.name)} | {cell.degrees} | {cell.name} ["
    assert line in errata.text()


def test_the_page_has_no_misprint_that_was_not_found_by_hand():
    assert len(CELLS) == len(BY_HAND)


def test_what_the_paper_says_against_itself():
    power, speed, *_ = errata.at_odds()
    assert "70.4 kW" in power[0]
    assert ": 27.2 kW" in power[1]
    assert power[2].startswith("2.59 times")
    assert "7 m/s" in speed[0]
    assert "9.81 m/s" in speed[1]
