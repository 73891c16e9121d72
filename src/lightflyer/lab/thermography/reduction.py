r"""Reflectance, transmittance and emissivity from temperatures, or from a light meter.

A thermal camera sees three apparent temperatures of a film above a hotplate: that of the hotplate,
that of the film's lower side, which reflects the hotplate, and that of its upper side, which
transmits it. With B the radiance within the camera's band
(:mod:`lightflyer.lab.thermography.data`) and surroundings at :math:`T_\infty`,

.. math::
    S &= B(T_\mathrm{hotplate}) - B(T_\infty), \\
    B(T_\mathrm{lower}) - B(T_\infty) &= \rho S + \varepsilon\,[B(T_\mathrm{film}) - B(T_\infty)],\\
    B(T_\mathrm{upper}) - B(T_\infty) &= \tau S + \varepsilon\,[B(T_\mathrm{film}) - B(T_\infty)],\\
    \varepsilon &= 1 - \tau - \rho .

Where the hotplate's temperature is its own and not an apparent one, S is multiplied by the
hotplate's emissivity. The film emits as much as its surroundings unless its temperature is given.
The paper has :math:`T^4` in place of B. For a light meter's readings of incident, reflected and
transmitted light, less its reading in the dark, the same relations hold without emission.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from scipy import optimize

from lightflyer.calibration.points import copies
from lightflyer.core.checks import require_range
from lightflyer.core.constants import STEFAN_BOLTZMANN
from lightflyer.core.errors import ConfigurationError, Doubt, ParameterError
from lightflyer.core.quantity import require_record
from lightflyer.files.result_text import Parts, listed
from lightflyer.lab.estimate import NORMAL_FACTOR, Estimate, central_interval, student_factor
from lightflyer.lab.result import (
    ABSORPTANCE,
    EMISSIVITY,
    LabResult,
    Reported,
    Series,
    ambient_doubts,
    dataset,
    doubts_of,
    estimate_table,
    plain,
    variables,
)
from lightflyer.lab.thermography.data import (
    LIGHT,
    MICROMETRE,
    THERMAL,
    UNCOOLED,
    Readings,
    Scene,
    flat_band,
)

if TYPE_CHECKING:
    import xarray as xr

DRAWS = 100_000  # Number of Monte Carlo draws

PROPERTIES = ("reflectance", "transmittance", "emissivity")
"""Properties that the readings determine."""

FREE_CONVECTION = 5.0
"""Coefficient of free convection by which the warming of an unheated film is estimated
[W/(m² K)]. An assumption; the range for gases is 2 to 25, [Bergman2011]_ table 1.1."""

_SHORTER = flat_band(8.0 * MICROMETRE, 14.0 * MICROMETRE)  # another usual band of such cameras
_CLEAR = 3.0  # standard uncertainties of the film's temperature that are allowed for
_WARMEST = 0.4  # excess radiation of a film over the hotplate's; at one half the relations fail
_STEP = 1e-30  # of a derivative along the imaginary axis
_ROUNDING = 1e-9
_WORTH_SAYING = 0.5  # standard uncertainties
_WIDE = 6.0  # robust standard deviations beyond which a row deviates from the others
_FAR = 2.0  # standard uncertainties by which it also does
_FEWEST = 5  # rows among which one can be told to deviate
_MAD = 1.4826  # standard deviation over the median absolute deviation, of a normal distribution
_NAMED = 5  # rows named in a message
_OTHER_UNIT = 100.0  # times, that light is more than all that the film leaves of it
_FAR_ABOVE = 5.0  # standard deviation of rows over what the readings' accuracy allows


@dataclass(frozen=True, repr=False)
class RadiativeProperties(LabResult):
    """Reflectance, transmittance and emissivity, or absorptivity for a light meter."""

    readings: Readings
    rows: np.ndarray  #: shape (3, n); properties of each row [1]
    #: Uncertainty propagated by derivatives, by names of :data:`PROPERTIES`; within 0 and 1
    first_order: dict[str, Estimate]
    monte_carlo: dict[str, Estimate]  #: The same by draws
    warnings: tuple[str, ...] = ()  #: What a reader of the result must know, one line each

    _figures = "thermography.figures:property_figures"

    @property
    def emissivity(self) -> Estimate:
        """Emissivity within the camera's band, or absorptivity for a light meter [1]."""
        return self.first_order["emissivity"]

    @property
    def meaning(self) -> Reported[str]:
        """Radiation that the properties are of, in words."""
        if self.readings.method == LIGHT:
            return "for the light of the source"
        camera = self.readings.scene.camera
        return "as T⁴, all wavelengths" if camera is None else f"within {camera.name}, near normal"

    def name_properties(self, values: Mapping[str, Any]) -> dict[str, Any]:
        """Values by the names of the properties of this method."""
        remainder = self.readings.method.remainder
        return {remainder if key == "emissivity" else key: one for key, one in values.items()}

    def finding(self) -> Parts:
        """The properties in a sentence."""
        found = self.name_properties(self.first_order)
        yield f"{listed(f'{name} {one}' for name, one in found.items())}, {self.meaning}"

    def parts(self) -> Parts:
        """The properties with both intervals, and the uncertainties of the readings."""
        second = self.name_properties(self.monte_carlo)
        rows = []
        for name, estimate in self.name_properties(self.first_order).items():
            rows += [(name, estimate), ("  by Monte Carlo", second[name])]
        yield estimate_table(rows, self.meaning)
        method = self.readings.method
        spreads = ", ".join(
            f"{name.removesuffix('_temperature')} {one:.2g}"
            for name, one in zip(method.readings, self.readings.uncertainties, strict=True)
        )
        yield f"standard uncertainties of the readings: {spreads} {method.unit}".rstrip()

    def summary(self) -> dict[str, Any]:
        """The result as a JSON object."""
        readings, scene = self.readings, self.readings.scene
        method = readings.method
        document = self.name_properties(plain(self.first_order)) | {
            "monte_carlo": self.name_properties(plain(self.monte_carlo)),
            "rows_used": readings.values.shape[1],
            "standard_uncertainties": {
                name: {"value": float(one), "unit": method.unit}
                for name, one in zip(method.readings, readings.uncertainties, strict=True)
            },
            **super().summary(),
        }
        if method == LIGHT:
            return document
        camera, film = scene.camera, scene.film_temperature
        ends = None if camera is None else (camera.wavelength[[0, -1]] / MICROMETRE).tolist()
        return document | {
            "band_um": ends,
            "hotplate_emissivity": scene.hotplate_emissivity.value,
            "film_temperature_K": None if film is None else film.value,
        }


