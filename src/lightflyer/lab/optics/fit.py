r"""Thicknesses, mixtures and optical constants of a film from its measured spectra.

Any numbers of a film (thickness, porosity, roughness, parameters of a formula of n and k, …) are
fitted to spectra of transmittance and reflectance, all together, with the errors of the
instruments' scales and zeros (:mod:`lightflyer.lab.optics.model`). Minima are looked for from many
starts (:mod:`lightflyer.lab.optics.search`).

**Errors of the points** are those that the residuals show. What a model leaves out makes residuals
alike over many points, and so does smoothing in the instrument; a fit that took points as
independent would be too sure of itself. The variance of a point is that of the residuals, times the
number of points over which they are alike. Intervals are those of the profile of the least cost,
with Student's factor for as many degrees of freedom as there are independent points.
"""

import contextlib
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Annotated, Any

import numpy as np

from lightflyer.core.entry_point import reads_units
from lightflyer.core.errors import Doubt, ParameterError
from lightflyer.core.text import correlation_text
from lightflyer.files.result_text import Parts, listed, table_of
from lightflyer.film.optics.averages import absorptance, emittance
from lightflyer.film.optics.stack import Film
from lightflyer.lab.estimate import NORMAL_FACTOR, Estimate
from lightflyer.lab.optics.data import FilmSpectrum, OpticsSample
from lightflyer.lab.optics.model import FilmProblem, OpticalModel, select_covered
from lightflyer.lab.optics.record import diagnose, in_display_unit, is_off
from lightflyer.lab.optics.search import STARTS, FilmFit, Scatter, intervals, search
from lightflyer.lab.readers.interpretation import PER_CENTIMETRE
from lightflyer.lab.result import (
    LabResult,
    Reported,
    Series,
    Shown,
    dataset,
    estimate_table,
    variables,
)

if TYPE_CHECKING:
    import xarray as xr

DRAWS = 200  # Number of films drawn for the bands of n and k

TEMPERATURE = 441.0
"""Temperature of the emittance that is told [K]: that of the flyers of [Lu2023]_."""

_STEP = 0.5  # standard errors, of the differences that carry uncertainties on
_WAVELENGTHS = 200
_NEARLY_ALL = 0.005
_PERCENT = 100.0
_HEADINGS = ("spectrum", "scatter\n[%]", "points", "indepen-\ndent", "scale's\nerror [%]",
             "zero's\nerror [%]")  # fmt: skip
_DIGITS = 5


@dataclass(frozen=True)
class FittedSpectrum:
    """A spectrum with its fit."""

    measured: FilmSpectrum
    # shape (n,); what the instrument reads of the fitted film, by its fitted errors [1]
    reading: np.ndarray
    share: np.ndarray  # shape (n,); what a perfect instrument would read [1]
    scale_error: float  # Fitted errors of the ordinate: relative, and [1]
    zero_error: float
    scatter: Scatter  # Of the points about the fit

    @property
    def residual(self) -> np.ndarray:
        """Measured less fitted, shape (n,) [1]."""
        return np.asarray(self.measured.spectrum.value - self.reading)


@dataclass(frozen=True)
class LayerIndex:
    """Optical constants of a layer with fitted numbers."""

    name: str
    wavelength: np.ndarray  # shape (m,); [m]
    n: np.ndarray  # shape (m,)
    k: np.ndarray  # shape (m,)
    n_band: np.ndarray  # shape (2, m); ends of the 95 % bands at each wavelength
    k_band: np.ndarray


@dataclass(frozen=True)
class Rival:
    """Another minimum."""

    values: dict[str, float]  # Free numbers [SI]
    excess: float  # Cost above that of the best minimum, in squared standard errors
    excluded: bool  # Whether the spectra exclude it at 95 % confidence


