"""A film as layers, top to bottom."""

import dataclasses
from collections.abc import Callable
from typing import Any, Literal, TypeAlias, get_args

import numpy as np

from lightflyer.array.namespace import Numeric, xp
from lightflyer.array.records import field
from lightflyer.core.checks import is_traced, require_positive, require_range
from lightflyer.core.errors import ParameterError
from lightflyer.core.quantity import (
    Checked,
    Length,
    OpenFraction,
    Quantity,
    Roughness,
    Thickness,
    require_fit,
    require_record,
)
from lightflyer.film.media.compound import indices
from lightflyer.film.media.medium import Medium, common_range
from lightflyer.film.optics.transfer_matrix import (
    StackOptics,
    Structure,
    ellipsometric_angles,
    structured_optics,
)

Side: TypeAlias = Literal["top", "bottom"]

GRAZING = np.nextafter(np.pi / 2, 0.0)

_UNITS = ((1e-9, "nm"), (1e-6, "µm"), (1e-3, "mm"))
_TOO_MANY = 1e4  # of a unit, so that the next one is written

_METRES, _RADIANS = Quantity("m"), Quantity("rad")
_CLEAR = 1e-3
"""Largest extinction coefficient of a medium that light may come from [1]. Its square is neglected
against that of the index; what it absorbs on the way is not counted."""


class Layer(Checked):
    """A layer of a film.

    Attributes
    ----------
    material : Medium
        The film's properties are differentiable in its parameters.
    thickness : array
        [m]; the film's properties are differentiable in it.
    coherent : bool
        Whether light interferes in it. It does not in a layer so thick or uneven that the spectrum
        or the beam averages over many fringes, such as a substrate.
    roughness : array or None
        Standard deviation of the height of its upper face [m]; None where it is smooth.

    Raises
    ------
    ParameterError
        If a concrete thickness is not positive, or none that a film has; or the material is none.
    """

    material: Medium
    thickness: Thickness
    coherent: bool = field(static=True, default=True)
    roughness: Roughness | None = None

    def __check_init__(self) -> None:
        require_positive(**{f"thickness of {self.material.name}": self.thickness})

    @property
    def thickness_text(self) -> str:
        """Concrete thickness in nanometres, or in the unit that suits a thick layer."""
        thickness = float(self.thickness)
        scale, unit = next((pair for pair in _UNITS if thickness < _TOO_MANY * pair[0]), _UNITS[-1])
        return f"{thickness / scale:.4g} {unit}"

    @property
    def sheets(self) -> tuple["Layer", ...]:
        """Homogeneous layers that stand for this one: itself, unless its medium is graded."""
        media = self.material.sheets
        if len(media) == 1:
            return (self,)
        thickness = self.thickness / len(media)
        faces = (self.roughness, *(None for _ in media[1:]))
        return tuple(
            Layer(medium, thickness, self.coherent, face)
            for medium, face in zip(media, faces, strict=True)
        )


