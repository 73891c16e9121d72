"""Spectra of light and heat radiation: sunlight, lamps, black bodies."""

import dataclasses
from functools import cache
from pathlib import Path

import numpy as np

from lightflyer.array.records import ShortRepr
from lightflyer.core import constants
from lightflyer.core.checks import require_positive
from lightflyer.core.entry_point import reads_units
from lightflyer.core.errors import ParameterError
from lightflyer.core.quantity import Length, Temperature
from lightflyer.files.table import shipped_table
from lightflyer.film.media.materials import read_spectrum_csv

SECOND_RADIATION_CONSTANT = constants.PLANCK * constants.SPEED_OF_LIGHT / constants.BOLTZMANN
"""hc/k [m K]."""

SPECTRUM_RANGE = (0.25e-6, 25e-6)  # Ends of a film's reported spectrum [m]
LED_BLUE = (450e-9, 20e-9)  # Peak and width at half maximum of the modelled lamp's blue chip [m]
LED_PHOSPHOR = (560e-9, 120e-9)
"""Peak and width at half maximum of the modelled lamp's phosphor [m]."""
LED_PHOSPHOR_PEAK = 0.55
"""Peak of the phosphor over that of the chip [1]; it makes the lamp's correlated colour temperature
6550 K."""

_LED_WAVELENGTHS = np.arange(380, 781) * 1e-9
_LINE_WIDTH = 1e-9  # of a line, over its wavelength
_SERIES_TERMS = 80
_SMALL_ARGUMENT = 0.5


@reads_units
@dataclasses.dataclass(frozen=True, eq=False)
class Spectrum(ShortRepr):
    """Spectral irradiance of light, linear between the wavelengths of a table.

    Raises
    ------
    ParameterError
        If wavelengths do not increase, or irradiances are negative, all zero or not finite.
    """

    name: str
    wavelength: Length  #: shape (m,); increasing [m]
    #: shape (m,); per wavelength, [W/m³] where it is absolute. Averages depend on its shape only
    irradiance: np.ndarray
    source: str = ""

    def __post_init__(self) -> None:
        wavelength, irradiance = np.asarray(self.wavelength), np.asarray(self.irradiance)
        if wavelength.ndim != 1 or wavelength.shape != irradiance.shape or wavelength.size < 2:
            raise ParameterError(f"spectrum {self.name}: needs two or more pairs of values")
        if not np.all(np.diff(wavelength) > 0.0) or wavelength[0] <= 0.0:
            raise ParameterError(f"spectrum {self.name}: wavelengths must be positive and increase")
        if not np.all(np.isfinite(irradiance) & (irradiance >= 0.0)) or not np.any(irradiance):
            raise ParameterError(f"spectrum {self.name}: irradiance must be zero or positive")

    @property
    def total(self) -> float:
        """Integral over all wavelengths [W/m²]."""
        return float(np.trapezoid(self.irradiance, self.wavelength))

    def between(self, shortest: float, longest: float) -> tuple[np.ndarray, np.ndarray]:
        """Wavelengths and trapezoidal weights of the part between two wavelengths."""
        inside = (self.wavelength > shortest) & (self.wavelength < longest)
        ends = np.clip(self.wavelength[[0, -1]], shortest, longest)
        points = np.unique(np.concatenate([ends, self.wavelength[inside]]))
        values = np.interp(points, self.wavelength, self.irradiance)
        half = 0.5 * np.diff(points)
        weight = (np.append(half, 0.0) + np.insert(half, 0, 0.0)) * values / self.total
        if not weight.sum() > 0.0:
            raise ParameterError(
                f"spectrum {self.name} has no power between {shortest * 1e6:.4g} µm and "
                f"{longest * 1e6:.4g} µm, where the film's materials have data"
            )
        return points, weight


@cache
def am0() -> Spectrum:
    """Sunlight above the atmosphere.

    Returns
    -------
    Spectrum
        0.1195 µm to 1000 µm; integral 1366.1 W/m².

    References
    ----------
    [ASTME490]_ table 3.

    Examples
    --------
    >>> print(f"{am0().total:.1f} W/m²")
    1366.1 W/m²
    """
    columns = shipped_table("am0_e490.csv").numbers
    wavelength = columns["wavelength_um"] * 1e-6
    irradiance = columns["irradiance_per_um"] * 1e6
    return Spectrum("AM0", wavelength, irradiance, "ASTM E490-00a (2014), table 3")