def properties_of(readings: Readings) -> np.ndarray:
    """Reflectance, transmittance and remainder of each row of readings [1], shape (3, n)."""
    return _properties(readings, _inputs(readings)[0])


def reduce_readings(
    readings: Readings, *, draws: int = DRAWS, seed: int = 0
) -> RadiativeProperties:
    r"""Reflectance, transmittance and emissivity with propagated uncertainties.

    Parameters
    ----------
    readings : Readings
    draws : int
        Number of Monte Carlo draws.
    seed : int
        Seed of the draws.

    Returns
    -------
    RadiativeProperties

    Raises
    ------
    ParameterError
        If a temperature is negative, or the source does not exceed the background.
    ConfigurationError
        If a property is below 0 or above 1 by more than its 95 % interval.

    Notes
    -----
    The uncertainties of the readings are common to all rows and do not average out. The scatter of
    several rows does average out; the scatter of their properties is added. First order uses
    derivatives at the mean readings, Monte Carlo normal draws of the readings, whose interval need
    not be symmetric. Both are widened by Student's factor for :math:`(n-1)\,u^2/u_s^2` degrees of
    freedom, where u is the total and :math:`u_s` the part of the scatter. The square of the ratio,
    as Welch and Satterthwaite have it, is too much for two or three rows.

    A film whose temperature is not given is as cold as its surroundings. What its warmth may do is
    estimated for a warning, with :data:`FREE_CONVECTION` in still air.

    References
    ----------
    [Lu2023]_ for the relations with :math:`T^4`, [Bergman2011]_ for free convection.
    """
    require_record("readings", (Readings,), readings)
    require_range("draws", draws, 1000)
    if readings.method == THERMAL and np.any(readings.values < 0.0):
        raise ParameterError("temperatures must not be negative")
    if np.any(readings.values[0] <= readings.values[3]):
        raise ParameterError("the source must exceed the background")
    each = properties_of(readings)
    count = each.shape[1]
    value = each.mean(axis=1)
    scatter = np.cov(each) / count if count > 1 else np.zeros((3, 3))
    rows, spread = _inputs(readings)
    mean = rows.mean(axis=1)
    if readings.scene.film_temperature is not None:  # its emission must not hide the rest
        warm = mean + np.array([0.0, 0.0, 0.0, 0.0, 0.0, _CLEAR * spread[5]])
        source, _, _, background, emissivity, film = _radiation(warm, _law(readings)[0])
        if film - background > _WARMEST * emissivity * (source - background):
            raise ConfigurationError(
                f"film_temperature = {mean[5]:.4g} ± {spread[5]:.2g} K is too close to the "
                "hotplate's: so warm a film does not show what it reflects and transmits"
            )
    slopes = _derivatives(readings, mean)
    total = np.diag((slopes * spread**2) @ slopes.T + scatter)
    random = np.diag(scatter)
    with np.errstate(divide="ignore", invalid="ignore"):
        freedom = np.where(random > _ROUNDING**2, (count - 1) * total / random, np.inf)
    factor = np.array([student_factor(one) for one in freedom])
    halves = factor * np.sqrt(total)
    first = dict(zip(PROPERTIES, map(Estimate.covering, value, halves), strict=True))
    rng = np.random.default_rng(seed)
    drawn = mean[:, None] + spread[:, None] * rng.normal(size=(len(mean), draws))
    cloud = _properties(readings, drawn) - _properties(readings, mean[:, None])
    cloud += rng.multivariate_normal(np.zeros(3), scatter, draws, method="eigh").T
    cloud = value[:, None] + cloud * (factor / NORMAL_FACTOR)[:, None]
    second = {
        name: Estimate(float(one.mean()), tuple(central_interval(one)), "", float(one.std()))
        for name, one in zip(PROPERTIES, cloud, strict=True)
    }
    return _judge(readings, each, first, second)


