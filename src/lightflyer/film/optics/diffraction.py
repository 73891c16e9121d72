r"""Where the holes of a film are too narrow for geometric optics.

A hole passes less than falls on it where it is not wide against the wavelength. Kirchhoff's
integral for a round hole in a thin conducting screen, at normal incidence, gives

.. math::
    1 - T = \frac1x\int_0^x J_0(t)\,dt, \qquad x = \frac{2\pi D}{\lambda},

which goes to :math:`\lambda/(2\pi D)` for wide holes. Films and flyers here take :math:`T = 1`.
"""

from collections.abc import Iterator

import numpy as np

from lightflyer.array.namespace import Numeric

LARGEST_DEFICIT = 0.05
"""Share that may be missing from what falls on a hole before it is worth a warning [1]."""

MEDIAN_WAVELENGTH_BY_TEMPERATURE = 4.107e-3
"""Half of a black body's radiation is beyond this wavelength times its temperature [m K]."""

MEDIAN_WAVELENGTH_OF_SUNLIGHT = 0.734e-6  # Half of sunlight's power is beyond this wavelength [m]

_MICROMETRE = 1e-6


def diffraction_deficit(hole_radius: Numeric, wavelength: Numeric) -> np.ndarray:
    """Share of the radiation on a round hole that does not pass it [1]; [Jackson1999]_ ch. 10.9."""
    # Kirchhoff's approximation: good for holes wider than the wavelength. In truth even less passes
    # holes that are much narrower.
    # The mean of J₀ up to x by Struve functions: itj0y0 of SciPy is wrong before 1.17.
    from scipy.special import j0, j1, struve  # slow to import

    x = _size(hole_radius, wavelength)
    return np.asarray(j0(x) + 0.5 * np.pi * (j1(x) * struve(0, x) - j0(x) * struve(1, x)))


def largest_deficit(hole_radius: Numeric, wavelength: Numeric) -> np.ndarray:
    """What :func:`diffraction_deficit` does not exceed [1], without SciPy; close for wide holes."""
    x = _size(hole_radius, wavelength)  # beyond x the integral of J₀ is at most √(2/(πx))
    return np.asarray((1.0 + np.sqrt(2.0 / (np.pi * x))) / x)


def _size(hole_radius: Numeric, wavelength: Numeric) -> np.ndarray:
    return 4.0 * np.pi * np.asarray(hole_radius) / wavelength


def narrow_holes(hole_radius: Numeric, temperature: Numeric) -> Iterator[str]:
    """Warnings of round holes that light or heat radiation does not pass as rays."""
    radius = float(np.min(hole_radius))
    yield from _narrow(f"holes of {2.0 * radius / _MICROMETRE:.3g} µm", radius, temperature)


def narrow_channels(width: Numeric, length: Numeric, temperature: Numeric) -> Iterator[str]:
    """Warnings of rectangular channels that are too narrow, as of :func:`narrow_holes`."""
    # What is missing goes, in wide channels, with the edge for the area: a rectangle lacks what a
    # round hole of the same ratio lacks.
    sides = np.broadcast_arrays(np.asarray(width, float), np.asarray(length, float))
    radius = sides[0] * sides[1] / (sides[0] + sides[1])
    narrowest = float(sides[0].ravel()[np.argmin(radius)])
    yield from _narrow(
        f"channels of {narrowest / _MICROMETRE:.3g} µm", float(np.min(radius)), temperature
    )


def _narrow(what: str, radius: float, temperature: Numeric) -> Iterator[str]:
    infrared = MEDIAN_WAVELENGTH_BY_TEMPERATURE / float(np.min(temperature))
    kinds = {"light": MEDIAN_WAVELENGTH_OF_SUNLIGHT, "heat radiation": infrared}
    for name, wavelength in kinds.items():
        if largest_deficit(radius, wavelength) <= LARGEST_DEFICIT:
            continue
        deficit = float(diffraction_deficit(radius, wavelength))
        if deficit > LARGEST_DEFICIT:
            yield (
                f"{what} are narrow for {name}, half of which has wavelengths beyond "
                f"{wavelength / _MICROMETRE:.2g} µm: by diffraction about {100.0 * deficit:.2g} % "
                "less passes them than open_fraction says"
            )
