"""Non-linear problem: two hot faces, solved by preconditioned Anderson acceleration.

The preconditioner contains all that is stiff, so that the number of steps hardly depends on the
Knudsen number. In thin gas it is the linear problem's factors, in dense gas those of the equation
linearised about the temperatures of the hot gas.
"""

from dataclasses import dataclass

import numpy as np
from scipy.linalg import lu_solve

from lightflyer.foundation.errors import ConvergenceError
from lightflyer.foundation.progress import report
from lightflyer.kinetic import nonlinear_kernel
from lightflyer.kinetic.linear import FaceResult, LinearSystem
from lightflyer.kinetic.operators import (
    BaseState,
    Quadrature,
    assemble,
    face_points,
    kernel_arguments,
    node_points,
)

_SQRT_PI = np.sqrt(np.pi)
_MOST_ITERATIONS = 60
_MEMORY = 12
_RENEWED = 0.03  # residual below which the preconditioner is renewed, once
_THIN_GAS = 1.0  # δ up to which the linear problem's factors precondition as well


@dataclass(frozen=True)
class HotDisk:
    """Two faces, top and bottom: TAC and temperature over the gas's far away.

    Of the molecules that arrive at a face, the share ``open_fraction`` passes the disk.
    """

    tac: tuple[float, float]
    temperature: tuple[float, float]
    open_fraction: float = 0.0


