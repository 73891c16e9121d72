r"""Flyers that carry one payload together, each on a tether of its own.

The flyers lie side by side in one flat layer, in a triangular lattice, and the payload hangs at a
depth :math:`H` below the layer's middle. The tether of a flyer at the distance :math:`\rho` from
the middle makes the angle :math:`\psi = \arctan(\rho/H)` with the vertical. The flyer tilts
outwards by :math:`\beta`, so that it balances weight :math:`w` and pull :math:`S`,

.. math::
    F\cos\beta = w + S\cos\psi, \qquad F\sin\beta = S\sin\psi
    \quad\Rightarrow\quad S = \sqrt{F^2 - w^2\sin^2\psi} - w\cos\psi

and the payload has :math:`S\cos\psi` of it. Tethers are straight, and their weight counts as the
flyer's.
"""

import math
from dataclasses import dataclass
from typing import Any

import numpy as np

from lightflyer.array.namespace import Numeric
from lightflyer.config.designs import as_design
from lightflyer.core.errors import ParameterError
from lightflyer.core.quantity import (
    Altitude,
    Checked,
    Density,
    Distance,
    LinearDensity,
    Mass,
    Modulus,
)
from lightflyer.design.diagnostics import diagnose
from lightflyer.environment.base import AbstractEnvironment, Place
from lightflyer.files.display_units import amount
from lightflyer.files.result_text import Parts, PrintedResult, rows_of, warning_lines
from lightflyer.force.base import AbstractForceModel
from lightflyer.statics.balance import equilibrium
from lightflyer.statics.loads import payload as payload_of

CLOSE = 3.0
"""Distance of neighbours, over their diameter, below which a warning says that they are close."""

MOST = 1_000_000  # Flyers of one swarm at most

_ALTITUDE_STEP = 250.0  # metres, of the search for the best altitude
_STEEPNESS = 2.0  # depth of the payload over the layer's radius, where none is given
_AREA_OF_ONE = 0.5 * math.sqrt(3.0)  # of the square of the spacing, in a triangular lattice
_LARGE_TILT = math.radians(15.0)  # the cosine, which the light goes with, is then 3 % off


class Tether(Checked):
    """What holds a payload below a flyer.

    Attributes
    ----------
    linear_density : array
        Mass over length [kg/m]; a fibre of 3 µm of polyethylene has 7e-9.
    density : array or None
        Of its material [kg/m³], for how strong it is; None where that is not asked.
    strength : array or None
        Tension at which its material breaks [Pa].
    """

    linear_density: LinearDensity = 0.0
    density: Density | None = None
    strength: Modulus | None = None

    @property
    def breaking_load(self) -> Numeric | None:
        """Pull at which it breaks [N]; None where its material is not known."""
        if self.density is None or self.strength is None:
            return None
        return self.strength * self.linear_density / self.density


class _Wanted(Checked):
    """What is to be carried; checks its numbers."""

    payload: Mass
    altitude: Altitude | None = None
    spacing: Distance | None = None
    depth: Distance | None = None


@dataclass(frozen=True, repr=False)
class Swarm(PrintedResult):
    """Flyers that carry one payload on tethers."""

    count: int  #: Flyers
    altitude: float  #: [m]
    spare_lift: float  #: What a level flyer lifts beside its own weight [N]
    layer_radius: float  #: Radius of the layer, and how far the payload hangs below it [m]
    depth: float  #: Radius of the layer, and how far the payload hangs below it [m]
    longest_tether: float  #: [m]
    tether_mass: float  #: Of all tethers together [kg]
    largest_pull: float  #: Of a tether [N]
    largest_tilt: float  #: Of the outermost flyers, outwards [rad]
    warnings: tuple[str, ...]

    def text_parts(self) -> Parts:
        yield rows_of(
            {
                "flyers": str(self.count),
                "altitude": amount(self.altitude, "m"),
                "spare lift of one": amount(self.spare_lift, "N", 4),
                "radius of the layer": amount(self.layer_radius, "m", 4),
                "depth of the payload": amount(self.depth, "m", 4),
                "longest tether": amount(self.longest_tether, "m", 4),
                "mass of all tethers": amount(self.tether_mass, "kg", 4),
                "largest pull": amount(self.largest_pull, "N", 4),
                "largest tilt": f"{math.degrees(self.largest_tilt):.3g}°",
            }
        )
        yield from warning_lines(self.warnings)


