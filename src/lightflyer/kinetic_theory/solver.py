"""The disk problem: force and heat relative to their free-molecular values, with errors."""

import time
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, Any

import numpy as np

from lightflyer.array.records import ShortRepr
from lightflyer.core.checks import require_range
from lightflyer.core.errors import ParameterError
from lightflyer.core.extras import extra
from lightflyer.core.progress import report
from lightflyer.core.quantity import HIGHEST_OPEN_FRACTION
from lightflyer.kinetic_theory.model_gases import gas_model
from lightflyer.kinetic_theory.walls import CERCIGNANI_LAMPIS, WALLS, Accommodation, walls_of

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from lightflyer.kinetic_theory.collisions.brackets import Molecule
    from lightflyer.kinetic_theory.disk.cases import Case, DiskOutcome
    from lightflyer.kinetic_theory.walls import FreeMolecularDisk

KNUDSEN_RANGE = (0.03, 100.0)  # Knudsen numbers λ(T_c)/(2r) for which the meshes are made
TEMPERATURE_RATIOS = (0.5, 3.5)  # T_h/T_c for which the non-linear solver is tested
SMALLEST_BOUNDARY = 1.5  # Half-width of the smallest reservoir [disk radii]

FURTHEST_DEPTH = 150.0
"""Half-width of the largest reservoir that the meshes resolve, in lengths 2λ/√π."""


_NITROGEN_COLLISIONS = 5.0  # near 300 K


@dataclass(frozen=True)
class Solution(ShortRepr):
    r"""Force and heat of a disk relative to their free-molecular values, and the flow.

    The free-molecular values are those of the same disk, holes included.
    """

    knudsen: float  #: λ(T_c)/(2r)
    force_ratio: float | None  #: F/F_fm; None where the free-molecular force is zero
    #: Q/Q_fm of each face; None for a face at the temperature of the gas
    heat_ratio_top: float | None
    heat_ratio_bottom: float | None  #: As ``heat_ratio_top``
    heat_ratio: float | None  #: Q/Q_fm of both faces together
    #: Numerical error of ``force_ratio`` and ``heat_ratio``: their change with a coarser mesh. It
    #: excludes the error of the model equation; with VHS molecules their change with a coarser mesh
    #: and fewer moments
    error_estimate: dict[str, float | None]
    iterations: int
    seconds: float  #: Time of the solution on both meshes
    force: float  #: Upwards [p·A], per unit perturbation in the linear problem
    heat: tuple[float, float]  #: Out of the top and bottom face [p √(2RT_c) A], likewise
    _case: "Case" = field(repr=False)
    _outcome: "DiskOutcome" = field(repr=False)

    @property
    def is_linear(self) -> bool:
        """Whether the problem is linear."""
        return self._case.linear

    @property
    def is_model(self) -> bool:
        """Whether a model equation stands for the collisions."""
        return self._case.molecule is None

    @property
    def boundary(self) -> float:
        """Half-width of the reservoir [disk radii], infinite in open space."""
        return self._case.boundary

    @property
    def inputs(self) -> dict[str, Any]:
        """Arguments of :func:`solve`, by name."""
        case = self._case
        top, bottom = case.temperature
        heated = (
            {"top_temperature": top, "bottom_temperature": bottom}
            if case.linear
            else {"temperature_ratio": [top, bottom]}
        )
        collisions: dict[str, Any] = {"collisions": "shakhov"}
        if case.molecule is not None:
            exponent = case.molecule.viscosity_exponent
            collisions = {"collisions": "vhs", "viscosity_exponent": exponent}
            if case.molecule.rotates:
                collisions["collision_number"] = 1.0 / case.molecule.exchange
        return {
            "knudsen": self.knudsen,
            "tac_top": case.tac[0],
            "tac_bottom": case.tac[1],
            **heated,
            "open_fraction": case.open_fraction,
            "gas": case.gas.name,
            "wall": case.wall_name,
            **describe_faces(case.scattering),
            "boundary": self.boundary if np.isfinite(self.boundary) else None,
            **collisions,
        }

    @property
    def title(self) -> str:
        """The problem in words."""
        case = self._case
        top, bottom = (f"{value:g}" for value in case.temperature)
        both = top if top == bottom else f"{top} and {bottom}"
        heated = f"linear, perturbation {both}" if case.linear else f"T_h/T_c {both}"
        is_open = np.isinf(self.boundary)
        where = "open space" if is_open else f"reservoir at {self.boundary:g} radii"
        holes = f"open fraction {case.open_fraction:g}, " if case.open_fraction else ""
        gas = case.gas.name
        if case.molecule is not None:
            gas += f" VHS molecules of exponent {case.molecule.viscosity_exponent:g}"
        return (
            f"Kn {self.knudsen:g}, TAC {case.tac[0]:g} top, {case.tac[1]:g} bottom, "
            f"{WALLS[case.wall_name]}, {holes}{gas}, {heated}, {where}"
        )

    def plot(self, ax: "Axes | None" = None) -> "Figure":
        """Draw temperature and streamlines of the gas in a plane through the axis."""
        from lightflyer.kinetic_theory.figures import flow_figure

        return flow_figure(self, ax)

    def to_json(self) -> dict[str, Any]:
        """The solution as a JSON object."""
        return {
            "kn": self.knudsen,
            "force_ratio": self.force_ratio,
            "heat_ratio_top": self.heat_ratio_top,
            "heat_ratio_bottom": self.heat_ratio_bottom,
            "heat_ratio": self.heat_ratio,
            "error_estimate": self.error_estimate,
            "iterations": self.iterations,
            "seconds": round(self.seconds, 3),
        }

    def flow(self, radius: Any, height: Any) -> dict[str, np.ndarray]:
        """Fields of the gas at points [√(2RT_c)]; ``radius``, ``height`` [disk radii]."""
        from lightflyer.kinetic_theory.disk.cases import sample

        return sample(self._outcome, np.asarray(radius, float), np.asarray(height, float))