def to_dataset(result: RadiativeProperties, files: Sequence[str]) -> "xr.Dataset":
    """Readings and properties of each row."""
    method, each = result.readings.method, dict(zip(PROPERTIES, result.rows, strict=True))
    readings = [
        Series(name, values, method.unit, name.replace("_", " "))
        for name, values in zip(method.readings, result.readings.values, strict=True)
    ]
    properties = [
        Series(name, values, "", f"{name} {result.meaning}")
        for name, values in result.name_properties(each).items()
    ]
    return dataset(
        f"reflectance, transmittance and {method.remainder}",
        variables("row", [*readings, *properties]), files,
        warnings=result.warnings, meaning=result.meaning,
    )  # fmt: skip


def _inputs(readings: Readings) -> tuple[np.ndarray, np.ndarray]:
    """Readings, hotplate's emissivity and film's temperature of each row, shape (5 or 6, n).

    Also their standard uncertainties.
    """
    scene = readings.scene
    extra = [scene.hotplate_emissivity, *filter(None, [scene.film_temperature])]
    same = np.ones(readings.values.shape[1])
    spread = [*readings.uncertainties, *(one.uncertainty or 0.0 for one in extra)]
    rows = np.vstack([readings.values, *(one.value * same for one in extra)])
    return rows, np.array(spread)


