"""The commented scene from which a user starts."""

from __future__ import annotations

import json

__all__ = ["template"]

_TEMPLATE = """\
# A scene says what the machine is, not how to solve it. Run it: crankmbs run <this file>
# A quantity is one number and one unit. A bare number is SI; angles and speeds need a unit.
# A key after "#" is optional.
title = {title}
#source = "where the numbers come from"

[crank]
radius = "40 mm"
inertia = "0.12 kg m^2"         # about the crank axis, flywheel included; [motion] does without
#mass = "8 kg"                  # counts for gravity and the main-bearing force
#center_of_mass = "-5 mm"       # along the throw of phase 0; negative: counterweight

[rod]
length = "140 mm"
mass = "0.56 kg"
center_of_mass = "40 mm"        # from the crank pin
inertia = "two-mass"            # or about the centre of mass, such as "1.9e-3 kg m^2"

[piston]
mass = "0.42 kg"
bore = "80 mm"                  # or area = "50 cm^2"
#offset = "1 mm"                # of the cylinder axis, in +Y

#[layout]                       # default: one cylinder
#firing_order = [1, 3, 4, 2]    # or cylinders = [{{ phase = "0 deg", bank = "-30 deg" }}, ...]

[gas]
ambient = "1 bar"               # on the crankcase side
#stroke = 2                     # default 4
#pressure = "gas.csv"           # in place of [gas.indicator]: crank_angle_deg,pressure_bar
#interpolation = "cubic"        # linear | pchip | cubic | step; two rows at one angle are a jump
#closing = "0.02 bar"           # so near the first a closing row is dropped; default 1 % of range

[gas.indicator]                 # polytropes over the exact volume
compression_ratio = 10
n_compression = 1.32
n_expansion = 1.27
intake_pressure = "0.92 bar"
exhaust_pressure = "1.08 bar"
peak_pressure = "58 bar"
#pre_expansion = 1.2            # volume after / before combustion at constant pressure

#[gravity]                      # left out: none
#acceleration = "9.81 m/s^2"
#angle = "90 deg"               # where it pulls, from X; left out: 180 deg, an upright engine

[start]                         # the crank is free ...
angle = "0 deg"
speed = "3000 rpm"
[[torque]]                      # ... and any number of torques act on it; positive drives
kind = "quadratic"              # -c omega |omega|; or constant, viscous, a table
coefficient = "2.4e-4 N m s^2"  # takes what the gas gives at 3000 rpm
#[motion]                       # in place of [start] and [[torque]]
#speed = "3000 rpm"             # or {{ mean = ..., amplitude = ..., order = ... }}

[run]
until = "20 cycles"             # or "10 rev", "0.75 s", "settled"
#every = "0.5 deg"              # output spacing; default 1 deg
"""


def template(name: str) -> str:
    """The text of a commented scene with this title, complete as it stands.

    >>> template("my engine").splitlines()[3]
    'title = "my engine"'
    """
    title = json.dumps(name, ensure_ascii=False).replace("\x7f", "\\u007f")
    return _TEMPLATE.format(title=title)