def solve(
    knudsen: float,
    tac_top: float,
    tac_bottom: float,
    *,
    top_temperature: float = 1.0,
    bottom_temperature: float = 1.0,
    temperature_ratio: float | tuple[float, float] | None = None,
    open_fraction: float = 0.0,
    gas: str = "monatomic",
    wall: str = "maxwell",
    tangential_accommodation: float | tuple[float, float] | None = None,
    rotational_accommodation: float | tuple[float, float] | None = None,
    boundary: float | None = None,
    collisions: str = "shakhov",
    viscosity_exponent: float | None = None,
    collision_number: float | None = None,
) -> Solution:
    r"""Solve the kinetic equation around a thin disk, or one with holes.

    Without ``temperature_ratio`` the linearised Shakhov equation is solved (of Rykov's type for a
    diatomic gas), with it the non-linear one with a viscosity :math:`\mu \propto T^\omega`. With
    ``collisions="vhs"`` the linear problem has the collision operator of VHS molecules in place of
    a model equation. Results are relative to the exact free-molecular values for the same wall,
    linear or non-linear.

    Parameters
    ----------
    knudsen : float
        λ(T_c)/(2r) with λ = (μ/p) √(πRT/2), from 0.03 to 100.
    tac_top, tac_bottom : float
        Accommodation coefficient of each face, above 0 and up to 1.
    top_temperature, bottom_temperature : float
        Temperature perturbation of each face in the linear problem.
    temperature_ratio : float or (float, float), optional
        T_h/T_c of both faces, or of the top and bottom face, from 0.5 to 3.5.
    open_fraction : float
        Share of the molecules arriving at a face that pass to its other side unchanged, from 0 to
        0.999: holes much smaller than the mean free path. The TACs are those of the rest.
    gas : {"monatomic", "diatomic"}
    wall : {"maxwell", "accommodated", "cercignani-lampis"}
        At Maxwell's the share TAC of the molecules leaves a face diffusely at its temperature, and
        the rest is reflected specularly. Accommodated, all leave diffusely at one temperature, so
        that the TAC is the share of the energy that face and arriving molecules could exchange.
        At those of Cercignani and Lampis normal motion, tangential motion and rotation accommodate
        each on its own, and the TAC is that of their energy together; with a model equation. In
        the linear problem they are exact. In the non-linear one what leaves is a Maxwellian of
        three temperatures, by which the force is within 0.6 % where normal energy accommodates to
        0.4 or more and the Knudsen number is at least 0.1.
    tangential_accommodation, rotational_accommodation : float or (float, float), optional
        Accommodation coefficients of tangential momentum and of rotational energy of both faces,
        or of the top and bottom face, at such walls, from 0 to 1. By default tangential and
        rotational energy accommodate as the TAC says; the normal motion follows.
    boundary : float, optional
        Half-width and half-height of a cylindrical reservoir at T_c [disk radii], at least 1.5
        and up to 338 Kn; by default open space.
    collisions : {"shakhov", "vhs"}
        A model equation, or molecules that scatter isotropically with a cross-section by which
        :math:`\mu \propto T^\omega`; these in the linear problem and without holes only.
    viscosity_exponent : float, optional
        ω of VHS molecules, from 0.5 (hard spheres) to 1; by default 0.66, or 0.74 with rotation.
    collision_number : float, optional
        Inverse probability that a diatomic VHS molecule exchanges rotational energy in a
        collision by Larsen and Borgnakke's rule, at least 1; by default 5, nitrogen's.

    Returns
    -------
    Solution

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
    [Shakhov1968]_; [Rykov1975]_ and [Wu2015]_ for a diatomic gas, whose constants are nitrogen's
    ([Bird1994]_, [LemmonJacobsen2004]_); [Bird1994]_ for VHS molecules;
    [CercignaniLampis1971]_, [Lord1991]_. Compared with
    [Plimpton2019]_ and [Schafer2025]_.

    Examples
    --------
    >>> from lightflyer.kinetic_theory import solve
    >>> solution = solve(1.0, 0.8, 0.9)
    >>> round(solution.force_ratio, 3), round(solution.heat_ratio, 3)
    (0.794, 0.934)
    """
    tac, stated = (tac_top, tac_bottom), (tangential_accommodation, rotational_accommodation)
    require_range("knudsen", knudsen, *KNUDSEN_RANGE)
    for name, value in zip(("tac_top", "tac_bottom"), tac, strict=True):
        require_range(name, value, 0.0, 1.0, open_below=True)
    require_range("open_fraction", open_fraction, 0.0, HIGHEST_OPEN_FRACTION)
    if boundary is not None:
        require_range("boundary", boundary, SMALLEST_BOUNDARY)
        furthest = furthest_boundary(knudsen)
        if boundary > furthest:
            raise ParameterError(
                f"boundary = {boundary:g} exceeds {furthest:.3g}, the largest resolved at "
                f"knudsen = {knudsen:g}; omit it: the effect of a reservoir falls as 1/boundary"
            )
    model = gas_model(gas)
    linear = temperature_ratio is None
    known, scattering = walls_of(wall, tac, *stated, rotates=model.has_rotation)
    if temperature_ratio is None:
        temperature = top_temperature, bottom_temperature
        require_range("top_temperature", top_temperature)
        require_range("bottom_temperature", bottom_temperature)
    else:
        top, bottom = np.broadcast_to(temperature_ratio, 2)
        temperature = float(top), float(bottom)
        require_range("temperature_ratio", temperature, *TEMPERATURE_RATIOS)
    if all(value == (0.0 if linear else 1.0) for value in temperature):
        raise ParameterError("both faces are at the gas temperature: force and heat are zero")
    extra("numba", "the kinetic solver", "kinetic")
    from lightflyer.kinetic_theory.disk.cases import SMALLEST_ERROR, Case, meshes, solve_case

    case = Case(
        rarefaction=float(np.sqrt(np.pi) / (4.0 * knudsen)),
        tac=(float(tac[0]), float(tac[1])),
        temperature=(float(temperature[0]), float(temperature[1])),
        linear=linear,
        gas=model,
        boundary=np.inf if boundary is None else float(boundary),
        open_fraction=float(open_fraction),
        wall=known,
        scattering=scattering,
    )
    molecule = _molecule(case, collisions, viscosity_exponent, collision_number)
    began = time.perf_counter()
    report("solving the kinetic equation (compiled once, at its first use)")
    if molecule is None:
        fine, coarse = (solve_case(case, mesh) for mesh in meshes(knudsen, linear=case.linear))
    else:
        from lightflyer.kinetic_theory.collisions.problem import solve_at_two_levels

        case = replace(case, molecule=molecule)
        fine, coarse = solve_at_two_levels(case, molecule)
    limit = case.free_molecular()
    found, other = (ratios(one.force, one.heat, limit) for one in (fine, coarse))
    errors = {
        name: difference(found[name], other[name], least) for name, least in SMALLEST_ERROR.items()
    }
    return Solution(
        knudsen=float(knudsen),
        **found,
        error_estimate=errors,
        iterations=fine.iterations,
        seconds=time.perf_counter() - began,
        force=fine.force,
        heat=fine.heat,
        _case=case,
        _outcome=fine,
    )