class NonlinearProblem:
    """Non-linear problem on the mesh of a linear system.

    Parameters
    ----------
    system : LinearSystem
        Its factors precondition the iteration in thin gas.
    rarefaction : float
        δ of the gas far away.
    quadrature : Quadrature
        Quadrature with which the system was assembled.
    """

    def __init__(self, system: LinearSystem, rarefaction: float, quadrature: Quadrature) -> None:
        self.system, self.rarefaction = system, rarefaction
        gas, mesh = system.gas, system.operators.mesh
        setup, panels = kernel_arguments(mesh, rarefaction, quadrature)
        self.arguments = (rarefaction, setup, panels)
        self.quadrature = quadrature
        self.gas = (
            0.8 * (1.0 - gas.translational_rate),
            2.0 * (1.0 - gas.rotational_rate),
            gas.exchange_rate,
            -gas.viscosity_exponent,
            gas.has_rotation,
        )
        self.nodes, self.faces = node_points(mesh), face_points(mesh)
        self.factors = system.factors

    def _half(self, fields: np.ndarray, face: int, sigma: np.ndarray, disk: HotDisk) -> tuple:
        solid, tac = 1.0 - disk.open_fraction, float(disk.tac[face])
        return (
            fields[face],
            fields[1 - face],
            sigma,
            np.array([solid * tac, solid * (1.0 - tac), disk.open_fraction]),
            float(disk.temperature[face]),
        )

    def arriving(self, fields: np.ndarray, face: int, disk: HotDisk) -> np.ndarray:
        """Fluxes that arrive at a face, less those of the gas at rest, shape (e, 4)."""
        fluxes = np.empty((self.faces.shape[0], 4))
        half = self._half(fields, face, np.ones(self.faces.shape[0]), disk)
        nonlinear_kernel.evaluate(self.faces, True, *self.arguments, self.gas, half, fluxes)
        return fluxes

    def evaluate(self, fields: np.ndarray, disk: HotDisk) -> np.ndarray:
        """Fields that follow from given fields, shape (2, n, fields)."""
        result = np.empty_like(fields)
        for face in (0, 1):
            sigma = _emitted_density(self.arriving(fields, face, disk), disk.temperature[face])
            half = self._half(fields, face, sigma, disk)
            nonlinear_kernel.evaluate(
                self.nodes, False, *self.arguments, self.gas, half, result[face]
            )
            result[face] += self.system.corrected(fields[face])
        return result

    def precondition_about(self, fields: np.ndarray, disk: HotDisk) -> None:
        """Precondition by the equation linearised about the temperatures of given fields."""
        operators = self.system.operators
        gas = self.system.gas
        base = BaseState(
            excess=0.5 * (fields[0, :, 3] + fields[1, :, 3]),
            face=0.5 * sum(disk.temperature),
            frequency_exponent=-1.0 - gas.viscosity_exponent,
        )
        about = assemble(operators.mesh, self.rarefaction, self.quadrature, base)
        diagonal = np.arange(operators.mesh.size)
        about.own[diagonal, diagonal] += operators.corrections
        system = LinearSystem(about, gas, self.system.mean_tac, disk.open_fraction)
        self.factors = system.factors

    def solve(
        self,
        disk: HotDisk,
        start: np.ndarray,
        tolerance: float,
    ) -> tuple[np.ndarray, int]:
        """Iterate to a fixed point.

        Parameters
        ----------
        disk : HotDisk
        start : array, shape (2, n, fields)
        tolerance : float
            Largest preconditioned residual of a field.

        Returns
        -------
        fields : array, shape (2, n, fields)
        iterations : int

        Raises
        ------
        ConvergenceError
            If the iteration diverges or does not converge; the message has the last residual.
        """
        is_dense, renewed = self.rarefaction > _THIN_GAS, False
        if is_dense:
            self.precondition_about(start, disk)
        fields = start
        steps: list[np.ndarray] = []
        states: list[np.ndarray] = []
        residual = np.inf
        for iteration in range(1, _MOST_ITERATIONS + 1):
            missing = self.evaluate(fields, disk) - fields
            step = self._precondition(missing)
            residual = float(np.abs(step).max())
            report(f"solving the non-linear equation, residual {residual:.1e}")
            if residual < tolerance:
                return fields + step, iteration
            if not np.isfinite(residual):
                raise ConvergenceError("the non-linear kinetic equation diverged")
            if is_dense and not renewed and residual < _RENEWED:
                # the temperatures are now accurate enough to precondition about
                renewed = True
                self.precondition_about(fields, disk)
                step, steps, states = self._precondition(missing), [], []
            steps.append(step.ravel())
            states.append(fields.ravel())
            del steps[:-_MEMORY], states[:-_MEMORY]
            fields = _damped(fields, _anderson(states, steps).reshape(fields.shape))
        raise ConvergenceError(
            f"the non-linear kinetic equation did not converge in {_MOST_ITERATIONS} iterations: "
            f"last residual {residual:.1e}"
        )

    def _precondition(self, residual: np.ndarray) -> np.ndarray:
        parts = 0.5 * (residual[0] + residual[1]), 0.5 * (residual[0] - residual[1])
        even, odd = (
            lu_solve(factor, part.ravel(), check_finite=False).reshape(part.shape)
            for factor, part in zip(self.factors, parts, strict=True)
        )
        return np.stack([even + odd, even - odd])

    def face_result(self, fields: np.ndarray, face: int, disk: HotDisk) -> FaceResult:
        """Normal pressure on a face and heat flux out of it, less those of the gas at rest."""
        tac, temperature = disk.tac[face], disk.temperature[face]
        arriving = self.arriving(fields, face, disk)
        sigma = _emitted_density(arriving, temperature)
        pressure = tac * (sigma * temperature - 1.0) / 4.0 + (2.0 - tac) * arriving[:, 1]
        emitted = (sigma * temperature**1.5 - 1.0) / _SQRT_PI
        heat = tac * (emitted - arriving[:, 2])
        if self.system.gas.has_rotation:
            heat = heat + tac * (0.5 * emitted - arriving[:, 3])
        solid = 1.0 - disk.open_fraction
        return FaceResult(2.0 * solid * pressure, solid * heat)


def _damped(old: np.ndarray, new: np.ndarray) -> np.ndarray:
    """Fields on the way to new ones, where pressure and temperature at most halve."""
    share = 1.0
    for field in (0, 3):
        value, change = 1.0 + old[..., field], new[..., field] - old[..., field]
        share = min(share, 0.5 / max(0.5, float((-change / value).max())))
    return old + share * (new - old)


def _emitted_density(arriving: np.ndarray, temperature: float) -> np.ndarray:
    """σ of a face that emits as many molecules as arrive, shape (e,)."""
    return (1.0 + 2.0 * _SQRT_PI * arriving[:, 0]) / np.sqrt(temperature)


def _anderson(states: list[np.ndarray], steps: list[np.ndarray]) -> np.ndarray:
    """Next state by Anderson mixing of the last states and their steps."""
    if len(steps) == 1:
        return states[-1] + steps[-1]
    differences = np.stack([steps[-1] - step for step in steps[:-1]], axis=1)
    weights = np.linalg.lstsq(differences, steps[-1], rcond=1e-12)[0]
    state, step = states[-1].copy(), steps[-1].copy()
    for k, weight in enumerate(weights):
        state -= weight * (states[-1] - states[k])
        step -= weight * (steps[-1] - steps[k])
    return state + step
