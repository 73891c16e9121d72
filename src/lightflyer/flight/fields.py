"""The numbers of a flyer file by their dotted names, and setups in which some are replaced.

A setup is built by the flyer file's own sections, whatever the numbers are: one number, an array,
or a value that JAX traces. So a sweep's designs are what the flyer file would describe.
"""

import difflib
from collections.abc import Mapping
from typing import Any, NamedTuple

from lightflyer.config.sections import RADIANS_PER_DEGREE, ChamberSection, FlyerFile, quantity_of
from lightflyer.film.layered_section import LayeredFilmSection
from lightflyer.film.properties import FilmProperties
from lightflyer.foundation.errors import ConfigurationError
from lightflyer.foundation.quantity import Quantity
from lightflyer.foundation.types import Numeric
from lightflyer.foundation.units import Measured

_SECTIONS = ("flyer", "film", "environment", "force")
_LAYERS = "film.layers"

_FIXED = {
    "altitude_min": "says where bands are searched",
    "altitude_max": "says where bands are searched",
    "pressure_min": "says where bands are searched",
    "pressure_max": "says where bands are searched",
    "latitude": "decides the atmosphere's whole table; give each place a study of its own",
    "longitude": "decides the atmosphere's whole table; give each place a study of its own",
    "f107": "decides the atmosphere's whole table; give each activity a study of its own",
    "f107a": "decides the atmosphere's whole table; give each activity a study of its own",
    "ap": "decides the atmosphere's whole table; give each activity a study of its own",
    "tac_correlation": "is about uncertainties and changes no design",
}

DATASET_UNITS = {
    "": "1",
    "kg/m^2": "kg m-2",
    "kg/m^3": "kg m-3",
    "W/m^2": "W m-2",
    "m/s^2": "m s-2",
    "deg": "degree",
}
"""Spellings of the flyer file's units in datasets, as UDUNITS and CF want them."""


class Field(NamedTuple):
    """A number that describes a design.

    Attributes
    ----------
    name : str
        Dotted, such as ``"film.emittance"``, or ``"altitude"`` or ``"pressure"``.
    quantity : Quantity
        Its unit and range.
    """

    name: str
    quantity: Quantity

    @property
    def attributes(self) -> dict[str, str]:
        """Of a coordinate that holds its values."""
        unit = self.quantity.unit
        words = self.name.replace(".", " ").replace("_", " ")
        return {"units": DATASET_UNITS.get(unit, unit), "long_name": words}


def dataset_unit(unit: str) -> str:
    """A unit as the flyer file writes it, from its spelling in datasets."""
    written = {there: here for here, there in DATASET_UNITS.items()}
    return written.get(unit, unit)


def coordinate_name(configuration: FlyerFile) -> str:
    """Name of the coordinate of a flyer's surroundings: altitude, or pressure in a chamber."""
    return "pressure" if isinstance(configuration.environment, ChamberSection) else "altitude"


def fields(configuration: FlyerFile) -> dict[str, Field]:
    """All numbers of a flyer file that may be varied, and the coordinate of its surroundings.

    Parameters
    ----------
    configuration : FlyerFile

    Returns
    -------
    dict of str to Field
        By dotted name.
    """
    quantities = {
        f"{section}.{name}": quantity
        for section in _SECTIONS
        for name, quantity in _quantities(getattr(configuration, section))
    }
    if isinstance(configuration.film, LayeredFilmSection):
        for number, layer in enumerate(configuration.film.layers):
            for name, quantity in _quantities(layer):
                quantities[f"{_LAYERS}.{number}.{name}"] = quantity
    coordinate = coordinate_name(configuration)
    if coordinate == "pressure":
        quantities[coordinate] = Quantity("Pa", 0.0, open_below=True)
    else:
        quantities[coordinate] = Quantity("m", *configuration.environment.build().coordinate_range)
    return {name: Field(name, quantity) for name, quantity in quantities.items()}


def _quantities(section: Any) -> list[tuple[str, Quantity]]:
    found = []
    for name in type(section).model_fields:
        if name not in _FIXED:
            try:
                found.append((name, quantity_of(type(section), name)))
            except StopIteration:
                continue  # a field that is no number
    return found


