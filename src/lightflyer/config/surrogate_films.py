"""Films of a flyer file whose thicknesses a search changes."""

from collections.abc import Callable, Mapping, Sequence
from typing import Any

from lightflyer.array.namespace import Numeric
from lightflyer.core.errors import ConfigurationError
from lightflyer.film.layer_section import OF_NO_MEDIUM
from lightflyer.film.optics.stack import Film
from lightflyer.film.optics.thickness_surrogate import ThicknessSurrogate
from lightflyer.film.properties import FilmProperties

_MEASURED = 1.0  # in place of a number that the section always replaces


class SurrogateFilms:
    """Properties of a flyer file's films of layers, for other thicknesses or another incidence."""

    # Implements :class:`~lightflyer.design.design.Surrogate`.

    def __init__(
        self,
        films: Mapping[str, Any],
        incidence_keys: Sequence[str],
        replaced: Callable[[Mapping[str, Numeric]], Mapping[str, Any]],
        names: Sequence[str] = (),
        *,
        passing: bool,
    ):
        self._directions = [f"environment.{key}" for key in incidence_keys]
        self._passing = passing
        self._parts_with = replaced
        for name in names:
            if not self.knows(name):
                raise ConfigurationError(
                    f"{name} changes the index of a layer; a search frees thicknesses only: fix "
                    "it or sweep it"
                )
        layered = {name: film for name, film in films.items() if film.layered}
        for name, section in layered.items():
            require_simple(name, section.film())
        self.tables = {
            name: ThicknessSurrogate.of(section.film(), section.light())
            for name, section in layered.items()
        }

    def knows(self, name: str) -> bool:
        """Whether a number leaves the indices of all layers alone."""
        return name in self._directions or name.rpartition(".")[2] in OF_NO_MEDIUM

    def __call__(
        self, values: Mapping[str, Numeric], tables: Mapping[str, ThicknessSurrogate]
    ) -> dict[str, FilmProperties]:
        """Properties of the films by name, to be traced."""
        parts = self._parts_with(values)
        incidence = parts["environment"].light_incidence
        return {
            name: _properties(part_at(parts, name), family, incidence, self._passing)
            for name, family in tables.items()
        }


def _properties(
    section: Any, family: ThicknessSurrogate, incidence: Numeric, passing: bool
) -> FilmProperties:
    film = section.film()
    optics = family.properties(film.homogeneous().thickness, incidence, passing=passing)
    density = _MEASURED if section.areal_density is not None else film.areal_density
    built: FilmProperties = section.with_optics(
        FilmProperties(areal_density=density, tac_top=_MEASURED, tac_bottom=_MEASURED, **optics)
    ).build()
    return built


def require_simple(name: str, film: Film) -> None:
    """Raise unless a film is one that a search can compute quickly; ``name``: of its section."""
    smooth = film.roughness_below is None and all(one.roughness is None for one in film.layers)
    whole = film.free_standing and film.open_fraction is None
    if not (smooth and whole and all(one.coherent for one in film.layers)):
        raise ConfigurationError(
            f"[{name}]: a search over thicknesses knows only smooth, coherent layers without "
            "holes; sweep this film"
        )


def part_at(parts: Mapping[str, Any], name: str) -> Any:
    """Section at a dotted name, such as ``"flyer.top"``."""
    first, *inner = name.split(".")
    part: Any = parts.get(first)
    for key in inner:
        part = part[int(key)] if key.isdigit() else getattr(part, key)
    return part
