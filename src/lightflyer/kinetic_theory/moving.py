"""A disk that moves along its axis through gas at rest: drag, and the heat that motion draws."""

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from scipy.special import hyp2f1

from lightflyer.array.records import ShortRepr
from lightflyer.core.checks import require_range
from lightflyer.core.extras import extra
from lightflyer.core.quantity import HIGHEST_OPEN_FRACTION
from lightflyer.kinetic_theory.model_gases import GasModel, gas_model
from lightflyer.kinetic_theory.walls import Accommodation, Wall, walls_of

KNUDSEN_RANGE = (0.004, 100.0)
"""Knudsen numbers λ/(2r) for which the meshes resolve the flow around a moving disk."""


@dataclass(frozen=True)
class MovedDisk:
    r"""Walls of a moving disk."""

    # Accommodation coefficient of the leading and the trailing face, as for :func:`solve_moving`
    tac: tuple[float, float]
    # Share of the molecules arriving at a face that pass to its other side
    open_fraction: float = 0.0
    wall: Wall = "maxwell"
    # Faces of Cercignani and Lampis, in place of ``wall``
    scattering: tuple[Accommodation, Accommodation] | None = None

    def free_molecular_drag(self, rotation: bool) -> float:
        r"""Drag without collisions, :math:`F/(pAs)`."""
        # .. math::
        #     \frac{1-\beta}{\sqrt\pi}\,\left[4\,(2-\bar\alpha) + \pi\,\bar\alpha\right], \qquad
        #     \frac{1-\beta}{\sqrt\pi}\,\left[4 + \pi + \frac{\pi}{8k}(1-\bar\alpha)\right]
        #
        # at Maxwell walls and at those from which all molecules leave at one temperature, with
        # :math:`k = 1`, or 3/2 with rotation. At those of Cercignani and Lampis :math:`\pi/4` of
        # the first becomes :math:`\frac\pi4\,{}_2F_1(-\frac12, -\frac12; 1; 1-\alpha_n)` of each
        # face, the momentum that its modes keep.
        mean = 0.5 * sum(self.tac)
        if self.scattering is not None:
            kept = np.mean([hyp2f1(-0.5, -0.5, 1.0, 1.0 - face.normal) for face in self.scattering])
            pushed = 4.0 + np.pi * float(kept)
        elif self.wall == "accommodated":
            kept = np.pi / 8.0 * (1.0 - mean) / (1.5 if rotation else 1.0)
            pushed = 4.0 + np.pi + kept
        else:
            pushed = 4.0 * (2.0 - mean) + np.pi * mean
        return float((1.0 - self.open_fraction) * pushed / np.sqrt(np.pi))


@dataclass(frozen=True)
class MovingOutcome:
    """A moving disk solved on one mesh."""

    drag: float  # :math:`F/(pAs)`
    heat: tuple[float, float]  # Heat out of the leading and the trailing face [p √(2RT) A s]
    iterations: int
    # shape (2, n, 6 or 9); at the nodes of the upper and the mirrored lower half
    fields: np.ndarray = field(repr=False)


@dataclass(frozen=True)
class MovingSolution(ShortRepr):
    r"""Drag of a disk that moves slowly along its axis, towards its top."""

    knudsen: float  #: λ/(2r)
    #: :math:`F/(pAs)` with the speed ratio :math:`s = U/\sqrt{2RT}` and the area of one face
    drag: float
    drag_ratio: float  #: Drag over that of free molecules
    #: Heat out of the top and the bottom face [p √(2RT) A s]. By reciprocity each is the force on
    #: the disk at rest, upwards [p A], per temperature perturbation of that face
    heat: tuple[float, float]
    #: Numerical error of the drag: its change with a coarser mesh. It excludes the error of the
    #: model equation
    error_estimate: float
    _outcome: Any = field(repr=False)

    def flow(self, radius: Any, height: Any) -> dict[str, np.ndarray]:
        """Fields of the gas at points, per speed ratio, far away at rest."""
        from lightflyer.kinetic_theory.disk.cases import sample

        return sample(self._outcome, np.asarray(radius, float), np.asarray(height, float))


