r"""Linear problem of a disk at walls of Cercignani and Lampis.

All molecules that leave a face were scattered by it, and a face is known by how much of each
mode it keeps. The gas is factorised once: then what arrives in each mode where another one leaves
is a matrix, and any two faces are a small system.

Modes of what a face scatters: products of polynomials that it only makes smaller.

At a wall of [CercignaniLampis1971]_ the normal and the tangential velocity are scattered each on
its own, and Laguerre's polynomials :math:`L_m(c_n^2)` and the functions
:math:`c_t^j\cos(j\varphi)\,L_k^{(j)}(c_t^2)` are eigenfunctions: molecules that arrive with one of
them leave with the same, times :math:`(1-\alpha_n)^m` and :math:`(1-\sigma_t)^{j+2k}`. They are
orthonormal over the molecules that meet the wall. So the wall is known by a number per mode, and
the solver by how much of each mode arrives where one leaves.
"""

from dataclasses import dataclass

import numpy as np
from scipy.linalg import lu_factor, lu_solve
from scipy.special import binom, gammaln, poch

from lightflyer.kinetic_theory.disk import modes_kernel
from lightflyer.kinetic_theory.disk.linear import FaceResult, FieldEquations
from lightflyer.kinetic_theory.disk.operators import (
    Operators,
    Quadrature,
    face_points,
    kernel_arguments,
    node_points,
)
from lightflyer.kinetic_theory.grid.rays import spline_table
from lightflyer.kinetic_theory.model_gases import GasModel


@dataclass(frozen=True)
class Mode:
    """One eigenfunction, by its degree in the normal velocity and two in the tangential one."""

    normal: int  # m
    harmonic: int  # j
    radial: int  # k

    @property
    def degree(self) -> int:
        """Highest power of the speed."""
        return 2 * (self.normal + self.radial) + self.harmonic

    def eigenvalue(self, normal: float, tangential: float) -> float:
        """Share that is left of it at a wall of given α_n and σ_t."""
        kept = (1.0 - normal) ** self.normal
        return float(kept * (1.0 - tangential) ** (self.harmonic + 2 * self.radial))

    def coefficients(self, size: int) -> np.ndarray:
        """Coefficients of powers of c_n² and c_t², shape (size, size)."""
        m, j, k = self.normal, self.harmonic, self.radial
        table = np.zeros((size, size))
        scale = 1.0 if j == 0 else np.sqrt(2.0 * np.exp(gammaln(k + 1) - gammaln(k + j + 1)))
        table[: m + 1, : k + 1] = scale * np.outer(_laguerre(m, 0), _laguerre(k, j))
        return table

    @property
    def momentum(self) -> float:
        r"""Normal momentum, :math:`\langle c_n\varphi\rangle`."""
        if self.harmonic or self.radial:
            return 0.0
        share = poch(-0.5, self.normal) / np.exp(gammaln(self.normal + 1.0))
        return float(0.5 * np.sqrt(np.pi) * share)


def _laguerre(degree: int, order: int) -> np.ndarray:
    """Coefficients of Laguerre's polynomial, the lowest power first."""
    powers = np.arange(degree + 1)
    signs = np.where(powers % 2, -1.0, 1.0)
    return np.asarray(signs * binom(degree + order, degree - powers) / np.exp(gammaln(powers + 1)))


NUMBER, NORMAL_ENERGY, TANGENTIAL_ENERGY = Mode(0, 0, 0), Mode(1, 0, 0), Mode(0, 0, 1)


