r"""Emissivity, or its upper bound, from infrared transmittance and reflectance.

A film absorbs, and so emits, what it neither transmits nor reflects. Spectra are averaged over a
band, and over Planck's spectrum at a temperature,

.. math:: \bar\tau(T) = \frac{\int B_\nu(T)\,\tau(\nu)\,d\nu}{\int B_\nu(T)\,d\nu},

with both integrals over the measured wavenumbers. Without reflectance, :math:`1-\bar\tau` is an
upper bound of the emissivity, not its value.
"""

from collections.abc import Sequence
from dataclasses import asdict, dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from scipy.special import ndtri

from lightflyer.array.records import ShortRepr
from lightflyer.core.checks import require_positive, require_range
from lightflyer.core.entry_point import reads_units
from lightflyer.core.errors import Doubt, ParameterError
from lightflyer.core.quantity import Temperature
from lightflyer.files.result_text import Parts, table_of
from lightflyer.lab.estimate import CONFIDENCE, Estimate, noise_density
from lightflyer.lab.ftir import means
from lightflyer.lab.readers.interpretation import PER_CENTIMETRE, MeasuredSpectrum
from lightflyer.lab.result import (
    EMISSIVITY,
    LabResult,
    Reported,
    Series,
    csv_text,
    dataset,
    doubts_of,
    plain,
    require_distinct,
    variables,
)

if TYPE_CHECKING:
    import xarray as xr

BAND = (500.0 * PER_CENTIMETRE, 1300.0 * PER_CENTIMETRE)  # Band of the paper, 900 ± 400 cm⁻¹ [1/m]
TEMPERATURES = (300.0, 400.0, 441.0, 500.0)  # Default temperatures of Planck-weighted means [K]

DEFAULT_ACCURACY = 0.01
"""Standard uncertainty of the ordinate where none is stated [1]: an assumption. Three
commercial instruments were within 0.001 with a PET film [ApplSpectrosc2000]_; drift between
background and sample, a film's wrinkles, and light reflected between film and interferometer
[BirchClarke1995]_ come on top."""

ONE_SIDED_FACTOR = float(ndtri(CONFIDENCE))
"""One-sided 95 % limit of a normal variable, in standard deviations."""

_BAND_MEAN = "over the band"
_FAR_ABOVE = 5.0  # standard deviation of repeats over the accuracy
_ROUNDING = 1e-9  # fraction of the band below which a gap is rounding
_PERCENT = 100.0


@dataclass(frozen=True)
class Averages(ShortRepr):
    """Averages of one quantity over the band and over Planck's spectrum."""

    band: Estimate
    planck: dict[float, Estimate]  #: By temperature [K]


