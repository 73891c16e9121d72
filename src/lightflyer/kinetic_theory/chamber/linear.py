r"""Linear problem of a disk between any floor, lid and side wall, in one system of equations.

Unlike in :mod:`lightflyer.kinetic_theory.disk.linear` the halves need not be alike, walls around
the gas may be solid, and the temperature of the film may follow from the heat balance of each of
its spots. The unknowns are, in this order: the fields of the upper and of the mirrored lower half;
for each half σ and emitted temperature at the nodes of the disk's face and of the walls; the
temperature of the film at the nodes of its top and bottom; the power that it absorbs; and the flux
by which the discretisation fails to conserve molecules in a closed chamber.
"""

from dataclasses import dataclass, field
from functools import cached_property

import numpy as np
from scipy.linalg import lu_factor, lu_solve

from lightflyer.kinetic_theory.chamber.enclosure import Chamber, Film, Surface
from lightflyer.kinetic_theory.chamber.half_mesh_operator import HalfOperator
from lightflyer.kinetic_theory.disk.linear import correct_uniform, source_matrices, turning_rows
from lightflyer.kinetic_theory.disk.operators import OperatorRows
from lightflyer.kinetic_theory.model_gases import GasModel

_SQRT_PI = np.sqrt(np.pi)
NUMBER, MOMENTUM, ENERGY, AXIAL, TURNING = range(5)
"""Fluxes that arrive at a wall; the last is that of rotational energy."""

# what arrives from a gas of unit density perturbation
_UNIFORM = np.array([0.5 / _SQRT_PI, 0.25, 1.0 / _SQRT_PI])


@dataclass(frozen=True)
class SystemLayout:
    """Places of the unknowns in their vector: n nodes, e of a face, w of a half's walls."""

    n: int
    fields: int
    e: int
    w: int

    def gas(self, half: int) -> slice:
        """Fields of a half, node by node."""
        size = self.n * self.fields
        return slice(half * size, (half + 1) * size)

    def _after_gas(self, half: int, first: int, size: int) -> slice:
        start = 2 * self.n * self.fields + half * 2 * (self.e + self.w) + first
        return slice(start, start + size)

    def sigma(self, half: int) -> slice:
        """σ of the disk's face."""
        return self._after_gas(half, 0, self.e)

    def face_temperature(self, half: int) -> slice:
        """Temperature at which the disk's face emits."""
        return self._after_gas(half, self.e, self.e)

    def wall_sigma(self, half: int) -> slice:
        return self._after_gas(half, 2 * self.e, self.w)

    def wall_temperature(self, half: int) -> slice:
        """Temperature at which the walls emit."""
        return self._after_gas(half, 2 * self.e + self.w, self.w)

    def film(self, half: int) -> slice:
        """Temperature of the film on the side of a half."""
        return self._after_gas(2, half * self.e, self.e)

    @property
    def power(self) -> int:
        """Power that the film absorbs, per unit area."""
        return self.film(1).stop

    @property
    def leak(self) -> int:
        """Flux of molecules by which a closed chamber fails to conserve them."""
        return self.power + 1

    @property
    def size(self) -> int:
        """Number of unknowns."""
        return self.leak + 1