def modes_up_to(degree: int, normal: int) -> tuple[Mode, ...]:
    """Modes of a total degree, and those of the normal velocity alone up to an m."""
    found = [
        Mode(m, j, k)
        for m in range(degree // 2 + 1)
        for k in range(degree // 2 + 1)
        for j in range(degree + 1)
        if 2 * (m + k) + j <= degree
    ]
    found += [Mode(m, 0, 0) for m in range(degree // 2 + 1, normal + 1)]
    return tuple(sorted(found, key=lambda mode: (mode.degree, mode.normal, mode.harmonic)))


_SQRT_PI = np.sqrt(np.pi)
_DEGREE, _NORMAL = 6, 6
"""Modes that are kept: those of a total degree, and of the normal velocity alone up to an m."""


@dataclass(frozen=True)
class Scattering:
    """A face: what it accommodates of normal energy, tangential momentum and rotation [1]."""

    normal: float
    tangential: float
    rotational: float
    temperature: float = 0.0  # Perturbation
    velocity: float = 0.0  # Away from the gas it would leave behind, along the face's normal


@dataclass(frozen=True)
class ModeRows:
    """What a face emits in each mode and what arrives at it, for n nodes and e of a face."""

    modes: tuple[Mode, ...]
    emitted: np.ndarray  # shape (n, e, 6 moments, k)
    arriving: np.ndarray  # shape (e, n, 6 sources, k)


def assemble_modes(
    operators: Operators,
    rarefaction: float,
    quadrature: Quadrature,
    modes: tuple[Mode, ...] | None = None,
) -> ModeRows:
    """Trace the rays between a face and the gas for all modes."""
    modes = modes or modes_up_to(_DEGREE, _NORMAL)
    mesh = operators.mesh
    setup, panels = kernel_arguments(mesh, rarefaction, quadrature)
    highest = max(mode.degree for mode in modes)
    setup = (*setup[:4], *spline_table(highest + 7))
    size = highest // 2 + 1
    coefficients = np.array([mode.coefficients(size) for mode in modes])
    harmonics = np.array([mode.harmonic for mode in modes])
    n, e = mesh.size, mesh.eta.size
    emitted = np.zeros((n, e, 6, len(modes)))
    flat = np.zeros((e, n, 6 * len(modes)))
    shared = rarefaction, setup, panels, coefficients, harmonics
    modes_kernel.emitted(node_points(mesh), *shared, emitted)
    modes_kernel.arriving(face_points(mesh), *shared, flat)
    arriving = flat.reshape(e, n, 6, len(modes))
    arriving *= 2.0 * _SQRT_PI * mesh.face_radius[:, None, None, None] ** -harmonics.astype(float)
    return ModeRows(modes, emitted, arriving)


class ScatteringSystem(FieldEquations):
    """Linear problem on a mesh for a gas, factorised once and solved for any faces."""

    def __init__(
        self, operators: Operators, rows: ModeRows, gas: GasModel, open_fraction: float = 0.0
    ) -> None:
        super().__init__(operators, gas)
        self.rows, self.open_fraction = rows, open_fraction
        passing = open_fraction * operators.reflected
        # moments at all nodes of each mode, and last of c·e_z, shape (n · fields, columns)
        n, e, _, k = rows.emitted.shape
        matrix = np.zeros((n, self.fields, self._parts, k, e))
        matrix[:, :6, 0] = rows.emitted.transpose(0, 2, 3, 1)
        if self.gas.has_rotation:
            turning = rows.emitted[:, :, :3].copy()
            turning[:, :, 0] -= rows.emitted[:, :, 3]
            matrix[:, 6:, 1] = turning.transpose(0, 2, 3, 1)
        along = np.zeros((n, self.fields))
        along[:, :6] = operators.velocity
        emission = np.column_stack([matrix.reshape(self.size, -1), along.ravel()])
        # what arrives in each mode by the fields, shape (parts · k · e, n · fields)
        translation, rotation = self._sources()
        parts = [np.einsum("ejsk,sf->kejf", rows.arriving, translation, optimize=True)]
        if self.gas.has_rotation:
            turning = rows.arriving[:, :, :3]
            parts.append(np.einsum("ejsk,sf->kejf", turning, rotation, optimize=True))
        arrival = np.stack(parts).reshape(-1, self.size)
        unit = np.eye(self.size)
        # fields, and what arrives at a face, where both faces emit a mode alike or opposite
        self.fields_of, self.arrives = [], []
        for sign in (1.0, -1.0):
            matrix = self._matrix(operators.own + sign * (operators.other + passing))
            factors = lu_factor(unit - matrix, check_finite=False, overwrite_a=True)
            self.fields_of.append(lu_solve(factors, emission, check_finite=False))
            self.arrives.append(arrival @ self.fields_of[-1])

    @property
    def _parts(self) -> int:
        """Distributions that are scattered: that of molecules, and of their rotational energy."""
        return 2 if self.gas.has_rotation else 1

    def _own(self, face: Scattering) -> tuple[np.ndarray, np.ndarray]:
        """What a face keeps of each mode, and what it emits of its own, shape (parts · k · e,)."""
        modes, e = self.rows.modes, self.operators.mesh.eta.size
        kept = np.array([mode.eigenvalue(face.normal, face.tangential) for mode in modes])
        momentum = np.array([mode.momentum for mode in modes])
        emits = 2.0 * face.velocity * kept * momentum
        # the wall's Maxwellian, c² − 2, in modes: each is negative where there is more energy
        for mode in (NORMAL_ENERGY, TANGENTIAL_ENERGY):
            place = modes.index(mode)
            emits[place] -= (1.0 - kept[place]) * face.temperature
        if self.gas.has_rotation:
            turning = np.zeros(len(modes))
            turning[modes.index(NUMBER)] = face.rotational * face.temperature
            kept = np.concatenate([kept, (1.0 - face.rotational) * kept])
            emits = np.concatenate([emits, turning])
        return np.repeat(kept, e), np.repeat(emits, e)

    def solve(self, top: Scattering, bottom: Scattering) -> tuple[np.ndarray, list[FaceResult]]:
        """Fields of the upper and the mirrored lower half (2, n, fields), and both faces."""
        solid, faces = 1.0 - self.open_fraction, (top, bottom)
        kept, own = (np.stack(part) for part in zip(*map(self._own, faces), strict=True))
        moved = 2.0 * np.array([face.velocity for face in faces])
        same, other = (0.5 * (self.arrives[0] + sign * self.arrives[1]) for sign in (1.0, -1.0))
        seen = np.block([[same[:, :-1], other[:, :-1]], [other[:, :-1], same[:, :-1]]])
        by_motion = np.concatenate(
            [
                same[:, -1] * moved[0] + other[:, -1] * moved[1],
                other[:, -1] * moved[0] + same[:, -1] * moved[1],
            ]
        )
        # b = Λ a + own is emitted by the solid part, a = solid (R b + that of motion) arrives
        matrix = np.eye(kept.size) - solid * kept.reshape(-1, 1) * seen
        right = own.ravel() + solid * kept.ravel() * by_motion
        leaving = np.linalg.solve(matrix, right)
        arrived = (solid * (seen @ leaving + by_motion)).reshape(2, -1)
        leaving = leaving.reshape(2, -1)
        emitted = solid * np.column_stack([leaving, moved])
        e, o = (
            (fields @ (0.5 * (emitted[0] + sign * emitted[1]))).reshape(-1, self.fields)
            for sign, fields in zip((1.0, -1.0), self.fields_of, strict=True)
        )
        fields = np.stack([e + o, e - o])
        modes, results = self.rows.modes, []
        momentum = np.array([mode.momentum for mode in modes])
        normal, tangential = modes.index(NORMAL_ENERGY), modes.index(TANGENTIAL_ENERGY)
        for face, around, left, come in zip(
            faces, fields,
            *(part.reshape(2, self._parts, len(modes), -1) for part in (leaving, arrived)),
            strict=True,
        ):  # fmt: skip
            recoil = momentum @ left[0] + 2.0 * face.velocity
            pressure = recoil / (2.0 * _SQRT_PI) + self.arriving_fluxes(around)[:, 1]
            # the face runs into what arrives
            gained = come[0, normal] + 2.0 * face.velocity * momentum[normal] - left[0, normal]
            gained = gained + come[0, tangential] - left[0, tangential]
            if self.gas.has_rotation:
                number = modes.index(NUMBER)
                gained = gained + left[1, number] - come[1, number]
            results.append(FaceResult(2.0 * solid * pressure, solid * gained / (2.0 * _SQRT_PI)))
        return fields, results
