"""Machines of other programs and books, with stored end states, and one with every feature."""

from dataclasses import replace

from validation.oracles.arithmetic import multiprecision
from validation.oracles.machine import Loads, Machine, PressureTable

_WIDE = multiprecision(60)

COASTING = Machine(
    crank_radius="0.046",
    crank_inertia="0.02",
    crank_mass="5",
    rod_length="0.1533333333",
    rod_mass="1.427",
    rod_center_of_mass="0.04305599999064",
    rod_inertia="0.0055",
    piston_mass="1.1416",
    gravity=("-9.81", "0"),
)
"""A crank train that turns under gravity alone."""

_TABLE = """
0 2000.0  30 -5000.0  90 -5000.0  150 -5000.0  180 -5000.0  220 11861.361144038645
255 55459.053810636775  285 170917.0289993799  310 485765.29472817865  328 1211342.8898111535
342 2701845.1412606575  352 4391152.525047166  360 6500000.0  368 5673461.511699559
378 3686656.121633727  392 1820875.1664794828  410 834602.5110982256  432 401626.9482926938
460 204337.23498284363  490 125998.95005554528  515 49958.7644775135  540 60000.0
570 10000.0  600 10000.0  650 10000.0  690 10000.0
"""
_DEGREES, _PASCALS = _TABLE.split()[::2], _TABLE.split()[1::2]

PROPELLER = replace(
    COASTING,
    piston_area="57.08e-4",
    pressure=PressureTable(
        angles=tuple(_WIDE.number(text) * _WIDE.pi / 180 for text in _DEGREES),
        pressures=tuple(_PASCALS),
        period=4 * _WIDE.pi,
        interpolation="cubic",
    ),
    loads=Loads(quadratic="9.5e-5"),
)
"""The same crank train fired by a made-up four-stroke diesel cycle, against a propeller."""

TORQUE_DRIVEN = Machine(
    crank_radius="0.1",
    crank_inertia=_WIDE.number("0.2") * _WIDE.number("0.1") ** 2 / 3,
    crank_mass="0.2",
    crank_center_of_mass="0.05",
    rod_length="0.3",
    rod_mass="0.2",
    rod_center_of_mass="0.15",
    rod_inertia="0.0015",
    piston_mass="0.4",
    loads=Loads(constant="0.1"),
)
"""exudyn's slider-crank: uniform bars, a constant torque, from rest at top dead centre."""

_DENSITY = 7700  # kg/m3, the default of the library's bodies
_CYLINDER = _DENSITY * _WIDE.pi / 40  # kg/m2: a length of 0.1 m of a cylinder, per diameter^2
_WEB = _WIDE.number("0.77")  # kg: 0.1 m x 0.05 m x 0.02 m
_JOURNAL, _PIN = (_CYLINDER * _WIDE.number(diameter) ** 2 for diameter in ("0.05", "0.03"))

ENGINE_1A = Machine(
    crank_radius="0.1",
    crank_inertia=1  # the engine's output
    + _JOURNAL * _WIDE.number("0.05") ** 2 / 8
    + 2 * _WEB * (_WIDE.number("0.0125") / 12 + _WIDE.number("0.05") ** 2)
    + _PIN * (_WIDE.number("0.03") ** 2 / 8 + _WIDE.number("0.01")),
    crank_mass=_WEB + _PIN,
    crank_center_of_mass="0.1",
    rod_length="0.2",
    rod_mass="1.848",
    rod_center_of_mass="0.1",
    rod_inertia="0.0067144",
    piston_mass=_CYLINDER * _WIDE.number("0.1") ** 2,
    gravity=("-9.80665", "0"),
)
"""Modelica.Mechanics.MultiBody.Examples.Loops.Engine1a: no gas, gravity along the cylinder.

From the dimensions of the model's bodies. Of the crank's mass only the first moment counts: of two
webs at half the radius and of the pin at the whole.
"""

KHURMI_15_3 = Machine(crank_radius="0.3", crank_inertia="1", rod_length="1", piston_mass="1")
"""Khurmi's Example 15.3; its masses do not matter."""

KHURMI_15_7 = replace(KHURMI_15_3, rod_length="1.2", piston_mass="250")
"""Khurmi's Example 15.7 without its pressure."""

KHURMI_15_8 = Machine(
    crank_radius="0.225",
    crank_inertia="1",
    rod_length="1.2",
    piston_mass="225",
    gravity=("-9.81", "0"),
)
"""Khurmi's Example 15.8 without its pressures."""

TEST_SET_CRANK = Machine(
    crank_radius="0.15",
    crank_inertia="0.002727",
    rod_length="0.3",
    rod_mass="0.151104",
    rod_center_of_mass="0.15",
    rod_inertia="0.0011340859",
    piston_mass="0.075552",
)
"""The slider-crank of the IVP test set with a rigid rod."""

V_TWIN = Machine(
    crank_radius=0.05,
    crank_inertia=0.04,
    crank_mass=6.0,
    crank_center_of_mass=-0.012,
    rod_length=0.17,
    rod_mass=1.1,
    rod_center_of_mass=0.045,
    rod_inertia=0.004,
    piston_mass=0.9,
    piston_area=0.006,
    offset=0.002,
    cylinders=((0.0, -0.4), (2.0, 0.5)),
    pressure=PressureTable(
        (0.3, 1.1, 2.0, 3.7, 5.0, 5.5), (1e5, 4e5, 2e5, -3e4, -3e4, 6e5), 6.9, "pchip"
    ),
    gravity=(-9.0, 2.0),
)
"""No engine: offset, banks, counterweight, slanted gravity and uneven pressure all at once."""
