"""A disk between floor, lid and side wall, or with a local heat balance: solution with errors."""

import time
from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Literal

import numpy as np

from lightflyer.array.records import ShortRepr
from lightflyer.core.checks import require_range
from lightflyer.core.errors import ParameterError
from lightflyer.core.extras import extra
from lightflyer.core.progress import report
from lightflyer.kinetic_theory.chamber.enclosure import Chamber, Film
from lightflyer.kinetic_theory.model_gases import gas_model
from lightflyer.kinetic_theory.solver import (
    KNUDSEN_RANGE,
    TEMPERATURE_RATIOS,
    describe_faces,
    difference,
    furthest_boundary,
    ratios,
)
from lightflyer.kinetic_theory.walls import WALLS, FreeMolecularDisk, walls_of

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from lightflyer.kinetic_theory.chamber.cases import ChamberCase, ChamberOutcome

Balance = Literal["isothermal", "local"]
"""Each face has one temperature, or each spot of the film that by which it loses the heat that it
absorbs."""

BALANCES: tuple[Balance, ...] = ("isothermal", "local")


@dataclass(frozen=True)
class ChamberSolution(ShortRepr):
    r"""Forces and heats of a disk and of what encloses the gas around it.

    Forces are upwards [p A] and heats out of a surface [p √(2RT_c) A], with the area A of the disk;
    in the linear problem per unit perturbation. p is the pressure far away. In a closed chamber it
    is that of the molecules that arrive at its side wall, on average: what a gauge at T_c reads
    behind a small hole there.
    """

    knudsen: float  #: λ(T_c)/(2r)
    #: F/F_fm, over the free-molecular force in open space; None where that is zero
    force_ratio: float | None
    #: Q/Q_fm of each face and of both, over the free-molecular heat with the mean temperatures of
    #: the faces
    heat_ratio_top: float | None
    heat_ratio_bottom: float | None  #: As ``heat_ratio_top``
    heat_ratio: float | None  #: As ``heat_ratio_top``
    #: Of ``disk``, ``floor``, ``lid`` and ``side``, the last three in a chamber. Of a reservoir:
    #: momentum and energy that leave through it, energy with its sign reversed
    forces: Mapping[str, float]
    heats: Mapping[str, float]  #: As ``forces``
    #: Numerical error of ``force_ratio``, ``heat_ratio``, ``force`` and ``heat``: their change with
    #: a coarser mesh. It excludes the error of the model equation
    error_estimate: dict[str, float | None]
    #: ``force`` and ``heat``: their sums over all surfaces of a chamber, over the sums of their
    #: magnitudes; zero but for numerical errors
    closure: dict[str, float]
    #: Largest relative difference of absorbed and lost heat of a spot of a local film; None for an
    #: isothermal one
    imbalance: float | None
    #: Heat that the film loses per area of the disk, by gas and radiation [p √(2RT_c)]
    absorbed: float
    film_radius: np.ndarray  #: shape (21,); distance from the film's centre [disk radii]
    film_temperature: np.ndarray  #: shape (21,); T/T_c − 1 there, its mean over both faces
    iterations: int
    seconds: float  #: Time of the solution on both meshes
    warnings: tuple[str, ...]  #: What limits the result
    _case: "ChamberCase"
    _outcome: "ChamberOutcome"

    def __repr__(self) -> str:
        return f"ChamberSolution({self.title}: force {self.force:.5g} pA, heat {self.heat:.5g})"

    @property
    def force(self) -> float:
        """Upwards on the disk [p A], per unit perturbation in the linear problem."""
        return self.forces["disk"]

    @property
    def heat(self) -> float:
        """Out of the disk [p √(2RT_c) A], likewise."""
        return self.heats["disk"]

    @property
    def is_linear(self) -> bool:
        """Whether the problem is linear."""
        return self._case.linear

    @property
    def is_model(self) -> bool:
        """Whether a model equation stands for the collisions."""
        return True

    @property
    def chamber(self) -> Chamber | None:
        """What encloses the gas; None is open space."""
        return self._case.chamber

    @property
    def boundary(self) -> float:
        """Distance up to which there is gas in every direction [disk radii]."""
        return np.inf if self.chamber is None else self.chamber.furthest

    @property
    def inputs(self) -> dict[str, Any]:
        """Arguments of :func:`solve`, by name."""
        case, film = self._case, self._case.film
        chamber: dict[str, Any] = {}
        if case.chamber is not None:
            chamber = {
                name: {
                    "distance": surface.distance,
                    "solid": surface.solid,
                    "temperature": surface.temperature,
                    "tac": surface.tac,
                }
                for name, surface in case.chamber.surfaces.items()
            }
        top, bottom = film.temperature
        return {
            "knudsen": self.knudsen,
            "tac_top": film.tac[0],
            "tac_bottom": film.tac[1],
            **(
                {"top_temperature": top, "bottom_temperature": bottom}
                if case.linear
                else {"temperature_ratio": [1.0 + top, 1.0 + bottom]}
            ),
            "gas": case.gas.name,
            "wall": film.wall_name,
            **describe_faces(film.scattering),
            "film": "local" if film.local else "isothermal",
            "radiation": film.radiation,
            "absorbed": film.absorbed,
            "chamber": chamber or None,
        }

    @property
    def title(self) -> str:
        """The problem in words."""
        film, gas = self._case.film, self._case.gas.name
        top, bottom = (value if self.is_linear else 1.0 + value for value in film.temperature)
        both = f"{top:g}" if top == bottom else f"{top:g} and {bottom:g}"
        heated = f"linear, perturbation {both}" if self.is_linear else f"T_h/T_c {both}"
        if film.absorbed is not None:
            heated = f"{'linear, ' if self.is_linear else ''}absorbs {film.absorbed:g} p√(2RT_c)"
        balance = "local heat balance, " if film.local else ""
        where = "open space" if self.chamber is None else self.chamber.title
        return (
            f"Kn {self.knudsen:g}, TAC {film.tac[0]:g} top, {film.tac[1]:g} bottom, "
            f"{WALLS[film.wall_name]}, {gas}, {heated}, {balance}{where}"
        )

    def plot(self, ax: "Axes | None" = None) -> "Figure":
        """Draw temperature and streamlines of the gas in a plane through the axis."""
        from lightflyer.kinetic_theory.figures import flow_figure

        return flow_figure(self, ax)

    def flow(self, radius: Any, height: Any) -> dict[str, np.ndarray]:
        """Fields of the gas at points, as of :meth:`Solution.flow`; NaN outside the chamber."""
        from lightflyer.kinetic_theory.disk.cases import sample_halves

        outcome = self._outcome
        points = np.asarray(radius, float), np.asarray(height, float)
        return sample_halves(outcome.meshes, outcome.fields, *points)

    def to_json(self) -> dict[str, Any]:
        """The solution as a JSON object."""
        return {
            "kn": self.knudsen,
            "force_ratio": self.force_ratio,
            "heat_ratio_top": self.heat_ratio_top,
            "heat_ratio_bottom": self.heat_ratio_bottom,
            "heat_ratio": self.heat_ratio,
            "forces": dict(self.forces),
            "heats": dict(self.heats),
            "error_estimate": self.error_estimate,
            "closure": self.closure,
            "absorbed": self.absorbed,
            "imbalance": self.imbalance,
            "film_radius": self.film_radius.tolist(),
            "film_temperature": self.film_temperature.tolist(),
            "iterations": self.iterations,
            "seconds": round(self.seconds, 3),
            "warnings": list(self.warnings),
        }


