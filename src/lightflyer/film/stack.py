"""A film as layers, top to bottom."""

from typing import Literal, TypeAlias

import equinox as eqx
import jax.numpy as jnp
import numpy as np

from lightflyer.film.medium import Medium
from lightflyer.film.transfer_matrix import StackOptics, stack_optics
from lightflyer.foundation.checks import require_positive, require_range
from lightflyer.foundation.errors import ParameterError
from lightflyer.foundation.precision import entry_point, is_traced
from lightflyer.foundation.quantity import Checked, Thickness
from lightflyer.foundation.types import Numeric

Side: TypeAlias = Literal["top", "bottom"]

GRAZING = np.nextafter(np.pi / 2, 0.0)


class Layer(Checked):
    """A layer of a film.

    Attributes
    ----------
    material : Medium
        The film's properties are differentiable in its parameters.
    thickness : array
        [m]; the film's properties are differentiable in it.

    Raises
    ------
    ParameterError
        If a concrete thickness is not positive, or none that a film has; or the material is none.
    """

    material: Medium
    thickness: Thickness

    def __check_init__(self) -> None:
        require_positive(**{f"thickness of {self.material.name}": self.thickness})

    @property
    def sheets(self) -> tuple["Layer", ...]:
        """Homogeneous layers that stand for this one: itself, unless its medium is graded."""
        media = self.material.sheets
        if len(media) == 1:
            return (self,)
        return tuple(Layer(medium, self.thickness / len(media)) for medium in media)


class Film(eqx.Module):
    """A free-standing film of smooth, homogeneous layers.

    Attributes
    ----------
    layers : tuple of Layer
        Top to bottom.

    Examples
    --------
    >>> from lightflyer.film.catalogue import material
    >>> film = Film((Layer(material("Ge"), 20e-9), Layer(material("PET"), 500e-9)))
    >>> print(f"{film.areal_density * 1e3:.3f} g/m²")
    0.801 g/m²
    """

    layers: tuple[Layer, ...]

    @property
    def areal_density(self) -> Numeric:
        """Mass per area [kg/m²].

        Raises
        ------
        ParameterError
            If a material has no density.
        """
        for layer in self.layers:
            if layer.material.density is None:
                note = layer.material.density_source
                raise ParameterError(
                    f"density of {layer.material.name} is unknown{f' ({note})' if note else ''}"
                )
        return sum(layer.thickness * layer.material.density for layer in self.layers)

    @property
    def thickness(self) -> Numeric:
        """Thickness of each layer [m], shape (layers,)."""
        values = [layer.thickness for layer in self.layers]
        if all(isinstance(value, int | float | np.ndarray | np.floating) for value in values):
            return np.array(values, float)
        return jnp.stack([jnp.asarray(value) for value in values])

    @property
    def covered_range(self) -> tuple[float, float]:
        """Wavelengths at which the film's optics can be computed [m].

        The intersection of the ranges of all materials that do not extrapolate.

        Raises
        ------
        ParameterError
            If the intersection is empty.
        """
        ranges = [layer.material.usable_range for layer in self.layers]
        shortest = max((ends[0] for ends in ranges), default=0.0)
        longest = min((ends[1] for ends in ranges), default=np.inf)
        if shortest >= longest:
            limited = (layer.material for layer in self.layers
                       if layer.material.usable_range != (0.0, np.inf))  # fmt: skip
            spans = ", ".join(dict.fromkeys(medium.describe_range() for medium in limited))
            raise ParameterError(f"the materials' data have no wavelength in common: {spans}")
        return shortest, longest

    def extrapolated(self, shortest: float, longest: float) -> tuple[str, ...]:
        """Materials whose data end within a range of wavelengths, with their policy.

        Parameters
        ----------
        shortest, longest : float
            [m].

        Returns
        -------
        tuple of str
            Such as ``"PET: hold beyond 0.4 µm to 19.942 µm"``.
        """
        found = (
            text for layer in self.layers for text in layer.material.extrapolated(shortest, longest)
        )
        return tuple(dict.fromkeys(found))

    def index(self, wavelength: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Refractive index and extinction coefficient of each layer.

        Parameters
        ----------
        wavelength : array, shape (...)
            Concrete [m].

        Returns
        -------
        n, k : array, shape (layers, ...)
            NumPy arrays where all media's parameters are concrete.

        Raises
        ------
        ParameterError
            If a wavelength is outside a material's data and its policy is ERROR.
        """
        wavelength = np.asarray(wavelength, float)
        pairs = [layer.material.index(wavelength) for layer in self.layers]
        empty = np.empty((0, *wavelength.shape))
        stack = _stacked if is_traced(pairs) else np.stack
        n = stack(tuple(pair[0] for pair in pairs)) if pairs else empty
        k = stack(tuple(pair[1] for pair in pairs)) if pairs else empty
        return n, k

    def flipped(self) -> "Film":
        """The film upside down."""
        layers = (Layer(one.material.flipped(), one.thickness) for one in reversed(self.layers))
        return Film(tuple(layers))

    def homogeneous(self) -> "Film":
        """The film with the sheets of its graded layers as layers of their own."""
        if all(len(layer.material.sheets) == 1 for layer in self.layers):
            return self
        return Film(tuple(sheet for layer in self.layers for sheet in layer.sheets))

    def optics(
        self, wavelength: np.ndarray | float, incidence: Numeric = 0.0, side: Side = "top"
    ) -> StackOptics:
        """Reflectance, transmittance and absorptance for light from one side.

        Parameters
        ----------
        wavelength : array, shape (...)
            In vacuum, concrete [m].
        incidence : array, shape (...)
            Angle between the light and the film's normal [rad].
        side : {"top", "bottom"}
            Where the light comes from.

        Returns
        -------
        StackOptics
            The first axis is the polarisation, s then p; the lit layer comes first.

        Raises
        ------
        ParameterError
            If an angle is not in [0, 90°), or a wavelength is outside a material's data.

        Notes
        -----
        Coherent: valid for films with parallel faces, up to about ten wavelengths thick.
        Differentiable in the thicknesses, the media's parameters and the angle.
        """
        require_range("incidence", incidence, 0.0, GRAZING)
        film = self if side == "top" else self.flipped()
        wavelength = np.asarray(wavelength, float)
        require_positive(wavelength=wavelength)
        sheets = film.homogeneous()
        n, k = sheets.index(wavelength)
        trailing = (1,) * max(wavelength.ndim, np.ndim(incidence))
        shape = (n.shape[0], *(1,) * (len(trailing) - wavelength.ndim), *wavelength.shape)
        thickness = sheets.thickness.reshape(-1, *trailing)
        optics = stack_optics(n.reshape(shape), k.reshape(shape), thickness, wavelength, incidence)
        return optics if sheets is film else optics.merged([len(one.sheets) for one in film.layers])


@entry_point
def _stacked(values: tuple[Numeric, ...]) -> Numeric:
    return jnp.stack(jnp.broadcast_arrays(*values))
