"""Names for the arrays that the whole package passes around."""

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
"""Floating-point numbers; docstrings give shapes and units."""

Mask = NDArray[np.bool_]
"""One truth value for each sample, simulation or column."""