def _molecule(
    case: "Case", collisions: str, exponent: float | None, number: float | None
) -> "Molecule | None":
    """Molecules of the real collision operator, or none for the model equation."""
    if collisions == "shakhov":
        for name, value in (("viscosity_exponent", exponent), ("collision_number", number)):
            if value is not None:
                raise ParameterError(f'{name} belongs to collisions = "vhs"')
        return None
    if collisions != "vhs":
        raise ParameterError(f'collisions = "{collisions}" is not shakhov or vhs')
    if not case.linear:
        raise ParameterError(
            'collisions = "vhs" is for the linear problem: omit temperature_ratio, or use '
            "direct simulation"
        )
    if case.scattering:
        raise ParameterError(f'wall = "{CERCIGNANI_LAMPIS}" belongs to collisions = "shakhov"')
    if case.open_fraction:
        raise ParameterError('open_fraction must be 0 with collisions = "vhs"')
    from lightflyer.kinetic_theory.collisions.brackets import Molecule

    rotates = case.gas.has_rotation
    if number is not None and not rotates:
        raise ParameterError('collision_number belongs to gas = "diatomic"')
    if exponent is None:
        exponent = case.gas.viscosity_exponent
    number = _NITROGEN_COLLISIONS if number is None else number
    require_range("viscosity_exponent", exponent, 0.5, 1.0)
    require_range("collision_number", number, 1.0)
    return Molecule(float(exponent), 1.0 / number if rotates else 0.0, rotates)


