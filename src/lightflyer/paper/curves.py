"""Numbers behind the paper's figures, as tables that are written beside them."""

from collections.abc import Callable, Iterator

import numpy as np

from lightflyer.core import constants
from lightflyer.design.outputs import OUTPUTS
from lightflyer.paper.conditions import (
    COLUMNS,
    Table,
    atmosphere,
    facts,
    film,
    in_chamber,
    over_altitude,
)
from lightflyer.paper.results import bands, best_payload, film_mass, planck_per_wavenumber

Curves = dict[str, np.ndarray]  # Columns by name with unit; all of a figure have one length
TORR = constants.SEA_LEVEL_PRESSURE / 760.0  # Definition of the unit [Pa]

COATINGS = ("ge", "cnt")
PANEL_SIZES_CM = (2, 3, 4)  # Diameters of Fig. 5(b-d) [cm]
SIZES_CM = np.round(np.arange(0.2, 6.01, 0.05), 2)  # Diameters of Fig. S8 [cm]
LARGER_SIZES_CM = (3, 4)  # Diameters of Fig. S7(a, b) and (c, d) [cm]
PLANCK_TEMPERATURES = (400, 500)  # Temperatures of Fig. 3(c) [K]

MAP_PRESSURES_MTORR = np.geomspace(1.0, 300.0, 61)
MAP_IRRADIANCES = np.linspace(0.0, 4000.0, 41)

_CENTIMETRE = 1e-2
_MILLI = 1e-3
_KILO = 1e3
_OBLIQUE = 45.0  # degrees, Fig. 6(a)
_ALTITUDES_KM = np.linspace(55.0, 90.0, 351)


def _curve(words: str, output: str, table: Table) -> Curves:
    """A column of an output, in the unit it is shown in; NaN where there is no value."""
    factor, unit = OUTPUTS[output].shown
    values = factor * table[output]
    return {f"{words} [{unit or 1}]": np.where(np.isfinite(values), values, np.nan)}


def figure_3c() -> Curves:
    """Planck radiance over the wavenumbers of the measured spectra."""
    wavenumber = np.linspace(400.0, 4000.0, 361)
    curves = {"wavenumber [1/cm]": wavenumber}
    for temperature in PLANCK_TEMPERATURES:
        radiance = planck_per_wavenumber(wavenumber, temperature)
        curves[f"radiance at {temperature} K [W/(m^2 sr cm^-1)]"] = radiance
    return curves


def figure_5a() -> Curves:
    """Temperature of the 2-cm disks over pressure and irradiance, reported reading."""
    pressure, light = np.meshgrid(MAP_PRESSURES_MTORR, MAP_IRRADIANCES, indexing="ij")
    curves = {"pressure [mTorr]": pressure.ravel(), "irradiance [W/m^2]": light.ravel()}
    for coating in COATINGS:
        table = in_chamber(
            COLUMNS[1],
            film(coating),
            curves["pressure [mTorr]"] * _MILLI * TORR,
            PANEL_SIZES_CM[0] * _CENTIMETRE,
            curves["irradiance [W/m^2]"],
        )
        curves |= _curve(f"temperature {coating}", "temperature", table)
        curves |= _curve(f"lift over weight {coating}", "lift_over_weight", table)
    return curves


def figure_5bcd() -> Curves:
    """Irradiance to levitate against pressure, both coatings, three sizes, all readings."""
    pressure = np.geomspace(1.0, 300.0, 201)
    curves = {"pressure [mTorr]": pressure, "pressure [Pa]": pressure * _MILLI * TORR}
    for size in PANEL_SIZES_CM:
        for coating in COATINGS:
            for column in COLUMNS:
                table = in_chamber(
                    column, film(coating), curves["pressure [Pa]"], size * _CENTIMETRE
                )
                words = f"irradiance {size} cm {coating} {column.key}"
                curves |= _curve(words, "levitation_irradiance", table)
    return curves


