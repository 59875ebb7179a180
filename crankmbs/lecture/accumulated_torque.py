"""Torque accumulated along a crank: what each main journal and each crank pin has to carry."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from crankmbs.errors import InputError
from crankmbs.numerics.arrays import Array

__all__ = ["AccumulatedTorque", "accumulated_torque"]


class AccumulatedTorque(NamedTuple):
    """journals : shape (..., cylinders + 1) [N m]; pins : shape (..., cylinders) [N m]."""

    journals: Array
    pins: Array


def accumulated_torque(crank_torque: ArrayLike) -> AccumulatedTorque:
    """Add the throws' torques up from the free end of the crank, cylinder 1, to the flywheel.

    journal_k = T_1 + ... + T_(k-1),  pin_k = journal_k + T_k / 2

    The first journal carries nothing and the last one all; a pin carries the journal before it and
    half of its own throw. Exact for a massless crank or a constant speed: what accelerates the
    crank's inertia is not taken off on the way.

    Parameters
    ----------
    crank_torque : shape (..., cylinders) [N m], as in a result: moment of each rod's force about
        the crank axis, cylinders in the order in which they stand

    Raises
    ------
    InputError : no cylinder

    Source: M. M. Yi, S. Y. Win, T. T. Htay, Kinematic Analysis of Crank Shaft for Diesel Engine,
    Figures 4 and 5.

    >>> accumulated_torque([2.0, -1.0]).pins.tolist()
    [1.0, 1.5]
    """
    torque = np.asarray(crank_torque, dtype=np.float64)
    if torque.ndim == 0 or torque.shape[-1] == 0:
        raise InputError("crank_torque needs a last axis of one or more cylinders; none came")
    journals = np.cumsum(torque, axis=-1)
    journals = np.concatenate([np.zeros_like(journals[..., :1]), journals], axis=-1)
    return AccumulatedTorque(journals, journals[..., :-1] + 0.5 * torque)
