"""A film as layers, top to bottom, and uncertainty of its properties from those of the layers."""

import dataclasses
from collections.abc import Callable, Mapping, Sequence
from typing import Any, Literal, TypeAlias, TypeVar, get_args

import numpy as np

from lightflyer.array import tree
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
from lightflyer.core.units import Measured
from lightflyer.film.media.compound import indices
from lightflyer.film.media.medium import Medium, common_range
from lightflyer.film.optics.transfer_matrix import (
    StackOptics,
    Structure,
    ellipsometric_angles,
    structured_optics,
)
from lightflyer.numerics.correlation import Correlations, correlation_matrix

Side: TypeAlias = Literal["top", "bottom"]

GRAZING = np.nextafter(np.pi / 2, 0.0)

_UNITS = ((1e-9, "nm"), (1e-6, "µm"), (1e-3, "mm"))
_TOO_MANY = 1e4  # of a unit, so that the next one is written

_METRES, _RADIANS = Quantity("m"), Quantity("rad")
_CLEAR = 1e-3
"""Largest extinction coefficient of a medium that light may come from [1]. Its square is neglected
against that of the index; what it absorbs on the way is not counted."""

T = TypeVar("T")

_SECOND_ORDER = 0.75  # fourth moment of a standard normal variable, 3, over 2²
_METRES_TO_NANOMETRES = 1e9
_LEAST_VARIANCE = 1e-9  # along a principal axis of correlations: less is rounding


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


def thickness_uncertainty(
    quantity: Callable[[Film], T],
    film: Film,
    uncertainty: Sequence[float],
    others: Sequence[tuple[Film, Film]] = (),
) -> T:
    r"""Standard uncertainty of anything computed from a film, from that of its thicknesses.

    Parameters
    ----------
    quantity : callable
        Takes a film; returns a number, an array, or a dict, list or tuple of these.
    film : Film
        With concrete thicknesses.
    uncertainty : sequence of float
        Standard uncertainty of each layer's thickness, top to bottom; zero where it is exact [m].
    others : sequence of (Film, Film)
        For each other number with an uncertainty, such as a porosity: the film with the number one
        standard uncertainty above and below its value.

    Returns
    -------
    same structure as ``quantity`` returns
        In the unit of each of its numbers.

    Raises
    ------
    ParameterError
        If there is not one uncertainty a layer, or one is negative or not below its thickness.

    Notes
    -----
    The thicknesses and other numbers are independent and normal. The quantity is computed with
    each at its value, :math:`y`, and one standard uncertainty above and below it,
    :math:`y_i^\pm`. To second order, its mean square deviation from :math:`y` is

    .. math::
        u^2(y) = \sum_i \left(\frac{y_i^+-y_i^-}{2}\right)^2
            + \frac34\sum_i\left(y_i^+ - 2y + y_i^-\right)^2.

    The first sum is the law of propagation of uncertainty; the second counts where the quantity is
    near an extremum, as interference makes it.

    References
    ----------
    [GUM2008]_ 5.1.3, notes 2 and 3, for the differences; 5.1.2 for the second order.

    Examples
    --------
    >>> from lightflyer.film import Film, Layer, material
    >>> film = Film((Layer(material("Ge"), 20e-9),))
    >>> print(f"{thickness_uncertainty(lambda one: one.areal_density, film, [1e-9]) * 1e3:.5f}")
    0.00532
    """
    if len(uncertainty) != len(film.layers):
        raise ParameterError(
            f"{len(uncertainty)} uncertainties of thicknesses are given for "
            f"{len(film.layers)} layers"
        )
    pairs = []
    for number, (layer, spread) in enumerate(zip(film.layers, uncertainty, strict=True)):
        require_range(f"uncertainty of the thickness of {layer.material.name}", spread, 0.0)
        if not spread < layer.thickness:
            nanometres = [_METRES_TO_NANOMETRES * one for one in (layer.thickness, spread)]
            raise ParameterError(
                f"thickness of {layer.material.name} = {nanometres[0]:g} ± {nanometres[1]:g} nm: "
                "± is one standard deviation and must be below the thickness"
            )
        if spread > 0.0:
            change = spread * np.eye(len(film.layers))[number]
            ends = film.thickness + change, film.thickness - change
            pairs.append(tuple(map(film.with_thicknesses, ends)))

    def add(total: np.ndarray, middle: np.ndarray, above: np.ndarray, below: np.ndarray) -> Any:
        first, second = 0.5 * (above - below), above - 2.0 * middle + below
        return total + first**2 + _SECOND_ORDER * second**2

    middle = quantity(film)
    total = tree.map_leaves(lambda one: np.zeros_like(one, float), middle)
    for one, other in (*pairs, *others):
        total = tree.map_leaves(add, total, middle, quantity(one), quantity(other))
    return tree.map_leaves(lambda one: np.sqrt(one)[()], total)


def neighbouring_films(
    film_with: Callable[[Mapping[str, float]], Film],
    numbers: Mapping[str, tuple[Quantity, Measured]],
    correlations: Correlations,
) -> list[tuple[Film, Film]]:
    """Films one standard uncertainty above and below, for each independent error of numbers.

    ``film_with``: the film with other numbers, by name; ``numbers``: their ranges and values, which
    stay within them. Numbers whose errors are correlated change together, along each principal axis
    of their correlations.
    """
    names = list(dict.fromkeys(name for pair in correlations for name in pair))
    variances, axes = np.linalg.eigh(correlation_matrix(names, correlations))
    changes = [
        dict(zip(names, np.sqrt(variance) * axis, strict=True))
        for variance, axis in zip(variances, axes.T, strict=True)
        if variance > _LEAST_VARIANCE
    ]
    changes += [{name: 1.0} for name in numbers if name not in names]

    def end(change: Mapping[str, float], sign: float) -> Film:
        moved = {}
        for name, share in change.items():
            quantity, value = numbers[name]
            number = value.value + sign * share * (value.uncertainty or 0.0)
            moved[name] = min(max(number, quantity.lowest), quantity.highest)
        return film_with(moved)

    return [(end(change, 1.0), end(change, -1.0)) for change in changes]
