"""What a design gives: the outputs of sweeps, optimisations and sensitivities by name."""

import difflib
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import jax.numpy as jnp

from lightflyer.config.sections import FlyerFile
from lightflyer.environment.base import EnvironmentState
from lightflyer.film.properties import FilmProperties
from lightflyer.flight.balance import Equilibrium, equilibrium
from lightflyer.flight.bands import HIGHEST_SEARCHED, AltitudeBand, altitude_band
from lightflyer.flight.fields import build, coordinate_name, dataset_unit
from lightflyer.flight.levitation import Levitation, levitate, weight
from lightflyer.foundation.errors import ConfigurationError
from lightflyer.foundation.files import QUANTITIES
from lightflyer.foundation.types import Numeric


class Design:
    """One design, whose results are computed when they are first asked for.

    Parameters
    ----------
    configuration : FlyerFile
    values : dict of str to array
        Numbers that differ from the flyer file's, by dotted name, the coordinate among them;
        scalars, which may be traced.
    film : FilmProperties, optional
        What the layers of the film give, where it has layers.
    """

    def __init__(
        self,
        configuration: FlyerFile,
        values: Mapping[str, Numeric],
        film: FilmProperties | None = None,
    ):
        self.flyer, self.environment, self.model = build(configuration, values, film)
        self._coordinate = values.get(coordinate_name(configuration))
        section = configuration.environment
        ends = (getattr(section, name, None) for name in ("altitude_min", "altitude_max"))
        self._ends = tuple(None if end is None else end.value for end in ends)
        self.converged: Any = jnp.array(True)

    @cached_property
    def state(self) -> EnvironmentState:
        """Surroundings."""
        return self.environment.state(self._coordinate)

    @cached_property
    def balance(self) -> Equilibrium:
        """Heat balance in the available light."""
        found = equilibrium(self.flyer, self.state, self.model, throw=False)
        self.converged &= found.converged
        return found

    @cached_property
    def levitation(self) -> Levitation:
        """What it takes to levitate."""
        found = levitate(self.flyer, self.state, self.model, throw=False)
        self.converged &= found.converged
        return found

    @cached_property
    def lift(self) -> Any:
        """Force in the available light [N]."""
        return self.model.force(self.flyer, self.state, self.balance.excess)

    @cached_property
    def payload(self) -> Any:
        """Largest payload in the available light [kg]."""
        return self.lift / self.state.gravity - self.flyer.own_mass

    @cached_property
    def band(self) -> AltitudeBand:
        """Widest altitude band in which it levitates."""
        low, high = self._ends
        searched = None
        if low is not None or high is not None:
            lowest, highest = self.environment.coordinate_range
            highest = min(highest, HIGHEST_SEARCHED)
            searched = (lowest if low is None else low, highest if high is None else high)
        found = altitude_band(self.flyer, self.environment, self.model, searched, throw=False)
        self.converged &= found.converged
        return found


@dataclass(frozen=True)
class Output:
    """A result that can be asked for.

    Attributes
    ----------
    units, long_name : str
        As in datasets.
    value : callable
        Of a :class:`Design`.
    over_altitude : bool
        Whether it is found by a search over altitude, so that no altitude is given.
    needs_coordinate : bool
        Whether it depends on where the flyer is.
    """

    units: str
    long_name: str
    value: Callable[[Design], Any]
    over_altitude: bool = False
    needs_coordinate: bool = True

    @property
    def attributes(self) -> dict[str, str]:
        """Of a variable that holds its values."""
        return {"units": self.units, "long_name": self.long_name}


def _at_a_point(name: str, value: Callable[[Design], Any]) -> Output:
    return Output(*QUANTITIES[name], value)


