"""The arrays of this package: double precision, and numbers of rows."""

import numpy as np
from numpy.typing import NDArray

__all__ = ["Array", "Index"]

Array = NDArray[np.float64]
Index = NDArray[np.intp]
