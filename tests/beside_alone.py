"""Cases solved together, held against the same scenes alone."""

import numpy as np

from crankmbs import simulate
from crankmbs.sweep.columns import row_of


def by_hand(scene):
    """The columns of a scene alone, finely sampled, and how it ends."""
    result = simulate(scene.with_(run__every="0.25 deg"), rtol=1e-12)
    return row_of(result, None), result.message


def assert_agree(rows, number, alone, least=0.0):
    """Every column within the errors of both, and those that are nothing but rounding."""
    for name, values in alone.items():
        found = rows.columns[name][number]
        assert found.shape == values.shape, name
        assert (np.isnan(found) == np.isnan(values)).all(), name
        if f"{name}_error" in alone:
            both = alone[f"{name}_error"] + rows.columns[f"{name}_error"][number]
            worst = np.nanmax(np.append(np.abs(found - values) - both, -1.0))
            assert worst <= least, (name, worst)