def solve_in_chamber(
    knudsen: float,
    tac_top: float,
    tac_bottom: float,
    *,
    chamber: Chamber | None = None,
    film: str = "isothermal",
    top_temperature: float = 1.0,
    bottom_temperature: float = 1.0,
    temperature_ratio: float | tuple[float, float] | None = None,
    radiation: float = 0.0,
    absorbed: float | None = None,
    gas: str = "monatomic",
    wall: str = "maxwell",
    tangential_accommodation: float | tuple[float, float] | None = None,
    rotational_accommodation: float | tuple[float, float] | None = None,
) -> ChamberSolution:
    r"""Solve the kinetic equation around a thin disk between floor, lid and side wall.

    As :func:`solve`, for a disk at any height in a cylindrical chamber whose surfaces are solid or
    reservoirs, and for a film whose spots balance their heat each on its own.

    Parameters
    ----------
    knudsen : float
        λ(T_c)/(2r), from 0.03 to 100.
    tac_top, tac_bottom : float
        Accommodation coefficient of each face, above 0 and up to 1.
    chamber : Chamber, optional
        By default open space.
    film : {"isothermal", "local"}
        Whether each face has one temperature, or each spot loses by gas and radiation the heat that
        it absorbs, the same everywhere, with the same temperature on both sides and no conduction
        along the film.
    top_temperature, bottom_temperature : float
        Temperature perturbation of each face in the linear problem.
    temperature_ratio : float or (float, float), optional
        T_h/T_c of both faces, or of the top and bottom face, from 0.5 to 3.5: the non-linear
        problem. Of a local film it is the mean over its area.
    radiation : float
        Heat that a local film radiates to surroundings at T_c per unit area and perturbation,
        :math:`4\epsilon\sigma T_c^4/(p\sqrt{2RT_c})` with the sum :math:`\epsilon` of both faces'
        emittances; in the non-linear problem as T⁴.
    absorbed : float, optional
        Heat that each spot of a local film absorbs [p √(2RT_c)], in place of the temperature.
    gas : {"monatomic", "diatomic"}
    wall : {"maxwell", "accommodated", "cercignani-lampis"}
        Of the disk; the last in the non-linear problem. At a chamber's surfaces all molecules leave
        diffusely.
    tangential_accommodation, rotational_accommodation : float or (float, float), optional
        As for :func:`solve`.

    Returns
    -------
    ChamberSolution

    Raises
    ------
    ParameterError
        If a parameter is out of range.
    ConvergenceError
        If the iteration does not converge; the message has the last residual.
    MissingExtraError
        If numba is not installed.

    References
    ----------
    As for :func:`solve`.
    """
    local, linear = require_balance(film, radiation, absorbed), temperature_ratio is None
    tacs, model = (float(tac_top), float(tac_bottom)), gas_model(gas)
    for name, value in zip(("tac_top", "tac_bottom"), tacs, strict=True):
        require_range(name, value, 0.0, 1.0, open_below=True)
    stated = tangential_accommodation, rotational_accommodation
    known, scattering = walls_of(wall, tacs, *stated, rotates=model.has_rotation)
    if scattering and linear:
        raise ParameterError(
            f'wall = "{wall}" in a chamber, or with a local heat balance, needs temperature_ratio'
        )
    if temperature_ratio is None:
        require_range("top_temperature", top_temperature)
        require_range("bottom_temperature", bottom_temperature)
        pair = float(top_temperature), float(bottom_temperature)
    else:
        first, second = (float(value) for value in np.broadcast_to(temperature_ratio, 2))
        require_range("temperature_ratio", (first, second), *TEMPERATURE_RATIOS)
        pair = first - 1.0, second - 1.0
    if local and pair[0] != pair[1]:
        raise ParameterError('film = "local" has one temperature on both sides')
    require_range("knudsen", knudsen, *KNUDSEN_RANGE)
    surfaces = {} if chamber is None else chamber.surfaces
    if not any((*pair, *(surface.temperature for surface in surfaces.values()))):
        raise ParameterError("all surfaces are at the gas temperature: forces and heats are zero")
    for name, surface in surfaces.items():
        if surface.distance > furthest_boundary(knudsen):
            raise ParameterError(
                f"{name} = {surface.distance:g} exceeds {furthest_boundary(knudsen):.3g}, the "
                f"largest resolved at knudsen = {knudsen:g}"
            )
    extra("numba", "the kinetic solver", "kinetic")
    from lightflyer.kinetic_theory.chamber.cases import ChamberCase, meshes, solve_chamber_case

    face = Film(
        tacs, pair, known, local, float(radiation), absorbed=absorbed, scattering=scattering
    )
    rarefaction = float(np.sqrt(np.pi) / (4.0 * knudsen))
    case = ChamberCase(rarefaction, face, model, chamber, linear)
    began = time.perf_counter()
    report("solving the kinetic equation (compiled once, at its first use)")
    fine, coarse = (solve_chamber_case(case, mesh) for mesh in meshes(linear=case.linear))
    found, other = _results(case, fine), _results(case, coarse)
    errors = {name: difference(found[name], other[name]) for name in _WITH_ERROR}
    closure: dict[str, float] = {}
    said, radius = [], np.linspace(0.0, 1.0, _PROFILE)
    forces = {"disk": fine.totals.force, **fine.totals.forces}
    if fine.totals.forces:
        heats = *fine.totals.heat, *fine.totals.heats.values()
        closure = {
            "force": sum(forces.values()) / sum(map(abs, forces.values())),
            "heat": sum(heats) / sum(map(abs, heats)),
        }
    for name in ("force", "heat"):
        error, whole = errors[name], found[name]
        if error is not None and whole is not None and error > _LARGE_ERROR * abs(whole):
            said.append(
                f"{name} changes by {error:.1e} with the mesh, more than "
                f"{100.0 * _LARGE_ERROR:g} % of its value"
            )
    return ChamberSolution(
        knudsen=float(knudsen),
        force_ratio=found["force_ratio"],
        heat_ratio_top=found["heat_ratio_top"],
        heat_ratio_bottom=found["heat_ratio_bottom"],
        heat_ratio=found["heat_ratio"],
        forces=forces,
        heats={"disk": sum(fine.totals.heat), **fine.totals.heats},
        error_estimate=errors,
        closure=closure,
        imbalance=fine.imbalance if case.film.local else None,
        absorbed=fine.absorbed,
        film_radius=radius,
        film_temperature=fine.film_at(radius),
        iterations=fine.iterations,
        seconds=time.perf_counter() - began,
        warnings=tuple(said),
        _case=case,
        _outcome=fine,
    )


