"""A medium that is the same in all light."""

import numpy as np

from lightflyer.film import tabulated_material


def flat(n, k=0.0, density=1000.0, name=None):
    """A material whose n and k are the same at all wavelengths."""
    ends = np.array([1e-8, 4e-3])
    indices = np.full(2, n), np.full(2, k)
    return tabulated_material(name or f"flat {n} {k}", ends, *indices, density=density)