def _flight_curves(size_cm: float, words: str = "") -> Curves:
    """Irradiance and temperature to levitate against altitude, all readings."""
    curves: Curves = {}
    for column in COLUMNS:
        for name, incidence in (("", 0.0), (" 45 deg", _OBLIQUE)):
            table = over_altitude(
                column,
                _ALTITUDES_KM * _KILO,
                size_cm * _CENTIMETRE,
                constants.SOLAR_CONSTANT_LU2023,
                incidence,
            )
            label = f"irradiance{name}{words} {column.key}"
            curves |= _curve(label, "levitation_irradiance", table)
        curves |= _curve(f"temperature{words} {column.key}", "levitation_temperature", table)
    return curves


def _altitudes() -> Curves:
    """Altitudes of the curves, and the temperature of the air."""
    _, temperature = atmosphere(_ALTITUDES_KM * _KILO)
    return {"altitude [km]": _ALTITUDES_KM, "gas temperature [K]": temperature}


def figure_6() -> Curves:
    """Irradiance and temperature to levitate against altitude, 2 cm, all readings."""
    return _altitudes() | _flight_curves(PANEL_SIZES_CM[0])


def figure_s7() -> Curves:
    """As Fig. 6 for larger disks."""
    curves = _altitudes()
    for size in LARGER_SIZES_CM:
        curves |= _flight_curves(size, f" {size} cm")
    return curves


def figure_s8() -> Curves:
    """Altitudes and largest payload over size, each at its best altitude, all readings."""
    curves = {"diameter [cm]": SIZES_CM}
    for column in COLUMNS:
        lower, best, upper = bands(column, SIZES_CM * _CENTIMETRE)
        for name, altitude in (("lower edge", lower), ("optimal", best), ("upper edge", upper)):
            curves[f"{name} {column.key} [km]"] = altitude / _KILO
        _, relative = best_payload(column, SIZES_CM * _CENTIMETRE)
        curves[f"payload {column.key} [mg]"] = relative * film_mass(SIZES_CM * _CENTIMETRE)
        curves[f"relative payload {column.key} [1]"] = relative
    return curves


FIGURES: dict[str, tuple[str, Callable[[], Curves]]] = {
    "figure-3c": ("Fig. 3(c), right axis", figure_3c),
    "figure-5a": ("Fig. 5(a)", figure_5a),
    "figure-5bcd": ("Fig. 5(b–d)", figure_5bcd),
    "figure-6": ("Fig. 6(a, b)", figure_6),
    "figure-s7": ("Fig. S7(a–d)", figure_s7),
    "figure-s8": ("Fig. S8(a, b)", figure_s8),
}
"""Title of each figure and the function that computes its numbers, by file name."""


def captions() -> dict[str, str]:
    """Caption of each figure, with its conditions, by file name."""
    chamber = facts()["chamber"]["note"]
    versions = (
        "Figs. 6 and S8 of the paper may come from slightly different versions of its model: the "
        "3-cm payload in its text follows if (20) takes the mean temperature, not the disk's."
    )
    return {
        "figure-3c": "Blackbody radiance per wavenumber at 400 K and 500 K; shaded, the window of "
        "900 ± 400 cm⁻¹. The measured spectra of the left axis are not available.",
        "figure-5a": f"Temperature of 2-cm disks over pressure and irradiance, reported reading; "
        f"above the white line they levitate. {chamber}",
        "figure-5bcd": f"Irradiance to levitate against pressure. {chamber}",
        "figure-6": f"2-cm disk in the paper's atmosphere: (a) irradiance to levitate, at normal "
        f"incidence and 45°; (b) its temperature when it just levitates, and that of the air. "
        f"{versions}",
        "figure-s7": "As Fig. 6, for disks of (a, b) 3 cm and (c, d) 4 cm. The paper's caption "
        "refers to Fig. 5, but its text speaks of altitudes.",
        "figure-s8": f"Over the disk's diameter, at 1360 W/m²: (a) altitudes at which it levitates "
        f"(shaded for the reported reading, edges for the others) and altitude of the largest "
        f"payload; (b) largest payload, thick, and relative payload, thin. {versions}",
    }


def rows(curves: Curves) -> Iterator[str]:
    """Lines of a CSV file with the curves; a cell without a value is empty."""
    yield ",".join(curves)
    for values in zip(*curves.values(), strict=True):
        yield ",".join("" if np.isnan(value) else f"{value:.8g}" for value in values)