class Film(Checked):
    """A film of layers, free-standing or between other media.

    Attributes
    ----------
    layers : tuple of Layer
        Top to bottom.
    above, below : Medium or None
        Endless media above and below it; None for vacuum. A substrate of known thickness is the
        lowest layer instead, and not coherent.
    roughness_below : array or None
        Standard deviation of the height of the lowest face [m]; None where it is smooth.
    open_fraction : array or None
        Share of the area that is holes [1]; None where there are none.
    hole_diameter : float or None
        [m]; for the warning of holes too narrow for geometric optics.

    Raises
    ------
    ParameterError
        If a film with holes is not free-standing, or a number is not possible.

    Examples
    --------
    >>> from lightflyer.film.media.library import material
    >>> film = Film((Layer(material("Ge"), 20e-9), Layer(material("PET"), 500e-9)))
    >>> print(f"{film.areal_density * 1e3:.3f} g/m²")
    0.801 g/m²
    """

    layers: tuple[Layer, ...] = field()  # a field: "Checked" reads no sequences
    above: Medium | None = None
    below: Medium | None = None
    roughness_below: Roughness | None = None
    open_fraction: OpenFraction | None = None
    hole_diameter: Length | None = None

    def __check_init__(self) -> None:
        for layer in require_record("layers", (tuple, list), self.layers):
            require_record("a layer of a film", (Layer,), layer)
        if self.open_fraction is not None and not self.free_standing:
            raise ParameterError(
                "open_fraction: behind the holes of a film on a substrate lies the substrate; "
                "average the optics of both by area"
            )

    @property
    def free_standing(self) -> bool:
        """Whether vacuum is above and below."""
        return self.above is None and self.below is None

    @property
    def faces(self) -> tuple[Numeric | None, ...]:
        """Roughness of each interface, top to bottom [m]; None where one is smooth."""
        return (*(layer.roughness for layer in self.layers), self.roughness_below)

    @property
    def is_rough(self) -> bool:
        """Whether an interface has a roughness."""
        return any(face is not None for face in self.faces)

    @property
    def lit_sides(self) -> tuple[Side, ...]:
        """Sides that light can come from: no light is taken to come out of an endless substrate."""
        return ("top", "bottom") if self.below is None else ("top",)

    @property
    def media(self) -> tuple[Medium, ...]:
        """All media that have optical data: above, those of the layers, below."""
        ends = (one for one in (self.above, self.below) if one is not None)
        return (*(layer.material for layer in self.layers), *ends)

    @property
    def areal_density(self) -> Numeric:
        """Mass per area, with what the holes leave out [kg/m²]."""
        if self.unknown_density is not None:
            raise ParameterError(self.unknown_density)
        solid = sum(layer.thickness * layer.material.density for layer in self.layers)
        return solid if self.open_fraction is None else solid * (1.0 - self.open_fraction)

    @property
    def unknown_density(self) -> str | None:
        """Which layer's density is unknown and how to give it, None where all are known."""
        for medium in (layer.material for layer in self.layers):
            if medium.density is None:
                note = f" ({medium.density_source})" if medium.density_source else ""
                return (
                    f"density of {medium.name} is unknown{note}; give it to the layer, such as "
                    'density = "2.2 g/cm^3", or in Python by with_density'
                )
        return None

    @property
    def thickness(self) -> Numeric:
        """Thickness of each layer [m], shape (layers,)."""
        return _column([layer.thickness for layer in self.layers])

    def with_thicknesses(self, thickness: Numeric) -> "Film":
        """The film with other thicknesses of its layers [m], shape (layers,)."""
        layers = tuple(
            dataclasses.replace(layer, thickness=one)
            for layer, one in zip(self.layers, thickness, strict=True)
        )
        return dataclasses.replace(self, layers=layers)

    @property
    def data_range(self) -> tuple[float, float]:
        """Wavelengths at which all materials have data, whatever their policy [m]."""
        return common_range(medium.wavelength_range for medium in self.media)

    @property
    def covered_range(self) -> tuple[float, float]:
        """Wavelengths at which the film's optics can be computed [m]."""
        # The intersection of the ranges of all materials that do not extrapolate.
        shortest, longest = common_range(medium.usable_range for medium in self.media)
        if shortest >= longest:
            limited = (one for one in self.media if one.usable_range != (0.0, np.inf))
            spans = ", ".join(dict.fromkeys(medium.describe_range() for medium in limited))
            raise ParameterError(f"the materials' data have no wavelength in common: {spans}")
        return shortest, longest

    def extrapolations(self, shortest: float, longest: float) -> tuple[str, ...]:
        """Materials whose data end within a range of wavelengths, with their policy."""
        found = (text for one in self.media for text in one.extrapolations(shortest, longest))
        return tuple(dict.fromkeys(found))

    def index(self, wavelength: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Refractive index and extinction coefficient of each layer, shape (layers, ...)."""
        wavelength = np.asarray(wavelength, float)
        empty = np.empty((0, *wavelength.shape))
        return (
            indices([one.material for one in self.layers], wavelength)
            if self.layers
            else (empty, empty)
        )

    def flip(self) -> "Film":
        """The film upside down."""
        layers = tuple(
            Layer(one.material.flip(), one.thickness, one.coherent, face)
            for one, face in zip(reversed(self.layers), reversed(self.faces[1:]), strict=True)
        )
        return dataclasses.replace(
            self, layers=layers, above=self.below, below=self.above, roughness_below=self.faces[0]
        )

    def homogeneous(self) -> "Film":
        """The film with the sheets of its graded layers as layers."""
        if all(len(layer.material.sheets) == 1 for layer in self.layers):
            return self
        sheets = tuple(sheet for layer in self.layers for sheet in layer.sheets)
        return dataclasses.replace(self, layers=sheets)

    def structure(self, wavelength: np.ndarray, axes: int) -> Structure:
        """What the film is besides its layers, at wavelengths; ``wavelength``: concrete."""
        above, below = 1.0, (1.0, 0.0)
        if self.above is not None:
            above, lost = self.above.index(wavelength)
            if not is_traced(lost) and np.max(lost, initial=0.0) > _CLEAR:
                raise ParameterError(
                    f"{self.above.name} is above the film and absorbs light on its way to it: "
                    f"k = {np.max(lost):.3g}"
                )
        if self.below is not None:
            below = self.below.index(wavelength)
        roughness = None
        if self.is_rough:
            heights = [0.0 if face is None else face for face in self.faces]
            roughness = _column(heights).reshape(-1, *(1,) * axes)
        coherent = tuple(layer.coherent for layer in self.layers)
        return Structure(above, below, roughness, () if all(coherent) else coherent)

    def optics(
        self, wavelength: np.ndarray | float, incidence: Numeric = 0.0, side: Side = "top"
    ) -> StackOptics:
        """Reflectance, transmittance and absorptance for light from one side."""
        # Light interferes in coherent layers with parallel faces, up to about ten wavelengths
        # thick. Differentiable in the thicknesses, the media's parameters and the angle.
        film = self._seen_from(side)
        optics: StackOptics = film._with_media(structured_optics, wavelength, incidence)
        if film.homogeneous() is not film:
            optics = optics.merge_layers([len(one.sheets) for one in film.layers])
        return optics if self.open_fraction is None else optics.with_holes(self.open_fraction)

    def ellipsometry(
        self, wavelength: np.ndarray | float, incidence: Numeric, side: Side = "top"
    ) -> Numeric:
        """Cos 2Ψ, sin 2Ψ cos Δ and sin 2Ψ sin Δ of the reflected light, shape (3, ...) [1]."""
        film = self._seen_from(side)
        return film._with_media(ellipsometric_angles, wavelength, incidence)

    def _seen_from(self, side: Side) -> "Film":
        if side not in get_args(Side):
            raise ParameterError(f'side "{side}" is unknown; choose top or bottom')
        return self if side == "top" else self.flip()

    def _with_media(
        self, function: Callable[..., Any], wavelength: np.ndarray | float, incidence: Numeric
    ) -> Any:
        """A function of the sheets' indices and thicknesses, for light from above."""
        wavelength = np.asarray(_METRES.number("wavelength", wavelength), float)
        incidence = _RADIANS.number("incidence", incidence)
        require_range("incidence", incidence, 0.0, GRAZING)
        require_positive(wavelength=wavelength)
        require_fit({"wavelength": wavelength.shape, "incidence": np.shape(incidence)})
        sheets = self.homogeneous()
        n, k = sheets.index(wavelength)
        trailing = (1,) * max(wavelength.ndim, np.ndim(incidence))
        shape = (n.shape[0], *(1,) * (len(trailing) - wavelength.ndim), *wavelength.shape)
        thickness = sheets.thickness.reshape(-1, *trailing)
        structure = sheets.structure(wavelength, len(trailing))
        return function(
            n.reshape(shape), k.reshape(shape), thickness, wavelength, incidence, structure
        )


def _column(values: list[Numeric]) -> Numeric:
    """Numbers as one array."""
    if all(isinstance(value, int | float | np.ndarray | np.floating) for value in values):
        return np.array(values, float)
    return xp.stack([xp.asarray(value) for value in values])
