"""The linear disk problem with the collision operator of real molecules."""

from functools import cached_property
from typing import Any

import numpy as np

from lightflyer.kinetic.collisions.rows import Components, MolecularRows
from lightflyer.kinetic.linear import LinearSystem
from lightflyer.kinetic.walls import Wall

_SQRT_PI = np.sqrt(np.pi)


class MolecularSystem(LinearSystem):
    """Linear problem of molecules on a mesh, for any disk.

    A node's fields are its moments: those of translation, then those of rotational energy. As all
    matrices are kept, it is for few of them: :mod:`lightflyer.kinetic.collisions.problem` has
    many, and this as preconditioner.

    Parameters
    ----------
    rows : MolecularRows
        Of molecules with the same viscosity exponent.
    components : Components
        Of the molecules.
    mean_tac, open_fraction, wall
        As for :class:`LinearSystem`.
    """

    def __init__(
        self,
        rows: MolecularRows,
        components: Components,
        mean_tac: float,
        open_fraction: float = 0.0,
        wall: Wall = "maxwell",
    ) -> None:
        self.components = components
        operators: Any = rows
        gas: Any = _Kind(components)
        super().__init__(operators, gas, mean_tac, open_fraction, wall)

    @property
    def moved(self) -> int:
        """See :attr:`LinearSystem.moved`."""
        return len(self.components.translation)

    def _number_of_fields(self) -> int:
        return self.components.size

    def _sources(self) -> tuple[np.ndarray, np.ndarray]:
        mixing = self.components.mixing
        return mixing[: self.moved], mixing[self.moved :]

    def _matrix(self, rows: np.ndarray) -> np.ndarray:
        translation, rotation = self._sources()
        matrix = np.empty((self.n, self.fields, self.n, self.fields))
        self._mix(rows, translation, matrix[:, : self.moved])
        turned = self.components.rotation
        if turned.size:
            part = rows[:, :, turned[:, None], turned]
            self._mix(part, rotation, matrix[:, self.moved :])
        return matrix.reshape(self.size, self.size)

    def _mix(self, rows: np.ndarray, sources: np.ndarray, out: np.ndarray) -> None:
        """Rows (n, n, sources, moments) times the sources of fields, node by node."""
        for i in range(self.n):
            out[i] = np.einsum("jsm,sf->mjf", rows[i], sources, optimize=True)

    @cached_property
    def _warmth(self) -> np.ndarray:
        operators, turned = self.operators, self.components.rotation
        return np.concatenate([operators.temperature, operators.sigma[..., turned]], axis=2)

    def _arriving_temperature(self) -> np.ndarray:
        translation, rotation = self._sources()
        fluxes = self.operators.fluxes
        arriving = (fluxes[..., 2] - 2.0 * fluxes[..., 0]) @ translation
        arriving += fluxes[:, :, self.components.rotation, 0] @ rotation
        return np.asarray(2.0 * _SQRT_PI / self._energy_modes * arriving)

    def _diffuse_instead(self) -> np.ndarray:
        operators = self.operators
        matrix = -self._matrix(operators.reflected)
        whole = matrix.reshape(self.n, self.fields, self.n, self.fields)
        arriving = 2.0 * _SQRT_PI * operators.fluxes[..., 0] @ self._sources()[0]
        for i in range(self.n):
            whole[i, : self.moved] += np.einsum("em,ejf->mjf", operators.sigma[i], arriving)
        return matrix

    def arriving(self, fields: np.ndarray) -> np.ndarray:
        """See :meth:`LinearSystem.arriving`."""
        translation, rotation = self._sources()
        fluxes, turned = self.operators.fluxes, self.components.rotation
        arriving = np.einsum("ejsk,sf,jf->ek", fluxes, translation, fields, optimize=True)
        if not turned.size:
            return arriving
        turning = np.einsum(
            "ejs,sf,jf->e", fluxes[:, :, turned, 0], rotation, fields, optimize=True
        )
        return np.concatenate([arriving, turning[:, None]], axis=1)


class _Kind:
    """What the faces need to know of the gas."""

    def __init__(self, components: Components) -> None:
        self.has_rotation = components.rotation.size > 0