_PROFILE = 21  # points from the centre to the edge of the film
_WITH_ERROR = ("force_ratio", "heat_ratio", "force", "heat")
_LARGE_ERROR = 0.02  # relative change with the coarser mesh of which a result warns


def _results(case: "ChamberCase", outcome: "ChamberOutcome") -> dict[str, float | None]:
    totals, film = outcome.totals, case.film
    weights = outcome.meshes[0].face_weights
    top, bottom = (float(weights @ values) for values in outcome.film)
    temperatures = (top, bottom) if case.linear else (1.0 + top, 1.0 + bottom)
    limit = FreeMolecularDisk(
        film.tac,
        temperatures,
        case.linear,
        case.gas.has_rotation,
        wall=film.wall,
        normal=film.scattering and (film.scattering[0].normal, film.scattering[1].normal),
    )
    return {
        **ratios(totals.force, totals.heat, limit),
        "force": totals.force,
        "heat": sum(totals.heat),
    }


def require_balance(film: str, radiation: float, absorbed: float | None) -> bool:
    """Whether a film balances its heat locally."""
    if film not in BALANCES:
        raise ParameterError(f'film = "{film}" is not {" or ".join(BALANCES)}')
    require_range("radiation", radiation, 0.0)
    local = film == "local"
    if radiation and not local:
        raise ParameterError('radiation belongs to film = "local"')
    if absorbed is not None:
        require_range("absorbed", absorbed, 0.0, open_below=True)
        if not local:
            raise ParameterError('absorbed belongs to film = "local"')
    return local
