"""A film as layers, top to bottom."""

from typing import Literal, TypeAlias

import equinox as eqx
import jax.numpy as jnp
import numpy as np

from lightflyer.film.materials import MICROMETRE, Extrapolation, Material
from lightflyer.film.transfer_matrix import StackOptics, stack_optics
from lightflyer.foundation.checks import require_positive, require_range
from lightflyer.foundation.errors import ParameterError
from lightflyer.foundation.quantity import Checked, Thickness
from lightflyer.foundation.types import Numeric

Side: TypeAlias = Literal["top", "bottom"]

GRAZING = np.nextafter(np.pi / 2, 0.0)


class Layer(Checked):
    """A layer of a film.

    Attributes
    ----------
    material : Material
    thickness : array
        [m]; the film's properties are differentiable in it.

    Raises
    ------
    ParameterError
        If a concrete thickness is not positive, or none that a film has.
    """

    material: Material = eqx.field(static=True)
    thickness: Thickness

    def __check_init__(self) -> None:
        require_positive(**{f"thickness of {self.material.name}": self.thickness})


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
        strict = [
            layer.material
            for layer in self.layers
            if layer.material.extrapolation is Extrapolation.ERROR
        ]
        shortest = max((material.wavelength_range[0] for material in strict), default=0.0)
        longest = min((material.wavelength_range[1] for material in strict), default=np.inf)
        if shortest >= longest:
            spans = ", ".join(_span(material) for material in dict.fromkeys(strict))
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
            f"{material.name}: {material.extrapolation} beyond {_span(material, named=False)}"
            for material in (layer.material for layer in self.layers)
            if material.extrapolation is not Extrapolation.ERROR
            and not np.all(material.covers(np.array([shortest, longest])))
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

        Raises
        ------
        ParameterError
            If a wavelength is outside a material's data and its policy is ERROR.
        """
        wavelength = np.asarray(wavelength, float)
        pairs = [layer.material.index(wavelength) for layer in self.layers]
        empty = np.empty((0, *wavelength.shape))
        n = np.stack([pair[0] for pair in pairs]) if pairs else empty
        k = np.stack([pair[1] for pair in pairs]) if pairs else empty
        return n, k

    def flipped(self) -> "Film":
        """The film upside down."""
        return Film(self.layers[::-1])

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
        Differentiable in the thicknesses and the angle.
        """
        require_range("incidence", incidence, 0.0, GRAZING)
        film = self if side == "top" else self.flipped()
        wavelength = np.asarray(wavelength, float)
        require_positive(wavelength=wavelength)
        n, k = film.index(wavelength)
        trailing = (1,) * max(wavelength.ndim, np.ndim(incidence))
        shape = (len(self.layers), *(1,) * (len(trailing) - wavelength.ndim), *wavelength.shape)
        thickness = film.thickness.reshape(-1, *trailing)
        return stack_optics(n.reshape(shape), k.reshape(shape), thickness, wavelength, incidence)


def _span(material: Material, *, named: bool = True) -> str:
    shortest, longest = (f"{end / MICROMETRE:.5g} µm" for end in material.wavelength_range)
    return f"{material.name + ' ' if named else ''}{shortest} to {longest}"
