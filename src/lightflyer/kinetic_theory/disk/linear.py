"""Linear problem: two faces of any TAC and temperature, split into even and odd fields."""

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from scipy.linalg import lu_factor, lu_solve
from scipy.sparse.linalg import LinearOperator, gmres

from lightflyer.core.errors import ConvergenceError
from lightflyer.kinetic_theory.disk.operators import Operators
from lightflyer.kinetic_theory.model_gases import GasModel
from lightflyer.kinetic_theory.walls import Wall

_SQRT_PI = np.sqrt(np.pi)
_TOLERANCE = 1e-9
_MOST_ITERATIONS = 200


@dataclass(frozen=True)
class FaceWalls:
    """The two faces, in pairs top, bottom; temperatures and velocity are perturbations."""

    # TACs are those of the solid part; the share ``open_fraction`` of the molecules that arrive at
    # a face passes the disk.

    tac: tuple[float, float]
    temperature: tuple[float, float]
    velocity: float = 0.0
    open_fraction: float = 0.0

    @property
    def solid(self) -> float:
        """Share of the molecules arriving at a face that meet it."""
        return 1.0 - self.open_fraction


class FieldEquations:
    """Matrices between the fields of a gas on a mesh."""

    def __init__(self, operators: Operators, gas: GasModel) -> None:
        self.operators, self.gas = operators, gas
        self.n = operators.mesh.size
        self.fields = 9 if gas.has_rotation else 6
        self.size = self.n * self.fields

    def _sources(self) -> tuple[np.ndarray, np.ndarray]:
        """Matrices from a node's fields to the six translational and three rotational sources."""
        return source_matrices(self.gas, self.fields)

    def _matrix(self, rows: np.ndarray) -> np.ndarray:
        """Rows (n, n, 6 sources, 6 moments) as a matrix between fields."""
        translation, rotation = self._sources()
        matrix = np.empty((self.n, self.fields, self.n, self.fields))
        matrix[:, :6] = np.einsum("ijsm,sf->imjf", rows, translation, optimize=True)
        if self.gas.has_rotation:
            # rotation moves as density and velocity do
            part = turning_rows(rows, self.operators.theta, self.operators.theta)
            matrix[:, 6:] = np.einsum("ijsm,sf->imjf", part, rotation, optimize=True)
        return matrix.reshape(self.size, self.size)

    def arriving_fluxes(self, fields: np.ndarray) -> np.ndarray:
        """Fluxes that arrive at the nodes of a face, shape (e, 3 or 4)."""
        # They are number, momentum, energy and, with rotation, rotational energy.
        translation, rotation = self._sources()
        fluxes = self.operators.fluxes
        arriving = np.einsum("ejsk,sf,jf->ek", fluxes, translation, fields, optimize=True)
        if self.gas.has_rotation:
            turning = np.einsum(
                "ejs,sf,jf->e", fluxes[:, :, :3, 0], rotation, fields, optimize=True
            )
            arriving = np.concatenate([arriving, turning[:, None]], axis=1)
        return arriving


