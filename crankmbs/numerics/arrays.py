"""The arrays of this package: double precision, numbers of rows, and what goes with them."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

__all__ = ["Array", "Index", "Labelled"]

Array = NDArray[np.float64]
Index = NDArray[np.intp]
Labelled = dict[str, tuple[tuple[str, ...], NDArray[Any], dict[str, Any]]]
"""Variables by name, as xarray takes them: dimensions, values and attributes. xarray itself takes
longer to be imported than a run."""
