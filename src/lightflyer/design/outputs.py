"""Outputs of a design: the name, unit and definition of every result, once, for all rooms."""

import difflib
import re
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from lightflyer.array.namespace import xp
from lightflyer.array.records import ShortRepr
from lightflyer.core.errors import ConfigurationError, ParameterError
from lightflyer.core.units import dataset_unit, scale_and_offset
from lightflyer.design.operating_point import OperatingPoint
from lightflyer.design.setup import Setup
from lightflyer.flyer.base import AbstractFlyer
from lightflyer.force.base import ModelResult

# units for larger values, by the one that is shown otherwise
_LARGER = {"mg": ("mg", "g", "kg"), "µN": ("µN", "mN", "N")}
_SMALLER = {"mg": ("fg", "pg", "ng"), "µN": ("fN", "pN", "nN")}  # for what is far below
_MANY, _FEW = 1e4, 1e-3  # numbers from which on a larger, and below which a smaller one is shown
_FEWER = 1e3  # number from which on the larger one of the smaller ones is


def _always(_: AbstractFlyer) -> bool:
    return True


def _is_buoyant(flyer: AbstractFlyer) -> bool:
    kind = type(flyer)
    own = AbstractFlyer.displaced_volume, AbstractFlyer.buoyancy
    return (kind.displaced_volume, kind.buoyancy) != own


def _has_film(flyer: AbstractFlyer) -> bool:
    return hasattr(flyer, "film")


@dataclass(frozen=True)
class Output(ShortRepr):
    """A result that can be asked for."""

    name: str
    unit: str  #: SI unit as files spell it, empty for a pure number
    long_name: str  #: As in datasets and on axes
    #: From a :class:`~lightflyer.design.operating_point.OperatingPoint` to an array in the unit
    value: Callable[[OperatingPoint], Any]
    shown_unit: str = ""  #: Unit in tables and figures
    json_unit: str = ""  #: Unit in JSON, where it ends the name
    less_is_better: bool = False  #: Whether the best design has the least of it
    #: Whether it is found by a search over the coordinate, so that no coordinate is given
    over_band: bool = False
    needs_coordinate: bool = True  #: Whether it depends on where the flyer is
    exists: Callable[[AbstractFlyer], bool] = _always  #: Whether a flyer has it

    @property
    def attributes(self) -> dict[str, str]:
        """Attributes of a dataset's variable that holds its values."""
        described = {"units": dataset_unit(self.unit), "long_name": self.long_name}
        return described | ({"shown_units": self.shown_unit} if self.shown_unit else {})

    @cached_property
    def shown(self) -> tuple[float, str]:
        """Factor from the SI unit to the one shown, and that unit."""
        return _factor(self.unit, self.shown_unit), self.shown_unit or self.unit

    def display_unit_for(self, values: Any) -> tuple[float, str]:
        """Factor and unit that suit some values; returns ``factor``, ``unit``."""
        size = np.abs(np.asarray(values, float))
        largest = float(np.max(size, where=np.isfinite(size), initial=0.0))
        units, most = _LARGER.get(self.shown_unit, (self.shown_unit,)), _MANY
        if 0.0 < largest * self.shown[0] < _FEW and self.shown_unit in _SMALLER:
            units, most = _SMALLER[self.shown_unit], _FEWER
        factors = [_factor(self.unit, unit) for unit in units]
        suitable = (index for index, factor in enumerate(factors) if largest * factor < most)
        index = next(suitable, len(units) - 1)
        return factors[index], units[index] or self.unit

    @cached_property
    def json(self) -> tuple[str, float]:
        """Name in JSON, and factor from the SI unit."""
        unit = self.json_unit or self.unit
        return json_name(self.name, unit), _factor(self.unit, self.json_unit)


def json_name(name: str, unit: str) -> str:
    """Name of a number in JSON, with its unit at the end; ``unit``: as files spell it."""
    status = re.sub(r"[^a-z0-9]+", "_", unit.lower().replace("^", "")).strip("_")
    return f"{name}_{status}" if status else name


def _factor(unit: str, shown: str) -> float:
    return scale_and_offset(unit, shown)[0] if shown and shown != unit else 1.0


