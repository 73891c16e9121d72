"""Synthetic spectra of a thin film on mylar, UV-visible and infrared."""

from importlib import resources

import numpy as np

from lightflyer.film.media.library import material
from lightflyer.film.media.mixture import porous
from lightflyer.film.optics.stack import Film, Layer
from lightflyer.lab.synthetic.faults import label

TRUTH = {"germanium": 31e-9, "porosity": 0.35, "mylar": 512e-9}
"""Thicknesses [m] and porosity [1] of the synthetic film."""

_NOISE = 0.002
_SCALE = 0.008  # standard deviation of the errors of the ordinates' scales
_SMOOTHED = 5  # points over which the synthetic instrument averages its noise
_VISIBLE = np.arange(420.0, 901.0, 4.0)  # [nm]
_INFRARED = np.arange(700.0, 4001.0, 16.0)  # [1/cm]


def optics_files(seed: int = 0) -> dict[str, str]:
    """Spectra of a film with noise and errors of their scales, and a sample file."""
    rng = np.random.default_rng(seed)
    germanium = porous(material("Ge"), TRUTH["porosity"])
    film = Film((Layer(germanium, TRUTH["germanium"]), Layer(material("PET"), TRUTH["mylar"])))
    visible, infrared = film.optics(_VISIBLE * 1e-9), film.optics(0.01 / _INFRARED)
    tilted = film.optics(_VISIBLE * 1e-9, np.deg2rad(8.0))
    made = {
        "visible-transmittance.csv": ("wavelength [nm]", "transmittance [%]", _VISIBLE,
                                      visible.transmittance),
        "visible-reflectance.csv": ("wavelength [nm]", "reflectance [%]", _VISIBLE,
                                    tilted.reflectance),
        "infrared-transmittance.csv": ("wavenumber [cm^-1]", "transmittance [%]", _INFRARED,
                                       infrared.transmittance),
    }  # fmt: skip
    truth = ", ".join(f"{name} {value:g}" for name, value in TRUTH.items())
    lines = label("optics", f"truth: {truth} (m, 1, m)")
    sample = resources.files("lightflyer") / "data" / "optics-sample.toml"
    files = {"sample.toml": sample.read_text(encoding="utf-8")}
    for name, (axis, ordinate, points, share) in made.items():
        scale = _SCALE * rng.normal()
        raw = rng.normal(size=points.size + _SMOOTHED - 1)
        noise = _NOISE * np.convolve(raw, np.ones(_SMOOTHED), mode="valid") / np.sqrt(_SMOOTHED)
        value = share.mean(axis=0) * (1.0 + scale) + noise
        rows = (f"{x:g},{100.0 * y:.4f}" for x, y in zip(points, value, strict=True))
        files[name] = "\n".join([*lines, f"{axis},{ordinate}", *rows]) + "\n"
    return files
