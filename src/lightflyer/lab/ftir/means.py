r"""Means of infrared spectra of a film, without lines of the air, and what they can be.

The path between the measurement of the background and that of the sample loses or gains air. With
the transmittance :math:`\tau_a` of some air, the film's own is :math:`\tau\,\tau_a^{-c}`. The
amount :math:`c` of each gas is the one that leaves the smoothest spectrum: that with the least
squares of the differences between neighbouring points, which lines are large in and films are not.

A mean is over a band or over Planck's spectrum, with its noise.
"""

from collections.abc import Iterator, Sequence
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from lightflyer.calibration.inputs import assumed_accuracies
from lightflyer.core.errors import ConfigurationError, Doubt, ParameterError
from lightflyer.files.quantities import ends
from lightflyer.film.optics.spectra import SECOND_RADIATION_CONSTANT, blackbody_fraction
from lightflyer.lab.estimate import (
    LEAST_POINTS,
    NORMAL_FACTOR,
    Estimate,
    point_noise,
    student_factor,
)
from lightflyer.lab.readers.interpretation import PER_CENTIMETRE, MeasuredSpectrum

GASES = {
    "CO₂": ((600.0, 740.0), (2250.0, 2400.0)),
    "water vapour": ((1250.0, 2050.0), (3400.0, 4000.0)),
}
"""Where each gas of the air has lines that a metre of it shows [1/cm]."""

_LEAST_LINES = 1e-3  # rms of the differences of the air's absorbance, over that of the film's noise
_LEAST_POINTS = 20
_ROUNDS = 4  # of the amount, which enters the exponent
_EDGE = 5  # points that an end of a straight line is the mean of

_WIDEST_STEP = 1.0  # of hcν/kT in one piece of the quadrature
_NODES, _FEW_NODES = 8, 2  # Gauss-Legendre, per piece
_FINE = 50_000  # points above which a spectrum is fine enough for few nodes

_TOLERANCE = 3.0  # standard deviations of accuracy and noise by which points may be beyond 0 and 1
_WORTH_SAYING = 0.01  # share of points beyond, of a band or of a black body's power without data
_WIDE_STEP = 10.0  # over the usual distance of points
_MOST_UNCOVERED = 0.1  # of a band, from which a mean over the rest is in doubt
_MOST_GAPS = 3  # that are named one by one
_PERCENT = 100.0
_ADVICE = {
    "transmittance": "check the background measurement, and whether the ordinate is in %",
    "reflectance": "check the reference mirror's measurement, and whether the ordinate is in %",
    "emissivity": "transmittance and reflectance do not fit together; check their backgrounds and "
    "that both are of this film",
}


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


class MeanShare(NamedTuple):
    """A mean share with its standard uncertainties, not yet cut at what is possible."""

    value: float  # [1]
    random: float  # Standard uncertainties from noise or scatter, and of the instrument [1]
    freedom: float  # Degrees of freedom of the random one
    accuracy: float

    def estimate(self) -> Estimate:
        half = np.hypot(student_factor(self.freedom) * self.random, NORMAL_FACTOR * self.accuracy)
        return Estimate.covering(self.value, float(half))


def remainder(parts: Sequence[MeanShare]) -> MeanShare:
    """One minus the parts, with independent errors; degrees of freedom after Welch."""
    variances = np.array([part.random**2 for part in parts])
    lost = sum(one**2 / part.freedom for one, part in zip(variances, parts, strict=True))
    return MeanShare(
        1.0 - sum(part.value for part in parts),
        float(np.sqrt(variances.sum())),
        float(variances.sum() ** 2 / lost) if lost > 0.0 else np.inf,
        float(np.sqrt(sum(part.accuracy**2 for part in parts))),
    )


def uncovered_power(covered: tuple[float, float], temperature: float) -> float:
    """Fraction of a black body's power outside a range of wavenumbers [1]; ``covered`` [1/m]."""
    below = 1.0 - blackbody_fraction(1.0 / covered[0], temperature) if covered[0] > 0.0 else 0.0
    return below + blackbody_fraction(1.0 / covered[1], temperature)