@dataclass(frozen=True, repr=False)
class OpticsFit(LabResult):
    """Numbers of a film from its spectra."""

    sample: OpticsSample
    numbers: dict[str, Estimate]  #: Free numbers [SI] with 95 % intervals
    #: Whether an interval ends at its lower and upper bound, and not by the spectra
    open_ends: dict[str, tuple[bool, bool]]
    correlation: np.ndarray  #: shape (free, free); of the errors of the free numbers
    covariance: np.ndarray  #: shape (free, free); likewise [SI]
    spectra: tuple[FittedSpectrum, ...]
    rivals: tuple[Rival, ...]  #: Other minima, the best first
    film: Film  #: With the fitted numbers
    indices: tuple[LayerIndex, ...]
    #: Of the film: absorptance of sunlight and emittance, as far as the materials' data go
    predictions: Reported[dict[str, Estimate]]
    #: Degrees of freedom, from independent points
    freedom: Annotated[float, Shown(key="degrees_of_freedom")]
    warnings: tuple[str, ...] = ()  #: What a reader of the result must know, one line each

    _drawing = "optics.figures:spectra"

    def finding(self) -> Parts:
        """Fitted numbers in a sentence."""
        yield listed(f"{name} {in_display_unit(one)}" for name, one in self.numbers.items())

    def parts(self) -> Parts:
        """Fitted numbers, what the fitted film does, and the errors of the instruments."""
        numbers = [(name, in_display_unit(one)) for name, one in self.numbers.items()]
        yield estimate_table(numbers, "fitted", _DIGITS)
        if self.predictions:
            yield estimate_table(self.predictions.items(), "of the fitted film", _DIGITS)
        yield table_of(
            _HEADINGS,
            (
                (
                    one.measured.label, f"{_PERCENT * one.scatter.deviation:.2f}",
                    f"{len(one.reading)}", f"{one.scatter.independent:.0f}",
                    f"{_PERCENT * one.scale_error:+.2f}", f"{_PERCENT * one.zero_error:+.2f}",
                )
                for one in self.spectra
            ),
        )  # fmt: skip

        yield correlation_text(list(self.numbers), self.correlation)

    def summary(self) -> dict[str, Any]:
        """The result as a JSON object."""
        return {
            "numbers": {
                name: one.to_json() | {"at_bound": list(self.open_ends[name])}
                for name, one in self.numbers.items()
            },
            "correlation": {
                "names": list(self.numbers), "matrix": np.round(self.correlation, 4).tolist(),
            },
            "spectra": [
                {
                    "file": one.measured.spectrum.source,
                    "quantity": one.measured.spectrum.quantity,
                    "points": len(one.reading),
                    "independent_points": one.scatter.independent,
                    "residual_standard_deviation": one.scatter.deviation,
                    "scale_error": one.scale_error,
                    "zero_error": one.zero_error,
                }
                for one in self.spectra
            ],
            "other_minima": [
                {"numbers": one.values, "excess": one.excess, "excluded": one.excluded}
                for one in self.rivals
            ],
            **super().summary(),
        }  # fmt: skip


