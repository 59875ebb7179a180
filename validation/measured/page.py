"""MEASURED.md: what the free run predicts of a machine's speed, and what the record cannot say."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

__all__ = ["page_of"]

_ASSUMED = ("piston_mass", "rod_mass")
_KNOWN = ("wheel", "sensor", "bore", "stroke", "rod_length")

_METHOD = """\
## What is compared

Between two teeth the crank takes a time D, once in each revolution of a cycle. The tooth's
error is the same in both, so ln(D2 / D1) / 2, the half orders of the speed (0.5, 1.5, ...),
is free of it. At one angle the inertia of crank and pistons is the same, too: the ratio of
the squares of both speeds is that of the kinetic energies, so the torque of the reciprocating
masses cancels. What is left is the work of the gas over the mean kinetic energy.

The pressure of each cycle as it was measured drives a free crank, `crankmbs.simulate` over
all cycles of a part in one run. Its load is constant; load and first speed are those with
which the cycles end when the record's do, the balance of energy. Beside that the wheel only
says at which angle a pressure was measured. Inertia and dead centre, and the delay of the
sensor where it is free, are fitted to the half orders up to 2.5 of the cycles named
"identified on", and of no others. An interval is one of 95 % by the scatter from cycle to
cycle alone: what the model errs by in every cycle alike is not in it.
"""
_INTERVALS = """\
Without the delay the two unknowns are well separated. With it they are not: the correlations
say that a larger inertia, a later dead centre and an earlier pressure make nearly the same
speed. A pressure that is shown late cannot be told from a combustion that is late: both move
the pressure against the volume. Inertia and dead centre are known to no more than what this
table spans."""
_RESULT = """\
"Left" is the root mean square of the mean cycle, measured less predicted: of all half orders;
of those up to 2.5, which a rigid crank should have; and of single cycles."""
_ORDERS = """\
Each half order with the delay {delay}: its measured amplitude with the standard deviation of
the mean over the cycles, how many times the predicted one that is, and by how much its own
phase is behind the predicted one's."""
_EVEN = """\
## The whole speed

Whole orders are compared only after the wheel's errors have been identified from the record:
the mean of both revolutions, measured over predicted, of the cycles identified on is taken
for the wheel's. There the even part agrees by construction; in other records it is predicted,
but only how it differs from full load. What the model errs by in whole orders at full load,
torsional vibration and the assumed masses among it, is taken for the wheel's as well, and
comes back in the other records."""
_LIMITS = """\
## Limits

- One machine, three records of less than half a second; its masses are not known, nor its
  load.
- Inertia and the sensor's gain enter as their ratio: a gain 5 % higher is an inertia 5 %
  higher.
- The sensor's zero has no half orders: 0.5 bar changes them by {offset:.2g} rpm (root mean
  square), masses twice as large by {masses:.2g} rpm. Neither can be identified from them.
- Friction of rings and bearings is in the constant load; what of it follows the gas is not
  modelled.
- Intervals are by scatter alone. Where a measured order lies outside, the model errs: a rigid
  crank, a constant load, a sensor without dynamics.
"""


def page_of(numbers: dict[str, Any]) -> str:
    """The page, of the numbers as they are written beside it."""
    machine = numbers["machine"]
    first, free = numbers["delays"][0], numbers["delays"][-1]
    best = first["held"][1:]
    worst = [max(_share(row) for row in case["held"][1:]) for case in (first, free)]
    lines = [
        "# Held against a machine",
        "",
        "Written by `python -m validation.measured FILE...`; as data in "
        "`validation/measured.json`.",
        "",
        f"A {machine['title']}. Its pressure and its wheel were recorded over time at "
        f"{len(numbers['inputs'])} loads. On {machine['identified_on']} cycles of the first "
        "record inertia and dead centre are identified. In "
        f"{sum(_count(row) for row in best)} other cycles the free run leaves up to "
        f"{worst[0]:.0f} % of the half orders up to 2.5, with a free delay of the sensor up to "
        f"{worst[1]:.0f} % (root mean squares). Higher orders are those of a crank that is not "
        "rigid.",
        "",
        "![half orders of the speed, measured and predicted](figures/measured_half_orders.png)",
        "",
        *_given(numbers),
        _METHOD,
        *_identified(numbers),
        "",
        *_predicted(numbers),
        "",
        *_orders(first, machine.get("of_orders", [])),
        "",
        *_even(first),
        "",
        _LIMITS.format(
            offset=numbers["unseen"]["offset_of_0.5_bar_rpm"],
            masses=numbers["unseen"]["masses_doubled_rpm"],
        ),
    ]
    return "\n".join(lines)


def _count(row: dict[str, Any]) -> int:
    first, last = row["cycles"]
    return int(last - first + 1)


def _share(row: dict[str, Any]) -> float:
    return float(100.0 * row["left_to_order_2.5_rms_rpm"] / row["half_rms_rpm"])