def tethered_swarm(
    what: Any,
    environment: AbstractEnvironment | None = None,
    model: AbstractForceModel | None = None,
    *,
    payload: Any,
    altitude: Any = None,
    place: Place | None = None,
    spacing: Any = None,
    depth: Any = None,
    tether: Tether | None = None,
) -> Swarm:
    """How many flyers carry one payload together.

    Parameters
    ----------
    what : AbstractFlyer, Setup, FlyerFile, path of a flyer file, or AbstractDesign
        One of the flyers, level; its own payload has no effect.
    environment, model : optional
        Where ``what`` is a flyer.
    payload : float
        Mass to carry [kg].
    altitude : float, optional
        [m]; by default that at which one flyer carries most.
    place : Place, optional
        Where and when.
    spacing : float, optional
        Distance of neighbours [m]; by default three diameters.
    depth : float, optional
        Of the payload below the layer [m]; by default twice the layer's radius.
    tether : Tether, optional
        By default without mass.

    Returns
    -------
    Swarm

    Raises
    ------
    ParameterError
        If a flyer does not lift itself, the tether included, or a million do not carry the payload.

    Notes
    -----
    The force on a tilted flyer is taken to be that on a level one, which for light from above is
    right to 3 % at 15°. Neighbours share neither gas, heat nor shadow here.

    Examples
    --------
    >>> import lightflyer as lf
    >>> film = lf.FilmProperties(1e-3, 0.75, 0.08, 0.08, tac_top=0.8, tac_bottom=0.9)
    >>> setup = lf.Setup(lf.Disk(film, radius=0.01), lf.Earth(), lf.Lu2023())
    >>> found = lf.mission.tethered_swarm(setup, payload="1 g")
    >>> print(f"{found.count} flyers at {found.altitude / 1e3:g} km")
    3267 flyers at 72 km
    """
    setup = as_design(what, environment, model).setup
    wanted = _Wanted(payload, altitude, spacing, depth)
    if wanted.altitude is None:
        low, high = setup.searched
        tried = np.linspace(low, high, 1 + max(1, round((high - low) / _ALTITUDE_STEP)))
        states = setup.environment.state(tried, place)
        carried = payload_of(setup.flyer, states, setup.model, throw=False)
        altitude = float(tried[int(np.nanargmax(carried))])
    else:
        altitude = float(wanted.altitude)
    state = setup.environment.state(altitude, place)
    gravity = float(state.gravity)
    spare = float(payload_of(setup.flyer, state, setup.model)) * gravity
    if spare <= 0.0:
        raise ParameterError(f"the flyer does not lift itself at {altitude / 1e3:g} km")
    diameter = 2.0 * math.sqrt(float(setup.flyer.area) / math.pi)
    between = CLOSE * diameter if wanted.spacing is None else float(wanted.spacing)
    if between < diameter:
        raise ParameterError(
            f"spacing = {between:g} m is less than the diameter of a flyer, {diameter:g} m"
        )
    tether = Tether() if tether is None else tether
    thread, limit = float(tether.linear_density), tether.breaking_load
    own = float(setup.flyer.own_mass) * gravity
    layer = _Layer(own, spare, thread * gravity, between, wanted.depth)
    count = layer.fewest(float(wanted.payload) * gravity)
    pulls, lengths, tilts = layer.pulls(count)
    pull, tilt, apart = float(pulls.max()), float(tilts.max()), between / diameter
    temperature = equilibrium(setup.flyer, state, setup.model).temperature
    warnings = list(diagnose(setup, state, temperature))
    if apart < CLOSE:
        warnings.append(
            f"neighbours are {apart:.2g} diameters apart: they share gas and heat, not counted here"
        )
    if tilt > _LARGE_TILT:
        warnings.append(
            f"the outermost flyers tilt by {math.degrees(tilt):.0f}°, at which they have less light"
        )
    if limit is not None and pull > float(limit):
        warnings.append(f"a tether is pulled by {pull:.3g} N and breaks at {float(limit):.3g} N")
    return Swarm(
        count, altitude, spare, layer.radius(count), layer.depth_of(count), float(lengths.max()),
        thread * float(lengths.sum()), pull, tilt, tuple(warnings),
    )  # fmt: skip


@dataclass(frozen=True)
class _Layer:
    """Weight and spare lift of a flyer [N], a tether's weight [N/m], distances [m]."""

    own: float
    spare: float
    thread: float
    spacing: float
    depth: Any

    def radius(self, count: int) -> float:
        """Radius of a layer of so many flyers."""
        return self.spacing * math.sqrt(_AREA_OF_ONE * count / math.pi)

    def depth_of(self, count: int) -> float:
        """Depth of the payload below so many."""
        return _STEEPNESS * self.radius(count) if self.depth is None else float(self.depth)

    def carried_weight(self, count: int) -> float:
        """Weight that so many carry [N]."""
        pulls, lengths, _ = self.pulls(count)
        return float(np.sum(pulls * self.depth_of(count) / lengths))

    def pulls(self, count: int) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Pull of each of so many tethers [N], their lengths [m], tilts of the flyers [rad]."""
        # rings of equal area around the middle, one a flyer
        distance = self.radius(count) * np.sqrt((np.arange(count) + 0.5) / count)
        depth = self.depth_of(count)
        angle, length = np.arctan2(distance, depth), np.hypot(distance, depth)
        force, hanging = self.own + self.spare, self.own + self.thread * length
        across = np.square(force) - np.square(hanging * np.sin(angle))
        pull = np.sqrt(np.maximum(across, 0.0)) - hanging * np.cos(angle)
        tilts = np.arcsin(np.clip(pull * np.sin(angle) / force, -1.0, 1.0))
        return pull, length, tilts

    def fewest(self, weight: float) -> int:
        """Fewest flyers that carry a weight [N]."""
        if weight <= 0.0:
            raise ParameterError("there is nothing to carry: the payload is zero")
        low, high = 0, 1
        while self.carried_weight(high) < weight:
            low, high = high, 2 * high
            if low > MOST:
                raise ParameterError(
                    f"{MOST} flyers on such tethers do not carry it; the tethers may weigh too much"
                )
        while high - low > 1:
            middle = (low + high) // 2
            if self.carried_weight(middle) >= weight:
                high = middle
            else:
                low = middle
        return high