@reads_units
def fit_optics(
    sample: OpticsSample, *, starts: int = STARTS, seed: int = 0, model: OpticalModel | None = None
) -> OpticsFit:
    """FilmFit numbers of a film to its spectra.

    Parameters
    ----------
    sample : OpticsSample
        As :func:`read_sample` reads it, or made in Python of a function that builds the film.
    starts : int
        How many points between the bounds minima are looked for from.
    seed : int
        Of these points, and of the draws of n and k.
    model : OpticalModel, optional
        That of another sample with the same film, bounds and wavelengths, which saves compiling it.

    Returns
    -------
    OpticsFit

    Raises
    ------
    ParameterError
        If nothing is free, there is no spectrum, or fewer points than free numbers.
    ConvergenceError
        If no film between the bounds has optical constants.

    Notes
    -----
    Transmittance and reflectance of a rough film are those of the specular beams.

    References
    ----------
    [GUM2008]_ for uncertainties; [Geyer1992]_ for points that are alike.
    """
    if starts < 1:
        raise ParameterError(f"starts = {starts} must be 1 or more")
    if not sample.free or not sample.spectra:
        raise ParameterError("a fit needs free numbers, and spectra")
    sample, left_out = select_covered(sample)
    points = sum(len(one.spectrum.value) for one in sample.spectra)
    if points <= len(sample.free):
        raise ParameterError(f"{points} points are too few for {len(sample.free)} free numbers")
    fit, ends = intervals(search(FilmProblem.of(sample, model), starts=starts, seed=seed))
    model, names = fit.problem.model, [one.name for one in fit.problem.free]
    # The uncertainty is that of the normal distribution with the same 95 % interval, so that what
    # is computed from it is as sure as the interval.
    low, high = (model.values(np.array(one)) for one in zip(*ends, strict=True))
    spread = 0.5 * (high - low) / NORMAL_FACTOR
    each = zip(model.values(fit.best.position), low, high, spread, fit.problem.free, strict=True)
    numbers = {
        one.name: Estimate(float(value), (float(first), float(last)), one.unit, float(error))
        for value, first, last, error, one in each
    }
    inner = fit.problem.covariance(fit.best)
    spreads = np.sqrt(np.diag(inner))
    correlation = inner / np.outer(spreads, spreads)
    covariance = correlation * np.outer(spread, spread)
    rivals = tuple(
        Rival(
            dict(zip(names, map(float, model.values(solution.position)), strict=True)),
            float(excess),
            bool(excess > fit.factor**2),
        )
        for solution, excess in fit.rivals
    )
    errors = fit.best.errors * np.array([one.errors for one in sample.spectra])
    shares = fit.problem.by_spectrum(model.shares(fit.best.position)[0])
    spectra = tuple(
        FittedSpectrum(one, reading, share, float(error[0]), float(error[1]), scatter)
        for one, reading, share, error, scatter in zip(
            sample.spectra, fit.problem.readings(fit.best), shares, errors, fit.scatter, strict=True
        )
    )
    open_ends = {
        one.name: (low <= 0.0, high >= 1.0)
        for one, (low, high) in zip(sample.free, ends, strict=True)
    }
    film = model.film(fit.best.position)
    predictions, diagnostics = _predictions(fit, covariance)
    return OpticsFit(
        sample=sample,
        numbers=numbers,
        open_ends=open_ends,
        correlation=correlation,
        covariance=covariance,
        spectra=spectra,
        rivals=rivals,
        film=film,
        indices=_indices(sample, fit, covariance, seed),
        predictions=predictions,
        freedom=fit.freedom,
        warnings=(
            *left_out,
            *_other_delta(sample, fit, starts, seed),
            *diagnose(sample, numbers, open_ends, correlation, fit, film),
            *diagnostics,
        ),
    )


def _other_delta(sample: OpticsSample, fit: FilmFit, starts: int, seed: int) -> list[Doubt]:
    """What Δ is, where S does not fit as it stands, but with the other sign or without its sign."""
    found = []
    readings = fit.problem.readings(fit.best)
    for at, one in enumerate(sample.spectra):
        sine = one.spectrum.value
        if one.spectrum.quantity != "S" or not is_off(one, sine - readings[at]):
            continue
        turned = replace(one, spectrum=replace(one.spectrum, value=-sine))
        others = tuple(turned if other is one else other for other in sample.spectra)
        problem = FilmProblem.of(replace(sample, spectra=others), fit.problem.model)
        again = search(problem, starts=starts, seed=seed)
        if not is_off(one, sine + again.problem.readings(again.best)[at]):
            found.append(Doubt(
                f"{one.where[0]}: Δ has the other sign: the film fits with -S, not with S; write "
                'delta = "reversed" in its [[ellipsometry]]'
            ))  # fmt: skip
        elif np.all(sine > -one.accuracy):
            without = replace(sample, spectra=tuple(o for o in sample.spectra if o is not one))
            least = search(FilmProblem.of(without), starts=starts, seed=seed)
            shown = OpticalModel(sample).shares(least.best.position)[0]
            if not is_off(one, sine - np.abs(fit.problem.by_spectrum(shown)[at])):
                found.append(Doubt(
                    f"{one.where[0]}: all Δ are within 0 to 180°, and the film fits where S has "
                    'lost its sign: Δ is folded, as by a rotating analyser; write delta = "folded" '
                    "in its [[ellipsometry]], which leaves S out"
                ))  # fmt: skip
    return list(dict.fromkeys(found))


