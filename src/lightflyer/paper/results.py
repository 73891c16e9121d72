"""Numbers behind the paper's claims, by each reading, and tables 1 and S2 with derived columns.

The numbers have the keys and the units of the quantities in ``data/lu2023.toml``. A cell that the
paper's text does not give is None, in CSV ``not available``.
"""

import math
import statistics
from typing import Any

import numpy as np
from scipy.constants import c, h, k
from scipy.optimize import brentq, minimize_scalar

from lightflyer.array.namespace import Numeric
from lightflyer.core import constants
from lightflyer.design.outputs import OUTPUTS, json_name
from lightflyer.film.properties import FilmProperties
from lightflyer.paper.conditions import (
    KINETIC,
    POINTS,
    Column,
    atmosphere,
    facts,
    film,
    in_chamber,
    over_altitude,
)
from lightflyer.statics.grid_refinement import Function, crossing, peak

SEARCHED_ALTITUDES = (50e3, 95e3)  # Range in which bands and best payloads are searched [m]
SEARCHED_PRESSURES = (1e-1, 1e2)  # Range in which the chamber's optimum is searched [Pa]
CHECKED_ALTITUDES = (68e3, 72e3, 78e3)  # Altitudes of the check table [m]

CHECKED_OUTPUTS = (
    "gas_temperature",
    "pressure",
    "levitation_temperature",
    "levitation_irradiance",
    "temperature",
    "lift_over_weight",
)
"""Outputs in the check table."""

_CENTIMETRE = 1e-2
_KILOMETRE = 1e3
_KILOWATT = 1e3
_MILLIGRAM = 1e-6
_NANOMETRE = 1e-9
_DISK = 2.0 * _CENTIMETRE
_GRAMS = 1e3
_LAYERS = (("alumina", 50.0), ("germanium", 20.0), ("mylar", 500.0), ("germanium", 20.0))
_LOOK_POINTS = POINTS // 4
_FLAT = 1e-8  # closer than usual: a search over diameters compares such maxima
_MILLIMETRES = 3  # decimals of an optimum's place: further ones are rounding of the payload
_DIAMETER_DIGITS = 5  # of a diameter in cm, to which it is searched

NOT_AVAILABLE = "not available"

Row = dict[str, Any]

_MOST_TESTS = 3  # of one material in Table S2


def band(column: Column, incidence_deg: float = 0.0) -> tuple[float, float]:
    """Altitudes [m] between which the 2-cm disk levitates in sunlight; ``incidence_deg`` [deg]."""
    lower, _, upper = bands(column, _DISK, incidence_deg)
    return float(lower[0]), float(upper[0])