@dataclass(frozen=True, repr=False)
class Ftir(LabResult):
    """Transmittance, reflectance and emissivity of a film from its infrared spectra."""

    spectra: list[MeasuredSpectrum]  #: Spectra of transmittance
    reflectances: list[MeasuredSpectrum]  #: Spectra of reflectance; empty if none was measured
    band: tuple[float, float]  #: [1/m]
    transmittance: Averages
    reflectance: Averages | None
    emissivity: Estimate | None  #: Emissivity over the band; None if reflectance was not measured
    #: One minus the transmittance over the band: the emissivity of a film that reflects nothing,
    #: which no film exceeds. A bound, not the emissivity
    upper_bound: Estimate
    #: Emissivity by temperature [K], or its upper bound if reflectance was not measured, over the
    #: measured wavenumbers
    planck_emissivity: dict[float, Estimate]
    uncovered_band: float  #: Fraction of the band's width without data [1]
    #: Fraction of a black body's power without data [1], by temperature [K]
    uncovered: dict[float, float]
    #: Standard uncertainty of the instrument's ordinate, included in the intervals [1]
    accuracy: Reported[float]
    warnings: tuple[str, ...] = ()  #: What a reader must know of these numbers

    _drawing = "ftir.figures:spectra"

    @property
    def covered(self) -> tuple[float, float]:
        """Part of the band that all spectra cover, over which its means are [1/m]."""
        low, high = _common_range([*self.spectra, *self.reflectances])
        return max(self.band[0], low), min(self.band[1], high)

    @property
    def at_most(self) -> float:
        """Emissivity over the band that is not exceeded at 95 % confidence, one-sided [1]."""
        return _limit(self.emissivity or self.upper_bound)

    def total_bounds(self) -> dict[float, tuple[float, float]]:
        """Bounds of the total emissivity, with nothing or everything emitted outside the data."""
        found = {}
        for temperature, estimate in self.planck_emissivity.items():
            inside = 1.0 - self.uncovered[temperature]
            low, high = estimate.interval
            if self.reflectance is None:
                low, high = 0.0, _limit(estimate)
            found[temperature] = (inside * low, 1.0 - inside * (1.0 - high))
        return found

    def emissivity_spectrum(self) -> tuple[np.ndarray, np.ndarray]:
        """Wavenumber [1/m] and emissivity, or its upper bound, where all spectra have data."""
        low, high = _common_range([*self.spectra, *self.reflectances])
        at = self.spectra[0].wavenumber
        at = at[(at >= low) & (at <= high)]
        rest = np.ones_like(at)
        for group in filter(None, (self.spectra, self.reflectances)):
            values = [np.interp(at, one.wavenumber, one.value) for one in group]
            rest = rest - np.mean(values, axis=0)
        return at, rest

    def table_text(self) -> str:
        """Spectrum of the emissivity, or of its upper bound, as a table of commas."""
        at, value = self.emissivity_spectrum()
        name = "emissivity" if self.reflectances else "emissivity at most"
        spread = self.accuracy * np.sqrt(1.0 + bool(self.reflectances))
        return csv_text([], [
            Series("wavenumber", at / PER_CENTIMETRE, "cm^-1"),
            Series("wavelength", 1e6 / at, "um"), Series(name, value),
            Series("standard uncertainty of the scale", np.full(at.shape, spread)),
        ])  # fmt: skip

    def finding(self) -> Parts:
        """The emissivity over the band, or its bound, in a sentence."""
        low, high = (end / PER_CENTIMETRE for end in self.covered)
        found = f"at most {self.at_most:.4g}" if self.emissivity is None else self.emissivity
        part = f", {_PERCENT * (1.0 - self.uncovered_band):.0f} % of the band"
        said = part * bool(self.uncovered_band)
        yield f"emissivity {found}, over {low:.5g} to {high:.5g} cm⁻¹{said}"

    def parts(self) -> Parts:
        """Means over the band, and those weighted with Planck's spectrum."""
        low, high = (end / PER_CENTIMETRE for end in self.covered)
        accuracy = f"{_PERCENT * self.accuracy:.3g} %"
        yield f"over {low:.5g} to {high:.5g} cm⁻¹, 95 % intervals with an accuracy of {accuracy}:"
        yield f"  transmittance {self.transmittance.band}"
        if self.reflectance is None:
            yield f"  1 - transmittance {self.upper_bound}"
            yield f"  upper bound: emissivity at most {self.at_most:.4g} (95 %, one-sided)"
        else:
            yield f"  reflectance {self.reflectance.band}"
            yield f"  emissivity {self.emissivity}"
        if self.uncovered_band:
            yield f"  {_PERCENT * self.uncovered_band:.1f} % of the band has no data"
        yield (
            "weighted with Planck's spectrum over the measured wavenumbers; total: nothing or\n"
            "everything is emitted outside them"
        )
        of_emissivity, of_total = "\nemissivity", "total,\nbounds"
        if self.reflectance is None:
            of_emissivity, of_total = "1 - trans-\nmittance", "total, at\nmost (95 %)"
        rows = []
        for (temperature, estimate), (least, most) in zip(
            self.planck_emissivity.items(), self.total_bounds().values(), strict=True
        ):
            first, last = estimate.interval
            rows.append((
                f"{temperature:g}", f"{self.transmittance.planck[temperature].value:.4f}",
                f"{estimate.value:.4f}", f"{first:.4f} to {last:.4f}",
                f"{_PERCENT * self.uncovered[temperature]:.1f} %",
                f"{most:.3f}" if self.reflectance is None else f"{least:.3f} to {most:.3f}",
            ))  # fmt: skip
        yield table_of(
            ("at\n[K]", "\ntransmittance", of_emissivity, "\n95 % interval", "outside\nthe data",
             of_total), rows, left=(),
        )  # fmt: skip

    def summary(self) -> dict[str, Any]:
        """The result as a JSON object."""
        uncovered: dict[Any, float] = {"band": self.uncovered_band, **self.uncovered}
        document: dict[str, Any] = {
            "band_transmittance": self.transmittance.band,
            "emissivity_upper_bound": plain(self.upper_bound)
            | {"at_most_95": _limit(self.upper_bound)},
            "planck_weighted": self.transmittance.planck,
            "uncovered_fraction": {
                where: Estimate(share, (share, share)) for where, share in uncovered.items()
            },
            "total_emissivity_bounds_95": self.total_bounds(),
            "band_per_cm": [end / PER_CENTIMETRE for end in self.band],
            "covered_per_cm": [end / PER_CENTIMETRE for end in self.covered],
        }
        if self.reflectance is None:
            document["planck_weighted_emissivity_upper_bound"] = self.planck_emissivity
        else:
            document |= {
                "band_reflectance": self.reflectance.band,
                "emissivity": self.emissivity,
                "planck_weighted_reflectance": self.reflectance.planck,
                "planck_weighted_emissivity": self.planck_emissivity,
            }
        return plain(document) | super().summary()