def field(configuration: FlyerFile, name: str) -> Field:
    """A number of a flyer file by its dotted name.

    Parameters
    ----------
    configuration : FlyerFile
    name : str

    Returns
    -------
    Field

    Raises
    ------
    ConfigurationError
        If there is no such number, with the nearest name; or if it cannot be varied, with why.
    """
    known = fields(configuration)
    if name in known:
        return known[name]
    last = name.rpartition(".")[2]
    if last in _FIXED:
        raise ConfigurationError(f"{name} cannot be varied: it {_FIXED[last]}")
    near = difflib.get_close_matches(name, known, n=1, cutoff=0.6)
    near = near or [full for full in known if full.rpartition(".")[2] == last]
    hint = f'did you mean "{near[0]}"?' if near else f"there are: {', '.join(known)}"
    raise ConfigurationError(f"{name} is not a number of the flyer file; {hint}")


def shape_film(configuration: FlyerFile, names: list[str]) -> list[str]:
    """Those of some fields for which a film of layers has to be computed anew.

    Parameters
    ----------
    configuration : FlyerFile
    names : list of str
        Dotted.

    Returns
    -------
    list of str
    """
    if not isinstance(configuration.film, LayeredFilmSection):
        return []
    measured = configuration.film.absorptance is not None
    angle = [] if measured else ["environment.incidence"]
    return [name for name in names if name.startswith(_LAYERS) or name in angle]


def build(
    configuration: FlyerFile, values: Mapping[str, Numeric], film: FilmProperties | None = None
) -> tuple[Any, Any, Any]:
    """Flyer, environment and force model of a flyer file with some numbers replaced.

    Parameters
    ----------
    configuration : FlyerFile
    values : dict of str to array, shape (...)
        By dotted name, in the units of the fields; they broadcast and may be traced. They are
        not checked. A coordinate among them plays no part.
    film : FilmProperties, optional
        What the layers of the film give, where it has layers; by default it is computed, which
        takes concrete layers.

    Returns
    -------
    flyer : AbstractFlyer
    environment : AbstractEnvironment
    model : AbstractForceModel
    """
    by_section: dict[str, dict[str, Any]] = {section: {} for section in _SECTIONS}
    for name, value in values.items():
        section, _, key = name.rpartition(".")
        if section in by_section:
            by_section[section][key] = Measured(value)
    sections = {
        name: getattr(configuration, name).model_copy(update=update)
        for name, update in by_section.items()
        if name != "film"
    }
    incidence = sections["environment"].incidence.value * RADIANS_PER_DEGREE
    if isinstance(configuration.film, LayeredFilmSection):
        properties = configuration.film.build(incidence) if film is None else film
        properties = _replace(configuration.film, properties, by_section["film"])
    else:
        properties = _with_faces(configuration.film, by_section["film"]).build()
    return (
        sections["flyer"].build(properties),
        sections["environment"].build(),
        sections["force"].build(),
    )


def film_of(configuration: FlyerFile, values: Mapping[str, float]) -> FilmProperties:
    """Properties of a film of layers with some of its numbers replaced.

    Parameters
    ----------
    configuration : FlyerFile
        Its film has layers.
    values : dict of str to float
        By dotted name; concrete or traced.

    Returns
    -------
    FilmProperties
    """
    section = configuration.film
    assert isinstance(section, LayeredFilmSection)
    layers = list(section.layers)
    for name, value in values.items():
        if name.startswith(_LAYERS):
            _, _, number, key = name.split(".")
            layers[int(number)] = layers[int(number)].model_copy(update={key: Measured(value)})
    degrees = values.get("environment.incidence", configuration.environment.incidence.value)
    moved = section.model_copy(update={"layers": tuple(layers)})
    return moved.build(degrees * RADIANS_PER_DEGREE)


def _with_faces(section: Any, update: dict[str, Any]) -> Any:
    """The section of measured properties; one emittance stands for both faces."""
    if "emittance" in update:
        update = {"emittance_top": None, "emittance_bottom": None} | update
    return section.model_copy(update=update)


def _replace(
    section: LayeredFilmSection, film: FilmProperties, update: dict[str, Any]
) -> FilmProperties:
    """Computed properties with values in their place, as if they had been measured."""
    given = {name: measured.value for name, measured in update.items()}
    if "emittance" in given:
        both = given.pop("emittance")
        given = {"emittance_top": both, "emittance_bottom": both} | given
    if "absorptance" in given and section.absorptance_bottom is None:
        given.setdefault("absorptance_bottom", None)  # the top's then stands for both
    if not given:
        return film
    parts = {name: getattr(film, name) for name in film.__dataclass_fields__}
    return type(film)(**parts | given)