def bands(
    column: Column, diameter: Any, incidence_deg: float = 0.0
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Altitudes [m] between which disks levitate in sunlight, and of their largest payload."""
    diameters = np.atleast_1d(np.asarray(diameter, float))

    def margin(altitude: Any) -> np.ndarray:
        light = constants.SOLAR_CONSTANT_LU2023
        asked = ("lift_over_weight",)
        table = over_altitude(column, altitude, diameters, light, incidence_deg, asked)
        return table["lift_over_weight"] - 1.0

    best, height = _maximum(margin, *SEARCHED_ALTITUDES)
    edges = [crossing(margin, np.full_like(best, end), best) for end in SEARCHED_ALTITUDES]
    flies = height >= 0.0
    lower, best, upper = (np.where(flies, place, np.nan) for place in (edges[0], best, edges[1]))
    return lower, best, upper


def _maximum(function: Function, low: Numeric, high: Numeric) -> tuple[np.ndarray, np.ndarray]:
    return peak(function, low, high, points=_LOOK_POINTS, flat=_FLAT)


def best_payload(column: Column, diameter: Any) -> tuple[np.ndarray, np.ndarray]:
    """Largest payload of disks over all altitudes, in sunlight [m], shape (m,); and."""
    diameters = np.atleast_1d(np.asarray(diameter, float))

    def relative(altitude: np.ndarray) -> np.ndarray:
        light, asked = constants.SOLAR_CONSTANT_LU2023, ("relative_payload",)
        return over_altitude(column, altitude, diameters, light, names=asked)["relative_payload"]

    best, payload = _maximum(relative, *SEARCHED_ALTITUDES)
    return np.round(best, _MILLIMETRES), payload


def film_mass(diameter: Any) -> Any:
    """Mass of a germanium-coated disk [mg] of a diameter [m]."""
    density = facts()["film"]["ge"]["areal_density_g_m2"] / _GRAMS
    return np.pi * (0.5 * np.asarray(diameter)) ** 2 * density / _MILLIGRAM


def optimum(column: Column, properties: FilmProperties, diameter: float) -> dict[str, float]:
    """Pressure [Pa], irradiance [W/m²] and temperature [K] where least light levitates a disk."""

    def table(log_pressure: Any) -> dict[str, np.ndarray]:
        return in_chamber(column, properties, np.exp(log_pressure), diameter)

    low, high = np.log(SEARCHED_PRESSURES)
    point, value = _maximum(lambda x: -table(x)["levitation_irradiance"], low, high)
    there = table(point)
    return {
        "pressure": float(np.exp(point[0])),
        "irradiance": float(-value[0]),
        "temperature": float(there["levitation_temperature"][0]),
    }


def planck_per_wavenumber(wavenumber_per_cm: Any, temperature: Any) -> np.ndarray:
    r"""Blackbody radiance per wavenumber [W/(m² sr cm⁻¹)]; ``wavenumber_per_cm`` [1/cm]."""
    # .. math:: L_{\tilde\nu} = \frac{2hc^2\tilde\nu^3}{\exp(hc\tilde\nu/kT) - 1}
    per_metre = np.asarray(wavenumber_per_cm) / _CENTIMETRE
    photon = h * c * per_metre / (k * np.asarray(temperature))
    return 2.0 * h * c**2 * per_metre**3 / np.expm1(photon) / _CENTIMETRE


def planck_peak(temperature: float) -> float:
    """Wavenumber [1/cm] at which the blackbody radiance per wavenumber is largest."""
    found = minimize_scalar(
        lambda x: -planck_per_wavenumber(x, temperature), bounds=(1.0, 1e4), method="bounded"
    )
    return float(found.x)


def _altitude_values(column: Column) -> dict[str, float]:
    light = constants.SOLAR_CONSTANT_LU2023
    values = {}
    for name, incidence in (("band", 0.0), ("band_45", 45.0)):
        edges = band(column, incidence)
        values[f"{name}_low"], values[f"{name}_high"] = (edge / _KILOMETRE for edge in edges)
        if name == "band":
            pressures, _ = atmosphere(np.array(edges))
            values["band_pressure_low"], values["band_pressure_high"] = map(float, pressures)
    _, coldest = _maximum(
        lambda x: -over_altitude(column, x, _DISK, light)["levitation_temperature"],
        *SEARCHED_ALTITUDES,
    )
    values["coldest"] = float(-coldest[0])
    return values


def _payload_values(column: Column) -> dict[str, float]:
    small, three = 0.5 * _CENTIMETRE, 3.0 * _CENTIMETRE
    altitude, relative = best_payload(column, [small, three])

    def excess(diameter: float, wanted: float) -> float:
        return float(best_payload(column, diameter)[1][0]) - wanted

    largest, own_weight = (
        brentq(excess, 1e-3, 0.2, args=(wanted,), xtol=1e-7) / _CENTIMETRE for wanted in (0.0, 1.0)
    )
    most = minimize_scalar(
        lambda x: -best_payload(column, x)[1][0] * film_mass(x),
        bounds=(1e-3, 0.1),
        method="bounded",
        options={"xatol": 1e-6},
    )
    return {
        "payload_3cm": float(relative[1] * film_mass(three)),
        "relative_payload_3cm": float(relative[1]),
        "altitude_3cm": float(altitude[1] / _KILOMETRE),
        "payload_05cm": float(relative[0] * film_mass(small)),
        "relative_payload_05cm": float(relative[0]),
        "altitude_05cm": float(altitude[0] / _KILOMETRE),
        "diameter_most_payload": round(float(most.x) / _CENTIMETRE, _DIAMETER_DIGITS),
        "diameter_largest": round(largest, _DIAMETER_DIGITS),
        "diameter_own_weight": round(own_weight, _DIAMETER_DIGITS),
    }


def common_values() -> dict[str, float]:
    """Numbers that do not depend on the reading."""
    pressures, _ = atmosphere(np.array([50e3, 100e3]))
    _, temperatures = atmosphere(np.linspace(50e3, 100e3, 5001))
    peak = 0.5 * (planck_peak(400.0) + planck_peak(500.0))
    density = facts()["density"]
    areal = sum(density[name] * thickness * _NANOMETRE for name, thickness in _LAYERS)
    names = {"infrared": "emissivity", "visible": "absorptivity"}
    values = {
        f"{names[row['band']]}_{row['sample'].lower()}": row["absorptance_from_t_and_r"]
        for row in table_1()
    }
    for row in table_s2():
        sample = row["sample"].lower()
        values[f"tac_{sample}"], values[f"tac_spread_{sample}"] = row["mean"], row["deviation"]
    return {
        "pressure_50km": float(pressures[0]),
        "pressure_100km": float(pressures[1]),
        "mesosphere_coldest": float(temperatures.min()),
        "mesosphere_warmest": float(temperatures.max()),
        "areal_density": float(areal * _GRAMS),
        "planck_peak": peak,
        "planck_peak_wavelength": 1e4 / peak,
        **values,
    }


def column_values(column: Column) -> dict[str, float]:
    """Numbers of one column, without the common ones."""
    best = {
        (coating, size): optimum(column, film(coating), size * _CENTIMETRE)
        for coating in ("ge", "cnt")
        for size in (2, 3, 4)
    }
    values = {}
    for coating in ("ge", "cnt"):
        heavy = film(coating, facts()["chamber"]["heavy_g_m2"])
        for suffix, there in (
            ("", best[coating, 2]),
            ("_heavy", optimum(column, heavy, _DISK)),
        ):
            values[f"optimum_temperature_{coating}{suffix}"] = there["temperature"]
            values[f"optimum_irradiance_{coating}{suffix}"] = there["irradiance"] / _KILOWATT
    for size in (2, 3, 4):
        ratio = best["ge", size]["irradiance"] / best["cnt", size]["irradiance"]
        values[f"reduction_{size}cm"] = 100.0 * (1.0 - ratio)
    return {**_altitude_values(column), **_payload_values(column), **values}


def kinetic_values() -> dict[str, float | None]:
    """Numbers of the mesosphere by kinetic theory; none where the disk flies nowhere."""
    # Those of the chamber depend on its floor and walls, which the paper's model does not have.
    light = constants.SOLAR_CONSTANT_LU2023
    _, most = _maximum(
        lambda x: over_altitude(KINETIC, x, _DISK, light)["lift_over_weight"], *SEARCHED_ALTITUDES
    )
    found = {
        **_altitude_values(KINETIC),
        **_payload_values(KINETIC),
        "largest_lift": float(most[0]),
    }
    return {name: value if np.isfinite(value) else None for name, value in found.items()}


def check_values(column: Column) -> list[dict[str, float]]:
    """Outputs of the 2-cm disk at three altitudes, in more digits than the paper gives."""
    altitude = np.array(CHECKED_ALTITUDES)
    table = over_altitude(column, altitude, _DISK, constants.SOLAR_CONSTANT_LU2023)
    columns = {json_name("altitude", "km"): altitude / _KILOMETRE}
    for name in CHECKED_OUTPUTS:
        key, factor = OUTPUTS[name].json
        columns[key] = factor * table[name]
    return [{name: float(v[i]) for name, v in columns.items()} for i in range(altitude.size)]


def emissivity_from(transmittance: float, reflectance: float) -> float:
    r"""Emissivity, or absorptivity, :math:`1 - \tau - \rho` [1]."""
    return 1.0 - transmittance - reflectance


def difference_uncertainty(first: float, second: float, correlation: float) -> float:
    r"""Standard uncertainty of a difference; ``correlation``: between -1 and 1."""
    # .. math:: u^2 = u_1^2 + u_2^2 - 2\rho\,u_1 u_2
    variance = first**2 + second**2 - 2.0 * correlation * first * second
    return math.sqrt(max(variance, 0.0))  # rounding may leave a negative zero


def table_1() -> list[Row]:
    """Optical properties of the films."""
    rows = []
    for stated in facts()["optical"]:
        transmittance, reflectance = stated["transmittance"], stated["reflectance"]
        errors = stated["transmittance_uncertainty"], stated["reflectance_uncertainty"]
        rows.append({
            "sample": stated["sample"],
            "band": stated["band"],
            "transmittance": transmittance,
            "transmittance_uncertainty": errors[0],
            "reflectance": reflectance,
            "reflectance_uncertainty": errors[1],
            "absorptance": stated["absorptance"],
            "absorptance_uncertainty": stated["absorptance_uncertainty"],
            "absorptance_from_t_and_r": emissivity_from(transmittance, reflectance),
            "its_uncertainty_independent": math.hypot(*errors),
            "its_uncertainty_sum": sum(errors),
            "upper_bound_from_t": emissivity_from(transmittance, 0.0),
            "upper_bound_ftir": stated.get("upper_bound_ftir"),
        })  # fmt: skip
    return rows


def table_s2() -> list[Row]:
    """Thermal accommodation coefficients: each test with its 95 % interval, and their mean."""
    rows = []
    for stated in facts()["accommodation"]:
        values = stated["tests"]
        tests: list[Any] = list(zip(values, stated["lowest"], stated["highest"], strict=True))
        tests += [(None, None, None)] * (_MOST_TESTS - len(tests))
        row: Row = {"sample": stated["sample"]}
        for number, (tac, lowest, highest) in enumerate(tests, start=1):
            row |= {f"test_{number}": tac, f"lowest_{number}": lowest, f"highest_{number}": highest}
        row["literature"] = stated.get("literature")
        row["mean"], row["deviation"] = statistics.mean(values), statistics.stdev(values)
        row["printed_mean"] = stated.get("tac")
        row["printed_uncertainty"] = stated.get("tac_uncertainty")
        rows.append(row)
    return rows


def tac_pairs() -> list[Row]:
    """Pairs of faces: mean TAC, and their difference with its uncertainty."""
    stated = {row["sample"]: row for row in facts()["accommodation"]}
    rows = []
    for bottom in ("Ge", "CNT"):
        for top in ("mylar", "alumina"):
            tac = stated[top]["tac"], stated[bottom]["tac"]
            errors = stated[top]["tac_uncertainty"], stated[bottom]["tac_uncertainty"]
            rows.append(
                {
                    "top": top,
                    "bottom": bottom,
                    "tac_top": tac[0],
                    "tac_top_uncertainty": errors[0],
                    "tac_bottom": tac[1],
                    "tac_bottom_uncertainty": errors[1],
                    "tac_mean": 0.5 * (tac[0] + tac[1]),
                    "tac_difference": tac[1] - tac[0],
                    "difference_uncertainty_independent": difference_uncertainty(*errors, 0.0),
                    "difference_uncertainty_correlated": difference_uncertainty(*errors, 1.0),
                }
            )
    return rows


def to_csv(rows: list[Row]) -> str:
    """Rows as comma-separated values with a header; ``rows``: all with the same keys."""
    lines = [",".join(rows[0])]
    for row in rows:
        given = (NOT_AVAILABLE if value is None else value for value in row.values())
        cells = (f"{value:.6g}" if isinstance(value, float) else str(value) for value in given)
        lines.append(",".join(cells))
    return "\n".join(lines) + "\n"
