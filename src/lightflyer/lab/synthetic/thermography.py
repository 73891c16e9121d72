"""Synthetic readings of a thermal camera and of a light meter."""

import numpy as np

from lightflyer.lab.synthetic._faults import faulty_table, label

REFLECTANCE, TRANSMITTANCE = 0.12, 0.80
"""Properties of the synthetic film in the infrared; its emissivity is 0.08."""
VISIBLE_REFLECTANCE, VISIBLE_TRANSMITTANCE = 0.15, 0.10
"""Properties of the synthetic film in the visible; its absorptivity is 0.75."""

_HOTPLATE, _AMBIENT, _ZERO = 423.15, 295.15, 273.15  # [K]
_NOISE = 0.2  # [K]
_ROWS = 12


def thermography_files(seed: int = 0) -> dict[str, str]:
    """A table of temperatures, and one of a light meter's readings.

    Parameters
    ----------
    seed : int

    Returns
    -------
    dict of str to str
        Text by file name.
    """
    rng = np.random.default_rng(seed)
    span = _HOTPLATE**4 - _AMBIENT**4
    truth = [_HOTPLATE, *((share * span + _AMBIENT**4) ** 0.25
                          for share in (REFLECTANCE, TRANSMITTANCE)), _AMBIENT]  # fmt: skip
    rows = [
        [f"{value - _ZERO + _NOISE * rng.normal():.2f}" for value in truth] for _ in range(_ROWS)
    ]
    names = ("Hotplate temperature", "Lower temperature", "Upper temperature",
             "Ambient temperature")  # fmt: skip
    dark, incident = 12.0, 1800.0
    meter = [incident, VISIBLE_REFLECTANCE * incident, VISIBLE_TRANSMITTANCE * incident, 0.0]
    light = [
        [f"{(value + dark) * (1.0 + 0.005 * rng.normal()):.1f}" for value in meter]
        for _ in range(_ROWS)
    ]
    emissivity = 1.0 - REFLECTANCE - TRANSMITTANCE
    said = f"truth: r {REFLECTANCE}, t {TRANSMITTANCE}, emissivity {emissivity:.2f}"
    absorbed = 1.0 - VISIBLE_REFLECTANCE - VISIBLE_TRANSMITTANCE
    visible = f"truth: r {VISIBLE_REFLECTANCE}, t {VISIBLE_TRANSMITTANCE}, absorptivity {absorbed}"
    return {
        "thermal.csv": faulty_table(
            label("thermography", said), [f"{name} (°C)" for name in names], rows, rng,
            delimiter=";", decimal_comma=True,
        ),
        "light-meter.csv": faulty_table(
            label("thermography", visible), ["incident", "reflected", "transmitted", "dark"],
            light, rng,
        ),
    }  # fmt: skip
