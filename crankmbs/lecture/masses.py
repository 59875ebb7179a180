"""Mass substitution: rod and crank as two masses, and the design masses of S1's Table 3."""

from __future__ import annotations

from collections.abc import Mapping
from types import MappingProxyType
from typing import Final, NamedTuple

from crankmbs.lecture._domain import Real

ROD_SHARE_CRANK_PIN: Final = (0.7, 0.8)
"""Usual share of the rod's mass at the crank pin (S1 Eq. 20) [1]."""

ROD_SHARE_PISTON_PIN: Final = (0.2, 0.3)
"""Usual share of the rod's mass at the piston pin (S1 Eq. 19) [1]."""


class SpecificMasses(NamedTuple):
    """A row of S1's Table 3: bore range [m], mass ranges per piston area [kg/m^2]."""

    bore: tuple[float, float]
    piston: tuple[float, float]
    rod: tuple[float, float]


SPECIFIC_MASSES: Final[Mapping[str, SpecificMasses]] = MappingProxyType(
    {
        "carburettor": SpecificMasses((0.06, 0.10), (100.0, 150.0), (120.0, 200.0)),
        "diesel": SpecificMasses((0.08, 0.12), (200.0, 300.0), (250.0, 350.0)),
    }
)
"""S1's Table 3; 1 g/cm^2 = 10 kg/m^2; the pistons are of aluminium alloy."""


class TwoMassRod(NamedTuple):
    """The rod as a mass at each of its pins [kg]."""

    piston_pin: Real
    crank_pin: Real


def two_mass_rod(*, rod_mass: Real, rod_length: Real, center_of_mass: Real) -> TwoMassRod:
    """Split the rod between its pins: m_op = m a/l, m_or = m (l - a)/l = m b/l.

    Exact in mass and centre of mass; in inertia only if the rod has `two_mass_rod_inertia`.
    Source: S0-F16 to S0-F18, S1 Eq. 13, 14; usual shares S1 Eq. 19, 20.
    Misprint: S1 prints one right side for both equations; Eq. 13 takes the distance from the
        centre of mass to the crank pin, Eq. 14 that to the piston pin.
    Arguments: rod_mass m [kg]; rod_length l [m]; center_of_mass a, from the crank pin [m].
    Returns: piston_pin m_op and crank_pin m_or [kg].

    >>> two_mass_rod(rod_mass=2.0, rod_length=0.25, center_of_mass=0.0625)
    TwoMassRod(piston_pin=0.5, crank_pin=1.5)
    """
    at_piston_pin = rod_mass * center_of_mass / rod_length
    return TwoMassRod(at_piston_pin, rod_mass - at_piston_pin)


def two_mass_rod_inertia(*, rod_mass: Real, rod_length: Real, center_of_mass: Real) -> Real:
    """Moment of inertia that the two masses have about the centre of mass: m a (l - a).

    Exact.
    Source: S0-F16 to S0-F18, S1 Eq. 13, 14.
    Arguments: rod_mass m [kg]; rod_length l [m]; center_of_mass a, from the crank pin [m].
    Returns: [kg m^2].

    >>> f"{two_mass_rod_inertia(rod_mass=1.6, rod_length=0.2, center_of_mass=0.05):.4f}"
    '0.0120'
    """
    return rod_mass * center_of_mass * (rod_length - center_of_mass)


def reduced_web_mass(*, web_mass: Real, center_of_mass: Real, crank_radius: Real) -> Real:
    """Mass at the crank radius with the web's centrifugal force: m_cw R_1 / r.

    Exact.
    Source: S1 Eq. 10, 11; the last term of S0-F21.
    Misprint: S0 writes m_khred x_r/r: "red" and x_r/r together would reduce twice.
    Arguments: web_mass m_cw [kg]; center_of_mass R_1, from the crank axis [m]; crank_radius r [m].
    Returns: [kg].

    >>> reduced_web_mass(web_mass=2.0, center_of_mass=0.025, crank_radius=0.05)
    1.0
    """
    return web_mass * center_of_mass / crank_radius


def reduced_crank_mass(
    *, crank_pin_mass: Real, web_mass: Real, center_of_mass: Real, crank_radius: Real
) -> Real:
    """Throw as one mass at the crank radius: m_cr = m_cp + 2 m_cw R_1 / r, with two equal webs.

    Exact.
    Source: S1 Eq. 12.
    Misprint: its middle form has a factor R too many, 2 (m_cw)_R R.
    Arguments: crank_pin_mass m_cp [kg]; web_mass m_cw of one web [kg]; center_of_mass R_1 of a
        web, from the crank axis [m]; crank_radius r [m].
    Returns: [kg].

    >>> reduced_crank_mass(
    ...     crank_pin_mass=0.6, web_mass=2.0, center_of_mass=0.025, crank_radius=0.05
    ... )
    2.6
    """
    return crank_pin_mass + 2.0 * reduced_web_mass(
        web_mass=web_mass, center_of_mass=center_of_mass, crank_radius=crank_radius
    )


def reciprocating_mass(*, piston_mass: Real, rod_piston_pin_mass: Real) -> Real:
    """Mass that moves with the piston: m_A = m_p + m_op, rings and pin counted with the piston.

    Exact for the two-mass rod.
    Source: S0-F15, S0-F23, S1 Eq. 15 = 21 (its m_1).
    Arguments: piston_mass m_p [kg]; rod_piston_pin_mass m_op [kg].
    Returns: [kg].

    >>> reciprocating_mass(piston_mass=1.25, rod_piston_pin_mass=0.25)
    1.5
    """
    return piston_mass + rod_piston_pin_mass


def rotating_mass(*, crank_mass: Real, rod_crank_pin_mass: Real) -> Real:
    """Mass that turns at the crank radius: m_B = m_cr + m_or.

    Exact for the two-mass rod.
    Source: S0-F15, S0-F21, S1 Eq. 16 = 23 (its m_R).
    Misprint: S0-F15 prints "Mace - mp" for "Mass - m_B".
    Arguments: crank_mass m_cr, reduced to the crank radius [kg]; rod_crank_pin_mass m_or [kg].
    Returns: [kg].

    >>> rotating_mass(crank_mass=1.5, rod_crank_pin_mass=1.25)
    2.75
    """
    return crank_mass + rod_crank_pin_mass


def design_mass(*, specific_mass: Real, piston_area: Real) -> Real:
    """Design mass of piston or rod from its mass per piston area: m = m'' A_p.

    A statistical estimate; `SPECIFIC_MASSES` has the ranges.
    Source: S1 Eq. 17, 18, Table 3 (which the text also calls "Table").
    Arguments: specific_mass m'' [kg/m^2]; piston_area A_p [m^2].
    Returns: [kg].

    >>> f"{design_mass(specific_mass=200.0, piston_area=57.079e-4):.5f}"
    '1.14158'
    """
    return specific_mass * piston_area
