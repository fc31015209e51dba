"""The array type of the package."""

import numpy as np

Array = np.ndarray
"""A NumPy array, of float64 unless the docstring says otherwise; shapes are stated where it is used."""
