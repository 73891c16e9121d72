"""Synthetic infrared spectra of a film."""

import numpy as np

from lightflyer.lab.synthetic.faults import faulty_table, label

_FIRST, _LAST, _STEP = 400.0, 4000.0, 2.0  # [1/cm]
_NOISE = 0.002
_LEVEL = 0.89  # transmittance between the bands
# centre, half width [1/cm] and depth of absorption bands, roughly those of PET film
_BANDS = ((728.0, 8.0, 0.30), (1100.0, 25.0, 0.22), (1245.0, 25.0, 0.28), (1725.0, 12.0, 0.40),
          (2960.0, 30.0, 0.05))  # fmt: skip
_REFLECTANCE = 0.04


def true_transmittance(wavenumber: np.ndarray) -> np.ndarray:
    """True transmittance of the synthetic spectra [1], shape (n,); ``wavenumber`` (n,) [1/cm]."""
    value = np.full_like(wavenumber, _LEVEL)
    for centre, half_width, depth in _BANDS:
        value = value - _LEVEL * depth / (1.0 + ((wavenumber - centre) / half_width) ** 2)
    return value


def ftir_files(seed: int = 0) -> dict[str, str]:
    """Spectra of transmittance as JCAMP-DX and as a table, and a spectrum of reflectance."""
    rng = np.random.default_rng(seed)
    wavenumber = np.arange(_FIRST, _LAST + 0.5 * _STEP, _STEP)
    truth = true_transmittance(wavenumber)
    inside = (wavenumber >= 500.0) & (wavenumber <= 1300.0)
    mean = np.trapezoid(truth[inside], wavenumber[inside]) / 800.0
    lines = label("ftir", f"truth: mean transmittance over 500-1300 cm^-1 {mean:.5f}, "
                          f"reflectance {_REFLECTANCE}")  # fmt: skip
    first, second = (truth + _NOISE * rng.normal(size=len(truth)) for _ in range(2))
    reflected = _REFLECTANCE + _NOISE * rng.normal(size=len(truth))
    rows = [
        [f"{1e4 / nu:.6f}", f"{100.0 * value:.4f}"]
        for nu, value in zip(wavenumber[::-1], second[::-1], strict=True)
    ]
    mirror = [f"{nu:.1f},{value:.6f}" for nu, value in zip(wavenumber, reflected, strict=True)]
    factor = 1e-6
    whole = np.round(first / factor).astype(int)
    table = [
        f"{wavenumber[start]:.1f} " + " ".join(map(str, whole[start : start + 6]))
        for start in range(0, len(whole), 6)
    ]
    header = {
        "TITLE": lines[0].lstrip("# "), "JCAMP-DX": "4.24", "DATA TYPE": "INFRARED SPECTRUM",
        "ORIGIN": "lightflyer", "OWNER": "public domain", "XUNITS": "1/CM",
        "YUNITS": "TRANSMITTANCE", "XFACTOR": "1.0", "YFACTOR": f"{factor:g}",
        "FIRSTX": f"{wavenumber[0]:g}", "LASTX": f"{wavenumber[-1]:g}",
        "FIRSTY": f"{first[0]:.6f}", "NPOINTS": str(len(whole)), "XYDATA": "(X++(Y..Y))",
    }  # fmt: skip
    labels = [f"##{name}={content}" for name, content in header.items()]
    labels.insert(1, f"$$ {lines[1].lstrip('# ')}")
    return {
        "film.jdx": "\n".join([*labels, *table, "##END="]) + "\n",
        "film.csv": faulty_table(lines, ["Wavelength (µm)", "Transmittance (%)"], rows, rng,
                               delimiter=";", decimal_comma=True),
        "film-reflectance.csv": "\n".join([*lines, "cm-1,reflectance", *mirror]) + "\n",
    }  # fmt: skip
