"""Synthetic spectra of a thin film on mylar, UV-visible and infrared."""

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

_SAMPLE = """\
# Germanium on mylar, free-standing: how thick and how porous is it?
#   lightflyer lab optics sample.toml --out optics

free = [
  {number = "layers.0.thickness", lowest = "5 nm", highest = "100 nm"},
  {number = "layers.0.porosity"},
  {number = "layers.1.thickness", lowest = "300 nm", highest = "800 nm"},
]

[[spectra]]
file = "visible-transmittance.csv"
scale_accuracy = "1 %"                 # standard uncertainty of the 100 % line
zero_accuracy = "0.1 %"                # and of the zero, in shares of full scale

[[spectra]]
file = "visible-reflectance.csv"
incidence = "8 deg"
collection = "specular"
scale_accuracy = "1 %"
zero_accuracy = "0.1 %"

[[spectra]]
file = "infrared-transmittance.csv"
scale_accuracy = "1 %"
zero_accuracy = "0.1 %"

[film]
layers = [                             # top to bottom
  {material = "Ge", porosity = 0.2, thickness = "20 nm"},
  {material = "PET", thickness = "500 nm"},
]
"""


def true_film() -> Film:
    """The film of the synthetic spectra."""
    germanium = porous(material("Ge"), TRUTH["porosity"])
    return Film((Layer(germanium, TRUTH["germanium"]), Layer(material("PET"), TRUTH["mylar"])))


def optics_files(seed: int = 0) -> dict[str, str]:
    """Spectra of a film with noise and errors of their scales, and a sample file."""
    rng = np.random.default_rng(seed)
    film = true_film()
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
    files = {"sample.toml": _SAMPLE}
    for name, (axis, ordinate, points, share) in made.items():
        value = share.mean(axis=0) * (1.0 + _SCALE * rng.normal()) + _noise(rng, points.size)
        rows = (f"{x:g},{100.0 * y:.4f}" for x, y in zip(points, value, strict=True))
        files[name] = "\n".join([*lines, f"{axis},{ordinate}", *rows]) + "\n"
    return files


def _noise(rng: np.random.Generator, size: int) -> np.ndarray:
    raw = rng.normal(size=size + _SMOOTHED - 1)
    return _NOISE * np.convolve(raw, np.ones(_SMOOTHED), mode="valid") / np.sqrt(_SMOOTHED)