def mean_over(
    spectrum: MeasuredSpectrum, noise: np.ndarray, ends: tuple[float, float],
    temperature: float | None = None,
) -> tuple[float, float]:  # fmt: skip
    """Mean over a band, or Planck's spectrum in it, and its standard uncertainty from noise [1].

    Linear between points; ``noise``: density at each point, shape (n,).
    """
    inside = (spectrum.wavenumber > ends[0]) & (spectrum.wavenumber < ends[1])
    wavenumber = np.concatenate([ends[:1], spectrum.wavenumber[inside], ends[1:]])
    value, density = (
        np.interp(wavenumber, spectrum.wavenumber, one) for one in (spectrum.value, noise)
    )
    if temperature is None:
        width = np.diff(wavenumber)
        weights = 0.5 * (np.append(width, 0.0) + np.append(0.0, width)) / (ends[1] - ends[0])
    else:
        nodes = _FEW_NODES if len(wavenumber) > _FINE else _NODES
        weights = planck_weights(wavenumber, temperature, nodes)
    first = value[0]  # subtracted, so that the mean of a flat spectrum is exact
    return first + float(weights @ (value - first)), float(np.sqrt(weights**2 @ density))


def planck_weights(wavenumber: np.ndarray, temperature: float, nodes: int = _NODES) -> np.ndarray:
    r"""Weights of points for a Planck-weighted mean, linear between the points, shape (n,)."""
    # The weight of a point is the integral of :math:`B_\nu(T)` times the hat function that is one
    # at the point and zero at its neighbours.
    per_metre = SECOND_RADIATION_CONSTANT / temperature
    steps = np.maximum(1, np.ceil(np.diff(wavenumber) * per_metre / _WIDEST_STEP)).astype(int)
    left = np.repeat(np.arange(len(steps)), steps)
    piece = np.arange(len(left)) - np.repeat(np.cumsum(steps) - steps, steps)
    width = np.diff(wavenumber)[left] / steps[left]
    start = wavenumber[left] + piece * width
    weights = np.zeros(len(wavenumber))
    for node, weight in zip(*np.polynomial.legendre.leggauss(nodes), strict=True):
        at = start + 0.5 * (1.0 + node) * width
        x = at * per_metre
        power = 0.5 * weight * width * x**3 * np.exp(-x) / -np.expm1(-x)
        share = (at - wavenumber[left]) / np.diff(wavenumber)[left]
        weights += np.bincount(left, power * (1.0 - share), len(weights))
        weights += np.bincount(left + 1, power * share, len(weights))
    return weights / weights.sum()


def combine_repeats(means: Sequence[tuple[float, float]], accuracy: float) -> MeanShare:
    """Mean of repeats, with the scatter of the means or the noise of the only one."""
    values = np.array([mean for mean, _ in means])
    if len(values) == 1:
        return MeanShare(float(values[0]), means[0][1], np.inf, accuracy)
    scatter = float(values.std(ddof=1) / np.sqrt(len(values)))
    return MeanShare(float(values.mean()), scatter, len(values) - 1, accuracy)


def cut(quantity: str, where: str, estimate: Estimate, said: list[str]) -> Estimate:
    """A share with what is possible of it; a line for what is cut is added to ``said``."""
    low, high = estimate.interval
    if high < 0.0 or low > 1.0:
        beyond = "below 0" if high < 0.0 else "above 1"
        raise ParameterError(
            f"{quantity} {where} is {estimate.value:.4g} ({low:.4g} to {high:.4g}), {beyond} by "
            f"more than its uncertainty: {_ADVICE[quantity]}"
        )
    possible = estimate.clipped(0.0, 1.0)
    if possible.value != estimate.value:
        said.append(
            f"{quantity} {where} came out as {estimate.value:.4g}, which is impossible but within "
            f"its uncertainty of {possible.value:g}; {possible.value:g} is given"
        )
    elif low < 0.0 or high > 1.0:
        end = 0 if low < 0.0 else 1
        said.append(f"the interval of the {quantity} {where} is cut at {end}")
    return possible