@cache
def cold_white_led() -> Spectrum:
    r"""Model of a cold-white lamp: a blue light-emitting diode with a yellow phosphor.

    The chip has the line shape :math:`(g+2g^5)/3`, :math:`g=e^{-((\lambda-\lambda_0)/w)^2}`,
    the phosphor is Gaussian; their peaks and widths are :data:`LED_BLUE` and
    :data:`LED_PHOSPHOR`, typical of gallium nitride and cerium-doped garnet.

    Returns
    -------
    Spectrum
        380 nm to 780 nm, in arbitrary units.

    Notes
    -----
    This is no measured lamp: give the lamp's own spectrum as a file where results depend on it.

    References
    ----------
    [Ohno2005]_ for the line shape.
    """
    wavelength = _LED_WAVELENGTHS
    peak, width = LED_BLUE
    # half maximum of the line shape is where g + 2 g^5 = 3/2
    chip = np.exp(-(((wavelength - peak) / (width * _OHNO_HALF_WIDTH)) ** 2))
    peak, width = LED_PHOSPHOR
    phosphor = np.exp(-4.0 * np.log(2.0) * ((wavelength - peak) / width) ** 2)
    shape = (chip + 2.0 * chip**5) / 3.0 + LED_PHOSPHOR_PEAK * phosphor
    return Spectrum("cold-white LED", wavelength, shape, "model, line shape of Ohno (2005)")


@reads_units
def spectral_line(wavelength: Length) -> Spectrum:
    """Light of one wavelength, as that of a laser.

    Parameters
    ----------
    wavelength : float
        [m].

    Returns
    -------
    Spectrum

    Examples
    --------
    >>> spectral_line("532 nm").name
    '532 nm'
    """
    require_positive(wavelength=wavelength)
    ends = wavelength * (1.0 + _LINE_WIDTH * np.array([-0.5, 0.5]))
    return Spectrum(f"{1e9 * float(wavelength):g} nm", ends, np.ones(2), "one wavelength")


def _ohno_half_width() -> float:
    """Width parameter of the line shape over its full width at half maximum."""
    real = np.roots([2.0, 0.0, 0.0, 0.0, 1.0, -1.5])
    half = float(real[np.abs(real.imag) < 1e-12].real[0])
    return float(0.5 / np.sqrt(-np.log(half)))


_OHNO_HALF_WIDTH = _ohno_half_width()


def spectrum_from_csv(path: str | Path) -> Spectrum:
    """Spectrum of a lamp from a CSV file.

    Parameters
    ----------
    path : str or path
        The first line that is not a comment names the columns, with the unit of the wavelength:
        ``wavelength [nm],irradiance``.

    Returns
    -------
    Spectrum

    Raises
    ------
    ConfigurationError
        One line that says what is wrong and where.
    """
    path = Path(path)
    wavelength, irradiance = read_spectrum_csv(path)
    return Spectrum(path.name, wavelength, irradiance, str(path))


@reads_units
def planck(wavelength: Length, temperature: Temperature) -> np.ndarray:
    r"""Spectral exitance of a black body per wavelength, over its total exitance.

    .. math:: \frac{\pi B_\lambda(T)}{\sigma T^4}
        = \frac{15}{\pi^4}\,\frac{x^4}{\lambda\,(e^x-1)},\qquad x=\frac{hc}{\lambda kT}

    Parameters
    ----------
    wavelength : array, shape (...)
        [m].
    temperature : float
        [K].

    Returns
    -------
    array, shape (...)
        [1/m]; its integral over all wavelengths is one.

    Raises
    ------
    ParameterError
        If the temperature is not positive.
    """
    require_positive(temperature=temperature)
    x = SECOND_RADIATION_CONSTANT / (wavelength * temperature)
    # in terms of exp(-x), which underflows quietly where exp(x) would overflow
    return 15.0 / np.pi**4 * x**4 * np.exp(-x) / (-np.expm1(-x) * wavelength)


def blackbody_fraction(wavelength: float, temperature: float) -> float:
    """Share of a black body's radiation at wavelengths shorter than a given one [1]."""
    # Source: [Chang1984]_ for the series in :math:`e^{-x}`.
    require_positive(temperature=temperature)
    x = SECOND_RADIATION_CONSTANT / (wavelength * temperature)
    if x < _SMALL_ARGUMENT:
        # Bernoulli series of the complement, ∫ t³/(eᵗ-1) from 0 to x
        terms = [1 / 3, -x / 8, x**2 / 60, -(x**4) / 5040, x**6 / 272160, -(x**8) / 13305600]
        return 1.0 - 15.0 / np.pi**4 * x**3 * float(sum(terms) + x**10 / 622702080)
    n = np.arange(1, _SERIES_TERMS + 1)
    series = np.exp(-n * x) * (x**3 / n + 3 * x**2 / n**2 + 6 * x / n**3 + 6 / n**4)
    return float(15.0 / np.pi**4 * series.sum())