def _predictions(fit: FilmFit, covariance: np.ndarray) -> tuple[dict[str, Estimate], list[str]]:
    model = fit.problem.model
    film = model.film(fit.best.position)
    if film.below is not None or film.above is not None:
        return {}, []
    found, diagnostics = {}, []
    centre = fit.best.position
    steps = _STEP * np.sqrt(np.diag(covariance)) / model.widths
    for name, average in (
        ("absorptance, AM0", absorptance),
        (f"emittance at {TEMPERATURE:g} K, top", lambda one: emittance(one, TEMPERATURE)),
    ):
        try:
            middle = average(film)
        except ParameterError as error:
            diagnostics.append(f"no {name}: {error}")
            continue
        slopes = []  # in the free numbers, by differences within the bounds
        for step in np.diag(steps):
            ends = np.clip([centre - step, centre + step], 0.0, 1.0)
            apart = float((ends[1] - ends[0]) @ model.widths)
            low, high = (float(average(model.film(end)).value) for end in ends)
            slopes.append((high - low) / apart if apart > 0.0 else 0.0)
        spread = float(np.sqrt(np.array(slopes) @ covariance @ slopes))
        value = float(middle.value)
        found[name] = replace(
            Estimate.normal(value, spread),
            interval=Estimate.normal(value, spread).clipped(0.0, 1.0).interval,
        )
        if middle.covered < 1.0 - _NEARLY_ALL:
            diagnostics.append(
                f"{name} is that of the {100.0 * float(middle.covered):.0f} % of the radiation for "
                f"which the materials have data; with the rest it is {float(middle.lower):.3f} to "
                f"{float(middle.upper):.3f}"
            )
    return found, diagnostics


def _indices(
    sample: OpticsSample, fit: FilmFit, covariance: np.ndarray, seed: int
) -> tuple[LayerIndex, ...]:
    model = fit.problem.model
    film = model.film(fit.best.position)
    ends = [one.spectrum.wavelength[[-1, 0]] for one in sample.spectra]
    wavelength = np.geomspace(min(e[0] for e in ends), max(e[1] for e in ends), _WAVELENGTHS)
    wavelength = np.clip(wavelength, *film.covered_range)
    rng = np.random.default_rng(seed)
    scaled = covariance / np.outer(model.widths, model.widths)
    draws = rng.multivariate_normal(fit.best.position, scaled, DRAWS, method="eigh")
    draws = np.clip(draws, 0.0, 1.0)
    # one evaluation of the media per draw, all layers together
    drawn = []
    for draw in draws:
        with contextlib.suppress(ParameterError):  # numbers that make no medium
            drawn.append(model.film(draw).index(wavelength))
    if not drawn:
        return ()
    n, k = film.index(wavelength)
    bands = [np.quantile([one[part] for one in drawn], [0.025, 0.975], axis=0) for part in (0, 1)]
    varied = [
        number for number in range(len(film.layers))
        if np.any(bands[0][1, number] > bands[0][0, number])
        or np.any(bands[1][1, number] > bands[1][0, number])
    ]  # fmt: skip
    return tuple(
        LayerIndex(film.layers[i].material.name, wavelength, np.asarray(n[i]), np.asarray(k[i]),
                   bands[0][:, i], bands[1][:, i])
        for i in varied
    )  # fmt: skip


def to_dataset(result: OpticsFit) -> "xr.Dataset":
    """Dataset of the spectra with their fits, each over its own wavenumbers."""
    found: dict[str, Any] = {}
    for number, one in enumerate(result.spectra):
        spectrum, axis = one.measured.spectrum, f"wavenumber_{number}"
        values = ("measured", spectrum.value), ("fitted", one.reading), ("film", one.share)
        found |= variables(axis, [
            Series(axis, spectrum.wavenumber / PER_CENTIMETRE, "cm^-1",
                   f"wavenumber of {spectrum.source}"),
            *(Series(f"{name}_{number}", value, "", f"{name} {spectrum.quantity}")
              for name, value in values),
        ])  # fmt: skip
    found |= variables(("number_1", "number_2"), [
        Series("covariance", result.covariance, "SI", "covariance of the free numbers")
    ])  # fmt: skip
    return dataset(
        "numbers of a film from its spectra", found,
        [one.measured.spectrum.source for one in result.spectra], warnings=result.warnings,
        free_numbers=", ".join(result.numbers),
    )  # fmt: skip