class LinearSystem(FieldEquations):
    r"""Linear problem on a mesh for a gas, factorised for one disk and solved for any."""

    # A disk with holes lets a share of the molecules pass to its other side. To even fields that is
    # specular reflection, to odd ones the opposite of it. What else a wall does to arriving
    # molecules than reflect them is :math:`X_0 + \alpha X_1`.

    def __init__(
        self,
        operators: Operators,
        gas: GasModel,
        mean_tac: float,
        open_fraction: float = 0.0,
        wall: Wall = "maxwell",
    ) -> None:
        super().__init__(operators, gas)
        self.wall = wall
        self.mean_tac, self.open_fraction = mean_tac, open_fraction
        self.accommodated = (1.0 - open_fraction) * mean_tac
        same, other = operators.own + operators.reflected, operators.other
        even = self._matrix(same + other)
        odd = self._matrix(same - other - 2.0 * open_fraction * operators.reflected)
        # X₁ of a wall, and X₀ if any. Maxwell's X₁ replaces specular by diffuse reflection. Where
        # all molecules are accommodated, X₀ replaces it by a diffuse one that keeps number and
        # energy, and X₁ takes the energy away.
        theta, (translation, rotation) = operators.face_theta, self._sources()
        sigma = 2.0 * _SQRT_PI / np.sqrt(theta) * operators.fluxes[..., 0]
        matrix = self._matrix(-operators.reflected.reshape(self.n, self.n, 6, 6))
        matrix = matrix.reshape(self.n, self.fields, self.n, self.fields)
        # diffuse reflection has the gas's temperature
        matrix[:, :6] += np.einsum(
            "iem,ejs,sf->imjf", operators.sigma, sigma, translation, optimize=True
        )
        self.exchange, self.unreflected = matrix.reshape(self.size, self.size), None
        if wall != "maxwell":
            # temperature of the molecules that arrive at the face, by fields, shape (e, n, fields)
            fluxes = operators.fluxes[..., 2] - 2.0 * theta * operators.fluxes[..., 0]
            arriving = fluxes @ translation
            if gas.has_rotation:
                turning = operators.fluxes[..., :3, 0].copy()
                turning[..., 1:] *= operators.theta[:, None]
                arriving += turning @ rotation
            arriving = 2.0 * _SQRT_PI * np.sqrt(theta) / self._energy_modes * arriving
            energy = np.einsum("iem,ejf->imjf", self._warmth, arriving, optimize=True)
            energy = energy.reshape(self.size, self.size)
            self.unreflected, self.exchange = self.exchange + energy, -energy
        met = self.accommodated * self.exchange
        if self.unreflected is not None:
            met += (1.0 - open_fraction) * self.unreflected
        unit = np.eye(self.size)
        self.factors = tuple(
            lu_factor(unit - matrix - met, check_finite=False) for matrix in (even, odd)
        )

    @cached_property
    def _beyond(self) -> np.ndarray:
        """Fields seen beyond the disk, mirrored."""
        return self._matrix(self.operators.reflected)

    @cached_property
    def _warmth(self) -> np.ndarray:
        """Emission of a unit temperature at each node of a face, shape (n, e, fields)."""
        operators = self.operators
        if not self.gas.has_rotation:
            return operators.temperature
        theta = operators.theta[:, None]
        turning = operators.sigma[..., :3].copy()
        turning[..., 0] -= operators.sigma[..., 3] / theta
        turning[..., 1:] /= theta[..., None]
        return np.concatenate([operators.temperature, turning / operators.face_theta], axis=2)

    @property
    def _energy_modes(self) -> float:
        """Energy per arriving molecule [kT]."""
        return 3.0 if self.gas.has_rotation else 2.0

    def emitted_temperature(
        self, tac: float, temperature: float, velocity: float, arriving: np.ndarray
    ) -> np.ndarray:
        """Temperature at which molecules leave a face diffusely, shape (e,)."""
        if self.wall == "maxwell":
            return np.full(arriving.shape[0], temperature)
        # what a face runs into arrives with more energy: 5/4 of its velocity, less that of the
        # molecules that are more, 2 · 1/2
        energy = arriving[:, 2:].sum(axis=1) - 2.0 * arriving[:, 0] + 0.25 * velocity
        return tac * temperature + (1.0 - tac) * 2.0 * _SQRT_PI / self._energy_modes * energy

    def diffuse_share(self, tac: float) -> float:
        """Share of the molecules meeting a face that leaves it diffusely [1]."""
        return tac if self.wall == "maxwell" else 1.0

    def solve(self, walls: FaceWalls) -> tuple[np.ndarray, int]:
        """Fields of the upper and the mirrored lower half; returns ``fields``, ``iterations``."""
        top, bottom = walls.tac
        mean, half = 0.5 * (top + bottom), 0.5 * walls.solid * (top - bottom)
        shift = walls.solid * mean - self.accommodated
        opened = walls.open_fraction - self.open_fraction
        operators, emission = self.operators, []  # of each face, by temperature and velocity
        for tac, temperature, velocity in zip(
            walls.tac, walls.temperature, (walls.velocity, -walls.velocity), strict=True
        ):
            diffuse, nothing = self.diffuse_share(tac), np.zeros((operators.sigma.shape[1], 4))
            leaving = self.emitted_temperature(tac, temperature, velocity, nothing)
            emitted = diffuse * np.einsum("ief,e->if", self._warmth, leaving)
            emitted[:, :6] += (4.0 - 2.0 * diffuse) * velocity * operators.velocity
            emitted[:, :6] += diffuse * _SQRT_PI * velocity * operators.sigma.sum(axis=1)
            emission.append(walls.solid * emitted.ravel())
        even = 0.5 * (emission[0] + emission[1])
        odd = 0.5 * (emission[0] - emission[1])

        def precondition(pair: np.ndarray) -> np.ndarray:
            parts = pair.reshape(2, -1)
            return np.concatenate(
                [
                    lu_solve(factor, part, check_finite=False)
                    for factor, part in zip(self.factors, parts, strict=True)
                ]
            )

        def apply(pair: np.ndarray) -> np.ndarray:
            # the factorised part gives back the pair itself
            e, o = pair.reshape(2, -1)
            changed = self.exchange @ np.stack([shift * e + half * o, shift * o + half * e], 1)
            if opened != 0.0:
                changed[:, 1] -= 2.0 * opened * (self._beyond @ o)
                if self.unreflected is not None:
                    changed -= opened * (self.unreflected @ np.stack([e, o], 1))
            return pair - precondition(changed.T.ravel())

        start = precondition(np.concatenate([even, odd]))
        if shift == half == opened == 0.0:
            solution, iterations = start, 1
        else:
            solution, iterations = solve_by_gmres(apply, start)
        e, o = solution.reshape(2, self.n, self.fields)
        return np.stack([e + o, e - o]), iterations

    def uniform_correction(self, fields: np.ndarray) -> np.ndarray:
        """Correction of given fields by which uniform ones are exact, shape (n, fields)."""
        return correct_uniform(self.operators.corrections, self.gas, fields)


