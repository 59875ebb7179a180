"""The stored end states of the known machines, and how they are computed anew."""

import csv
from dataclasses import dataclass
from pathlib import Path

from validation.oracles.arithmetic import Number, multiprecision
from validation.oracles.free_motion import free_motion
from validation.oracles.known_machines import COASTING, ENGINE_1A, PROPELLER, TORQUE_DRIVEN
from validation.oracles.machine import Machine

PATH = Path(__file__).parent.parent / "reference" / "end_states.csv"
DIGITS = 20
HEADER = f"""\
# End states of free motions in exact decimal inputs (validation/oracles/known_machines.py).
# Source: Taylor series of the absolute-coordinate equations, validation/oracles/free_motion.py,
# with 25 and with 30 digits (orders 32 and 39), which agree to the {DIGITS} digits written.
# Rewritten by: python -m validation.oracles
"""


@dataclass(frozen=True)
class Case:
    """A motion from (theta0, omega0) at t = 0 to `time`."""

    machine: Machine
    theta0: str
    omega0: str
    time: str


CASES = {
    "coasting": Case(COASTING, "0.3", "100", "0.5"),
    "propeller": Case(PROPELLER, "0", "335.1", "0.75"),
    "torque_driven_1s": Case(TORQUE_DRIVEN, "0", "0", "1"),
    "torque_driven_3s": Case(TORQUE_DRIVEN, "0", "0", "3"),
    "engine_1a": Case(ENGINE_1A, "0", "10", "5"),
}


def compute(case: Case, digits: int) -> tuple[Number, Number]:
    """theta [rad] and omega [rad/s] at the end, with so many digits in every operation."""
    motion = free_motion(
        case.machine,
        case.theta0,
        case.omega0,
        times=[case.time],
        arithmetic=multiprecision(digits),
    )
    return motion.theta[-1], motion.omega[-1]


def rewrite() -> None:
    """Compute every case twice and store what agrees; raises ArithmeticError if they do not."""
    lines = [HEADER, "case,time_s,theta_rad,omega_rad_per_s\n"]
    compare = multiprecision(40)
    for name, case in CASES.items():
        state = [compare.number(str(value)) for value in compute(case, 30)]
        check = [compare.number(str(value)) for value in compute(case, 25)]
        for value, other in zip(state, check, strict=True):
            if abs(value - other) > abs(value) * compare.number(f"1e-{DIGITS}"):
                raise ArithmeticError(f"{name}: {value} and {other} do not agree")
        theta, omega = (value.context.nstr(value, DIGITS) for value in state)
        lines.append(f"{name},{case.time},{theta},{omega}\n")
    PATH.write_text("".join(lines), encoding="utf-8")


def stored() -> dict[str, tuple[str, str]]:
    """theta [rad] and omega [rad/s] by case, as the decimal strings of the file."""
    with PATH.open(encoding="utf-8") as file:
        rows = csv.DictReader(line for line in file if not line.startswith("#"))
        return {row["case"]: (row["theta_rad"], row["omega_rad_per_s"]) for row in rows}