_POINT = (
    Output("pressure", "Pa", "gas pressure", lambda case: case.state.pressure),
    Output("gas_temperature", "K", "gas temperature", lambda case: case.state.temperature),
    Output(
        "levitation_irradiance",
        "W/m^2",
        "smallest irradiance that levitates the flyer",
        lambda case: case.levitation.irradiance,
        less_is_better=True,
    ),
    Output(
        "levitation_temperature",
        "K",
        "flyer temperature at the levitation irradiance",
        lambda case: case.levitation.temperature,
    ),
    Output(
        "temperature",
        "K",
        "flyer temperature in the available light",
        lambda case: case.balance.temperature,
        less_is_better=True,
    ),
    Output(
        "lift",
        "N",
        "upward force in the available light",
        lambda case: case.lift,
        shown_unit="µN",
    ),
    Output(
        "lift_over_weight",
        "",
        "lift over weight with payload",
        lambda case: case.lift / case.weight,
    ),
    Output(
        "payload",
        "kg",
        "largest payload in the available light",
        lambda case: case.payload,
        shown_unit="mg",
        json_unit="mg",
    ),
    Output(
        "relative_payload",
        "",
        "largest payload over the flyer's own mass",
        lambda case: case.payload / case.flyer.own_mass,
    ),
    Output(
        "payload_per_area",
        "kg/m^2",
        "largest payload over the area seen from above",
        lambda case: case.payload / case.flyer.area,
        shown_unit="g/m^2",
        json_unit="g/m^2",
    ),
    Output(
        "usable",
        "",
        "whether the flyer levitates in the available light and its film survives",
        lambda case: case.usable,
    ),
    Output(
        "covered",
        "",
        "whether force model and gas are within the ranges in which they are known to hold",
        lambda case: case.covered,
    ),
    Output(
        "buoyancy",
        "N",
        "buoyancy in the available light, a part of the lift",
        lambda case: case.buoyancy,
        shown_unit="µN",
        exists=_is_buoyant,
    ),
    Output(
        "climb_speed",
        "m/s",
        "steady speed upwards in the available light, in still air",
        lambda case: case.climb_speed,
        shown_unit="mm/s",
        exists=lambda flyer: flyer.steady,
    ),
)

_BAND = (
    Output(
        "lowest_altitude",
        "m",
        "lower edge of the widest altitude band",
        lambda case: case.band.lower,
        shown_unit="km",
        less_is_better=True,
        over_band=True,
    ),
    Output(
        "highest_altitude",
        "m",
        "upper edge of the widest altitude band",
        lambda case: case.band.upper,
        shown_unit="km",
        over_band=True,
    ),
    Output(
        "band_width",
        "m",
        "width of the widest altitude band",
        lambda case: xp.where(case.band.exists, case.band.upper - case.band.lower, 0.0),
        shown_unit="km",
        over_band=True,
    ),
)

_VERDICT = (
    Output(
        "rest_temperature",
        "K",
        "flyer temperature where it comes to rest, the highest_altitude",
        lambda case: xp.where(case.rest.exists, case.rest.balance.temperature, np.nan),
        less_is_better=True,
        over_band=True,
    ),
    Output(
        "longest_night",
        "s",
        "time to sink in the dark from where it comes to rest to the lowest_altitude",
        lambda case: case.longest_night,
        shown_unit="h",
        json_unit="h",
        over_band=True,
    ),
    Output(
        "usable_lowest_altitude",
        "m",
        "lower edge of the widest part of the altitude bands that the film survives",
        lambda case: case.usable_band.lower,
        shown_unit="km",
        less_is_better=True,
        over_band=True,
    ),
    Output(
        "usable_highest_altitude",
        "m",
        "upper edge of the widest part of the altitude bands that the film survives",
        lambda case: case.usable_band.upper,
        shown_unit="km",
        over_band=True,
    ),
    Output(
        "usable_payload",
        "kg",
        "largest payload where the film survives, if something holds the flyer there",
        lambda case: case.usable_payload,
        shown_unit="mg",
        json_unit="mg",
        over_band=True,
    ),
    Output(
        "afloat_payload",
        "kg",
        "largest payload with which the flyer stays up by itself, at the peak of lift",
        lambda case: case.peak.payload,
        shown_unit="mg",
        json_unit="mg",
        over_band=True,
    ),
    Output(
        "afloat_temperature",
        "K",
        "flyer temperature at the peak of lift",
        lambda case: case.peak.balance.temperature,
        less_is_better=True,
        over_band=True,
    ),
)

