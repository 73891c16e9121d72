"""Names of axes in files of spectra: which quantity, which unit, what is refused."""

import re
from typing import NamedTuple

PER_CENTIMETRE = 100.0  # One reciprocal centimetre [1/m]

_WAVENUMBERS = {
    "1/cm", "/cm", "cm-1", "cm^-1", "cm**-1", "cm⁻¹", "wavenumber", "wavenumbers",
    "wavenumbercm-1", "wavenumbers(cm-1)", "wn", "reciprocalcentimeters",
}  # fmt: skip
_WAVELENGTHS = {
    "nm": 1e-9, "nanometer": 1e-9, "nanometers": 1e-9, "nanometre": 1e-9, "nanometres": 1e-9,
    "um": 1e-6, "micrometer": 1e-6, "micrometers": 1e-6, "micrometre": 1e-6, "micrometres": 1e-6,
    "micron": 1e-6, "microns": 1e-6,
}  # fmt: skip
_AXIS = re.compile(r"^(?:wave(?:number|length)s?)?[\[(/]?(.*?)[\])]?$")

_QUANTITIES = {
    "t": "transmittance", "trans": "transmittance", "transmittance": "transmittance",
    "transmission": "transmittance", "transmitance": "transmittance",
    "r": "reflectance", "refl": "reflectance", "reflectance": "reflectance",
    "reflection": "reflectance", "reflectivity": "reflectance",
    "a": "absorbance", "abs": "absorbance", "absorbance": "absorbance",
    "absorbanceunits": "absorbance", "opticaldensity": "absorbance", "od": "absorbance",
    "log(1/r)": "log(1/R)", "log1/r": "log(1/R)", "-log(r)": "log(1/R)", "-logr": "log(1/R)",
    "": "",
}  # fmt: skip
_REFUSED = (
    (r"kubelka|\bk-?m\b", "Kubelka-Munk units, from which no reflectance follows without the "
     "scattering; export it as %R"),
    (r"interferogram|i-?gram", "an interferogram; export the spectrum as %T or %R"),
    (r"single.?(?:beam|channel)|\bsb(?:eam)?\b|\begy\b|energy|background|reference",
     "a single beam; divide it by its background and export %T or %R"),
    (r"\barb", "arbitrary units, which are no share of light; export %T or %R"),
    (r"raman", "Raman intensity, not transmittance or reflectance"),
    (r"emi(?:ssion|ttance|ssivity)", "emission, not transmittance or reflectance"),
    (r"photoacoustic", "a photoacoustic signal, not transmittance or reflectance"),
    (r"\batr\b", "ATR units, which depend on the crystal; "
     "measure transmittance and reflectance"),
    (r"absorptance|absorption", "absorption; export transmittance or reflectance"),
    (r"derivative", "a derivative; export the spectrum itself"),
)  # fmt: skip


class Axis(NamedTuple):
    """Unit of an abscissa."""

    scale: float  # To 1/m or m
    is_wavelength: bool


class OrdinateUnit(NamedTuple):
    """Quantity of an ordinate."""

    # ``"transmittance"``, ``"reflectance"``, ``"absorbance"``, ``"log(1/R)"``, or empty where the
    # name tells none
    quantity: str
    percent: bool  # Whether the name says per cent


def axis_of(name: str) -> Axis | None:
    """Unit that the name of an abscissa states."""
    text = re.sub(r"\s+", "", name.casefold()).replace("µ", "u").replace("μ", "u")
    match = _AXIS.match(text)
    inner = match[1] if match else text
    if text in _WAVENUMBERS or inner in _WAVENUMBERS:
        return Axis(PER_CENTIMETRE, is_wavelength=False)
    scale = _WAVELENGTHS.get(text, _WAVELENGTHS.get(inner))
    return None if scale is None else Axis(scale, is_wavelength=True)


def parse_ordinate(name: str) -> OrdinateUnit | str:
    """Quantity that the name of an ordinate states."""
    text = " ".join(name.casefold().split())
    percent = "%" in text or "percent" in text or "per cent" in text
    core = re.sub(r"per ?cent(?:age)?|%|\bunits?\b", "", text)
    core = re.sub(r"[\s_]+|\[\s*\]|\(\s*\)|[\[(]a\.?u\.?[\])]", "", core).strip("-.:,;/")
    core = core[1:-1] if core.startswith("(") and core.endswith(")") else core
    quantity = _QUANTITIES.get(core)
    if quantity is not None:
        return OrdinateUnit(quantity, percent)
    for pattern, what in _REFUSED:
        if re.search(pattern, text):
            return f"shows {what}"
    return f'shows "{name[:40]}", which is not known as transmittance, reflectance or absorbance'
