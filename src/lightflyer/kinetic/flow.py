"""Fields of a solution at arbitrary points."""

from typing import Any

import numpy as np

from lightflyer.kinetic._kernels import kernel
from lightflyer.kinetic.cases import COARSE, Outcome
from lightflyer.kinetic.interpolation import bases_at, interpolate, nodes_in_eta
from lightflyer.kinetic.operators import kernel_arguments
from lightflyer.kinetic.rays import spheroidal

_NAMES = (
    "pressure",
    "velocity_radial",
    "velocity_axial",
    "temperature",
    "heat_flux_radial",
    "heat_flux_axial",
    "rotational_temperature",
)


@kernel
def _sample(points, halves, mesh, values):
    order, eta_size = mesh[3].shape[2], nodes_in_eta(mesh)
    xi_basis, eta_basis = np.empty(order), np.empty(order)
    for p in range(points.shape[0]):
        xi, eta = spheroidal(points[p, 0] ** 2, points[p, 1])
        i, j = bases_at(max(xi, 1e-12), eta, mesh, xi_basis, eta_basis)
        fields = halves[0] if points[p, 1] >= 0.0 else halves[1]
        interpolate(fields, i, j, eta_size, xi_basis, eta_basis, values[p])
        scale = np.sqrt(max(0.0, 1.0 - eta * eta))
        values[p, 1] *= scale
        values[p, 4] *= scale
        if points[p, 1] < 0.0:  # the lower half is kept mirrored
            values[p, 2] *= -1.0
            values[p, 5] *= -1.0


def sample(outcome: Outcome, radius: Any, height: Any) -> dict[str, np.ndarray]:
    """Fields at points, by the solver's own interpolation.

    Parameters
    ----------
    outcome : Outcome
    radius, height : array, shape (...)
        [disk radii].

    Returns
    -------
    dict of str to array, shape (...)
    """
    radius, height = np.broadcast_arrays(radius, height)
    points = np.stack([radius.ravel(), height.ravel()], axis=1)
    panels = kernel_arguments(outcome.mesh, 1.0, COARSE.quadrature)[1]
    values = np.empty((points.shape[0], outcome.fields.shape[-1]))
    _sample(points, outcome.fields, panels, values)
    names = _NAMES[: 7 if values.shape[1] > 6 else 6]
    return {name: values[:, k].reshape(radius.shape) for k, name in enumerate(names)}