def turning_rows(rows: np.ndarray, theta: np.ndarray, source_theta: np.ndarray) -> np.ndarray:
    """Rows between rotational energy and its flux: those of density and velocity."""
    if rows.shape[-1] == 6:
        part = rows[:, :, :3, :3].copy()
        part[..., 0] -= rows[:, :, :3, 3] / theta[:, None, None]
        part[..., 1:] /= theta[:, None, None, None]
    else:
        part = rows[:, :, :3, :1].copy()
    part[:, :, 1:] *= source_theta[None, :, None, None]
    return part


def source_matrices(gas: GasModel, fields: int) -> tuple[np.ndarray, np.ndarray]:
    """Matrices from a node's fields to the six translational and three rotational sources."""
    mix = np.zeros((9, fields))
    heat = 0.8 * (1.0 - gas.translational_rate)
    for source, factor in enumerate((1.0, 2.0, 2.0, 1.0, heat, heat)):
        mix[source, source] = factor
    if gas.has_rotation:
        # total temperature is 3/5 translational and 2/5 rotational
        mix[0, 3], mix[0, 6] = -0.4 * gas.exchange_rate, 0.4 * gas.exchange_rate
        mix[3, 3], mix[3, 6] = 1.0 - 0.4 * gas.exchange_rate, 0.4 * gas.exchange_rate
        mix[6, 6], mix[6, 3] = 1.0 - 0.6 * gas.exchange_rate, 0.6 * gas.exchange_rate
        mix[7, 7] = mix[8, 8] = 2.0 * (1.0 - gas.rotational_rate)
    return mix[:6], mix[6:]


def correct_uniform(corrections: np.ndarray, gas: GasModel, fields: np.ndarray) -> np.ndarray:
    """Correction of given fields by which uniform ones are exact, shape (n, fields)."""
    # ``corrections``, shape (n, 6, 6), are those of a gas of one temperature.
    translation, rotation = source_matrices(gas, fields.shape[1])
    moments = np.einsum("nsm,sf,nf->nm", corrections, translation, fields, optimize=True)
    if gas.has_rotation:
        part = corrections[:, :3, :3].copy()
        part[..., 0] -= corrections[:, :3, 3]
        turning = np.einsum("nsm,sf,nf->nm", part, rotation, fields, optimize=True)
        moments = np.concatenate([moments, turning], axis=1)
    return moments


def solve_by_gmres(
    apply: Callable[[np.ndarray], np.ndarray], right: np.ndarray, tolerance: float = _TOLERANCE
) -> tuple[np.ndarray, int]:
    """Solution of a linear system given by its action, and the number of iterations."""
    residuals: list[float] = []
    operator = LinearOperator((right.size, right.size), matvec=apply, dtype=float)
    solution, info = gmres(
        operator,
        right,
        rtol=tolerance,
        restart=_MOST_ITERATIONS,
        maxiter=1,
        callback=residuals.append,
        callback_type="pr_norm",
    )
    if info != 0:
        raise ConvergenceError(
            f"the kinetic equation did not converge in {_MOST_ITERATIONS} iterations: "
            f"last residual {residuals[-1]:.1e}"
        )
    return solution, max(1, len(residuals))


@dataclass(frozen=True)
class FaceResult:
    """Normal pressure on a face [p₀] and heat flux out of it [p₀√(2RT₀)], at its nodes."""

    # They are over the whole area, holes included.

    pressure: np.ndarray
    heat: np.ndarray


def face_result(
    system: LinearSystem, walls: FaceWalls, fields: np.ndarray, face: int
) -> FaceResult:
    """Normal pressure on a face and heat flux out of it; ``fields`` (n, fields)."""
    return result_of_arriving(system, walls, system.arriving_fluxes(fields), face)


def result_of_arriving(
    system: LinearSystem, walls: FaceWalls, arriving: np.ndarray, face: int
) -> FaceResult:
    """Normal pressure and heat flux, as :func:`face_result`, from fluxes that arrive at a face."""
    tac, diffuse = walls.tac[face], system.diffuse_share(walls.tac[face])
    velocity = walls.velocity * (1.0 if face == 0 else -1.0)
    number, momentum, energy = arriving[:, 0], arriving[:, 1], arriving[:, 2]
    temperature = system.emitted_temperature(tac, walls.temperature[face], velocity, arriving)
    sigma = 2.0 * _SQRT_PI * number + _SQRT_PI * velocity
    moved = (4.0 - 2.0 * diffuse) * velocity
    emitted = diffuse * (sigma / 4.0 + temperature / 8.0) + moved / (2.0 * _SQRT_PI)
    pressure = emitted + (2.0 - diffuse) * momentum
    heat = diffuse * ((sigma + temperature) / _SQRT_PI - energy) + 0.625 * moved - 2.5 * velocity
    if system.gas.has_rotation:
        heat = heat + diffuse * (temperature / (2.0 * _SQRT_PI) - arriving[:, 3])
    return FaceResult(2.0 * walls.solid * pressure, walls.solid * heat)
