r"""Least squares of measured spectra over the numbers of a film.

An ordinate reads :math:`y = (1+s)m + o` plus noise, with the film's share :math:`m`, and errors of
scale :math:`s` and zero :math:`o` that all points of a spectrum have in common. These have the
standard uncertainties that are stated of the instrument, and are fitted with the film's numbers.

Numbers are fitted as shares of the way between their bounds; derivatives are JAX's.
"""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import product
from typing import Any

import numpy as np

from lightflyer.array.namespace import Numeric, by_numpy
from lightflyer.core.errors import ParameterError
from lightflyer.film.optics.stack import Film
from lightflyer.lab.estimate import point_noise
from lightflyer.lab.optics.data import ORDINATES, FilmSpectrum, FreeNumber, OpticsSample

LEAST_ERROR = 1e-4  # Least standard error of a point [1]: no photometer is better

_TOLERANCE = 1e-8
_FLAT = 1e-2  # least curvature that a direction is taken to have, that of a prior of ten widths
_IMPOSSIBLE = 1e6  # residual of a film that has no optical constants, in standard errors
_STEP = 1e-6  # of the width between the bounds, over which slopes are taken
_OF_S = {"s": 1.0, "p": 0.0, "none": 0.5}  # share of s-polarised light


class OpticalModel:
    """What the instruments would read of a film without their own errors."""

    def __init__(self, sample: OpticsSample):
        self.free, self._build = sample.free, sample.build
        self.lowest = np.array([one.lowest for one in sample.free])
        self.widths = np.array([one.highest for one in sample.free]) - self.lowest
        sizes = [len(one.spectrum.value) for one in sample.spectra]
        #: of each point of all spectra in turn
        self._wavelength = np.concatenate([one.spectrum.wavelength for one in sample.spectra])
        lit = [
            (one.incidence, one.side, one.spectrum.quantity, _OF_S[one.polarisation])
            for one in sample.spectra
        ]
        self._incidence, self._side, self._quantity, self._of_s = (
            np.repeat(one, sizes) for one in zip(*lit, strict=True)
        )
        self._last: tuple[bytes, tuple[np.ndarray, np.ndarray]] | None = None

    def film(self, position: Numeric) -> Film:
        """The film at a position between the bounds."""
        values = self.lowest + self.widths * position
        return self._build({one.name: values[number] for number, one in enumerate(self.free)})

    def values(self, position: np.ndarray) -> np.ndarray:
        """Free numbers in SI units at positions, shape (..., free)."""
        return np.asarray(self.lowest + self.widths * position)

    def positions(self, values: np.ndarray) -> np.ndarray:
        """Positions between the bounds of free numbers in SI units."""
        return np.asarray((values - self.lowest) / self.widths)

    def require_fit(self, sample: OpticsSample) -> None:
        """Raise :class:`ParameterError` unless a sample has these bounds and wavelengths."""
        bounds, theirs = (
            [(one.name, one.lowest, one.highest) for one in free]
            for free in (self.free, sample.free)
        )
        other = OpticalModel(sample)
        points = ("_wavelength", "_incidence", "_side", "_quantity")
        if bounds != theirs or not all(
            np.array_equal(getattr(self, name), getattr(other, name)) for name in points
        ):
            raise ParameterError("the model is that of other bounds, spectra or wavelengths")

    def shares(self, position: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Share of the light at each point of all spectra, and its derivatives (points, free)."""
        position = np.asarray(position, float)
        key = position.tobytes()
        if self._last is None or self._last[0] != key:
            slopes = [
                (self._shares(position + step) - self._shares(position - step)) / (2.0 * _STEP)
                for step in _STEP * np.eye(position.size)
            ]
            self._last = key, (self._shares(position), np.stack(slopes, axis=-1))
        return self._last[1]

    def _shares(self, position: np.ndarray) -> np.ndarray:
        found = np.empty(self._wavelength.size)
        with by_numpy():
            film = self.film(position)
            # all points that light falls on alike are computed together
            for side, angles in product(("top", "bottom"), (False, True)):
                is_angle = np.isin(self._quantity, ORDINATES)
                here = np.flatnonzero((self._side == side) & (is_angle == angles))
                if not here.size:
                    continue
                lit: Any = self._wavelength[here], self._incidence[here], side
                if angles:
                    values = dict(zip(ORDINATES, film.ellipsometry(*lit), strict=True))
                else:
                    optics, of_s = film.optics(*lit), self._of_s[here]
                    values = {
                        name: of_s * share[0] + (1.0 - of_s) * share[1]
                        for name, share in (
                            ("transmittance", optics.transmittance),
                            ("reflectance", optics.reflectance),
                        )
                    }
                shown = self._quantity[here]
                found[here] = np.select([shown == name for name in values], [*values.values()])
        return found


@dataclass(frozen=True)
class FilmSolution:
    """A minimum."""

    position: np.ndarray  # Of the free numbers between their bounds, shape (free,)
    # Errors of scale and zero, in their standard uncertainties, shape (spectra, 2)
    errors: np.ndarray
    cost: float  # Sum of squared residuals, priors included

    @property
    def vector(self) -> np.ndarray:
        """Everything that is fitted, shape (size,)."""
        return np.concatenate([self.position, self.errors.ravel()])


@dataclass(frozen=True)
class FilmProblem:
    """Residuals of all spectra in standard errors."""

    model: OpticalModel
    free: tuple[FreeNumber, ...]
    spectra: tuple[FilmSpectrum, ...]
    # Standard error of a point of each spectrum, as if points were independent [1]
    spread: tuple[float, ...]
    informed: bool = True  # Whether what is known of the free numbers beforehand counts

    @classmethod
    def of(cls, sample: OpticsSample, model: OpticalModel | None = None) -> "FilmProblem":
        """The problem with the noise of neighbouring points as standard error."""
        model = OpticalModel(sample) if model is None else model
        model.require_fit(sample)
        spread = [max(point_noise(one.spectrum.value), LEAST_ERROR) for one in sample.spectra]
        return cls(model, sample.free, sample.spectra, tuple(spread))

    @cached_property
    def _accuracy(self) -> np.ndarray:
        return np.array([one.errors for one in self.spectra])

    @cached_property
    def _owner(self) -> np.ndarray:
        """Number of each point's spectrum, shape (points,)."""
        sizes = [len(one.spectrum.value) for one in self.spectra]
        return np.repeat(np.arange(len(sizes)), sizes)

    @cached_property
    def _known(self) -> list[tuple[int, float, float]]:
        """Number, position and its standard uncertainty of what is known beforehand."""
        starts = self.model.positions(np.array([one.start for one in self.free]))
        return [
            (number, float(starts[number]), one.prior / self.model.widths[number])
            for number, one in enumerate(self.free)
            if one.prior is not None and self.informed
        ]

    def by_spectrum(self, values: np.ndarray) -> list[np.ndarray]:
        """Values at all points, by spectrum."""
        return np.split(values, np.flatnonzero(np.diff(self._owner)) + 1)

    def readings(self, solution: FilmSolution) -> list[np.ndarray]:
        """What the instruments read by a solution, without noise."""
        return self.by_spectrum(self._readings(solution.position, solution.errors))

    def _readings(self, position: np.ndarray, errors: np.ndarray) -> np.ndarray:
        scale, zero = (errors * self._accuracy)[self._owner].T
        return np.asarray(self.model.shares(position)[0] * (1.0 + scale) + zero)

    def residuals(self, vector: np.ndarray) -> np.ndarray:
        """Residuals in standard errors, those of priors last; ``vector`` (size,)."""
        found = self._solution(vector)
        measured = np.concatenate([one.spectrum.value for one in self.spectra])
        off = self._readings(found.position, found.errors) - measured
        priors = [(vector[number] - at) / spread for number, at, spread in self._known]
        points = off / np.array(self.spread)[self._owner]
        whole = np.concatenate([points, found.errors.ravel(), priors])
        # a formula of n and k may not hold everywhere between the bounds; no step goes there
        return np.where(np.isfinite(whole), whole, _IMPOSSIBLE)

    def jacobian(self, vector: np.ndarray) -> np.ndarray:
        """Derivatives of the residuals, shape (residuals, size)."""
        count, owner = len(self.free), self._owner
        share, slopes = self.model.shares(vector[:count])
        scale, zero = self._accuracy[owner].T
        rows = np.zeros((owner.size, vector.size))
        rows[:, :count] = (1.0 + scale * vector[count + 2 * owner])[:, None] * slopes
        rows[np.arange(owner.size), count + 2 * owner] = scale * share
        rows[np.arange(owner.size), count + 2 * owner + 1] = zero
        rows /= np.array(self.spread)[owner][:, None]
        alone = np.eye(vector.size)
        priors = [alone[number] / spread for number, _, spread in self._known]
        whole = np.concatenate([rows, alone[count:], np.reshape(priors, (-1, vector.size))])
        return np.where(np.isfinite(whole), whole, 0.0)

    def is_possible(self, solution: FilmSolution) -> bool:
        """Whether the film of a solution has optical constants."""
        return bool(np.all(np.isfinite(self.model.shares(solution.position)[0])))

    def _solution(self, vector: np.ndarray, cost: float = np.nan) -> FilmSolution:
        count = len(self.free)
        return FilmSolution(vector[:count], vector[count:].reshape(-1, 2), cost)

    def minimise(
        self,
        position: np.ndarray,
        errors: np.ndarray | None = None,
        held: Mapping[int, float] | None = None,
    ) -> FilmSolution:
        """The minimum near a position; ``position`` (free,); ``errors`` (spectra, 2)."""
        import lmfit  # takes a while

        held = held or {}
        errors = np.zeros((len(self.spectra), 2)) if errors is None else errors
        parameters = lmfit.Parameters()
        for number, value in enumerate([*position, *errors.ravel()]):
            low, high = (0.0, 1.0) if number < len(self.free) else (-np.inf, np.inf)
            parameters.add(f"p{number}", held.get(number, value), number not in held, low, high)
        varied = [one.vary for one in parameters.values()]

        def vector(given: Any) -> np.ndarray:
            return np.array([*given.valuesdict().values()])

        minimizer = lmfit.Minimizer(lambda given: self.residuals(vector(given)), parameters,
                                    calc_covar=False)  # fmt: skip
        result = minimizer.leastsq(
            Dfun=lambda given: self.jacobian(vector(given)).T[varied], col_deriv=1,
            ftol=_TOLERANCE, xtol=_TOLERANCE, gtol=0.0,
        )  # fmt: skip
        return self._solution(vector(result.params), float(result.chisqr))

    def covariance(self, solution: FilmSolution) -> np.ndarray:
        """Covariance of the free numbers' positions, shape (free, free)."""
        # Numbers that the spectra do not tell have a variance that is large, not infinite: that of
        # ten times the distance between their bounds.
        full, _ = self._inverse(solution)
        return np.asarray(full[: len(self.free), : len(self.free)])

    def determined_numbers(self, solution: FilmSolution) -> float:
        """How many numbers the spectra tell, of which some are known beforehand in part."""
        full, jacobian = self._inverse(solution)
        points = jacobian[: self._owner.size]
        return float(np.sum((points @ full) * points))

    def common_errors(self, solution: FilmSolution) -> np.ndarray:
        """Variance of the free numbers over that without errors common to ordinates, (spectra,)."""
        # N, C and S of a point follow from one Ψ and one Δ, whose errors move them together; which
        # way depends on the point. How far deviations at one point add up, the residuals tell, as
        # in variances of clustered data [LiangZeger1986]_.
        full, jacobian = self._inverse(solution)
        moves = (jacobian @ full)[:, : len(self.free)] * self.residuals(solution.vector)[:, None]
        parts = self.by_spectrum(moves[: self._owner.size])
        readings: dict[tuple[float, str, bytes], list[int]] = {}
        for number, one in enumerate(self.spectra):
            if one.spectrum.quantity in ORDINATES:
                points = one.incidence, one.side, one.spectrum.wavenumber.tobytes()
                readings.setdefault(points, []).append(number)
        found = np.ones(len(self.spectra))
        for reading in readings.values():
            together = np.sum(sum(parts[each] for each in reading) ** 2, axis=0)
            apart = sum(np.sum(parts[each] ** 2, axis=0) for each in reading)
            told = apart > 0.0  # numbers that these ordinates say anything of
            if told.any():
                found[reading] = max(1.0, float(np.mean(together[told] / apart[told])))
        return found

    def _inverse(self, solution: FilmSolution) -> tuple[np.ndarray, np.ndarray]:
        """Covariance of everything that is fitted, and the residuals' derivatives."""
        jacobian = self.jacobian(solution.vector)
        values, vectors = np.linalg.eigh(jacobian.T @ jacobian)
        return (vectors / np.maximum(values, _FLAT)) @ vectors.T, jacobian


def select_covered(sample: OpticsSample) -> tuple[OpticsSample, tuple[str, ...]]:
    """The sample with the points of its spectra that the materials' data cover."""
    film = sample.build({one.name: one.start for one in sample.free})
    shortest, longest = film.covered_range
    kept, warnings = [], []
    for one in sample.spectra:
        wavelength = one.spectrum.wavelength
        inside = (wavelength >= shortest) & (wavelength <= longest)
        if np.count_nonzero(inside) < 2:
            raise ParameterError(
                f"{one.spectrum.source}: the materials' optical data extend from "
                f"{1e6 * shortest:.4g} to {1e6 * longest:.4g} µm, the spectrum from "
                f"{1e6 * wavelength[-1]:.4g} to {1e6 * wavelength[0]:.4g} µm"
            )
        if not inside.all():
            warnings.append(
                f"{one.spectrum.source}: {np.count_nonzero(~inside)} of {inside.size} points are "
                f"outside the materials' optical data, {1e6 * shortest:.4g} to "
                f"{1e6 * longest:.4g} µm, and are not used"
            )
        part = replace(
            one.spectrum,
            wavenumber=one.spectrum.wavenumber[inside],
            value=one.spectrum.value[inside],
        )
        kept.append(replace(one, spectrum=part))
    return replace(sample, spectra=tuple(kept)), tuple(warnings)
