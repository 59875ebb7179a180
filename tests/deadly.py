"""Loads in Python that the workers of a sweep can import."""

import os


def braking(t, theta, omega):
    return -7.775e-4 * omega * abs(omega)


def deadly(t, theta, omega):
    """Ends the process that computes it where the crank turns fast."""
    if omega > 90.0:
        os._exit(9)
    return 0.0


def failing(t, theta, omega):
    raise ZeroDivisionError("on purpose")