def _limit(estimate: Estimate) -> float:
    return min(1.0, estimate.value + ONE_SIDED_FACTOR * (estimate.uncertainty or 0.0))


@reads_units
def reduce_ftir(
    spectra: Sequence[MeasuredSpectrum],
    reflectances: Sequence[MeasuredSpectrum] = (),
    *,
    band: tuple[float, float] = BAND,
    temperatures: Temperature = TEMPERATURES,
    accuracy: float | None = None,
) -> Ftir:
    """Average a film's spectra for its emissivity, or its upper bound.

    Parameters
    ----------
    spectra : sequence of MeasuredSpectrum
        Spectra of transmittance; several are repeated measurements of one film.
    reflectances : sequence of MeasuredSpectrum
        Spectra of reflectance, likewise.
    band : tuple of float
        Lowest and highest wavenumber of the band [1/m].
    temperatures : sequence of float
        Temperatures of the Planck weighting [K].
    accuracy : float, optional
        Standard uncertainty of the instrument's ordinate, common to a whole spectrum and to all
        repeats [1]; by default :data:`DEFAULT_ACCURACY`, with a warning.

    Returns
    -------
    Ftir
        Shares are cut at 0 and 1, with a warning where their intervals reach beyond.

    Raises
    ------
    ParameterError
        If there is no spectrum, one shows another quantity, diffuse reflectance alone, or has no
        data in the band, an argument is impossible, or a share is below 0 or above 1 by more than
        its uncertainty.

    Notes
    -----
    The interval of one spectrum includes its noise, whose correlation along the spectrum is
    estimated (:mod:`lightflyer.lab.estimate`), and the accuracy; that of several includes the
    scatter of their means with Student's factor, and the accuracy. Transmittance and reflectance
    have independent errors. With two or three repeats whose scatter is comparable with the accuracy
    the interval is wider than it need be.
    """
    used = DEFAULT_ACCURACY if accuracy is None else accuracy
    heat = [float(t) for t in temperatures]
    require_positive(temperatures=np.asarray(heat))
    require_range("accuracy", used, 0.0, 1.0)
    require_range("lower end of the band", band[0], 0.0)
    require_range("upper end of the band", band[1], band[0], open_below=True)
    if not spectra:
        raise ParameterError("a spectrum of transmittance is needed")
    whole = [*spectra, *reflectances]
    named = (("transmittance", spectra), ("reflectance", reflectances))
    for quantity, one in ((name, one) for name, group in named for one in group):
        if one.quantity != quantity:
            raise ParameterError(f"{one.source}: shows {one.quantity}, not {quantity}")
        if quantity == "reflectance" and one.collection == "diffuse":
            raise ParameterError(
                f"{one.source}: holds diffuse reflectance, which leaves out the specular beam; "
                "no emissivity follows without it"
            )
    require_distinct([(one.source, (one.wavenumber, one.value)) for one in spectra])
    low, high = _common_range(whole)
    inside = (max(band[0], low), min(band[1], high))
    covered = (inside[1] - inside[0]) / (band[1] - band[0])
    if covered <= 0.0:
        in_cm = [end / PER_CENTIMETRE for end in (*band, low, high)]
        raise ParameterError(
            f"{spectra[0].source}: has no data in the band from {in_cm[0]:g} to {in_cm[1]:g} "
            f"cm^-1; its data extend from {in_cm[2]:.5g} to {in_cm[3]:.5g} cm^-1"
        )
    uncovered_band = 0.0 if covered > 1.0 - _ROUNDING else 1.0 - covered
    uncovered = {t: means.uncovered_power((low, high), t) for t in heat}
    raw: list[dict[str | float, means.MeanShare]] = []  # by temperature, and over the band
    far: list[Doubt] = []
    for group in filter(None, (spectra, reflectances)):
        noisy = [(one, noise_density(one.value)) for one in group]
        found = {_BAND_MEAN: [means.mean_over(*one, inside) for one in noisy]} | {
            t: [means.mean_over(*one, (low, high), t) for one in noisy] for t in heat
        }
        raw.append({where: means.combine_repeats(each, used) for where, each in found.items()})
        scatter = raw[-1][_BAND_MEAN].random * float(np.sqrt(len(group)))
        if len(group) > 1 and scatter > _FAR_ABOVE * used > 0.0:
            far.append(Doubt(
                f"repeats of {group[0].quantity} differ by {scatter:.2g} over the band, where an "
                f"accuracy of {used:.2g} is stated or assumed: are all of one film?"
            ))  # fmt: skip
    rest = {where: means.remainder([one[where] for one in raw]) for where in raw[0]}
    said: list[str] = []
    transmittance = _cut("transmittance", raw[0], said)
    reflectance = _cut("reflectance", raw[1], said) if reflectances else None
    # without reflectance the rest is cut where the transmittance was, which has been said
    emissivity = _cut("emissivity", rest, said if reflectances else [])
    return Ftir(
        spectra=list(spectra),
        reflectances=list(reflectances),
        band=band,
        transmittance=transmittance,
        reflectance=reflectance,
        emissivity=emissivity.band if reflectances else None,
        upper_bound=means.cut(
            "emissivity", _BAND_MEAN, means.remainder([raw[0][_BAND_MEAN]]).estimate(), []
        ),
        planck_emissivity=emissivity.planck,
        uncovered_band=uncovered_band,
        uncovered=uncovered,
        accuracy=used,
        warnings=(
            *means.coverage_warnings(whole, band, uncovered_band, uncovered),
            *far,
            *means.spectrum_warnings(spectra, reflectances, band, used),
            *said,
            *means.accuracy_warnings(accuracy, used),
            *(doubts_of("emissivity", EMISSIVITY, emissivity.band.value) if reflectances else []),
        ),
    )


