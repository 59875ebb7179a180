"""An order is claimed only where the last two local slopes agree and the errors are no rounding."""

import numpy as np
import pytest

from validation.checks.multibody_order import order_of

pytestmark = pytest.mark.slow


def errors(*slopes, first=1e-3):
    found = [first]
    for slope in slopes:
        found.append(found[-1] / 2.0**slope)
    return found


@pytest.mark.parametrize(
    ("slopes", "first", "order"),
    [
        ((2.0, 2.0, 2.0), 1e-3, 2.0),
        ((0.3, 1.9, 2.0), 1e-3, 1.95),
        ((2.0, 1.0, 1.0), 1e-3, 1.0),
        ((2.0, 2.0, 1.7), 1e-3, None),
        ((2.0, 2.0), 1e-11, None),
        ((2.0,), 1e-3, None),
    ],
)
def test_order_of_errors(slopes, first, order):
    found = order_of(np.array(errors(*slopes, first=first)))
    assert found == (order if order is None else pytest.approx(order))