def _law(readings: Readings) -> tuple[Callable[..., Any], Callable[..., Any]]:
    """What is proportional to radiation, as a function of a reading, and its derivative."""
    camera = readings.scene.camera
    if readings.method == LIGHT:
        return np.asarray, np.ones_like
    if camera is None:
        return (lambda kelvin: kelvin**4), (lambda kelvin: 4.0 * kelvin**3)
    return camera.radiance, camera.slope


def _radiation(values: np.ndarray, law: Callable[..., Any]) -> np.ndarray:
    """A function of the temperatures or light among the inputs; the hotplate's emissivity as is."""
    return np.concatenate([law(values[:4]), values[4:5], law(values[5:])])


def _relations(inputs: np.ndarray) -> np.ndarray:
    """Properties, shape (3, ...), from radiation, hotplate's emissivity and film's radiation."""
    source, reflected, transmitted, background, emissivity = inputs[:5]
    span = emissivity * (source - background)
    film = (inputs[5] - background) / span if len(inputs) > 5 else 0.0 * span
    lower, upper = (reflected - background) / span, (transmitted - background) / span
    remainder = (1.0 - lower - upper) / (1.0 - 2.0 * film)
    return np.stack([lower - remainder * film, upper - remainder * film, remainder])


def _properties(readings: Readings, inputs: np.ndarray) -> np.ndarray:
    """Properties, shape (3, ...), from readings and what else is uncertain, shape (5 or 6, ...)."""
    return _relations(_radiation(inputs, _law(readings)[0]))


def _derivatives(readings: Readings, mean: np.ndarray) -> np.ndarray:
    """Derivatives of the three properties by the inputs, shape (3, inputs)."""
    law, slope = _law(readings)
    radiation = _radiation(mean, law)
    steps = radiation[:, None] + 1j * _STEP * np.eye(len(mean))
    by_radiation = _relations(steps).imag / _STEP
    slopes = _radiation(mean, slope)
    slopes[4] = 1.0
    return np.asarray(by_radiation * slopes)


