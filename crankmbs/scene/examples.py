"""What a key may be given as: in the manual's tables, and where a key is missing."""

from __future__ import annotations

__all__ = ["example_of"]

_OF_KEYS = {
    "acceleration": '"9.81 m/s^2"',
    "after": '"0.2 s"',
    "ambient": '"1 bar"',
    "amplitude": '"40 rpm"',
    "angle": '"30 deg"',
    "area": '"57 cm^2"',
    "bank": '"-30 deg"',
    "bore": '"85 mm"',
    "closes": '"-20 deg"',
    "closing": '"0.02 bar"',
    "compression_ratio": "10",
    "crank_end": '"crank_end.csv"',
    "diameter": '"56 mm"',
    "exhaust_pressure": '"1.08 bar"',
    "file": '"table.csv"',
    "force": '"250 N"',
    "from": '"800 rpm"',
    "from_speed": '"300 rpm"',
    "inertia": '"0.15 kg m^2"',
    "intake_pressure": '"0.92 bar"',
    "journal_positions": '["-50 mm", "50 mm"]',
    "ki": '"0.02 1/rad"',
    "kp": '"0.004 s/rad"',
    "length": '"153 mm"',
    "mean": '"3200 rpm"',
    "motored": '"motored.csv"',
    "n_compression": "1.32",
    "n_expansion": "1.27",
    "name": '"starter"',
    "offset": '"1.3 mm"',
    "order": "2",
    "over": '"2 s"',
    "peak_pressure": '"58 bar"',
    "period": '"3 rev"',
    "phase": '"180 deg"',
    "polytrope": "1.32",
    "position": '"100 mm"',
    "pressure": '"gas.csv"',
    "radius": '"46 mm"',
    "relaxed_at": '"20 mm"',
    "ring_force": '"40 N"',
    "rod_diameter": '"30 mm"',
    "spacing": '"100 mm"',
    "speed": '"3200 rpm"',
    "stiffness": '"12 N/mm"',
    "throw_unbalance": '["0.01 kg m"]',
    "to": '"3200 rpm"',
    "torque": '"-87 N m"',
    "until": '"5 s"',
    "until_speed": '"400 rpm"',
    "viscous": '"30 N s/m"',
    "width": '"31 mm"',
}
_OF_PARTS = {
    "Crank.center_of_mass": '"-8 mm"',
    "Crank.mass": '"12 kg"',
    "Damper.coefficient": '"30 N s/m"',
    "Governor.speed": '"1500 rpm"',
    "Gravity.angle": '"90 deg"',
    "Misfire.cycles": '"5-8"',
    "Piston.mass": '"1.14 kg"',
    "Quadratic.coefficient": '"7.8e-4 N m s^2"',
    "Rod.center_of_mass": '"38 mm"',
    "Rod.inertia": '"5.8e-3 kg m^2"',
    "Rod.mass": '"1.6 kg"',
    "Run.until": '"20 cycles"',
    "Viscous.coefficient": '"0.26 N m s"',
}


def example_of(part: type, key: str) -> str | None:
    """What a key of a part may be given as, as a file writes it; None where any will do.

    >>> from crankmbs import Crank
    >>> example_of(Crank, "radius")
    '"46 mm"'
    """
    owner = part.__name__.removeprefix("Own")  # of one cylinder, as that of all
    return _OF_PARTS.get(f"{owner}.{key}") or _OF_KEYS.get(key)