_DESIGN = (
    Output(
        "areal_density",
        "kg/m^2",
        "areal density of the flyer",
        lambda case: case.flyer.own_mass / case.flyer.area,
        shown_unit="g/m^2",
        less_is_better=True,
        needs_coordinate=False,
    ),
    Output(
        "area",
        "m^2",
        "area seen from above when level",
        lambda case: case.flyer.area,
        shown_unit="cm^2",
        needs_coordinate=False,
    ),
    Output(
        "own_mass",
        "kg",
        "mass of the flyer",
        lambda case: case.flyer.own_mass,
        shown_unit="mg",
        needs_coordinate=False,
    ),
    Output(
        "absorptance",
        "",
        "absorptance of the top face for the light",
        lambda case: case.flyer.film.absorptance,
        needs_coordinate=False,
        exists=_has_film,
    ),
)


_BUCKLES = "load_over_buckling"


def _of_shape(name: str, unit: str, long_name: str, **shown: str) -> Output:
    return Output(
        name,
        unit,
        long_name,
        lambda case: getattr(case.shape, name),
        less_is_better=name in ("deflection", "stress_over_strength", "gap_closed", _BUCKLES),
        exists=_knows(name),
        **shown,  # type: ignore[arg-type]
    )


def _knows(name: str) -> Callable[[AbstractFlyer], bool]:
    return lambda flyer: name in flyer.known_shape


_SHAPE = (
    _of_shape("curvature", "1/m", "curvature in the available light; positive where edges rise"),
    _of_shape(
        "deflection",
        "m",
        "height between the middle and the edge in the available light",
        shown_unit="mm",
        json_unit="mm",
    ),
    _of_shape("stress_over_strength", "", "largest tension in a layer over its strength"),
    _of_shape("gap_closed", "", "share of the gap that the membranes close between ligaments"),
    _of_shape(_BUCKLES, "", "compression, or pressure from outside, over that at which it buckles"),
    _of_shape("buckling_pressure", "Pa", "pressure from outside at which its shell buckles"),
    _of_shape("lift_kept", "", "lift of the curled flyer over that of a flat one, in thin gas"),
    _of_shape("lowest_frequency", "Hz", "lowest frequency of the flat flyer, without gas"),
    Output(
        "bearable_acceleration",
        "m/s^2",
        "acceleration at which a layer breaks, held where the payload hangs",
        lambda case: case.shape.bearable_load / case.flyer.own_mass,
        exists=_knows("bearable_load"),
    ),
    Output(
        "bearable_wind",
        "m/s",
        "speed of the air along its axis at which a layer breaks, held so",
        lambda case: case.bearable_wind,
        exists=_knows("bearable_load"),
    ),
)

_BUDGET = (
    Output(
        "payload_needed",
        "kg",
        "mass that the payload needs",
        lambda case: case.needs.mass,
        shown_unit="mg",
        json_unit="mg",
        less_is_better=True,
    ),
    Output(
        "payload_margin",
        "kg",
        "largest payload less the mass that the payload needs",
        lambda case: case.payload - case.needs.mass,
        shown_unit="mg",
        json_unit="mg",
    ),
    Output(
        "power_needed",
        "W",
        "mean power that the payload needs",
        lambda case: case.needs.power,
        shown_unit="µW",
        json_unit="uW",
        less_is_better=True,
    ),
    Output(
        "cell_area",
        "m^2",
        "area of the solar cells that the payload needs",
        lambda case: case.needs.cell_area,
        shown_unit="mm^2",
        json_unit="mm^2",
        less_is_better=True,
    ),
    Output(
        "transmit_power",
        "W",
        "power that the payload's radio sends",
        lambda case: case.needs.transmit_power,
        shown_unit="µW",
        json_unit="uW",
        less_is_better=True,
    ),
)

