"""What infrared spectra and the numbers from them can and cannot be: warnings and errors."""

from collections.abc import Iterator, Sequence

import numpy as np

from lightflyer.calibration.inputs import assumed_accuracies
from lightflyer.core.errors import Doubt, ParameterError
from lightflyer.lab.estimate import Estimate
from lightflyer.lab.readers.spectra.interpretation import PER_CENTIMETRE, MeasuredSpectrum
from lightflyer.lab.spectrum_noise import LEAST_POINTS, point_noise

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


class Bounds:
    """Cuts estimates of shares at 0 and 1 and says what it cut in ``warnings``, one line each."""

    def __init__(self) -> None:
        self.warnings: list[str] = []

    def cut(self, quantity: str, where: str, estimate: Estimate) -> Estimate:
        """The estimate with what is possible of it; its uncertainty is unchanged."""
        low, high = estimate.interval
        if high < 0.0 or low > 1.0:
            beyond = "below 0" if high < 0.0 else "above 1"
            raise ParameterError(
                f"{quantity} {where} is {estimate.value:.4g} ({low:.4g} to {high:.4g}), {beyond} "
                f"by more than its uncertainty: {_ADVICE[quantity]}"
            )
        possible = estimate.clipped(0.0, 1.0)
        if possible.value != estimate.value:
            self.warnings.append(
                f"{quantity} {where} came out as {estimate.value:.4g}, which is impossible but "
                f"within its uncertainty of {possible.value:g}; {possible.value:g} is given"
            )
        elif low < 0.0 or high > 1.0:
            end = 0 if low < 0.0 else 1
            self.warnings.append(f"the interval of the {quantity} {where} is cut at {end}")
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
        yield from _gaps(one, band)
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


def _gaps(spectrum: MeasuredSpectrum, band: tuple[float, float]) -> Iterator[str]:
    at = spectrum.wavenumber
    steps = np.diff(at)
    least = _WORTH_SAYING * min(band[1] - band[0], np.ptp(at))
    places = np.flatnonzero((steps > _WIDE_STEP * np.median(steps)) & (steps > least))
    linear = f"{spectrum.quantity} is taken as linear there"
    if len(places) > _MOST_GAPS:
        ends = at[[places[0], places[-1] + 1]] / PER_CENTIMETRE
        yield (
            f"{spectrum.source}: has {len(places)} gaps between {ends[0]:.5g} and {ends[1]:.5g} "
            f"cm^-1, up to {steps[places].max() / PER_CENTIMETRE:.3g} cm^-1 wide; {linear}"
        )
        return
    for pair in (at[place : place + 2] for place in places):
        inside = np.diff(np.clip(pair, *band))[0]
        kind = Doubt if inside > _MOST_UNCOVERED * (band[1] - band[0]) else str
        yield kind(
            f"{spectrum.source}: has no points between {pair[0] / PER_CENTIMETRE:.5g} and "
            f"{pair[1] / PER_CENTIMETRE:.5g} cm^-1; {linear}"
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