def spectrum_warnings(
    spectra: Sequence[MeasuredSpectrum],
    reflectances: Sequence[MeasuredSpectrum],
    band: tuple[float, float],
    accuracy: float,
) -> Iterator[str]:
    """What is suspicious about the spectra themselves; ``band`` [1/m]."""
    for one in (*spectra, *reflectances):
        tolerance = _TOLERANCE * float(np.hypot(accuracy, point_noise(one.value)))
        beyond = (one.value < -tolerance) | (one.value > 1.0 + tolerance)
        if beyond.mean() > _WORTH_SAYING:
            yield (
                f"{one.source}: {_PERCENT * beyond.mean():.1f} % of its points lie below 0 or "
                f"above 1 by more than accuracy and noise explain (lowest {one.value.min():.3g}, "
                f"highest {one.value.max():.3g}); {_ADVICE[one.quantity]}"
            )
        yield from (f"{one.source}: {note.removeprefix(f'{one.source}: ')}" for note in one.notes)
        at = one.wavenumber
        steps = np.diff(at)
        least = _WORTH_SAYING * min(band[1] - band[0], np.ptp(at))
        places = np.flatnonzero((steps > _WIDE_STEP * np.median(steps)) & (steps > least))
        linear = f"{one.quantity} is taken as linear there"
        if len(places) > _MOST_GAPS:
            ends = at[[places[0], places[-1] + 1]] / PER_CENTIMETRE
            yield (
                f"{one.source}: has {len(places)} gaps between {ends[0]:.5g} and {ends[1]:.5g} "
                f"cm^-1, up to {steps[places].max() / PER_CENTIMETRE:.3g} cm^-1 wide; {linear}"
            )
            places = places[:0]
        for pair in (at[place : place + 2] for place in places):
            inside = np.diff(np.clip(pair, *band))[0]
            kind = Doubt if inside > _MOST_UNCOVERED * (band[1] - band[0]) else str
            yield kind(
                f"{one.source}: has no points between {pair[0] / PER_CENTIMETRE:.5g} and "
                f"{pair[1] / PER_CENTIMETRE:.5g} cm^-1; {linear}"
            )
        if len(one.wavenumber) < LEAST_POINTS:
            yield (
                f"{one.source}: has {len(one.wavenumber)} points, too few to tell how the noise of "
                "neighbours is correlated; it is taken as independent"
            )
    too_high = "what the film scatters is then taken as emitted, and the emissivity is too high"
    for one in reflectances:
        if one.collection is None:
            yield (
                f"{one.source}: does not say which light was collected (--collection); if it was "
                f"the specular beam alone, {too_high}"
            )
        elif one.collection == "specular":
            yield f"{one.source}: holds specular reflectance; {too_high} unless the film is smooth"
    if not reflectances:
        return
    at, mirror = spectra[0].wavenumber, reflectances[0].wavenumber
    inside = (at >= mirror[0]) & (at <= mirror[-1])
    sums = sum(
        np.mean([np.interp(at, one.wavenumber, one.value) for one in group], axis=0)
        for group in (spectra, reflectances)
    )
    noise = np.hypot(point_noise(spectra[0].value), point_noise(reflectances[0].value))
    limit = 1.0 + _TOLERANCE * np.hypot(np.sqrt(2.0) * accuracy, noise)
    share = float(np.mean(sums[inside] > limit)) if inside.any() else 0.0
    if share > _WORTH_SAYING:
        yield (
            f"transmittance and reflectance add up to more than 1 at {_PERCENT * share:.1f} % of "
            f"the wavenumbers (to {sums[inside].max():.3g}); {_ADVICE['emissivity']}"
        )


def accuracy_warnings(stated: float | None, used: float) -> list[str]:
    """What a reader must know of the instrument's accuracy; ``stated``: as the user states it."""
    if stated is None:
        return list(assumed_accuracies({"spectrometer": f"± {_PERCENT * used:g} % of full scale"}))
    if stated == 0.0:
        return ["intervals leave out the spectrometer's accuracy, which is stated as 0"]
    return []


def coverage_warnings(
    spectra: Sequence[MeasuredSpectrum],
    band: tuple[float, float],
    uncovered_band: float,
    uncovered: dict[float, float],
) -> list[str]:
    """What lies outside the measured wavenumbers; ``band`` [1/m]."""
    found = []
    if uncovered_band > 0.0:
        ends = f"{band[0] / PER_CENTIMETRE:g} to {band[1] / PER_CENTIMETRE:g}"
        shorter = [
            f"{one.source}, {one.quantity} from {one.wavenumber[0] / PER_CENTIMETRE:.5g} to "
            f"{one.wavenumber[-1] / PER_CENTIMETRE:.5g} cm^-1"
            for one in spectra
            if one.wavenumber[0] > band[0] or one.wavenumber[-1] < band[1]
        ]
        text = (
            f"{_PERCENT * uncovered_band:.1f} % of the band from {ends} cm^-1 has no data, and the "
            f"mean is over the rest: {'; '.join(shorter)}"
        )
        found.append(Doubt(text) if uncovered_band > _MOST_UNCOVERED else text)
    shares = [share for share in uncovered.values() if share > _WORTH_SAYING]
    if shares:
        ends = " to ".join(
            dict.fromkeys(f"{_PERCENT * one:.1f} %" for one in (min(shares), max(shares)))
        )
        hot = " to ".join(dict.fromkeys(f"{one:g}" for one in (min(uncovered), max(uncovered))))
        found.append(
            f"{ends} of a black body's power at {hot} K lies outside the measured wavenumbers; "
            "weighted means are over the rest, their bounds take nothing or everything emitted "
            "there"
        )
    return found