BUDGET_OUTPUTS: dict[str, Output] = {output.name: output for output in _BUDGET}
"""Outputs of the budget of a payload, by name."""

OUTPUTS: dict[str, Output] = {
    output.name: output for output in (*_POINT, *_SHAPE, *_BAND, *_VERDICT, *_DESIGN)
}
"""Outputs that every flyer has, by name, and those of its film where there is one."""


def shape_outputs(flyer: AbstractFlyer) -> tuple[str, ...]:
    """Names of the outputs of how a flyer holds its shape."""
    return tuple(output.name for output in _SHAPE if output.exists(flyer))


def node_outputs(flyer: AbstractFlyer) -> dict[str, Output]:
    """Outputs of the nodes of a flyer that has several."""
    if len(flyer.nodes) < 2:
        return {}
    found = (
        Output(
            f"temperature_{node}",
            "K",
            f"temperature of the {node} in the available light",
            lambda case, node=node: case.balance.temperature_of(node),  # type: ignore[misc]
        )
        for node in flyer.nodes
    )
    return {output.name: output for output in found}


def budget_outputs(setup: Setup) -> dict[str, Output]:
    """Outputs of the budget of a payload; empty where the setup has no budget."""
    if setup.budget is None:
        return {}
    absent = {
        "cell_area": setup.budget.cells is None,
        "transmit_power": setup.budget.link is None,
    }
    return {name: output for name, output in BUDGET_OUTPUTS.items() if not absent.get(name, False)}


def model_outputs(setup: Setup) -> dict[str, Output]:
    """Outputs of the force model's own, and the flows of the flyer; empty for most models."""
    flows = {name: ModelResult("", name.replace("_", " ")) for name in setup.flyer.flows}
    taken = OUTPUTS.keys() | node_outputs(setup.flyer).keys() | budget_outputs(setup).keys()
    found = {}
    for name, result in (flows | dict(setup.model.results)).items():
        about = f'force model {type(setup.model).__name__}: result "{name}"'
        if name in taken:
            raise ParameterError(f"{about} has the name of an output that every flyer has")
        for unit in filter(None, (result.unit, result.shown_unit)):
            try:
                _factor(result.unit, unit)
            except ConfigurationError as error:
                raise ParameterError(f"{about}: {error}") from None
        found[name] = Output(
            name,
            result.unit,
            result.long_name,
            lambda case, name=name: case.own_results[name],  # type: ignore[misc]
            shown_unit=result.shown_unit,
            json_unit=result.shown_unit,
        )
    return found


def outputs_of(setup: Setup) -> dict[str, Output]:
    """All outputs of a flyer under its force model, by name.

    Parameters
    ----------
    setup : Setup

    Returns
    -------
    dict of str to Output

    Raises
    ------
    ParameterError
        If a result of the model's own has the name of another, or a unit that cannot be read.
    """
    flyer = setup.flyer
    shared = {name: output for name, output in OUTPUTS.items() if output.exists(flyer)}
    return shared | node_outputs(flyer) | model_outputs(setup) | budget_outputs(setup)


def check_outputs(names: Sequence[str], setup: Setup, given: Sequence[str]) -> None:
    """Raise unless all outputs exist and can be computed from what is given."""
    known, coordinate = outputs_of(setup), setup.environment.coordinate
    if not names:
        raise ConfigurationError(f"names no output; choose from {', '.join(known)}")
    for name in names:
        if name not in known:
            near = difflib.get_close_matches(name, known, n=1, cutoff=0.6)
            hint = f'did you mean "{near[0]}"?' if near else f"choose from {', '.join(known)}"
            raise ConfigurationError(f'"{name}" is not an output; {hint}')
        output, where = known[name], coordinate.name
        if output.over_band and where != "altitude":
            raise ConfigurationError(f'"{name}" needs an atmosphere, not a chamber')
        if output.over_band and where in given:
            raise ConfigurationError(
                f'"{name}" is searched over all altitudes; leave altitude out, and give outputs at '
                "one altitude a study of their own"
            )
        if output.needs_coordinate and not output.over_band and where not in given:
            raise ConfigurationError(
                f'"{name}" needs {where}, one such as "70 {coordinate.shown_unit}" or a range '
                "of them"
            )