def _common_range(spectra: Sequence[MeasuredSpectrum]) -> tuple[float, float]:
    """Lowest and highest wavenumber that all spectra have [1/m]."""
    low = max(one.wavenumber[0] for one in spectra)
    high = min(one.wavenumber[-1] for one in spectra)
    if low >= high:
        raise ParameterError("the spectra have no wavenumbers in common")
    return low, high


def _cut(quantity: str, shares: dict[str | float, means.MeanShare], said: list[str]) -> Averages:
    found = {}
    for where, share in shares.items():
        words = where if isinstance(where, str) else f"at {where:g} K"
        found[where] = means.cut(quantity, words, share.estimate(), said)
    return Averages(found.pop(_BAND_MEAN), found)  # type: ignore[arg-type]


def to_dataset(result: Ftir) -> "xr.Dataset":
    """Dataset of the spectra, each over its own wavenumbers."""
    found: dict[str, Any] = {}
    for group in (result.spectra, result.reflectances):
        for number, one in enumerate(group):
            name = f"{one.quantity}_{number}"
            axis = f"wavenumber_{name}"
            said = asdict(one.metadata) | {"collection": one.collection}
            said = {key: text for key, text in said.items() if text} | {"file": one.source}
            at = Series(axis, one.wavenumber / PER_CENTIMETRE, "cm^-1", "wavenumber")
            found |= variables(axis, [at])
            found |= variables(axis, [Series(name, one.value, "", one.quantity)], **said)
    wavenumber, value = result.emissivity_spectrum()
    name = "emissivity" if result.reflectances else "emissivity_upper_bound"
    found |= variables("wavenumber", [
        Series("wavenumber", wavenumber / PER_CENTIMETRE, "cm^-1", "wavenumber"),
        Series(name, value, "", name.replace("_", " ")),
    ])  # fmt: skip
    files = [one.source for one in (*result.spectra, *result.reflectances)]
    return dataset("infrared spectra", found, files, warnings=result.warnings)