def _judge(
    readings: Readings, rows: np.ndarray, first: dict[str, Estimate], second: dict[str, Estimate]
) -> RadiativeProperties:
    method, light = readings.method, readings.method == LIGHT
    warnings: list[str] = []
    if rows.shape[1] >= _FEWEST:
        away = np.abs(rows - np.median(rows, axis=1, keepdims=True))
        robust = _MAD * np.median(away, axis=1, keepdims=True)
        spread = np.array([[one.uncertainty or 0.0] for one in first.values()])
        far = np.flatnonzero((away > np.maximum(_WIDE * robust, _FAR * spread)).any(axis=0))
        places = [readings.places[row] if readings.places else f"row {row + 1}" for row in far]
        more = f" and {len(places) - _NAMED} more" if len(places) > _NAMED else ""
        if places:
            shown = f"{', '.join(places[:_NAMED])}{more}"
            warnings.append(f"{shown}: far from the other rows; check the readings")
    names, means = method.readings, readings.values.mean(axis=1)
    # what is most likely wrong with impossible readings
    hint = f"{names[1]} and {names[2]} together are more than {names[0]} can cause"
    for number in (2, 1):
        if means[number] < means[3]:
            hint = f"{names[number]} is below {names[3]}; are columns exchanged?"
        if means[number] > means[0]:
            hint = f"{names[number]} is above {names[0]}; are columns exchanged?"
    hint = warnings[0] if warnings else hint
    source = f"{readings.places[0].rpartition(':')[0]}: " if readings.places else ""
    for name, one in first.items():
        shown = method.remainder if name == "emissivity" else name
        low, high = one.interval
        if high < -_ROUNDING or low > 1.0 + _ROUNDING:
            raise ConfigurationError(
                f"{source}{shown} {one} is impossible, it lies between 0 and 1: {hint}"
            )
        if not -_ROUNDING <= one.value <= 1.0 + _ROUNDING:
            warnings.append(
                f"{shown} {one.value:.3g} is beyond its bound by less than its uncertainty; value "
                "and interval are cut there"
            )
        elif low < -_ROUNDING or high > 1.0 + _ROUNDING:
            warnings.append(
                f"the interval of {shown}, {low:.3g} to {high:.3g}, is cut at its bound"
            )
    if not readings.uncertainties.any() and rows.shape[1] == 1:
        warnings.append("no reading states an uncertainty: the interval of one row has no width")
    apart = abs(means[0]) / max(np.abs(means[1:])) if light else 0.0
    unit = f"{names[0]} is {apart:.3g} times the others: is it in mW and they in W?"
    warnings += doubts_of(
        method.remainder, ABSORPTANCE if light else EMISSIVITY, first["emissivity"].value,
        unit if apart >= _OTHER_UNIT else "",
    )  # fmt: skip
    inputs, spread = _inputs(readings)
    slopes = _derivatives(readings, inputs.mean(axis=1))
    stated = np.sqrt(((slopes * spread) ** 2).sum(axis=1))[2]
    scatter = float(rows[2].std(ddof=1)) if rows.shape[1] > 1 else 0.0
    if scatter > _FAR_ABOVE * stated > 0.0:
        warnings.append(Doubt(
            f"{method.remainder} varies by {scatter:.2g} from row to row, where the readings' "
            f"accuracy allows {stated:.2g}: not all rows are of one film in one state"
        ))  # fmt: skip
    if not light:
        warnings += ambient_doubts(readings.values[3])
        warnings += _unstated(readings, first["emissivity"])
    by_slopes, by_draws = (
        {name: one.clipped(0.0, 1.0) for name, one in found.items()} for found in (first, second)
    )
    warnings += [*copies(*readings.values), *readings.warnings]
    return RadiativeProperties(readings, rows, by_slopes, by_draws, tuple(warnings))


def _unstated(readings: Readings, one: Estimate) -> list[str]:
    """What the camera's band and the film's own emission may do where they are not stated."""
    scene, camera = readings.scene, readings.scene.camera
    means = readings.values.mean(axis=1)
    said: list[str] = []
    if camera is None or camera.assumed:
        other = UNCOOLED if camera is None else _SHORTER
        seen = Scene(other, scene.hotplate_emissivity, scene.film_temperature)
        of_means = Readings(readings.method, means[:, None], readings.uncertainties, seen)
        found = float(properties_of(of_means)[2, 0])
        said.append(
            f"T⁴ is no camera's response: one of {other.name} with these readings sees an "
            f"emissivity of {found:.3f}, the bias is {one.value - found:+.3f}; state the camera's "
            "band"
            if camera is None
            else f"the camera's band is assumed to be {camera.name}; with {other.name} the "
            f"emissivity is {found:.3f} in place of {one.value:.3f}; state the camera's band"
        )
    if scene.film_temperature is not None or not 0.0 < one.value < 1.0:
        return said
    hot, _, _, cold = means
    radiated = one.value * STEFAN_BOLTZMANN

    def gained(film: float) -> float:
        return float(radiated * (hot**4 + cold**4 - 2.0 * film**4)
                     - 2.0 * FREE_CONVECTION * (film - cold))  # fmt: skip

    film = optimize.brentq(gained, cold, hot)
    law = _law(readings)[0]
    share = float((law(film) - law(cold)) / (law(hot) - law(cold)))
    missing = 2.0 * share * one.value
    if missing >= max(_WORTH_SAYING * (one.uncertainty or 0.0), _ROUNDING):
        said.append(
            f"the film is taken to be as cold as its surroundings; in still air it is about "
            f"{film - cold:.0f} K warmer, and the emissivity about {missing:.3f} higher; state the "
            "film's temperature"
        )
    return said