OUTPUTS: dict[str, Output] = {
    "pressure": _at_a_point("pressure", lambda design: design.state.pressure),
    "gas_temperature": _at_a_point("gas_temperature", lambda design: design.state.temperature),
    "temperature": _at_a_point("temperature", lambda design: design.balance.temperature),
    "lift": _at_a_point("lift", lambda design: design.lift),
    "lift_over_weight": _at_a_point(
        "lift_over_weight", lambda design: design.lift / weight(design.flyer, design.state)
    ),
    "payload": _at_a_point("payload", lambda design: design.payload),
    "relative_payload": _at_a_point(
        "relative_payload", lambda design: design.payload / design.flyer.own_mass
    ),
    "levitation_irradiance": _at_a_point(
        "levitation_irradiance", lambda design: design.levitation.irradiance
    ),
    "levitation_temperature": _at_a_point(
        "levitation_temperature", lambda design: design.levitation.temperature
    ),
    "lowest_altitude": Output(
        "m", "lower edge of the widest altitude band", lambda design: design.band.lower, True
    ),
    "highest_altitude": Output(
        "m", "upper edge of the widest altitude band", lambda design: design.band.upper, True
    ),
    "band_width": Output(
        "m",
        "width of the widest altitude band",
        lambda design: jnp.where(
            design.band.exists, design.band.upper - design.band.lower, jnp.zeros(())
        ),
        True,
    ),
    "areal_density": Output(
        "kg m-2",
        "areal density of the film",
        lambda design: design.flyer.film.areal_density,
        needs_coordinate=False,
    ),
    "own_mass": Output(
        "kg", "mass of the flyer", lambda design: design.flyer.own_mass, needs_coordinate=False
    ),
    "absorptance": Output(
        "1",
        "absorptance of the top face for the light",
        lambda design: design.flyer.film.absorptance,
        needs_coordinate=False,
    ),
}
"""All outputs by name."""


def unit_of_output(name: str) -> str:
    """Unit of an output as people write it, empty for a pure number."""
    output = OUTPUTS.get(name)
    return "" if output is None else dataset_unit(output.units)


def check_outputs(names: Sequence[str], configuration: FlyerFile, given: Sequence[str]) -> None:
    """Raise unless all outputs exist and can be computed from what is given.

    Parameters
    ----------
    names : sequence of str
        Of outputs.
    configuration : FlyerFile
    given : sequence of str
        Dotted names of the fields that have values, among them perhaps the coordinate.

    Raises
    ------
    ConfigurationError
        Saying which output is unknown, with the nearest name; or what else it needs.
    """
    if not names:
        raise ConfigurationError(f"names no output; there are: {', '.join(OUTPUTS)}")
    for name in names:
        if name not in OUTPUTS:
            near = difflib.get_close_matches(name, OUTPUTS, n=1, cutoff=0.6)
            hint = f'did you mean "{near[0]}"?' if near else f"there are: {', '.join(OUTPUTS)}"
            raise ConfigurationError(f'"{name}" is not an output; {hint}')
    coordinate = coordinate_name(configuration)
    unit = {"pressure": "Pa", "altitude": "km"}[coordinate]
    for name in names:
        output = OUTPUTS[name]
        if output.over_altitude and coordinate == "pressure":
            raise ConfigurationError(f'"{name}" needs an atmosphere, not a chamber')
        if output.over_altitude and coordinate in given:
            raise ConfigurationError(
                f'"{name}" is searched over all altitudes; leave altitude out, and the outputs '
                "at one altitude to a study of their own"
            )
        if output.needs_coordinate and not output.over_altitude and coordinate not in given:
            raise ConfigurationError(
                f'"{name}" needs {coordinate}, one such as "70 {unit}" or a range of them'
            )


def evaluate(
    configuration: FlyerFile,
    names: Sequence[str],
    values: Mapping[str, Numeric],
    film: FilmProperties | None = None,
) -> tuple[dict[str, Any], Any]:
    """Outputs of one design; to be mapped, compiled and differentiated in double precision.

    Parameters
    ----------
    configuration : FlyerFile
    names : sequence of str
        Of the outputs.
    values : dict of str to array, shape ()
        By dotted name.
    film : FilmProperties, optional
        What the layers of the film give, where it has layers.

    Returns
    -------
    outputs : dict of str to array, shape ()
        An irradiance that no light gives is infinite, an edge that does not exist is NaN.
    converged : bool array, shape ()
    """
    design = Design(configuration, values, film)
    outputs = {name: jnp.asarray(OUTPUTS[name].value(design), float) for name in names}
    return outputs, design.converged