def solve_moving(
    knudsen: float,
    tac_top: float,
    tac_bottom: float,
    *,
    open_fraction: float = 0.0,
    gas: str = "monatomic",
    wall: str = "maxwell",
    tangential_accommodation: float | tuple[float, float] | None = None,
    rotational_accommodation: float | tuple[float, float] | None = None,
) -> MovingSolution:
    r"""Solve the linear kinetic equation around a thin disk that moves along its axis.

    The disk has the temperature of the gas and is much slower than its molecules.

    Parameters
    ----------
    knudsen : float
        λ/(2r) with λ = (μ/p) √(πRT/2), from 0.004 to 100.
    tac_top, tac_bottom : float
        Accommodation coefficient of the leading and the trailing face, above 0 and up to 1.
    open_fraction : float
        Share of the molecules arriving at a face that pass to its other side unchanged, from 0 to
        0.999.
    gas : {"monatomic", "diatomic"}
    wall : {"maxwell", "accommodated", "cercignani-lampis"}
    tangential_accommodation, rotational_accommodation : float or (float, float), optional
        As for :func:`solve`.

    Returns
    -------
    MovingSolution

    Raises
    ------
    ParameterError
        If a parameter is out of range.
    ConvergenceError
        If the iteration does not converge.
    MissingExtraError
        If numba is not installed.

    References
    ----------
    [Shakhov1968]_; [Rykov1975]_ for a diatomic gas.

    Examples
    --------
    >>> from lightflyer.kinetic_theory import solve_moving
    >>> solution = solve_moving(1.0, 1.0, 1.0)
    >>> print(f"{solution.drag:.3f}, {solution.drag_ratio:.3f}")
    3.173, 0.787
    """
    require_range("knudsen", knudsen, *KNUDSEN_RANGE)
    for name, value in (("tac_top", tac_top), ("tac_bottom", tac_bottom)):
        require_range(name, value, 0.0, 1.0, open_below=True)
    require_range("open_fraction", open_fraction, 0.0, HIGHEST_OPEN_FRACTION)
    model = gas_model(gas)
    tacs = float(tac_top), float(tac_bottom)
    stated = tangential_accommodation, rotational_accommodation
    known, scattering = walls_of(wall, tacs, *stated, rotates=model.has_rotation)
    extra("numba", "the kinetic solver", "kinetic")
    from lightflyer.kinetic_theory.disk.cases import DiskOutcome, meshes

    disk = MovedDisk(tacs, float(open_fraction), known, scattering)
    rarefaction = float(np.sqrt(np.pi) / (4.0 * knudsen))
    (fine, mesh), (coarse, _) = (
        (moving_outcomes(rarefaction, level, [(model, disk)])[0], level.mesh(rarefaction, np.inf))
        for level in meshes(knudsen, linear=True)
    )
    return MovingSolution(
        knudsen=float(knudsen),
        drag=fine.drag,
        drag_ratio=fine.drag / disk.free_molecular_drag(model.has_rotation),
        heat=fine.heat,
        error_estimate=abs(fine.drag - coarse.drag),
        _outcome=DiskOutcome(-fine.drag, fine.heat, fine.fields, fine.iterations, mesh),
    )


def moving_outcomes(
    rarefaction: float, level: Any, cases: Sequence[tuple[GasModel, MovedDisk]]
) -> list[MovingOutcome]:
    """Solve for several gases and disks on one mesh, whose rays are traced once."""
    from lightflyer.kinetic_theory.disk.cases import totals
    from lightflyer.kinetic_theory.disk.linear import FaceWalls, LinearSystem, face_result
    from lightflyer.kinetic_theory.disk.operators import assemble
    from lightflyer.kinetic_theory.disk.scattering import (
        Scattering,
        ScatteringSystem,
        assemble_modes,
    )

    mesh = level.mesh(rarefaction, np.inf)
    operators = assemble(mesh, rarefaction, level.quadrature)
    system: LinearSystem | None = None
    found = []
    for gas, disk in cases:
        if disk.scattering is not None:
            rows = assemble_modes(operators, rarefaction, level.quadrature)
            scatterer = ScatteringSystem(operators, rows, gas, disk.open_fraction)
            fields, faces = scatterer.solve(
                *(
                    Scattering(*face, velocity=sign)
                    for face, sign in zip(disk.scattering, (1.0, -1.0), strict=True)
                )
            )
            force, heat = totals(mesh, faces)
            found.append(MovingOutcome(-force, heat, 1, fields))
            continue
        if system is None or system.gas is not gas or system.wall != disk.wall:
            mean = 0.5 * sum(disk.tac)
            system = LinearSystem(operators, gas, mean, disk.open_fraction, disk.wall)
        walls = FaceWalls(disk.tac, (0.0, 0.0), velocity=1.0, open_fraction=disk.open_fraction)
        fields, iterations = system.solve(walls)
        force, heat = totals(
            mesh, [face_result(system, walls, fields[face], face) for face in (0, 1)]
        )
        found.append(MovingOutcome(-force, heat, iterations, fields))
    return found
