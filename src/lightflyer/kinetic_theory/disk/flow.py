"""Fields of a solution at arbitrary points."""

from typing import Any

import numpy as np

from lightflyer.kinetic_theory.disk.cases import COARSE, Outcome
from lightflyer.kinetic_theory.disk.operators import kernel_arguments
from lightflyer.kinetic_theory.grid.interpolation import bases_at, interpolate, nodes_in_eta
from lightflyer.kinetic_theory.grid.kernels import kernel
from lightflyer.kinetic_theory.grid.mesh import Mesh
from lightflyer.kinetic_theory.grid.rays import spheroidal

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
def _sample(points, halves, upper, lower, values):
    order, eta_size = upper[3].shape[2], nodes_in_eta(upper)
    xi_basis, eta_basis = np.empty(order), np.empty(order)
    for p in range(points.shape[0]):
        xi, eta = spheroidal(points[p, 0] ** 2, points[p, 1])
        mesh, fields = (upper, halves[0]) if points[p, 1] >= 0.0 else (lower, halves[1])
        i, j = bases_at(max(xi, 1e-12), eta, mesh, xi_basis, eta_basis)
        interpolate(fields, i, j, eta_size, xi_basis, eta_basis, values[p])
        scale = np.sqrt(max(0.0, 1.0 - eta * eta))
        values[p, 1] *= scale
        values[p, 4] *= scale
        if points[p, 1] < 0.0:  # the lower half is kept mirrored
            values[p, 2] *= -1.0
            values[p, 5] *= -1.0


def sample(outcome: Outcome, radius: Any, height: Any) -> dict[str, np.ndarray]:
    """Fields at points, by the solver's own interpolation; ``radius``, ``height`` [disk radii]."""
    meshes = outcome.mesh, outcome.mesh
    return sample_halves(meshes, outcome.fields, np.asarray(radius), np.asarray(height))


def sample_halves(
    meshes: tuple[Mesh, Mesh], halves: np.ndarray, radius: np.ndarray, height: np.ndarray
) -> dict[str, np.ndarray]:
    """Fields at points in halves that need not be alike; ``halves`` (2, n, 6 or 9)."""
    radius, height = np.broadcast_arrays(radius, height)
    points = np.stack([radius.ravel(), height.ravel()], axis=1)
    upper, lower = (kernel_arguments(mesh, 1.0, COARSE.quadrature)[1] for mesh in meshes)
    values = np.empty((points.shape[0], halves.shape[-1]))
    _sample(points, halves, upper, lower, values)
    beyond = (radius > meshes[0].boundary) | (height > meshes[0].ceiling)
    beyond |= height < -meshes[1].ceiling
    values[beyond.ravel()] = np.nan
    names = _NAMES[: 7 if values.shape[1] > 6 else 6]
    return {name: values[:, k].reshape(radius.shape) for k, name in enumerate(names)}
