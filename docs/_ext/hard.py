"""The hard cases as a table that can be read, from what the claims measured."""

from __future__ import annotations

import json
import re
from pathlib import Path
from typing import NamedTuple

__all__ = ["WHY", "hard_page"]

_DETAILS = Path(__file__).parents[2] / "validation" / "details.json"
_RIGHT = re.compile(r"right: (\w+) (\S+), stated (\S+) ([^;]+)")
_STOPPED = re.compile(r"stopped \(status -?\d\): ([^;]+)")

WHY = {
    "beside_dead_centre": "the torque is almost zero, and what a rounding changes grows",
    "close_knots": "an interval a thousand times narrower than a sample's",
    "compression": "the crank turns back at each compression",
    "compression_angle": "the end that is asked for does not exist",
    "dead_centre": "no torque acts: the crank must stay, and a rounding makes it leave",
    "fine_output": "output must not set the steps, and needs values between them",
    "flywheel": "the speed changes in its last digits alone",
    "fold": "the rod stands square to the cylinder, where the constraints lose rank",
    "fold_offset": "the same beside an offset",
    "held": "the torque jumps across zero at this speed: steps shrink without end",
    "hundred_thousand_cycles": "errors of each cycle add up in the angle",
    "light_rod": "the mass matrix of free bodies is nearly singular",
    "load_step": "a jump in time inside a step costs the order of a method",
    "million_rpm": "inertia forces exceed gas forces by orders of magnitude",
    "noise": "the pressure is not smooth between any two rows",
    "one_rpm": "the weights work against a small kinetic energy",
    "piston_10_t": "the reduced inertia varies by orders of magnitude within a turn",
    "piston_1_g": "inertia is small beside the gas force",
    "pressure_jumps": "forces jump, so that samples have two values there",
    "pressure_linear": "a kink at every row lowers the order of a method that steps across it",
    "pressure_pchip": "curvature jumps at every row",
    "pressure_step": "the force jumps at every row",
    "ramp_to_zero": "the crank rests before the end that is asked for",
    "reversals": "the crank angle cannot be the variable where the crank turns back",
    "rod_longer_1e_3": "the rod's angular speed reverses within 10 degrees of crank angle",
    "rod_longer_1e_6": "the same within 0.3 degrees",
    "rod_longer_1e_9": "the same within 0.01 degrees",
    "rod_too_short": "the mechanism cannot turn",
    "rtol_1e_15": "below the rounding of a double",
    "speed_file_touches_zero": "time over angle has an infinite slope there",
    "speed_jump": "the torque jumps at a speed, whose time is not known beforehand",
    "stiff_creep": "a fast decay beside a slow motion: explicit methods take minute steps",
    "stiff_load": "the crank stops within a millionth of a turn",
    "thousand_revolutions": "errors of each turn add up in the angle",
    "touches_zero": "the least error decides whether the crank passes or falls back",
    "until_zero": "there is nothing to run",
}
"""Why each case is hard, by its name."""


class _Row(NamedTuple):
    """What happened, and of its worst variable the true and the stated error."""

    outcome: str
    true: str
    stated: str


def hard_page() -> str:
    """Case, why it is hard, what exudyn's bodies and what crankmbs make of it, in Markdown."""
    details = json.loads(_DETAILS.read_text(encoding="utf-8"))
    heads = "| case | why it is hard | exudyn's rigid bodies | crankmbs | true error | stated |"
    lines = [heads, "|---|---|---|---|---|---|"]
    for name, why in WHY.items():
        line = details[f"hard_{name}"]["table"][2]
        case, kinetostatic, crank_angle, _, multibody = map(
            str.strip, re.split(r"(?<!\\)\|", line.strip("|"))
        )
        prescribed = crank_angle.startswith("refused: formulation")
        here = _row(kinetostatic if prescribed else crank_angle)
        bodies = _row(multibody)
        error = f"; true {bodies.true}, stated {bodies.stated}" if bodies.true else ""
        linked = f"[{case}](../../validation/CLAIMS.md#hard_{name})"
        lines.append(f"| {linked} | {why} | {bodies.outcome}{error} | {' | '.join(here)} |")
    return "\n".join([*lines, ""])


def _row(cell: str) -> _Row:
    """A cell of the claims' table."""
    if cell.startswith("refused: "):
        return _Row(f"refused: {cell.removeprefix('refused: ').split(';')[0]}", "", "")
    stopped, right = _STOPPED.search(cell), _RIGHT.search(cell)
    outcome = f"stops: {stopped[1].removeprefix('stopped at ')}" if stopped else "right"
    if right is None:
        return _Row(outcome, "", "")
    name, true, stated, units = right.groups()
    what = name.replace("_", " ")
    return _Row(outcome, f"{true} {units} ({what})", f"{stated} {units}")