def _part(row: dict[str, Any]) -> str:
    return f"{row['name']}, {row['cycles'][0]} to {row['cycles'][1]}"


def _given(numbers: dict[str, Any]) -> Iterator[str]:
    machine = numbers["machine"]
    known = ", ".join(f"{key.replace('_', ' ')} {machine[key]}" for key in _KNOWN)
    assumed = ", ".join(f"{key.replace('_', ' ')} {machine[key]}" for key in _ASSUMED)
    yield f"Source: {machine['source']}. Given: {known}. Assumed: {assumed}. Not given: the rest."
    yield from ("", "| input | SHA-256 |", "|---|---|")
    for name, digest in numbers["inputs"].items():
        yield f"| {name} | `{digest}` |"
    yield ""


def _identified(numbers: dict[str, Any]) -> Iterator[str]:
    yield from ("## What is identified", "")
    yield (
        "| identified on | delay [ms] | inertia [kg m^2] | dead centre [deg] | misfit [% of the "
        "speed] | correlations: inertia with dead centre; with delay; dead centre with delay |"
    )
    yield "|---|---|---|---|---|---|"
    rows = [(row["held"][0]["name"], row) for row in numbers["delays"]]
    on = _part(numbers["delays"][0]["held"][0])
    for name, row in [*rows, *((each["name"], each) for each in numbers["others"])]:
        delay = _with(row["delay_ms"], 2) if "delay_ms" in row else row["delay"].split()[0]
        inertia, centre = _with(row["inertia_kg_m2"], 5), _with(row["dead_centre_deg"], 1)
        correlation = "; ".join(f"{each:.2f}" for each in row["correlation"])
        where = on if name == rows[0][0] else f"{name}, all"
        yield (
            f"| {where} | {delay} | {inertia} | {centre} | {100.0 * row['misfit']:.3f} | "
            f"{correlation} |"
        )
    yield from ("", "The dead centre counts from the first edge after the gap, modulo 360 degrees.")
    yield "The last rows are a question to the other records, not used for any prediction."
    yield from ("", _INTERVALS, *numbers["machine"].get("of_delay", []))


def _with(pair: list[float], digits: int) -> str:
    return f"{pair[0]:.{digits}f} +- {pair[1]:.{digits}f}"


def _predicted(numbers: dict[str, Any]) -> Iterator[str]:
    yield from ("## What is predicted", "", _RESULT, "")
    yield (
        "| delay | cycles | speed [rpm] | load [N m] | imep [bar] | half orders, rms [rpm] | left "
        "| up to 2.5 | single cycles | interval up to | correlation |"
    )
    yield f"|{'---|' * 11}"
    for case in numbers["delays"]:
        for k, row in enumerate(case["held"]):
            name = f"{_part(row)} (identified on)" if k == 0 else _part(row)
            rpm = [row[key] for key in ("half_rms_rpm", "left_rms_rpm")]
            rpm += [row["left_to_order_2.5_rms_rpm"], row["left_single_cycle_rms_rpm"]]
            cells = [
                *(case["delay"], name, f"{row['mean_rpm']:.0f}", f"{row['load_Nm']:.2f}"),
                f"{row['imep_bar']:.2f}",
                *(f"{each:.1f}" for each in rpm),
                *(f"+- {row['band_largest_rpm']:.1f}", f"{row['correlation']:.3f}"),
            ]
            yield f"| {' | '.join(cells)} |"


def _orders(case: dict[str, Any], remarks: list[str]) -> Iterator[str]:
    yield from (_ORDERS.format(delay=case["delay"]), "")
    orders = [each["order"] for each in case["held"][0]["orders"]]
    yield f"| cycles | {' | '.join(f'{each:g}' for each in orders)} |"
    yield f"|{'---|' * (len(orders) + 1)}"
    for row in case["held"]:
        cells = [_order(each, row["mean_rpm"]) for each in row["orders"]]
        yield f"| {_part(row)} | {' | '.join(cells)} |"
    yield from ("", *remarks)


def _order(each: dict[str, float], rpm: float) -> str:
    hertz = each["order"] * rpm / 60.0
    return (
        f"{each['measured_rpm']:.1f} +- {each['scatter_rpm']:.1f} rpm at {hertz:.0f} Hz: "
        f"x {each['ratio']:.2f}, {each['lag_deg']:+.0f} deg"
    )


def _even(case: dict[str, Any]) -> Iterator[str]:
    yield from (_EVEN, "")
    yield from ("| cycles | even part, rms [rpm] | left [rpm] |", "|---|---|---|")
    for row in case["held"]:
        yield f"| {_part(row)} | {row['even_rms_rpm']:.1f} | {row['even_left_rms_rpm']:.1f} |"
    yield from ("", "![the whole speed, measured and predicted](figures/measured_speed.png)")
