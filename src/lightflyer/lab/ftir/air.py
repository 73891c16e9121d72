r"""Lines of carbon dioxide and water vapour, taken out of infrared spectra.

The path between the measurement of the background and that of the sample loses or gains air. With
the transmittance :math:`\tau_a` of some air, the film's own is :math:`\tau\,\tau_a^{-c}`. The
amount :math:`c` of each gas is the one that leaves the smoothest spectrum: that with the least
squares of the differences between neighbouring points, which lines are large in and films are not.
"""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from lightflyer.core.errors import ConfigurationError, ParameterError
from lightflyer.files.quantities import ends
from lightflyer.lab.readers.spectra.interpretation import PER_CENTIMETRE, MeasuredSpectrum

GASES = {
    "CO₂": ((600.0, 740.0), (2250.0, 2400.0)),
    "water vapour": ((1250.0, 2050.0), (3400.0, 4000.0)),
}
"""Where each gas of the air has lines that a metre of it shows [1/cm]."""

_LEAST_LINES = 1e-3  # rms of the differences of the air's absorbance, over that of the film's noise
_LEAST_POINTS = 20
_ROUNDS = 4  # of the amount, which enters the exponent
_EDGE = 5  # points that an end of a straight line is the mean of


def without_air(spectrum: MeasuredSpectrum, air: MeasuredSpectrum) -> MeasuredSpectrum:
    """A spectrum without the lines of the air; ``air``: transmittance of air alone."""
    if air.quantity != "transmittance":
        raise ParameterError(f"{air.source}: shows {air.quantity}, not transmittance of air")
    if np.array_equal(air.value, spectrum.value):
        raise ParameterError(
            f"{air.source}: has the same data as {spectrum.source}; it is not a spectrum of air"
        )
    if np.any(air.value <= 0.0):
        raise ParameterError(f"{air.source}: its transmittance is not above zero everywhere")
    at, value, said = spectrum.wavenumber, spectrum.value.copy(), []
    lines = -np.log(np.interp(at, air.wavenumber, air.value))
    covered = (at >= air.wavenumber[0]) & (at <= air.wavenumber[-1])
    for gas, ranges in GASES.items():
        wavenumber = at / PER_CENTIMETRE
        inside = covered & np.any(
            [(wavenumber >= a) & (wavenumber <= b) for a, b in ranges], axis=0
        )
        if inside.sum() < _LEAST_POINTS:
            continue
        both, amount, error = inside[1:] & inside[:-1], 0.0, np.nan
        for _ in range(_ROUNDS):
            clean = spectrum.value * np.exp(amount * lines)
            step, slope = np.diff(clean)[both], np.diff(lines)[both]
            slope = slope * (0.5 * (clean[1:] + clean[:-1]))[both]
            power, noise = float(slope @ slope), float(np.std(step))
            if not power > (_LEAST_LINES * noise) ** 2 * slope.size:
                amount = np.nan  # there are no lines
                break
            amount -= float(slope @ step) / power
            error = noise / np.sqrt(power)
        if not np.isfinite(amount):
            continue
        value[inside] *= np.exp(amount * lines[inside])
        said.append(f"{gas}: {amount:.3g} ± {error:.1g} times the lines of {air.source} taken out")
    if not said:
        raise ParameterError(f"{air.source}: has no lines of air where {spectrum.source} has data")
    return replace(spectrum, value=value, notes=(*spectrum.notes, *said))


def parse_ranges(text: str) -> list[tuple[float, float]]:
    """Ranges of wavenumbers such as ``"2280-2400 cm^-1, 655-680 cm^-1"`` [1/m]."""
    found = []
    for part in filter(str.strip, text.split(",")):
        whole = ends("--straight-line", part.strip(), "m^-1")
        if whole is None:
            raise ConfigurationError(
                f'--straight-line: "{part.strip()}" is not a range; write "2280-2400 cm^-1"'
            )
        found.append(whole)
    if not found:
        raise ConfigurationError(f'--straight-line "{text}" has no range in it')
    return found


def with_straight_lines(
    spectrum: MeasuredSpectrum, ranges: Sequence[tuple[float, float]]
) -> MeasuredSpectrum:
    """A spectrum that is straight within ranges [1/m]."""
    at, value = spectrum.wavenumber, spectrum.value.copy()
    for low, high in ranges:
        inside = (at >= low) & (at <= high)
        before, after = np.flatnonzero(at < low)[-_EDGE:], np.flatnonzero(at > high)[:_EDGE]
        if not (inside.any() and before.size and after.size):
            said = " to ".join(f"{end / PER_CENTIMETRE:g}" for end in (low, high))
            raise ParameterError(f"{spectrum.source}: {said} cm^-1 is not within its data")
        places, levels = (
            [float(of[one].mean()) for one in (before, after)] for of in (at, spectrum.value)
        )
        value[inside] = np.interp(at[inside], places, levels)
    return replace(spectrum, value=value)