def furthest_boundary(knudsen: float) -> float:
    """Half-width of the largest reservoir that is resolved at a Knudsen number [disk radii]."""
    return FURTHEST_DEPTH * 4.0 * knudsen / float(np.sqrt(np.pi))


def describe_faces(faces: "tuple[Accommodation, ...] | None") -> dict[str, Any]:
    """Arguments that state faces of Cercignani and Lampis."""
    if faces is None:
        return {}
    _, tangential, rotational = (list(values) for values in zip(*faces, strict=True))
    return {"tangential_accommodation": tangential, "rotational_accommodation": rotational}


def ratios(
    force: float, heat: tuple[float, float], limit: "FreeMolecularDisk"
) -> dict[str, float | None]:
    """Force and heats over the free-molecular ones [1]."""
    top, bottom = (_quotient(*pair) for pair in zip(heat, limit.heat, strict=True))
    return {
        "force_ratio": _quotient(force, limit.force),
        "heat_ratio_top": top,
        "heat_ratio_bottom": bottom,
        "heat_ratio": _quotient(sum(heat), sum(limit.heat)),
    }


def _quotient(value: float, limit: float) -> float | None:
    return None if abs(limit) < 1e-12 else float(value / limit)


def difference(fine: float | None, coarse: float | None, least: float = 0.0) -> float | None:
    """Numerical error by a coarser mesh."""
    return None if fine is None or coarse is None else max(abs(fine - coarse), least)
