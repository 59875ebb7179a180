"""The generalized-alpha method as exudyn has it, and the start from which it does not ring.

M. Arnold and O. Brüls (2007), "Convergence of the generalized-alpha scheme for constrained
mechanical systems", Multibody System Dynamics 18, 185-202.
"""

from __future__ import annotations

from typing import Any

import exudyn

from crankmbs.numerics.arrays import Array

__all__ = ["SPECTRAL_RADIUS", "quiet_shifts", "settings_of"]

exu: Any = exudyn  # its stubs are narrower than what it takes

SPECTRAL_RADIUS = 0.9  # cleanly of order 2, so that extrapolation pays; 0.6 is not
_ALPHA_M = (2.0 * SPECTRAL_RADIUS - 1.0) / (SPECTRAL_RADIUS + 1.0)
_ALPHA_F = SPECTRAL_RADIUS / (SPECTRAL_RADIUS + 1.0)
_GAMMA = 0.5 + _ALPHA_F - _ALPHA_M
_BETA = 0.25 * (_GAMMA + 0.5) ** 2


def settings_of(step: float, most: int = 1, *, stiff: bool = False) -> Any:
    """The generalized-alpha method, index 3, at equal steps [s]: halving them divides the error by
    four."""
    settings = exu.SimulationSettings()
    integration = settings.timeIntegration
    integration.numberOfSteps = most
    integration.endTime = most * step
    integration.adaptiveStep = False  # it may succeed with nonsense near a singular position
    integration.verboseMode = 0
    integration.generalizedAlpha.spectralRadius = SPECTRAL_RADIUS
    integration.generalizedAlpha.computeInitialAccelerations = False
    integration.generalizedAlpha.resetAccelerations = False
    integration.newton.useModifiedNewton = True
    integration.newton.modifiedNewtonJacUpdatePerStep = True  # a third less time than full Newton
    integration.computeLoadsJacobian = 2 if stiff else 0
    settings.solution.file.write = False
    settings.linearSolver.solverType = exu.LinearSolverType.EXUdense
    return settings


def quiet_shifts(jerk: Array, step: float) -> tuple[Array, Array, Array, Array]:
    """What the method's own smooth velocity is off by, and what to add to position, velocity and
    acceleration at the start so that its multipliers do not ring.

    With the jerk j the method's own smooth solution has, to the order of h^2, the velocity
    v - (1/12 + (alpha_f - alpha_m)^2 / 4) h^2 j and the algorithmic acceleration
    a + (alpha_m - alpha_f) h j. exudyn takes one acceleration for both; shifts of position and
    velocity make up for that in the first step.
    """
    late = _ALPHA_F * step * jerk
    shifted = -(step**2) * (1.0 / 12.0 + 0.25 * (_ALPHA_F - _ALPHA_M) ** 2) * jerk
    position = step**2 * (0.5 - _GAMMA + _BETA) * late
    return shifted, position, shifted - step * (1.0 - _GAMMA) * late, _ALPHA_M * step * jerk
