"""The formulas of three lectures on the crank mechanism, as pure functions of numbers or arrays.

Sources: S0, R. Grega, "Kinematics and dynamics of crank mechanism", TU Kosice; S1, M. M. Yi,
S. Y. Win, T. T. Htay, "Kinematic Analysis of Crank Shaft for Diesel Engine"; S2, T. Kholbekov,
C. Amonov, E. Omanov, "Kinematics of KShM of Internal Combustion Engines". S0 and S2 do not number
their formulas: S0-F7 is the seventh of S0, V a stated value, D a definition.

Symbols: crank angle phi from the cylinder axis (S0's alpha), crank radius r, rod length l, rod
ratio lambda = r/l, offset e = k r of the cylinder axis in +Y, rod angle beta with
sin beta = lambda (sin phi - k), omega and alpha the crank's angular speed and acceleration.
Displacement counts from l + r, towards the crank; a force towards the crank is positive.

A name ending in `_series` is the lectures' truncation of the exact function without the ending.
Each docstring says whether it is exact, its order in lambda (of the error, without offset), the
greatest error over a revolution, and what the print has wrong. SI units; arguments broadcast.
"""

from crankmbs.lecture.cylinder_gas import (
    brauer_angle,
    brauer_points,
    clearance_volume,
    cylinder_volume,
    cylinder_volume_series,
    gas_force,
    piston_area,
    polytropic_pressure,
)
from crankmbs.lecture.dead_centres import (
    bottom_dead_centre,
    brix_correction,
    brix_correction_series,
    datum_shift,
    stroke,
    stroke_central,
    top_dead_centre,
)
from crankmbs.lecture.inertia_forces import (
    first_order_inertia_force,
    inertia_force,
    inertia_force_series,
    rotating_inertia_force,
    second_order_inertia_force,
)
from crankmbs.lecture.masses import (
    ROD_SHARE_CRANK_PIN,
    ROD_SHARE_PISTON_PIN,
    SPECIFIC_MASSES,
    SpecificMasses,
    TwoMassRod,
    design_mass,
    reciprocating_mass,
    reduced_crank_mass,
    reduced_web_mass,
    rotating_mass,
    two_mass_rod,
    two_mass_rod_inertia,
)
from crankmbs.lecture.motion import piston_acceleration, piston_displacement, piston_velocity
from crankmbs.lecture.motion_series import (
    first_order_displacement,
    piston_acceleration_series,
    piston_displacement_series,
    piston_velocity_series,
    second_order_displacement,
)
from crankmbs.lecture.pin_forces import (
    crank_torque,
    net_force,
    radial_force,
    rod_force,
    side_thrust,
    tangential_force,
)
from crankmbs.lecture.pin_forces_series import (
    radial_force_series,
    rod_force_series,
    side_thrust_series,
    tangential_force_series,
)
from crankmbs.lecture.rod_angles import (
    cos_beta,
    cos_beta_series,
    maximum_rod_angle,
    relative_offset,
    rod_angle,
    rod_ratio,
    secant_beta_series,
    sin_beta,
    tan_beta,
    tan_beta_series,
)
from crankmbs.lecture.special_angles import (
    ACCELERATION_MINIMUM_LIMIT,
    ACCELERATION_MINIMUM_LIMIT_SERIES,
    acceleration_minimum_angle,
    acceleration_minimum_angle_series,
    dead_centre_accelerations,
    quarter_displacements_series,
    quarter_velocities,
)
from crankmbs.lecture.speeds import (
    angular_speed,
    crank_angle_at,
    maximum_piston_speed,
    maximum_piston_speed_sqrt,
    maximum_speed_angle,
    mean_piston_speed,
)

__all__ = [
    "ACCELERATION_MINIMUM_LIMIT",
    "ACCELERATION_MINIMUM_LIMIT_SERIES",
    "ROD_SHARE_CRANK_PIN",
    "ROD_SHARE_PISTON_PIN",
    "SPECIFIC_MASSES",
    "SpecificMasses",
    "TwoMassRod",
    "acceleration_minimum_angle",
    "acceleration_minimum_angle_series",
    "angular_speed",
    "bottom_dead_centre",
    "brauer_angle",
    "brauer_points",
    "brix_correction",
    "brix_correction_series",
    "clearance_volume",
    "cos_beta",
    "cos_beta_series",
    "crank_angle_at",
    "crank_torque",
    "cylinder_volume",
    "cylinder_volume_series",
    "datum_shift",
    "dead_centre_accelerations",
    "design_mass",
    "first_order_displacement",
    "first_order_inertia_force",
    "gas_force",
    "inertia_force",
    "inertia_force_series",
    "maximum_piston_speed",
    "maximum_piston_speed_sqrt",
    "maximum_rod_angle",
    "maximum_speed_angle",
    "mean_piston_speed",
    "net_force",
    "piston_acceleration",
    "piston_acceleration_series",
    "piston_area",
    "piston_displacement",
    "piston_displacement_series",
    "piston_velocity",
    "piston_velocity_series",
    "polytropic_pressure",
    "quarter_displacements_series",
    "quarter_velocities",
    "radial_force",
    "radial_force_series",
    "reciprocating_mass",
    "reduced_crank_mass",
    "reduced_web_mass",
    "relative_offset",
    "rod_angle",
    "rod_force",
    "rod_force_series",
    "rod_ratio",
    "rotating_inertia_force",
    "rotating_mass",
    "secant_beta_series",
    "second_order_displacement",
    "second_order_inertia_force",
    "side_thrust",
    "side_thrust_series",
    "sin_beta",
    "stroke",
    "stroke_central",
    "tan_beta",
    "tan_beta_series",
    "tangential_force",
    "tangential_force_series",
    "top_dead_centre",
    "two_mass_rod",
    "two_mass_rod_inertia",
]