class ChamberSystem:
    """Equations of a disk in a chamber, or in open space, for one film."""

    def __init__(
        self,
        halves: tuple[HalfOperator, HalfOperator],
        gas: GasModel,
        chamber: Chamber | None,
        film: Film,
        face_theta: float = 1.0,
    ) -> None:
        self.halves, self.gas, self.chamber, self.film = halves, gas, chamber, film
        self.face_theta = face_theta
        self.fields = 9 if gas.has_rotation else 6
        mesh = halves[0].mesh
        self.layout = SystemLayout(
            mesh.size, self.fields, mesh.eta.size, halves[0].walls.theta.size
        )
        self.weights = mesh.face_weights

    @property
    def is_linear(self) -> bool:
        """Whether the rows are about a gas of one temperature."""
        return all(bool(np.all(half.gas.theta == 1.0)) for half in self.halves)

    @property
    def energy_modes(self) -> float:
        """Energy per arriving molecule [kT]."""
        return 3.0 if self.gas.has_rotation else 2.0

    def surface_masks(self, half: int) -> list[tuple[str, Surface, np.ndarray]]:
        """Name of side wall and lid or floor of a half, with their nodes."""
        if self.chamber is None:
            return []
        flat = self.halves[half].rim.is_flat
        name, end = ("lid", self.chamber.lid) if half == 0 else ("floor", self.chamber.floor)
        return [("side", self.chamber.side, ~flat), (name, end, flat)]

    # ------------------------------------------------------------------ functionals

    def _functional(self, rows: OperatorRows, half: int, outputs: int) -> np.ndarray:
        """Rows as a matrix on all unknowns, shape (m, outputs, size)."""
        # The outputs of walls are their fluxes; those of the gas are its fields.
        layout, (translation, rotation) = self.layout, source_matrices(self.gas, self.fields)
        diffuse = self.film.diffuse_share(half)
        m, k = rows.velocity.shape
        matrix = np.zeros((m, outputs, layout.size))
        seen = rows.own + (1.0 - diffuse) * rows.reflected
        for side, part in ((half, seen), (1 - half, rows.other)):
            block = np.zeros((m, outputs, layout.n, self.fields))
            block[:, :k] = np.einsum("ijsm,sf->imjf", part, translation, optimize=True)
            if self.gas.has_rotation:
                theta = self.halves[side].gas.theta
                turning = turning_rows(part, rows.theta, theta)
                block[:, k:] = np.einsum("ijsm,sf->imjf", turning, rotation, optimize=True)
            matrix[:, :, layout.gas(side)] = block.reshape(m, outputs, layout.n * self.fields)
        faces = rows.sigma, rows.temperature
        self._add_emission(
            matrix, rows, faces, diffuse, (layout.sigma(half), layout.face_temperature(half))
        )
        direct, across, reflected = rows.rim
        mine = direct + (1.0 - diffuse) * reflected
        for side, part in ((half, mine), (1 - half, across)):
            places = layout.wall_sigma(side), layout.wall_temperature(side)
            self._add_emission(matrix, rows, (part[:, 0], part[:, 1]), 1.0, places, 1.0)
        return matrix

    def _add_emission(
        self,
        matrix: np.ndarray,
        rows: OperatorRows,
        emission: tuple[np.ndarray, np.ndarray],
        share: float,
        places: tuple[slice, slice],
        theta: float | None = None,
    ) -> None:
        """Add σ and temperature of a wall; rotational energy goes with its temperature."""
        k, theta = rows.velocity.shape[1], self.face_theta if theta is None else theta
        for part, place in zip(emission, places, strict=True):
            matrix[:, :k, place] += share * np.swapaxes(part, 1, 2)
        if not self.gas.has_rotation:
            return
        number = np.swapaxes(emission[0], 1, 2)
        if k == 6:
            turning = number[:, :3].copy()
            turning[:, 0] -= number[:, 3] / rows.theta[:, None]
            turning[:, 1:] /= rows.theta[:, None, None]
        else:
            turning = number[:, :1]
        matrix[:, k:, places[1]] += share * turning / theta

    def _motion(self, rows: OperatorRows, half: int, outputs: int) -> np.ndarray:
        """What the motion of the disk sends, besides molecules that it meets, (m, outputs)."""
        velocity = self._velocity(half)
        sent = np.zeros((rows.velocity.shape[0], outputs))
        factor = 4.0 - 2.0 * self.film.diffuse_share(half)
        sent[:, : rows.velocity.shape[1]] = factor * velocity * rows.velocity
        return sent

    def _velocity(self, half: int) -> float:
        return self.film.velocity if half == 0 else -self.film.velocity

    def _arrival(self, rows: OperatorRows, half: int) -> tuple[np.ndarray, np.ndarray]:
        """Fluxes at walls: matrix, shape (m, 4 or 5, size), and what motion adds."""
        outputs = 5 if self.gas.has_rotation else 4
        return self._functional(rows, half, outputs), self._motion(rows, half, outputs)

    @cached_property
    def wall_scales(self) -> tuple[np.ndarray, ...]:
        """Factors by which a gas of uniform density arrives exactly at walls, (w, 3) each."""
        # By them a closed chamber has one density. The rows are to be those of the linear problem.
        arrivals = (self._arrival(half.walls, k)[0] for k, half in enumerate(self.halves))
        return tuple(_UNIFORM / (matrix[:, :3] @ self.uniform) for matrix in arrivals)

    @cached_property
    def uniform(self) -> np.ndarray:
        """Unknowns of a gas at rest whose density is higher by one unit."""
        layout, x = self.layout, np.zeros(self.layout.size)
        for half in (0, 1):
            x[layout.gas(half)].reshape(layout.n, -1)[:, 0] = 1.0
            x[layout.sigma(half)] = x[layout.wall_sigma(half)] = 1.0
        return x

    @cached_property
    def face_arrivals(self) -> tuple[tuple[np.ndarray, np.ndarray], ...]:
        """Fluxes at the faces of the disk by unknowns, and what motion adds."""
        return tuple(self._arrival(half.face, k) for k, half in enumerate(self.halves))

    @cached_property
    def wall_arrivals(self) -> tuple[tuple[np.ndarray, np.ndarray], ...]:
        """Fluxes at the walls around the gas by unknowns, and what motion adds."""
        found = tuple(self._arrival(half.walls, k) for k, half in enumerate(self.halves))
        if self.is_linear:
            for (matrix, _), scale in zip(found, self.wall_scales, strict=True):
                matrix[:, :3] *= scale[:, :, None]
        return found

    # ------------------------------------------------------------------ equations

    @cached_property
    def equations(self) -> tuple[np.ndarray, np.ndarray]:
        """Matrix and right-hand side."""
        layout, film = self.layout, self.film
        matrix, right = np.eye(layout.size), np.zeros(layout.size)
        for half in (0, 1):
            rows, place = self.halves[half].gas, layout.gas(half)
            sent = self._functional(rows, half, self.fields)
            matrix[place] -= sent.reshape(-1, layout.size)
            right[place] = self._motion(rows, half, self.fields).ravel()
            arriving, moved = self.face_arrivals[half]
            velocity, warm = self._velocity(half), layout.face_temperature(half)
            factor = 2.0 * _SQRT_PI / np.sqrt(self.face_theta)
            matrix[layout.sigma(half)] -= factor * arriving[:, NUMBER]
            # also what a moving face runs into
            right[layout.sigma(half)] = factor * moved[:, NUMBER] + _SQRT_PI * velocity
            kept = 0.0 if film.wall == "maxwell" else 1.0 - film.tac[half]
            matrix[warm, layout.film(half)] -= (1.0 - kept) * np.eye(layout.e)
            if kept:
                matrix[warm] -= kept * self._warmth(arriving)
                run_into = 2.0 * _SQRT_PI / self.energy_modes * 0.25 * velocity
                right[warm] = kept * (self._warmth(moved) + run_into)
            arriving, moved = self.wall_arrivals[half]
            sigma, emitted = layout.wall_sigma(half), layout.wall_temperature(half)
            for _, surface, mask in self.surface_masks(half):
                if surface.solid:
                    at = np.arange(sigma.start, sigma.stop)[mask]
                    matrix[at] -= 2.0 * _SQRT_PI * arriving[mask, NUMBER]
                    matrix[at, layout.leak] -= 1.0
                    right[at] = 2.0 * _SQRT_PI * moved[mask, NUMBER]
                    at = np.arange(emitted.start, emitted.stop)[mask]
                    kept = 1.0 - surface.tac
                    right[at] = surface.tac * surface.temperature
                    if kept:
                        matrix[at] -= kept * self._warmth(arriving)[mask]
                        right[at] += kept * self._warmth(moved)[mask]
            if not film.local:
                right[layout.film(half)] = film.temperature[half]
        if film.local:
            top, bottom = layout.film(0), layout.film(1)
            matrix[top, bottom] -= np.eye(layout.e)
            lost, moved = self.film_loss
            matrix[bottom] = lost
            matrix[bottom, layout.power] -= 1.0
            right[bottom] = -moved
            if film.absorbed is not None:
                right[layout.power] = film.absorbed
            else:
                matrix[layout.power, layout.power] = 0.0
                matrix[layout.power, top] = self.weights
                right[layout.power] = film.temperature[0]
        if self.chamber is not None and self.chamber.is_closed:
            # it has the mean σ of its side wall as its measure of pressure
            matrix[layout.leak, layout.leak] = 0.0
            for half in (0, 1):
                rim, place = self.halves[half].rim, layout.wall_sigma(half)
                matrix[layout.leak, place] = np.where(rim.is_flat, 0.0, rim.weights)
            matrix[layout.leak] /= matrix[layout.leak].sum()
        return matrix, right

    def _warmth(self, arriving: np.ndarray) -> np.ndarray:
        """Temperature of arriving molecules from their fluxes on the second axis."""
        energy = arriving[:, ENERGY] - 2.0 * arriving[:, NUMBER]
        if self.gas.has_rotation:
            energy = energy + arriving[:, TURNING]
        return 2.0 * _SQRT_PI / self.energy_modes * energy

    # ------------------------------------------------------------------ results

    def face_heat(self, half: int) -> tuple[np.ndarray, np.ndarray]:
        """Heat out of a face by unknowns, shape (e, size), and what motion adds."""
        layout, diffuse, velocity = self.layout, self.film.diffuse_share(half), self._velocity(half)
        theta = self.face_theta
        arriving, moved = self.face_arrivals[half]
        heat = -diffuse * arriving[:, ENERGY]
        added = -diffuse * moved[:, ENERGY]
        unit = np.eye(layout.e) * diffuse / _SQRT_PI
        heat[:, layout.sigma(half)] += unit * theta**1.5
        heat[:, layout.face_temperature(half)] += unit
        if self.gas.has_rotation:
            heat -= diffuse * arriving[:, TURNING]
            heat[:, layout.face_temperature(half)] += 0.5 * unit
        factor = 4.0 - 2.0 * diffuse
        return heat, added + (0.625 * factor - 2.5) * velocity

    @cached_property
    def film_loss(self) -> tuple[np.ndarray, np.ndarray]:
        """Heat that each spot of the film loses by unknowns, and what motion adds."""
        (top, top_moved), (bottom, bottom_moved) = (self.face_heat(half) for half in (0, 1))
        loss = top + bottom
        place = self.layout.film(0)
        loss[:, place] += self.film.radiation * np.eye(self.layout.e)
        return loss, top_moved + bottom_moved

    def face_pressure(self, half: int) -> tuple[np.ndarray, np.ndarray]:
        """Normal pressure on a face by unknowns, shape (e, size), and what motion adds."""
        layout, diffuse, velocity = self.layout, self.film.diffuse_share(half), self._velocity(half)
        arriving, moved = self.face_arrivals[half]
        pressure = 2.0 * (2.0 - diffuse) * arriving[:, MOMENTUM]
        added = 2.0 * (2.0 - diffuse) * moved[:, MOMENTUM]
        unit = np.eye(layout.e) * diffuse
        pressure[:, layout.sigma(half)] += 0.5 * unit
        pressure[:, layout.face_temperature(half)] += 0.25 * unit
        return pressure, added + (4.0 - 2.0 * diffuse) * velocity / _SQRT_PI

    def uniform_correction(self, fields: np.ndarray, half: int) -> np.ndarray:
        """Correction of given fields of a half by which uniform ones are exact, (n, fields)."""
        return correct_uniform(self.halves[half].corrections, self.gas, fields)

    def solve(self) -> np.ndarray:
        """Unknowns, shape (size,)."""
        return lu_solve(self.factors, self.equations[1], check_finite=False)

    def respond(self, faces: tuple[float, float], surfaces: dict[str, float]) -> np.ndarray:
        """Unknowns for other temperatures of the same film, at rest, and of the same chamber."""
        layout, right = self.layout, np.zeros(self.layout.size)
        for half in (0, 1):
            if not self.film.local:
                right[layout.film(half)] = faces[half]
            emitted = right[layout.wall_temperature(half)]
            for name, surface, mask in self.surface_masks(half):
                if surface.solid:
                    emitted[mask] = surface.tac * surfaces.get(name, 0.0)
        if self.film.local:
            right[layout.power] = faces[0]
        return lu_solve(self.factors, right, check_finite=False)

    @cached_property
    def factors(self) -> tuple[np.ndarray, np.ndarray]:
        """LU factors of the matrix."""
        return lu_factor(self.equations[0], check_finite=False)

    def totals(self, x: np.ndarray) -> "Totals":
        """Forces and heats of all surfaces."""
        pressures, heats = (
            [float(self.weights @ (matrix @ x + added)) for matrix, added in map(found, (0, 1))]
            for found in (self.face_pressure, self.face_heat)
        )
        totals = Totals(pressures[1] - pressures[0], (heats[0], heats[1]))
        for half in (0, 1):
            matrix, moved = self.wall_arrivals[half]
            arriving = matrix @ x + moved
            sigma, emitted = x[self.layout.wall_sigma(half)], x[self.layout.wall_temperature(half)]
            heat = (sigma + emitted) / _SQRT_PI - arriving[:, ENERGY]
            sent = 0.5 * sigma / _SQRT_PI - arriving[:, NUMBER]
            if self.gas.has_rotation:
                heat = heat + sent + 0.5 * emitted / _SQRT_PI - arriving[:, TURNING]
            fluxes = arriving[:, AXIAL], 0.5 * sigma + 0.25 * emitted, heat, sent
            self.add_walls(totals, half, fluxes)
        return totals

    def add_walls(self, totals: "Totals", half: int, fluxes: tuple[np.ndarray, ...]) -> None:
        """Add forces, heats and molecules of the walls of a half to totals, by name."""
        axial, recoil, heat, sent = fluxes
        rim, sign = self.halves[half].rim, 1.0 if half == 0 else -1.0
        for name, _, mask in self.surface_masks(half):
            # molecules leave a side wall with no axial momentum
            force = sign * (2.0 * axial + np.where(rim.is_flat, recoil, 0.0))
            for total, values in (
                (totals.forces, force),
                (totals.heats, heat),
                (totals.molecules, sent),
            ):
                total[name] = total.get(name, 0.0) + float(rim.weights[mask] @ values[mask])


@dataclass(frozen=True)
class Totals:
    """Forces upwards [p A], heats out of surfaces [p √(2RT_c) A] and molecules that they send."""

    force: float
    heat: tuple[float, float]
    forces: dict[str, float] = field(default_factory=dict)
    heats: dict[str, float] = field(default_factory=dict)
    molecules: dict[str, float] = field(default_factory=dict)
